// Friction and restitution of contacts in parts of surfaces that have their own (docs/methods/friction.md 4).
#pragma once

#include "components/contact_table.h"
#include "components/surface_rules.h"
#include "jobs/executor.h"
#include "systems/collision/inputs/collision_inputs.h"

namespace skerry {

/// Friction at one place of a surface as a tensor in the tangent plane: the coefficients along a unit tangent, times 1
/// along and `across` across it. If `across` is 1, the direction has no effect.
struct FrictionShape {
    Vec3 direction = Vec3::Zero();
    Real across = 1;
};

/// Geometric mean of two friction tensors whose larger eigenvalue may differ from 1: the coefficients along `axis` are
/// those of isotropic friction times `scale`. Order does not matter (Ando, Li and Mathias 2004, the mean of two
/// positive definite matrices).
struct MeanShape {
    FrictionAxis axis;
    Real scale = 1;
};
MeanShape mean_shape(const FrictionShape& first, const FrictionShape& second, const Vec3& normal);

/// Overwrites friction, restitution and friction axes of contacts whose features belong to sets. A contact at a feature
/// in two sets has the properties of the set that was added last. Returns false if there are no sets. Runs in parallel
/// over blocks of contacts.
bool apply_surface_sets(Executor& executor, const CollisionInputs& inputs, const SurfaceSetTable& sets,
                        const SetOfFeature& set_of, ContactTable& contacts);

}  // namespace skerry
