// Stable step of a mesh, and the tetrahedra that limit it.
#pragma once

#include <vector>

#include "engine/fill/explicit_body.h"
#include "skerry/scene.h"

namespace skerry {

struct BodyPlan;
struct ScenePlan;

/// Returns the BodyCase of a body (explicit_body.h): its materials and settings. step_bound() treats the body as
/// explicit and elastic, so that its mesh has a stable step even if its dynamics are rigid or implicit.
BodyCase body_case_of(const ScenePlan& plan, const BodyPlan& body);

struct CostlyTetrahedron {
    Index tetrahedron = 0;      // index of the tetrahedron in the mesh
    Vec3 place = Vec3::Zero();  // centroid of the tetrahedron, in the coordinates of the mesh [m]
    Real altitude = 0;          // smallest altitude of the tetrahedron [m]
    Real mean_edge = 0;         // mean length of the tetrahedron's six edges [m]
    Real step = 0;              // largest stable step that this tetrahedron allows [s]
};

/// Stable step that the mesh would have without its worst tetrahedra.
struct StepWithout {
    Real share = 0;  // fraction of the tetrahedra that are removed
    std::size_t count = 0;
    Real step = 0;  // [s]
};

struct StepBound {
    Real step = 0;  // [s]
    ElementKind element{};
    // The tetrahedron with the smallest step, then others by increasing step. Tetrahedra whose steps exceed the
    // smallest one by less than 10 % are sorted by altitude.
    std::vector<CostlyTetrahedron> worst;
    std::vector<StepWithout> without;
    // In a mesh of more than 100,000 tetrahedra, a fraction of them is left out of `without`, to save time, if they all
    // allow similar steps.
    // - alike_share: largest fraction that was left out,
    // - alike_ratio: longest step that its tetrahedra allow, divided by the shortest one.
    //
    // Both are 0 if no fraction was left out.
    Real alike_share = 0;
    Real alike_ratio = 0;
};

/// Computes the stable step of a body with this mesh. Throws SceneError if the mesh cannot be a body. With `details` it
/// also finds the few worst tetrahedra, and the stable step without the worst 0.1 % and 1 % of the tetrahedra.
StepBound step_bound(const Mesh& mesh, const BodyCase& body_case, bool details);

/// Computes the stable step, with details, of a body in an existing world. The world must not have planned or made a
/// step since the body was added. `mesh` and `body_case` describe the body.
StepBound step_bound(World& world, BodyHandle body, const Mesh& mesh, const BodyCase& body_case);

}  // namespace skerry
