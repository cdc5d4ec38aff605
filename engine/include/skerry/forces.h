// Contact forces and reaction forces of attachments, summed over a call of advance (docs/outputs.md).
#pragma once

#include <limits>
#include <string>
#include <vector>

#include "components/handle.h"
#include "components/types.h"

namespace skerry {
struct WorldState;  // internal type, declared outside the pragma that exports symbols
}

#pragma GCC visibility push(default)
namespace skerry {

/// Forces on a body or a collider, summed over all committed steps of the last call of advance. Discarded attempts at a
/// step contribute nothing.
struct ForceReport {
    Vec3 impulse = Vec3::Zero();  // sum of the impulses on the object [N s]
    // Sum of the moments of the impulses about `moment_point` [N m s]. Each impulse acts at its contact point at the
    // start of the step.
    Vec3 moment_impulse = Vec3::Zero();
    Vec3 friction_impulse = Vec3::Zero();  // tangential part of `impulse` [N s]; zero for attachments
    // Sum of the magnitudes of the normal impulses [N s]. It shows pressure even where opposite impulses cancel.
    Real pressing_impulse = 0;
    // Largest force of a single step [N]: the impulse of the step divided by its force interval (see `seconds`).
    Real largest_force = 0;
    Index contacts = 0;       // number of contacts with an impulse in the last step
    Index most_contacts = 0;  // largest number of contacts with an impulse in any step
    // Sum of the force intervals of the steps [s]. The forces of a step act from the middle of the previous step to the
    // middle of this one, its force interval (docs/methods/time_stepping.md 1.5). So the sum is the duration of the
    // call plus half of (length of the last step before the call - length of the last step of the call).
    //
    // With leapfrog and for implicit bodies, the force interval is the step, and the sum is the duration.
    Real seconds = 0;
    Vec3 moment_point = Vec3::Zero();  // point about which moments are taken, as given to measure_forces [m]
    // False if the call was too short for the force to be measured (docs/outputs.md), or took no step.
    bool measured = true;

    /// Mean force over the call [N]; NaN if the force was not measured.
    Vec3 force() const { return mean(impulse); }
    /// Mean moment over the call about moment_point [N m]; NaN if the force was not measured.
    Vec3 moment() const { return mean(moment_impulse); }
    /// Mean moment over the call about another fixed point [N m]; NaN if the force was not measured.
    Vec3 moment_about(const Vec3& point) const;

private:
    Vec3 mean(const Vec3& sum) const {
        constexpr Real none = std::numeric_limits<Real>::quiet_NaN();
        return measured && seconds > 0 ? Vec3(sum / seconds) : Vec3(Vec3::Constant(none));
    }
};

/// Forces between two partners: two bodies, a body and a collider, or a body that touches itself.
struct PairForces {
    BodyHandle first{};         // the body on which the forces act
    BodyHandle second{};        // the second body; a stale handle if the second partner is a collider
    ColliderHandle collider{};  // the collider; a stale handle if the second partner is a body
    ForceReport on_first;       // forces that the second partner exerts on the first
};

/// A view of the measured forces of a world. It is valid until the world is moved or destroyed. Contacts of bodies and
/// colliders that were removed since the last call of advance are not included.
///
/// Steps do not compute sleeping bodies. The forces on a sleeping body are mean values over the time in which it was
/// still before it fell asleep (at least sleep_time). They balance its weight and loads, with an error of at most the
/// change of its momentum during this time, divided by this time. If forces were not measured then, those of the last
/// step before the sleep are used, which World::contacts also returns.
///
/// The impulses on the two partners of a pair are exactly opposite, but their moments about one point are not: each
/// impulse acts at the surface of its own object, so friction exerts a moment across a gap between the two surfaces.
class Forces {
public:
    /// Sum of the forces of all contacts on a body. Contacts of a body with itself add only to `contacts` and
    /// `pressing_impulse`, because their impulses cancel.
    ForceReport on(BodyHandle body) const;
    ForceReport on(ColliderHandle collider) const;
    /// Forces between two given partners; zero if the two did not touch. If the two partners are one body, the impulses
    /// cancel.
    ForceReport on(BodyHandle body, BodyHandle by) const;
    ForceReport on(BodyHandle body, ColliderHandle by) const;
    ForceReport on(ColliderHandle collider, BodyHandle by) const;
    /// Forces of an attachment on its body. They keep the attached nodes on their prescribed motion: they balance
    /// elastic forces, weight, loads and contacts, and accelerate the nodes. If several attachments hold a node, its
    /// force belongs to the attachment added last.
    ///
    /// The drag by MaterialSettings::damping is not included: in a body with held nodes it acts on all nodes, as if the
    /// body were in a medium at rest.
    ForceReport by(AttachmentHandle attachment) const;
    /// All pairs of objects that touched during the last call of advance: first body-collider pairs, then body-body
    /// pairs, each sorted by handles.
    std::vector<PairForces> pairs() const;

private:
    friend class World;
    explicit Forces(const WorldState& world) : world_(&world) {}
    const WorldState* world_;
};

}  // namespace skerry
#pragma GCC visibility pop
