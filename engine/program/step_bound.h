// Which tetrahedra of a mesh bound its step.
#pragma once

#include <map>
#include <vector>

#include "skerry/scene.h"

namespace skerry {

/// A body of its own: what its step depends on. As made, the default material and elements.
struct StepCase {
    Settings settings;
    MaterialSettings material;
    BodySettings body;
    std::map<int, MaterialSettings> labelled;  // of tetrahedra by label
};

struct CostlyTetrahedron {
    Index tetrahedron = 0;      // of the mesh, counted from 0
    Vec3 place = Vec3::Zero();  // m, its middle, in the mesh's frame
    Real altitude = 0;          // m, smallest
    Real mean_edge = 0;         // m, of its six
    Real step = 0;              // s, that it allows
};

/// What the step would be if some were not there.
struct StepWithout {
    Real share = 0;  // of the tetrahedra
    std::size_t count = 0;
    Real step = 0;  // s
};

struct StepBound {
    Real step = 0;  // s
    ElementKind element{};
    std::vector<CostlyTetrahedron> worst;  // the one that bounds the step, then the flattest that allow hardly more
    std::vector<StepWithout> without;
};

/// The stable step of a body of this mesh; with `details`, what bounds it: the few worst, and what the step is when the
/// worst 0.1 % and 1 % are taken out, with the masses that the rest then has. Throws SceneError for a mesh that is no
/// body.
StepBound step_bound(const Mesh& mesh, const StepCase& of, bool details);

}  // namespace skerry
