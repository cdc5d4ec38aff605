#include "engine/world/forces/force_ledger.h"

#include <Eigen/Geometry>
#include <algorithm>

#include "engine/world/state/model.h"
#include "engine/world/state/step_scratch.h"

namespace skerry {

namespace {

std::uint32_t slots_in(std::span<const std::uint32_t> slot) {
    std::uint32_t count = 0;
    for (const std::uint32_t s : slot)
        if (s != no_slot) count = std::max(count, s + 1);
    return count;
}

template <class Row>
void make_room(std::vector<Row>& rows, std::uint32_t count) {
    if (rows.size() < count) rows.resize(count);
}

std::size_t body_row(const Model& model, std::uint32_t slot) {
    return static_cast<std::size_t>(model.body_map.row(model.body_map.handle_of_slot(slot)));
}

PairKey key_of(const Model& model, const ContactPartners& partners) {
    const std::uint32_t first = model.bodies.slot[static_cast<std::size_t>(partners.first)];
    if (partners.second != no_index) return {true, first, model.bodies.slot[static_cast<std::size_t>(partners.second)]};
    return {false, first, model.colliders.slot[static_cast<std::size_t>(partners.collider)]};
}

bool is_zero(const ContactSums& sums) {
    return sums.pressing == 0 && sums.impulse == Vec3::Zero();
}

}  // namespace

void ForceLedger::Peak::end_step(Real h) {
    largest_force = std::max(largest_force, impulse.norm() / h);
    contacts = step_contacts;
    most_contacts = std::max(most_contacts, contacts);
    impulse.setZero();
    step_contacts = 0;
}

void ForceLedger::start(const Model& model, const Vec3& moment_point) {
    *this = {};
    on_ = true;
    moment_point_ = moment_point;
    fit(model);
    for (std::size_t b = 0; b < model.bodies.slot.size(); ++b)
        if (model.bodies.kind[b] == BodyKind::deformable)
            bodies_[model.bodies.slot[b]].unknown = model.bodies.asleep[b] != 0;
}

void ForceLedger::fit(const Model& model) {
    std::uint32_t body_count = 0;
    for (std::size_t b = 0; b < model.bodies.slot.size(); ++b)
        if (model.bodies.kind[b] == BodyKind::deformable) body_count = std::max(body_count, model.bodies.slot[b] + 1);
    make_room(bodies_, body_count);
    make_room(colliders_, slots_in(model.colliders.slot));
    make_room(attachments_, slots_in(model.attachments.slot));
}

void ForceLedger::begin_call(const Model& model, StepScratch& scratch) {
    fit(model);
    seconds_ = 0;
    for (PairRow& row : pairs_) {
        row.sums = {};
        row.peak.begin_call();
    }
    std::erase_if(pairs_, [](const PairRow& row) { return is_zero(row.still); });
    for (BodyRow& row : bodies_) {
        row.peak.begin_call();
        row.unknown_seconds = 0;
    }
    for (Peak& peak : colliders_) peak.begin_call();
    for (AttachmentRow& row : attachments_) {
        row.sums = {};
        row.peak.begin_call();
    }
    scratch.forces.held_velocity.resize(model.nodes.velocity.size());
    for (const Index n : model.attachments.node)
        scratch.forces.held_velocity[static_cast<std::size_t>(n)] = model.nodes.velocity[static_cast<std::size_t>(n)];
}

ForceLedger::PairRow& ForceLedger::pair(const PairKey& key) {
    const auto place = std::ranges::lower_bound(pairs_, key, {}, &PairRow::key);
    if (place != pairs_.end() && place->key == key) return *place;
    return *pairs_.insert(place, PairRow{.key = key});
}

void ForceLedger::add_to_partners(const PairKey& key, const Vec3& impulse, Index contacts) {
    bodies_[key.first].peak.add(impulse, contacts);
    if (!key.bodies)
        colliders_[key.second].add(-impulse, contacts);
    else
        bodies_[key.second].peak.add(-impulse, key.second == key.first ? 0 : contacts);
}

/// What a pair does at the end of a step: rest goes on as it was while the two were still, and how it was is noted.
void ForceLedger::end_pair_step(const Model& model, std::span<const std::uint8_t> rested, Real h, PairRow& row) {
    const std::size_t first = body_row(model, row.key.first);
    const std::size_t second = row.key.bodies ? body_row(model, row.key.second) : first;
    if (rested[first] && rested[second]) {
        if (!row.touched && row.still_seconds > 0) {
            const ContactSums held = (h / row.still_seconds) * row.still;
            row.sums += held;
            row.peak.add(held.impulse, row.still_contacts);
            add_to_partners(row.key, held.impulse, row.still_contacts);
        }
        return;
    }
    row.still_contacts = row.peak.step_contacts;
    const Real still_for = std::min(model.bodies.still_time[first], model.bodies.still_time[second]);
    if (still_for > 0) {
        row.still_seconds = std::min(still_for, measured_seconds_);
    } else {
        row.still = {};
        row.still_seconds = 0;
    }
}

void ForceLedger::add_pairs(const Model& model, std::span<const std::uint8_t> rested, const StepScratch& scratch) {
    const Real h = scratch.parameters.h;
    for (const PairSums& of_step : scratch.forces.pairs) {
        PairRow& row = pair(key_of(model, of_step.partners));
        row.sums += of_step.sums;
        row.still += of_step.sums;
        row.peak.add(of_step.sums.impulse, of_step.contacts);
        row.touched = true;
        add_to_partners(row.key, of_step.sums.impulse, of_step.contacts);
    }
    for (PairRow& row : pairs_) {
        end_pair_step(model, rested, h, row);
        row.peak.end_step(h);
        row.touched = false;
    }
    for (BodyRow& row : bodies_) row.peak.end_step(h);
    for (Peak& peak : colliders_) peak.end_step(h);
}

void ForceLedger::add_reactions(const Model& model, std::span<const std::uint8_t> rested, const StepScratch& scratch) {
    const Real h = scratch.parameters.h;
    for (std::size_t a = 0; a < model.attachments.slot.size(); ++a) {
        if (model.attachments.slot[a] == no_slot) continue;
        AttachmentRow& row = attachments_[model.attachments.slot[a]];
        const auto body = static_cast<std::size_t>(model.attachments.body[a]);
        ImpulseAndMoment of_step = scratch.forces.reactions[a];
        if (rested[body]) {
            const Real part = row.still_seconds > 0 ? h / row.still_seconds : 0;
            of_step = {part * row.still.impulse, part * row.still.moment};
        } else if (model.bodies.still_time[body] > 0) {
            row.still += of_step;
            row.still_seconds = std::min(model.bodies.still_time[body], measured_seconds_);
        } else {
            row.still = {};
            row.still_seconds = 0;
        }
        row.sums += of_step;
        row.peak.add(of_step.impulse, 0);
        row.peak.end_step(h);
    }
}

void ForceLedger::add_step(const Model& model, std::span<const std::uint8_t> rested, StepScratch& scratch) {
    const Real h = scratch.parameters.h;
    seconds_ += h;
    measured_seconds_ += h;
    add_pairs(model, rested, scratch);
    add_reactions(model, rested, scratch);
    for (std::size_t b = 0; b < model.bodies.slot.size(); ++b) {
        if (model.bodies.kind[b] != BodyKind::deformable) continue;
        BodyRow& row = bodies_[model.bodies.slot[b]];
        if (row.unknown && rested[b]) row.unknown_seconds += h;
        row.unknown &= model.bodies.asleep[b] != 0;
    }
    for (const Index n : model.attachments.node)
        scratch.forces.held_velocity[static_cast<std::size_t>(n)] = model.nodes.velocity[static_cast<std::size_t>(n)];
}

void ForceLedger::add_drift(const Model& model, Real seconds, StepScratch& scratch) {
    // From the last attachment back, as in measure_reactions.
    for (std::size_t a = model.attachments.slot.size(); a-- > 0;) {
        const Range nodes = model.attachments.nodes[a];
        if (model.has_frame(static_cast<std::size_t>(model.attachments.body[a]))) continue;  // has momenta of its own
        for (auto i = static_cast<std::size_t>(nodes.begin); i < static_cast<std::size_t>(nodes.end); ++i) {
            const auto n = static_cast<std::size_t>(model.attachments.node[i]);
            const Vec3 impulse = model.nodes.mass[n] * (model.nodes.velocity[n] - scratch.forces.held_velocity[n]);
            scratch.forces.held_velocity[n] = model.nodes.velocity[n];
            if (model.attachments.slot[a] == no_slot) continue;
            const Vec3 from = model.nodes.position[n] - seconds * model.nodes.velocity[n] - moment_point_;
            attachments_[model.attachments.slot[a]].sums += {impulse, from.cross(impulse)};
        }
    }
}

void ForceLedger::forget_body(std::uint32_t slot) {
    std::erase_if(pairs_, [slot](const PairRow& row) {
        return row.key.first == slot || (row.key.bodies && row.key.second == slot);
    });
    if (slot < bodies_.size()) bodies_[slot] = {};
}

void ForceLedger::forget_collider(std::uint32_t slot) {
    std::erase_if(pairs_, [slot](const PairRow& row) { return !row.key.bodies && row.key.second == slot; });
    if (slot < colliders_.size()) colliders_[slot] = {};
}

void ForceLedger::forget_attachment(std::uint32_t slot) {
    if (slot < attachments_.size()) attachments_[slot] = {};
}

const ForceLedger::BodyRow& ForceLedger::body(std::uint32_t slot) const {
    static const BodyRow none;
    return slot < bodies_.size() ? bodies_[slot] : none;
}

const ForceLedger::Peak& ForceLedger::collider(std::uint32_t slot) const {
    static const Peak none;
    return slot < colliders_.size() ? colliders_[slot] : none;
}

const ForceLedger::AttachmentRow& ForceLedger::attachment(std::uint32_t slot) const {
    static const AttachmentRow none;
    return slot < attachments_.size() ? attachments_[slot] : none;
}

}  // namespace skerry
