// Sums of what contacts and attachments give over a call of advance, while somebody asks for them. No step depends on
// it.
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

/// Names partners as handles do, so that rows may come and go. Pairs with a collider come first.
struct PairKey {
    bool bodies = false;                  // the second is a body, not a collider
    std::uint32_t first = 0, second = 0;  // slots

    auto operator<=>(const PairKey&) const = default;
};

class ForceLedger {
public:
    /// Largest of the steps of a call, and those of the last one.
    struct Peak {
        Real largest_force = 0;  // N
        Index contacts = 0, most_contacts = 0;
        // of the present step
        Vec3 impulse = Vec3::Zero();  // N s
        Index step_contacts = 0;
        void add(const Vec3& more, Index of_contacts) {
            impulse += more;
            step_contacts += of_contacts;
        }
        /// `kick`: s, for which loads act in it.
        void end_step(Real kick);
        void begin_call() { *this = {}; }
    };
    struct PairRow {
        PairKey key{};
        ContactSums sums{};   // of the call
        ContactSums still{};  // since one of the two last moved
        Real still_seconds = 0;
        Index still_contacts = 0;  // of the last step that was not rest
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
    /// s, for which forces have acted in the call on what `row` of BodyTable moves; no_index: on all but implicit
    /// bodies.
    Real seconds_on(const Model& model, Index row) const;
    /// The same of a pair: of both where both are implicit.
    Real seconds_of(const Model& model, const PairKey& key) const;

    /// What holds bodies that rest already is as it was when they came to rest.
    void start(const Model& model, const RestingContactTable& resting, const Vec3& moment_point);
    void stop() { *this = {}; }
    /// Before the first step of a call, or after a call that took none. `held_velocity`: by node, of held nodes.
    void begin_call(const Model& model, StepScratch& scratch);
    /// After a step that was committed. `rested`: by body, whether it was at rest when the step began.
    void add_step(const Model& model, std::span<const std::uint8_t> rested, StepScratch& scratch);
    /// After leapfrog has let positions drift by so many seconds, with new velocities of held nodes.
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
    Vec3 moment_point_ = Vec3::Zero();  // m
    // s, for which forces acted on implicit bodies (`whole`), and on others
    struct Seconds {
        Real whole = 0, kick = 0;
    };
    Seconds step_, call_;
    Real measured_seconds_ = 0;   // s, since forces are measured
    std::vector<PairRow> pairs_;  // by key
    // by slot
    std::vector<Peak> bodies_, colliders_;
    std::vector<AttachmentRow> attachments_;
};

}  // namespace skerry
