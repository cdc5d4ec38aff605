// Sums of contact and attachment forces over one call of advance. They are measured only on request of the user, and no
// step depends on them.
#pragma once

#include <compare>
#include <cstdint>
#include <span>
#include <vector>

#include "components/resting_contact_table.h"
#include "components/types.h"
#include "systems/contact/sum_contact_impulses.h"
#include "systems/dynamics/checks/measure_reactions.h"

namespace skerry {

struct Model;
struct StepScratch;
struct ForceReport;

/// Key of a pair of contact partners. It names each partner by the slot of its handle, so that the key stays valid when
/// table rows move. Pairs with a collider are sorted first.
struct PairKey {
    bool bodies = false;                  // true: the second partner is a body; false: it is a collider
    std::uint32_t first = 0, second = 0;  // slots

    auto operator<=>(const PairKey&) const = default;
};

class ForceLedger {
public:
    /// Forces and contacts of an object or a pair of objects in one call of advance. Also contains the sums over the
    /// present step, from which they follow.
    struct Peak {
        Real largest_force = 0;                 // largest mean force of a step [N]
        Index contacts = 0, most_contacts = 0;  // number of contacts in the last step, and the largest in a step
        // Impulse and number of contacts in the present step. end_step sets both to zero.
        Vec3 impulse = Vec3::Zero();  // [N s]
        Index step_contacts = 0;
        void add(const Vec3& more, Index of_contacts) {
            impulse += more;
            step_contacts += of_contacts;
        }
        /// Ends a step. `seconds`: time for which forces act on the object in the step [s].
        void end_step(Real seconds);
        void begin_call() { *this = {}; }
    };
    struct PairRow {
        PairKey key{};
        // number of contacts in the last step that began with a body of the pair awake
        ContactSums sums{};          // sums of contact impulses over the call of advance
        ContactSums sums_at_rest{};  // sums of contact impulses over the time in which both objects were still
        Real still_seconds = 0;      // time over which `sums_at_rest` is summed [s]
        // number of contacts in the last step at the start of which a body of the pair was awake
        Index still_contacts = 0;
        Peak peak{};
        bool touched = false;  // true if the pair had contacts in the present step
    };
    struct AttachmentRow {
        ImpulseAndMoment sums, sums_at_rest;
        Real still_seconds = 0;
        Peak peak{};
    };

    bool on() const { return on_; }
    const Vec3& moment_point() const { return moment_point_; }
    /// Time for which forces have acted on an object in this call [s]. `row`: row of BodyTable for a body; no_index for
    /// a collider.
    Real seconds_on(const Model& model, Index row) const;
    /// Time for which forces have acted between the objects of a pair in this call [s]. If all bodies of the pair are
    /// implicit, it is the sum of the step lengths. Otherwise it is the sum of their StepParameters::kick_time.
    Real seconds_of(const Model& model, const PairKey& key) const;
    /// True if the call was long enough for contact forces to be measured. The step before the call may have left small
    /// gaps. A call much shorter than this step may not close them, so that contacts would have no force.
    bool shows_contacts() const;
    /// True if the force of an attachment counts as measured: rounding errors of positions and velocities have a small
    /// effect, and on a rigid body shows_contacts() is true. On a sleeping body the force counts in every call with at
    /// least one step. `attachment`: row of AttachmentTable. `impulse`: its impulse in this call [N s].
    bool shows_reaction(const Model& model, std::size_t attachment, const Vec3& impulse) const;

    /// Starts to measure forces. Sleeping bodies get the contact and attachment forces of the last step before they
    /// fell asleep.
    void start(const Model& model, const RestingContactTable& resting, const Vec3& moment_point);
    void stop() { *this = {}; }
    /// Begins the sums of a call of advance: sets them to zero, and stores the velocities of held nodes. Must be called
    /// before the first step of the call, and again at its end if it had no step. `step_before`: length of the last
    /// step before the call; 0 if there was none [s].
    void begin_call(const Model& model, Real step_before, StepScratch& scratch);
    /// Must be called after a committed step. `was_asleep`: for each body, nonzero if the body was asleep when the step
    /// began.
    void add_step(const Model& model, std::span<const std::uint8_t> was_asleep, StepScratch& scratch);
    /// Adds the impulses by which attachments change the velocities of held nodes in a drift (the part of a leapfrog
    /// step that moves the positions). Must be called after the drift has moved positions by `seconds` [s].
    void add_drift(const Model& model, Real seconds, StepScratch& scratch);
    void forget_body(std::uint32_t slot);
    void forget_collider(std::uint32_t slot);
    void forget_attachment(std::uint32_t slot);

    std::span<const PairRow> pairs() const { return pairs_; }
    const Peak& body(std::uint32_t slot) const;
    const Peak& collider(std::uint32_t slot) const;
    const AttachmentRow& attachment(std::uint32_t slot) const;

private:
    PairRow& pair(const PairKey& key);
    void fit(const Model& model);
    void take_over_rest(const Model& model, const RestingContactTable& resting);
    void take_over_reactions(const Model& model, std::span<const Vec3> contact_force);
    void take_over_axes(const Model& model, std::size_t attachment, std::span<const Vec3> contact_force);
    void add_pairs(const Model& model, std::span<const std::uint8_t> was_asleep, const StepScratch& scratch);
    bool stayed_still(const Model& model, std::size_t body) const;
    void end_pair_step(const Model& model, std::span<const std::uint8_t> was_asleep, PairRow& row);
    void add_to_partners(const PairKey& key, const Vec3& impulse, Index contacts);
    void add_reactions(const Model& model, std::span<const std::uint8_t> was_asleep, const StepScratch& scratch);

    bool on_ = false;
    Vec3 moment_point_ = Vec3::Zero();  // [m]
    // Time for which forces act [s]: `whole_step` on implicit bodies, `kick` on all other objects.
    struct ForceTimes {
        Real whole_step = 0, kick = 0;
    };
    ForceTimes step_, call_;
    Real step_before_ = 0;        // length of the last step before the call; 0 if there was none [s]
    std::vector<PairRow> pairs_;  // sorted by key
    // indexed by handle slot
    std::vector<Peak> bodies_, colliders_;
    std::vector<AttachmentRow> attachments_;
};

}  // namespace skerry
