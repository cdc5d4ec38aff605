// A cheap bound on how stiff elements have become, for those that are made to stand a stiffness
// (docs/methods/clusters.md 3).
#pragma once

#include "components/material_table.h"
#include "systems/material/with_law.h"

namespace skerry {

/// Pa, not below the bound of the law in each lane; 0 where the law does not stiffen. `square`: |F|^2, `J`: det F.
template <class T>
[[gnu::always_inline]] inline T quick_stiffness(const MaterialConstants& material, const T& square, const T& J) {
    return with_law(material.model, [&](auto law) {
        if constexpr (law.stiffness_varies)
            return law.rough_stiffness_bound(material, square, J);
        else
            return T{};
    });
}

}  // namespace skerry
