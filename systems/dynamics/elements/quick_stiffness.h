// A cheap bound on how stiff elements have become, for those that are made to stand a stiffness
// (docs/methods/clusters.md 3).
#pragma once

#include "components/material_table.h"
#include "systems/material/with_law.h"

namespace skerry {

/// Pa, of the material's Hessian in each lane: that of the law; 0 where the law does not stiffen.
template <class T>
T quick_stiffness(const MaterialConstants& material, const LaneMat3<T>& F) {
    T stiffness{};
    with_law(material.model, [&](auto law) {
        if constexpr (law.stiffness_varies) stiffness = law.stiffness_bound(material, F);
    });
    return stiffness;
}

}  // namespace skerry
