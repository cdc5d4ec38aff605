// Cheap bound on the present stiffness of elements, for comparison with the assumed stiffness of implicit elements
// (docs/methods/clusters.md 3).
#pragma once

#include "components/material_table.h"
#include "systems/material/with_law.h"

namespace skerry {

/// Cheap upper bound on the stiffness of a material law in each lane [Pa]. Returns 0 if the stiffness of the law is
/// constant, since it then never exceeds the assumed stiffness. `square`: |F|^2, `J`: det F.
template <class Law, class T>
[[gnu::always_inline]] inline T quick_stiffness(const Law& law, const MaterialConstants& material, const T& square,
                                                const T& J) {
    if constexpr (Law::stiffness_varies)
        return law.rough_stiffness_bound(material, square, J);
    else
        return T{};
}
template <class T>
[[gnu::always_inline]] inline T quick_stiffness(const MaterialConstants& material, const T& square, const T& J) {
    return with_law(material.model, [&](auto law) { return quick_stiffness(law, material, square, J); });
}

}  // namespace skerry
