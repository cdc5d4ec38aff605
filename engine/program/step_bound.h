// Tetrahedra of a mesh that bound its stable step.
#pragma once

#include <map>
#include <vector>

#include "skerry/scene.h"

namespace skerry {

/// All inputs on which the stable step of a single body depends. Defaults: default material and elements.
struct StepCase {
    Settings settings;
    MaterialSettings material;
    BodySettings body;
    std::map<int, MaterialSettings> labelled;  // materials of tetrahedra by label
};

struct CostlyTetrahedron {
    Index tetrahedron = 0;      // number in the mesh, counted from 0
    Vec3 place = Vec3::Zero();  // centre in the mesh's frame [m]
    Real altitude = 0;          // smallest altitude [m]
    Real mean_edge = 0;         // mean of the six edges [m]
    Real step = 0;              // step that this tetrahedron allows [s]
};

/// The stable step if some tetrahedra were removed.
struct StepWithout {
    Real share = 0;  // share of the tetrahedra removed
    std::size_t count = 0;
    Real step = 0;  // [s]
};

struct StepBound {
    Real step = 0;  // [s]
    ElementKind element{};
    std::vector<CostlyTetrahedron> worst;  // the one that bounds the step, then the flattest with hardly more
    std::vector<StepWithout> without;
};

/// Computes the stable step of a body with this mesh. With `details` it also finds the few worst tetrahedra, and the
/// step without the worst 0.1 % and 1 %, with the masses of the remaining mesh. Throws SceneError for a mesh that is
/// not a valid body.
StepBound step_bound(const Mesh& mesh, const StepCase& of, bool details);

}  // namespace skerry
