#include "systems/dynamics/elements/keep_frames.h"

#include <algorithm>

#include "components/check.h"
#include "jobs/parallel_for.h"
#include "systems/material/with_law.h"

namespace skerry {

void keep_frames(Executor& executor, const ElementInputs& elements, std::span<const ElementRotation> rotation_next,
                 std::span<ElementRotation> rotation) {
    SKERRY_CHECK(rotation.size() == elements.node.size() && rotation_next.size() == rotation.size());
    const auto turns = [](const MaterialConstants& material) { return has_frame(material.model); };
    if (std::none_of(elements.constants.begin(), elements.constants.end(), turns)) return;
    constexpr std::size_t blocks_per_job = 256;
    parallel_for(executor, rotation.size(), blocks_per_job, [&](std::size_t begin, std::size_t end) {
        if (elements.schedule.none_active(begin, end)) return;
        for (std::size_t b = begin; b < end; ++b)
            if (elements.schedule.duration(b) != 0 &&
                turns(elements.constants[static_cast<std::size_t>(elements.material[b])]))
                rotation[b] = rotation_next[b];
    });
}

}  // namespace skerry
