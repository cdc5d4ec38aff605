// Friction and restitution of contacts in surface sets: parts of a surface with properties of their own
// (docs/methods/friction.md 4).
#pragma once

#include "components/contact_table.h"
#include "components/surface_rules.h"
#include "jobs/executor.h"
#include "systems/collision/inputs/collision_inputs.h"

namespace skerry {

/// Dependence of friction on the direction at a place of a surface. The friction coefficients are multiplied by 1 along
/// the unit tangent `direction`, and by `across` in (0, 1] across it. If `across` is 1, `direction` is not used.
struct FrictionShape {
    Vec3 direction = Vec3::Zero();
    Real across = 1;
};

/// Friction between two surfaces whose friction depends on the direction (docs/methods/friction.md 4.2). Its tensor
/// is the geometric mean of the friction tensors A, B of the surfaces, each with the eigenvalues 1 and `across`. With
/// a = sqrt(det A), b = sqrt(det B) and G = A/a + B/b, the mean of two 2x2 matrices is sqrt(a b) G / sqrt(det G) (Ando,
/// Li and Mathias 2004).
struct MeanShape {
    FrictionAxis axis;
    // larger eigenvalue of the mean: the coefficients along `axis` are those of isotropic friction times `scale`
    Real scale = 1;
};
MeanShape mean_shape(const FrictionShape& first, const FrictionShape& second, const Vec3& normal);

/// Overwrites friction, restitution and friction axes of contacts whose features (vertices, edges, faces) belong to
/// surface sets. A contact at a feature in two sets has the properties of the set that was added last. Returns false if
/// there are no sets. Runs in parallel over blocks of contacts.
bool apply_surface_sets(Executor& executor, const CollisionInputs& inputs, const SurfaceSetTable& sets,
                        const SetOfFeature& set_of, ContactTable& contacts);

}  // namespace skerry
