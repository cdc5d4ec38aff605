#include "systems/dynamics/elements/keep_memory.h"

#include <algorithm>

#include "jobs/parallel_for.h"
#include "systems/material/with_law.h"

namespace skerry {

void keep_memory(Executor& executor, const ElementInputs& elements, ElementBlockTable& table) {
    const auto turns = [](const MaterialConstants& material) { return has_frame(material.model); };
    const auto remembers = [&](const MaterialConstants& material) { return turns(material) || material.relaxes(); };
    if (std::none_of(elements.constants.begin(), elements.constants.end(), remembers)) return;
    const std::span<const ElementRotation> rotation_next = table.rotation_next.span();
    const std::span<const SpringStrain> strain_next = table.spring_strain_next.span();
    const std::span<ElementRotation> rotation = table.rotation.span();
    const std::span<SpringStrain> strain = table.spring_strain.span();
    constexpr std::size_t blocks_per_job = 256;
    parallel_for(executor, rotation.size(), blocks_per_job, [&](std::size_t begin, std::size_t end) {
        for (std::size_t b = begin; b < end; ++b) {
            if (elements.is_left_out(b)) continue;
            const MaterialConstants& material = elements.constants[static_cast<std::size_t>(elements.material[b])];
            if (turns(material)) rotation[b] = rotation_next[b];
            if (material.relaxes()) strain[b] = strain_next[b];
        }
    });
}

}  // namespace skerry
