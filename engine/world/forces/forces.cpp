#include "skerry/forces.h"

#include <Eigen/Geometry>
#include <algorithm>

#include "engine/base/complaint.h"
#include "engine/world/world_state.h"

namespace skerry {

namespace {

ForceReport report_of(const ForceLedger& ledger, const ForceLedger::Peak& peak, Real seconds) {
    ForceReport report;
    report.seconds = seconds;
    report.moment_point = ledger.moment_point();
    report.largest_force = peak.largest_force;
    report.contacts = peak.contacts;
    report.most_contacts = peak.most_contacts;
    return report;
}

enum class PairSide { first, second };

void add(const ContactSums& sums, PairSide side, ForceReport& report) {
    const Real sign = side == PairSide::first ? 1 : -1;
    report.impulse += sign * sums.impulse;
    report.moment_impulse += side == PairSide::first ? sums.first_moment : sums.second_moment;
    report.friction_impulse += sign * sums.friction;
    report.pressing_impulse += sums.pressing;
}

/// True if all bodies of a pair sleep. The stored contact forces of the pair are then mean values over the time for
/// which its two objects were still.
bool rests(const Model& model, const PairKey& key) {
    const auto asleep = [&](std::uint32_t slot) {
        return model.bodies.asleep[static_cast<std::size_t>(model.body_map.row(model.body_map.handle_of_slot(slot)))] !=
               0;
    };
    return asleep(key.first) && (!key.bodies || asleep(key.second));
}

ForceReport pair_report(const WorldState& world, const PairKey& key, PairSide side) {
    const ForceLedger& ledger = world.record.forces;
    const Real seconds = ledger.seconds_of(world.model, key);
    const bool measured = seconds > 0 && (ledger.shows_contacts() || rests(world.model, key));
    for (const ForceLedger::PairRow& row : ledger.pairs())
        if (row.key == key) {
            ForceReport report = report_of(ledger, row.peak, seconds);
            add(row.sums, side, report);
            report.measured = measured;
            return report;
        }
    ForceReport none = report_of(ledger, {}, seconds);
    none.measured = measured;
    return none;
}

}  // namespace

Vec3 ForceReport::moment_about(const Vec3& point) const {
    return moment() - (point - moment_point).cross(force());
}

void World::measure_forces(bool on, const Vec3& moment_point) {
    state_->require_between_steps("measure_forces");
    if (!moment_point.allFinite())
        refuse("measure_forces", "moment_point", "a value that is not finite", "three finite numbers (m)");
    state_->settle();
    if (on)
        state_->record.forces.start(state_->model, state_->cache.resting, moment_point);
    else
        state_->record.forces.stop();
}

bool World::measures_forces() const {
    return state_->record.forces.on();
}

Forces World::forces() const {
    if (!state_->record.forces.on())
        refuse("forces", {}, "a world that does not measure forces", "a call of measure_forces before that of advance");
    return Forces(*state_);
}

ForceReport Forces::on(BodyHandle body) const {
    const Index row = world_->model.row(body, "forces");
    const ForceLedger& ledger = world_->record.forces;
    ForceReport report = report_of(ledger, ledger.body(body.slot), ledger.seconds_on(world_->model, row));
    for (const ForceLedger::PairRow& pair : ledger.pairs()) {
        const bool is_first = pair.key.first == body.slot;
        const bool is_second = pair.key.bodies && pair.key.second == body.slot;
        if (is_first && is_second)
            report.pressing_impulse += pair.sums.pressing;
        else if (is_first || is_second)
            add(pair.sums, is_first ? PairSide::first : PairSide::second, report);
    }
    const bool was_asleep = world_->model.bodies.asleep[static_cast<std::size_t>(row)] != 0;
    report.measured = report.seconds > 0 && (was_asleep || ledger.shows_contacts());
    return report;
}

ForceReport Forces::on(ColliderHandle collider) const {
    (void)world_->model.row(collider, "forces");
    const ForceLedger& ledger = world_->record.forces;
    ForceReport report = report_of(ledger, ledger.collider(collider.slot), ledger.seconds_on(world_->model, no_index));
    // The mean force is the impulse divided by the time for which forces act: the sum of step lengths for implicit
    // bodies, of kick times for others (docs/methods/time_stepping.md 1.5). It is not defined if the collider touches
    // both kinds of bodies and these times differ too much.
    Real shortest = infinity, longest = 0;
    bool touched = false, awake = false;
    for (const ForceLedger::PairRow& pair : ledger.pairs()) {
        if (pair.key.bodies || pair.key.second != collider.slot) continue;
        touched = true;
        awake = awake || !rests(world_->model, pair.key);
        const Real seconds = ledger.seconds_of(world_->model, pair.key);
        shortest = std::min(shortest, seconds);
        longest = std::max(longest, seconds);
        add(pair.sums, PairSide::second, report);
    }
    if (touched) report.seconds = longest;
    constexpr Real small_share = 0.01;  // largest accepted relative difference between the times
    const bool even = !touched || longest - shortest <= small_share * longest;
    report.measured = report.seconds > 0 && even && ((touched && !awake) || ledger.shows_contacts());
    return report;
}

ForceReport Forces::on(BodyHandle body, BodyHandle by) const {
    (void)world_->model.row(body, "forces");
    (void)world_->model.row(by, "forces");
    const bool is_first = body.slot <= by.slot;
    const PairKey key{true, is_first ? body.slot : by.slot, is_first ? by.slot : body.slot};
    ForceReport report = pair_report(*world_, key, is_first ? PairSide::first : PairSide::second);
    if (body == by) {
        report.impulse = report.moment_impulse = report.friction_impulse = Vec3::Zero();
        report.largest_force = 0;
    }
    return report;
}

ForceReport Forces::on(BodyHandle body, ColliderHandle by) const {
    (void)world_->model.row(body, "forces");
    (void)world_->model.row(by, "forces");
    const PairKey key{false, body.slot, by.slot};
    return pair_report(*world_, key, PairSide::first);
}

ForceReport Forces::on(ColliderHandle collider, BodyHandle by) const {
    (void)world_->model.row(by, "forces");
    (void)world_->model.row(collider, "forces");
    const PairKey key{false, by.slot, collider.slot};
    return pair_report(*world_, key, PairSide::second);
}

ForceReport Forces::by(AttachmentHandle attachment) const {
    const auto row = static_cast<std::size_t>(world_->model.row(attachment, "forces"));
    const ForceLedger& ledger = world_->record.forces;
    const ForceLedger::AttachmentRow& sums = ledger.attachment(attachment.slot);
    ForceReport report =
        report_of(ledger, sums.peak, ledger.seconds_on(world_->model, world_->model.attachments.body[row]));
    report.impulse = sums.sums.impulse;
    report.moment_impulse = sums.sums.moment;
    report.measured = ledger.shows_reaction(world_->model, row, report.impulse);
    return report;
}

std::vector<PairForces> Forces::pairs() const {
    std::vector<PairForces> pairs;
    for (const ForceLedger::PairRow& row : world_->record.forces.pairs()) {
        if (row.sums.pressing == 0) continue;
        PairForces pair;
        pair.first = world_->model.body_map.handle_of_slot(row.key.first);
        if (row.key.bodies) {
            pair.second = world_->model.body_map.handle_of_slot(row.key.second);
            pair.on_first = on(pair.first, pair.second);
        } else {
            pair.collider = world_->model.collider_map.handle_of_slot(row.key.second);
            pair.on_first = on(pair.first, pair.collider);
        }
        pairs.push_back(pair);
    }
    return pairs;
}

}  // namespace skerry
