// Sums of contact and attachment forces over a call of advance, while a user has requested them. No step depends on
// them.
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

/// Names partners by slot, as handles do, so that rows may come and go. Pairs with a collider come first.
struct PairKey {
    bool bodies = false;                  // the second is a body, not a collider
    std::uint32_t first = 0, second = 0;  // slots

    auto operator<=>(const PairKey&) const = default;
};

class ForceLedger {
public:
    /// Largest force and contact counts of the steps of a call, and the sums of the present step.
    struct Peak {
        Real largest_force = 0;  // [N]
        Index contacts = 0, most_contacts = 0;
        // sums of the present step
        Vec3 impulse = Vec3::Zero();  // [N s]
        Index step_contacts = 0;
        void add(const Vec3& more, Index of_contacts) {
            impulse += more;
            step_contacts += of_contacts;
        }
        /// `kick`: time for which loads act in the step [s].
        void end_step(Real kick);
        void begin_call() { *this = {}; }
    };
    struct PairRow {
        PairKey key{};
        ContactSums sums{};   // sums over the call
        ContactSums still{};  // sums since one of the two last moved
        Real still_seconds = 0;
        Index still_contacts = 0;  // contacts of the last step in which one of the two was awake
        Peak peak{};
        bool touched = false;  // in the present step
    };
    struct AttachmentRow {
        ImpulseAndMoment sums, still;
        Real still_seconds = 0;
        Peak peak{};
    };

    bool on() const { return on_; }
    const Vec3& moment_point() const { return moment_point_; }
    /// Time for which forces have acted in the call on the body in `row` of BodyTable [s]; no_index: on anything that
    /// is not an implicit body.
    Real seconds_on(const Model& model, Index row) const;
    /// Time for which forces have acted in the call on a pair [s]. The implicit interval counts only if all its bodies
    /// are implicit.
    Real seconds_of(const Model& model, const PairKey& key) const;

    /// Starts measuring. Supports of bodies already at rest count with the forces of the time when they came to rest.
    void start(const Model& model, const RestingContactTable& resting, const Vec3& moment_point);
    void stop() { *this = {}; }
    /// To be called before the first step of a call, or after a call that took no step. Stores the velocity of held
    /// nodes.
    void begin_call(const Model& model, StepScratch& scratch);
    /// To be called after a committed step. `rested`: by body, whether it was at rest when the step began.
    void add_step(const Model& model, std::span<const std::uint8_t> rested, StepScratch& scratch);
    /// To be called after leapfrog has let positions drift by `seconds`, with new velocities of held nodes.
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
    void add_pairs(const Model& model, std::span<const std::uint8_t> rested, const StepScratch& scratch);
    void end_pair_step(const Model& model, std::span<const std::uint8_t> rested, PairRow& row);
    void add_to_partners(const PairKey& key, const Vec3& impulse, Index contacts);
    void add_reactions(const Model& model, std::span<const std::uint8_t> rested, const StepScratch& scratch);

    bool on_ = false;
    Vec3 moment_point_ = Vec3::Zero();  // [m]
    // intervals in which forces acted on implicit bodies (`whole`) and on others (`kick`) [s]
    struct Seconds {
        Real whole = 0, kick = 0;
    };
    Seconds step_, call_;
    Real measured_seconds_ = 0;   // time since measuring began [s]
    std::vector<PairRow> pairs_;  // sorted by key
    // by slot
    std::vector<Peak> bodies_, colliders_;
    std::vector<AttachmentRow> attachments_;
};

}  // namespace skerry
