#include "systems/dynamics/stability/watch_stable_steps.h"

#include <algorithm>

#include "systems/dynamics/stability/stable_step.h"

namespace skerry {

namespace {

/// One more than the highest level of a body.
int levels_of_body(const std::array<Index, element_level_count>& level_count) {
    int levels = element_level_count;
    while (levels > 1 && level_count[static_cast<std::size_t>(levels - 1)] == 0) --levels;
    return levels;
}

}  // namespace

std::uint64_t pieces_of_body(Range blocks, const std::array<Index, element_level_count>& level_count) {
    return pieces_of_look(blocks, levels_of_body(level_count));
}

void watch_stable_steps(const WatchInputs& inputs, StepWatch& watch) {
    for (; watch.body < watch.kept; ++watch.body) {
        const auto b = static_cast<std::size_t>(watch.body);
        const Range blocks = inputs.body_blocks[b];
        const int levels = levels_of_body(inputs.level_count[b]);
        const std::uint64_t pieces = pieces_of_look(blocks, levels);
        if (watch.step[b] != StepWatch::not_looked_at) {
            const std::uint64_t due = watch.target > watch.before ? std::min(pieces, watch.target - watch.before) : 0;
            if (watch.look.piece < due)
                continue_look(inputs.elements, blocks, levels, watch.position, inputs.mass, watch.stiffness_sum, due,
                              watch.look);
            if (due < pieces) return;
            watch.step[b] = result_of(watch.look).step;
        }
        watch.look = {};
        watch.before += pieces;
    }
}

}  // namespace skerry
