#include "systems/dynamics/stability/watch_stable_steps.h"

#include <algorithm>

#include "jobs/parallel_for.h"
#include "systems/dynamics/stability/stable_step.h"

namespace skerry {

void watch_stable_steps(Executor& executor, const WatchInputs& inputs, Column<WatchPart>& parts, StepWatch& watch) {
    parts.clear();
    parts.reserve(inputs.body_blocks.size());  // this capacity is enough for any later step
    for (bool whole = true; whole && watch.body < watch.kept; watch.body += whole) {
        const auto b = static_cast<std::size_t>(watch.body);
        const std::uint64_t pieces = pieces_of_check(inputs.elements, inputs.body_blocks[b]);
        if (watch.step[b] != StepWatch::not_evaluated) {
            const std::uint64_t before = watch.first_piece[b];
            const std::uint64_t due = watch.target > before ? std::min(pieces, watch.target - before) : 0;
            whole = due == pieces;
            parts.push_back({watch.body, due, whole, watch.evaluation});
        }
        if (!whole) continue;
        watch.evaluation = {};
    }
    watch.before = watch.first_piece[static_cast<std::size_t>(watch.body)];
    parallel_for(executor, parts.size(), 1, [&](std::size_t begin, std::size_t end) {
        for (std::size_t p = begin; p < end; ++p) {
            WatchPart& part = parts[p];
            const auto b = static_cast<std::size_t>(part.body);
            continue_check(executor, inputs.elements, inputs.body_blocks[b], watch.position, inputs.mass,
                           watch.stiffness_sum, part.until, part.evaluation);
        }
    });
    for (const WatchPart& part : parts) {
        if (part.whole)
            watch.step[static_cast<std::size_t>(part.body)] = result_of(part.evaluation).step;
        else
            watch.evaluation = part.evaluation;
    }
}

}  // namespace skerry
