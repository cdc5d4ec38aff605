// Contact forces and reactions of attachments, summed over a call of advance (docs/outputs.md).
#pragma once

#include <string>
#include <vector>

#include "components/handle.h"
#include "components/types.h"

namespace skerry {
struct WorldState;  // internal; declared outside the block of public symbols
}

#pragma GCC visibility push(default)
namespace skerry {

/// Forces on a body or a collider over the last call of advance: sums over all steps of the call. A step that needed
/// several tries counts once.
struct ForceReport {
    Vec3 impulse = Vec3::Zero();  // [N s]
    // sum of the moments of the impulses about `moment_point` [N m s]; each impulse acts at its own point, as it is at
    // the start of the step
    Vec3 moment_impulse = Vec3::Zero();
    Vec3 friction_impulse = Vec3::Zero();  // tangential part of `impulse` [N s]; zero for attachments
    // sum of the magnitudes of the normal impulses [N s]: it shows pressure even where opposite impulses cancel
    Real pressing_impulse = 0;
    Real largest_force = 0;   // largest force of a step [N]: its impulse over the time for which loads act in it
    Index contacts = 0;       // number of contacts with an impulse in the last step
    Index most_contacts = 0;  // largest number of contacts with an impulse in any step
    // Time for which loads acted [s]: the duration of the call plus half of (last step before the call - last step of
    // the call). For implicit bodies and with leapfrog it is the duration alone (docs/methods/time_stepping.md 1.5).
    Real seconds = 0;
    Vec3 moment_point = Vec3::Zero();  // reference point of moments, as given to measure_forces [m]

    /// Mean force over the call [N]; zero if the call took no step.
    Vec3 force() const { return seconds > 0 ? Vec3(impulse / seconds) : Vec3::Zero(); }
    /// Mean moment over the call about moment_point [N m].
    Vec3 moment() const { return seconds > 0 ? Vec3(moment_impulse / seconds) : Vec3::Zero(); }
    /// Mean moment over the call about another fixed point [N m].
    Vec3 moment_about(const Vec3& point) const;
};

/// Forces of the second partner on the first: two bodies, a body and a collider, or a body that touches itself.
struct PairForces {
    BodyHandle first{};
    BodyHandle second{};        // a stale handle if the second partner is a collider
    ColliderHandle collider{};  // a stale handle if the second partner is a body
    ForceReport on_first;
};

/// The measured forces of a world: a view, valid until the world is moved or destroyed. Contacts of bodies and
/// colliders that were removed since the call are not included.
///
/// Forces on bodies at rest are means over the time in which the bodies were still before they came to rest. For each
/// body their sum equals its weight and loads to within its mass times its speed over sleep_time. If forces were not
/// measured at that time, the forces of the last step before the rest are used (World::contacts).
///
/// The impulses on the two partners of a pair are opposite to the last bit. Their moments differ by the moment of
/// friction across the distance of the surfaces: each impulse acts on the nodes, or the point of the collider, that it
/// is applied to.
class Forces {
public:
    /// Sum over all contacts. Contacts of a body with itself add only to `contacts` and `pressing_impulse`.
    ForceReport on(BodyHandle body) const;
    ForceReport on(ColliderHandle collider) const;
    /// Forces of one pair: zero if the two did not touch. For a body with itself the impulses cancel.
    ForceReport on(BodyHandle body, BodyHandle by) const;
    ForceReport on(BodyHandle body, ColliderHandle by) const;
    ForceReport on(ColliderHandle collider, BodyHandle by) const;
    /// Forces of an attachment on its body. They hold its nodes on their prescribed motion against elements, weight,
    /// loads and contacts, and accelerate them. A node held by several attachments counts for the one added last.
    /// Damping of a held body is not included: it acts on all nodes, like a medium at rest.
    ForceReport by(AttachmentHandle attachment) const;
    /// All pairs that touched: first bodies with colliders, then bodies with bodies, each in the order of handles.
    std::vector<PairForces> pairs() const;

private:
    friend class World;
    explicit Forces(const WorldState& world) : world_(&world) {}
    const WorldState* world_;
};

}  // namespace skerry
#pragma GCC visibility pop
