// List of all material laws.
#pragma once

#include "components/options.h"
#include "systems/material/corotational.h"
#include "systems/material/guard.h"
#include "systems/material/linear.h"
#include "systems/material/ogden.h"
#include "systems/material/orthotropic.h"
#include "systems/material/stable_neo_hookean.h"

namespace skerry {

/// Calls visit(law), where `law` is an empty object of the struct that implements the model. visit is compiled once for
/// each law. Each law is a struct in a file of its own, with these members ("by lanes": templates that compute one
/// element per lane of a vector type):
///
///     has_frame           true if the law uses a frame that rotates with the element: then all functions by lanes take
///                         R, the rotation nearest to F
///     stiffness_varies    true if the stiffness depends on the deformation: then the law also has stiffness_bound by
///                         lanes, and an element gets a share in the mass of its nodes in proportion to this bound
///     stress_flops        number of operations of stress by lanes per tetrahedron, for profile_elements
///     energy_density, stress, stiffness_bound (material, F)     for one element, the simple reference for the kernels
///     tangent (material, F)                                     for one element, for Newton steps
///     energy_density, stress (material, F[, R])                 by lanes; the stress may be a SplitStress
///     rough_stiffness_bound (material, |F|^2, det F)            by lanes, if stiffness_varies: >= stiffness_bound
///     add_stiffness (material, F[, R], H)                       by lanes: adds dP/dF or an upper bound to H
///                                                               (StiffnessTerms in
///                                                               dynamics/stability/element_stiffness.cpp)
///
/// A law also needs an entry in with_law and, if materials can use it, in EnumNames<MaterialModel>.
template <class Visit>
[[gnu::always_inline]] inline decltype(auto) with_law(MaterialModel model, Visit&& visit) {
    switch (model) {
        case MaterialModel::linear:
            return visit(Linear{});
        case MaterialModel::corotational:
            return visit(Corotational{});
        case MaterialModel::guard:
            return visit(Guard{});
        case MaterialModel::ogden:
        case MaterialModel::hencky:
            return visit(Ogden{});
        case MaterialModel::orthotropic:
            return visit(Orthotropic{});
        case MaterialModel::stable_neo_hookean:
            break;
    }
    return visit(StableNeoHookean{});
}

inline bool has_frame(MaterialModel model) {
    return with_law(model, [](auto law) { return law.has_frame; });
}

}  // namespace skerry
