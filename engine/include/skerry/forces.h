// Forces of contacts and reactions of attachments, summed over a call of advance (docs/outputs.md).
#pragma once

#include <string>
#include <vector>

#include "components/handle.h"
#include "components/types.h"

namespace skerry {
struct WorldState;  // named here, where it is not public
}

#pragma GCC visibility push(default)
namespace skerry {

/// What a body or a collider got over the last call of advance: sums over all its steps, each taken once however many
/// tries it took.
struct ForceReport {
    Vec3 impulse = Vec3::Zero();  // N s
    // N m s, about `moment_point`: of each impulse where it acts, at the start of its step
    Vec3 moment_impulse = Vec3::Zero();
    Vec3 friction_impulse = Vec3::Zero();  // N s, of `impulse` what acts along the surfaces; attachments have none
    // N s, sizes of the normal parts added up: how hard surfaces are pressed, also where opposite ones cancel
    Real pressing_impulse = 0;
    Real largest_force = 0;   // N, of one step: the impulse of that step over the time that loads act in it
    Index contacts = 0;       // with an impulse, in the last step
    Index most_contacts = 0;  // the same, of the step that had most
    // s, for which loads acted: by which the call moved time on, and half of what its last step is shorter than that
    // before its first (docs/methods/time_stepping.md 1.5)
    Real seconds = 0;
    Vec3 moment_point = Vec3::Zero();  // m, that of measure_forces

    /// N, mean over the call; zero where it took no step.
    Vec3 force() const { return seconds > 0 ? Vec3(impulse / seconds) : Vec3::Zero(); }
    /// N m, mean over the call, about moment_point.
    Vec3 moment() const { return seconds > 0 ? Vec3(moment_impulse / seconds) : Vec3::Zero(); }
    /// N m, mean over the call, about another point that does not move.
    Vec3 moment_about(const Vec3& point) const;
};

/// Two bodies, a body and a collider, or a body that touches itself, and what the second gave to the first.
struct PairForces {
    BodyHandle first{};
    BodyHandle second{};        // stale where it is a collider
    ColliderHandle collider{};  // stale where it is a body
    ForceReport on_first;
};

/// A view of a world that measures forces, valid as long as the world is where it is. What was removed since the call
/// has taken its contacts along. Bodies at rest are held by the mean of what held them while they were still: the sum
/// over what holds one is its weight and loads to within mass times its speed over sleep_time. Where forces were not
/// measured then, by what held them in the last step before they came to rest (World::contacts).
///
/// The partners of a pair have opposite impulses, to the last bit. Their moments differ by what the distance between
/// their surfaces makes of friction: each acts on the nodes, or on the point of the collider, which it is applied to.
class Forces {
public:
    /// By all that it touches. Contacts of a body with itself add nothing but contacts and pressing_impulse.
    ForceReport on(BodyHandle body) const;
    ForceReport on(ColliderHandle collider) const;
    /// Of one pair: zero where they did not touch. Of a body with itself impulses cancel.
    ForceReport on(BodyHandle body, BodyHandle by) const;
    ForceReport on(BodyHandle body, ColliderHandle by) const;
    ForceReport on(ColliderHandle collider, BodyHandle by) const;
    /// By an attachment on its body: what keeps its nodes on their way against elements, weight, loads and contacts,
    /// and what it takes to speed them up. A node that several attachments hold counts for the one added last.
    /// Damping of a held body is not in it: it acts on all nodes, as a medium that stands still would.
    ForceReport by(AttachmentHandle attachment) const;
    /// All pairs that touched: those of bodies and colliders, then those of bodies, in the order of handles.
    std::vector<PairForces> pairs() const;

private:
    friend class World;
    explicit Forces(const WorldState& world) : world_(&world) {}
    const WorldState* world_;
};

}  // namespace skerry
#pragma GCC visibility pop
