#include "engine/world/forces/force_ledger.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <limits>

#include "engine/world/edit/rigid_bodies.h"
#include "engine/world/kernels.h"
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

bool rests(const Model& model, Index body) {
    return model.bodies.asleep[static_cast<std::size_t>(body)] != 0;
}

/// Force [N], and moment about `moment_point` [N m], with which an attachment balances the elastic forces of an
/// implicit body at the nodes `held`.
ImpulseAndMoment hold_of_implicit(const Model& model, std::size_t attachment, std::span<const std::size_t> held,
                                  const Vec3& moment_point) {
    const auto body = static_cast<std::size_t>(model.attachments.body[attachment]);
    const std::vector<Vec3> force = elastic_forces(model, body);
    const auto first = static_cast<std::size_t>(model.bodies.nodes[body].begin);
    const auto turning = [&](std::size_t n) {
        return Vec3((model.nodes.position[n] - moment_point).cross(force[n - first]));
    };
    ImpulseAndMoment hold;
    for (const std::size_t n : held) hold += {-force[n - first], -turning(n)};
    const auto r = static_cast<std::size_t>(model.bodies.rigid[body].begin);
    // The attachment also holds the rotating frame, on which the elastic forces on all nodes exert a moment.
    if (model.rigid_bodies.holder[r] == static_cast<Index>(attachment))
        for (std::size_t n = first; n < first + force.size(); ++n) hold.moment += turning(n);
    return hold;
}

/// True for an implicit body. Forces act on it for the length of the step, and on other bodies for
/// StepParameters::kick_time (docs/methods/time_stepping.md 1.5).
bool is_implicit(const Model& model, std::size_t body) {
    return model.bodies.implicit[body].size() > 0;
}

/// True if all bodies of a pair are implicit. A collider as second partner does not matter.
bool is_implicit(const Model& model, const PairKey& key) {
    return is_implicit(model, body_row(model, key.first)) &&
           (!key.bodies || is_implicit(model, body_row(model, key.second)));
}

bool is_zero(const ContactSums& sums) {
    return sums.pressing == 0 && sums.impulse == Vec3::Zero();
}

}  // namespace

void ForceLedger::Peak::end_step(Real seconds) {
    largest_force = std::max(largest_force, impulse.norm() / seconds);
    contacts = step_contacts;
    most_contacts = std::max(most_contacts, contacts);
    impulse.setZero();
    step_contacts = 0;
}

void ForceLedger::start(const Model& model, const RestingContactTable& resting, const Vec3& moment_point) {
    *this = {};
    on_ = true;
    moment_point_ = moment_point;
    fit(model);
    take_over_rest(model, resting);
}

/// Initialises the forces on sleeping bodies: those of the last step before the bodies fell asleep. They are stored as
/// sums over a fictitious time of one second (still_seconds), so that each impulse equals its force.
void ForceLedger::take_over_rest(const Model& model, const RestingContactTable& resting) {
    Column<Vec3> force, held;
    for (std::size_t c = 0; c < resting.size(); ++c) force.push_back(resting.contact.impulse[c] / resting.step[c]);
    ContactSumInputs inputs = ContactSumInputs::bind({}, resting.contact, model.bodies, model.nodes, model.attachments);
    inputs.impulse = force;
    Column<PairSums> pairs;
    sum_contact_impulses(inputs, moment_point_, pairs, held);
    for (const PairSums& of_rest : pairs) {
        const ContactPartners& partners = of_rest.partners;
        if (!rests(model, partners.first) || (partners.second != no_index && !rests(model, partners.second))) continue;
        PairRow& row = pair(key_of(model, partners));
        row.sums_at_rest = of_rest.sums;
        row.still_seconds = 1;
        row.still_contacts = of_rest.contacts;
    }
    take_over_reactions(model, held);
}

/// Initialises the forces of attachments on sleeping bodies, like take_over_rest() as sums over one second. An
/// attachment balances all other forces on its nodes. `contact_force`: contact force on each node [N].
void ForceLedger::take_over_reactions(const Model& model, std::span<const Vec3> contact_force) {
    const NodeTable& nodes = model.nodes;
    Column<Vec3> motion;
    motion.assign(nodes.position.size(), Vec3::Zero());
    std::vector<std::uint8_t> listed(nodes.position.size(), 0);
    // Attachments are visited in reverse order, as in measure_reactions. If several attachments hold a node, the node
    // counts for the last of them.
    for (std::size_t a = model.attachments.slot.size(); a-- > 0;) {
        const Index body = model.attachments.body[a];
        if (model.attachments.slot[a] == no_slot || !rests(model, body)) continue;
        std::vector<std::size_t> held;
        if (!holds_completely(model.attachments.held[a])) {
            take_over_axes(model, a, contact_force);
            continue;
        }
        for (const Index n : rows_of(model.attachments.node, model.attachments.nodes[a])) {
            const auto row = static_cast<std::size_t>(n);
            if (!listed[row]) held.push_back(row);
            listed[row] = 1;
        }
        AttachmentRow& row = attachments_[model.attachments.slot[a]];
        row.still_seconds = 1;
        for (const std::size_t n : held) {
            const Vec3 others = nodes.mass[n] * model.settings.gravity + nodes.applied_before[n] + contact_force[n];
            row.sums_at_rest += {-others, (moment_point_ - nodes.position[n]).cross(others)};
        }
        if (model.is_held(static_cast<std::size_t>(body)) && !model.is_rigid(static_cast<std::size_t>(body))) {
            row.sums_at_rest += hold_of_implicit(model, a, held, moment_point_);
            continue;
        }
        // The elastic forces follow from virtual work: the change of elastic energy when only these nodes move.
        const auto power = [&](auto&& motion_of) {
            for (const std::size_t n : held) motion[n] = motion_of(nodes.position[n]);
            return kernels().elastic_power(model.all_elements(), model.bodies.blocks[static_cast<std::size_t>(body)],
                                           nodes.position, motion);
        };
        for (int axis = 0; axis < 3; ++axis) {
            const Vec3 unit = Vec3::Unit(axis);
            row.sums_at_rest.impulse[axis] += power([&](const Vec3&) { return unit; });
            row.sums_at_rest.moment[axis] += power([&](const Vec3& x) { return Vec3(unit.cross(x - moment_point_)); });
        }
        for (const std::size_t n : held) motion[n].setZero();
    }
}

/// Does the work of take_over_reactions for one attachment that holds its nodes along single directions. Only the parts
/// of the forces along these directions count.
void ForceLedger::take_over_axes(const Model& model, std::size_t attachment, std::span<const Vec3> contact_force) {
    const NodeTable& nodes = model.nodes;
    const Mat3& held = model.attachments.held[attachment];
    const auto body = static_cast<std::size_t>(model.attachments.body[attachment]);
    Column<Vec3> motion;
    motion.assign(nodes.position.size(), Vec3::Zero());
    AttachmentRow& row = attachments_[model.attachments.slot[attachment]];
    row.still_seconds = 1;
    for (const Index node : rows_of(model.attachments.node, model.attachments.nodes[attachment])) {
        const auto n = static_cast<std::size_t>(node);
        if (!(nodes.inverse_mass[n] > 0)) continue;
        Vec3 force = -(nodes.mass[n] * model.settings.gravity + nodes.applied_before[n] + contact_force[n]);
        for (int axis = 0; axis < 3; ++axis) {
            motion[n] = Vec3::Unit(axis);
            force[axis] +=
                kernels().elastic_power(model.all_elements(), model.bodies.blocks[body], nodes.position, motion);
        }
        motion[n].setZero();
        force = held * (held.transpose() * force);
        row.sums_at_rest += {force, (nodes.position[n] - moment_point_).cross(force)};
    }
}

void ForceLedger::fit(const Model& model) {
    std::uint32_t body_count = 0;
    for (std::size_t b = 0; b < model.bodies.slot.size(); ++b)
        if (model.bodies.kind[b] == BodyKind::deformable) body_count = std::max(body_count, model.bodies.slot[b] + 1);
    make_room(bodies_, body_count);
    make_room(colliders_, slots_in(model.colliders.slot));
    make_room(attachments_, slots_in(model.attachments.slot));
}

Real ForceLedger::seconds_on(const Model& model, Index row) const {
    return row != no_index && is_implicit(model, static_cast<std::size_t>(row)) ? call_.whole_step : call_.kick;
}

Real ForceLedger::seconds_of(const Model& model, const PairKey& key) const {
    return is_implicit(model, key) ? call_.whole_step : call_.kick;
}

bool ForceLedger::shows_contacts() const {
    // Least length of the call, as a fraction of the last step before it. A step may leave gaps that are a small
    // fraction of the path of the bodies in it. A much shorter call may not close these gaps, so contact forces would
    // be missing.
    constexpr Real shortest_share = 0.01;
    return call_.whole_step > 0 && call_.whole_step >= shortest_share * step_before_;
}

bool ForceLedger::shows_reaction(const Model& model, std::size_t attachment, const Vec3& impulse) const {
    if (!(call_.whole_step > 0)) return false;
    const auto body = static_cast<std::size_t>(model.attachments.body[attachment]);
    if (rests(model, static_cast<Index>(body))) return true;
    // The reaction on a rigid body is computed as its change of momentum minus the impulses of weight and contacts. So
    // contact forces must be measured too.
    const bool rigid = model.is_rigid(body), implicit = is_implicit(model, body);
    if (rigid && !shows_contacts()) return false;
    constexpr Real digits = 2 * std::numeric_limits<Real>::epsilon();
    Real held = 0;   // mass of the nodes that the attachment holds [kg]
    Real noise = 0;  // rounding error of the momentum [N s]
    const auto add_position = [&](std::size_t n, Real mass) {
        if (!model.nodes.velocity[n].isZero(0))
            noise += mass * digits * model.nodes.position[n].norm() / step_.whole_step;
    };
    for (const Index node : rows_of(model.attachments.node, model.attachments.nodes[attachment])) {
        const auto n = static_cast<std::size_t>(node);
        held += model.weight_of_node(n);
        if (!rigid) add_position(n, model.weight_of_node(n));
    }
    if (rigid || implicit)
        for (auto n = static_cast<std::size_t>(model.bodies.nodes[body].begin);
             n < static_cast<std::size_t>(model.bodies.nodes[body].end); ++n) {
            if (rigid) add_position(n, model.weight_of_node(n));
            noise += model.weight_of_node(n) * digits * model.nodes.velocity[n].norm();
        }
    // Largest accepted rounding error of the reaction: small_share times the force, plus the force that gives the held
    // nodes the acceleration small_acceleration [m/s^2].
    constexpr Real small_share = 0.01, small_acceleration = 1e-3;
    return noise <= small_share * impulse.norm() + small_acceleration * held * call_.whole_step;
}

void ForceLedger::begin_call(const Model& model, Real step_before, StepScratch& scratch) {
    fit(model);
    call_ = {};
    step_before_ = step_before;
    for (PairRow& row : pairs_) {
        row.sums = {};
        row.peak.begin_call();
    }
    std::erase_if(pairs_, [](const PairRow& row) { return is_zero(row.sums_at_rest); });
    for (Peak& peak : bodies_) peak.begin_call();
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
    const auto found = std::ranges::lower_bound(pairs_, key, {}, &PairRow::key);
    if (found != pairs_.end() && found->key == key) return *found;
    return *pairs_.insert(found, PairRow{.key = key});
}

void ForceLedger::add_to_partners(const PairKey& key, const Vec3& impulse, Index contacts) {
    bodies_[key.first].add(impulse, contacts);
    if (!key.bodies)
        colliders_[key.second].add(-impulse, contacts);
    else
        bodies_[key.second].add(-impulse, key.second == key.first ? 0 : contacts);
}

/// True if the body was still at the beginning and at the end of the step. In a step that stops a body, contacts also
/// take its momentum. Such a step counts only if the body falls asleep in it, because no other forces are known.
bool ForceLedger::stayed_still(const Model& model, std::size_t body) const {
    const Real still_time = model.bodies.still_time[body];
    return still_time > step_.whole_step || (still_time > 0 && rests(model, static_cast<Index>(body)));
}

/// Completes the sums of a pair at the end of a step.
/// - If both bodies were asleep and the step has no contact between them, the pair gets the impulse of its mean force
///   at rest, which is sums_at_rest / still_seconds.
/// - If a body was awake but both stayed still, the step is added to still_seconds.
/// - If a body has moved, sums_at_rest and still_seconds are set to zero.
void ForceLedger::end_pair_step(const Model& model, std::span<const std::uint8_t> was_asleep, PairRow& row) {
    const std::size_t first = body_row(model, row.key.first);
    const std::size_t second = row.key.bodies ? body_row(model, row.key.second) : first;
    const Real seconds = is_implicit(model, row.key) ? step_.whole_step : step_.kick;
    if (was_asleep[first] && was_asleep[second]) {
        if (!row.touched && row.still_seconds > 0) {
            const ContactSums held = (seconds / row.still_seconds) * row.sums_at_rest;
            row.sums += held;
            row.peak.add(held.impulse, row.still_contacts);
            add_to_partners(row.key, held.impulse, row.still_contacts);
        }
        return;
    }
    row.still_contacts = row.peak.step_contacts;
    if (stayed_still(model, first) && stayed_still(model, second)) {
        row.still_seconds += seconds;
    } else {
        row.sums_at_rest = {};
        row.still_seconds = 0;
    }
}

void ForceLedger::add_pairs(const Model& model, std::span<const std::uint8_t> was_asleep, const StepScratch& scratch) {
    for (const PairSums& of_step : scratch.forces.pairs) {
        PairRow& row = pair(key_of(model, of_step.partners));
        row.sums += of_step.sums;
        const ContactPartners& partners = of_step.partners;
        const bool both_were_asleep =
            was_asleep[static_cast<std::size_t>(partners.first)] != 0 &&
            (partners.second == no_index || was_asleep[static_cast<std::size_t>(partners.second)] != 0);
        if (!both_were_asleep) row.sums_at_rest += of_step.sums;
        row.peak.add(of_step.sums.impulse, of_step.contacts);
        row.touched = true;
        add_to_partners(row.key, of_step.sums.impulse, of_step.contacts);
    }
    for (PairRow& row : pairs_) {
        end_pair_step(model, was_asleep, row);
        row.peak.end_step(is_implicit(model, row.key) ? step_.whole_step : step_.kick);
        row.touched = false;
    }
    for (std::size_t b = 0; b < model.bodies.slot.size(); ++b)
        if (model.bodies.kind[b] == BodyKind::deformable)
            bodies_[model.bodies.slot[b]].end_step(is_implicit(model, b) ? step_.whole_step : step_.kick);
    for (Peak& peak : colliders_) peak.end_step(step_.kick);
}

void ForceLedger::add_reactions(const Model& model, std::span<const std::uint8_t> was_asleep,
                                const StepScratch& scratch) {
    for (std::size_t a = 0; a < model.attachments.slot.size(); ++a) {
        if (model.attachments.slot[a] == no_slot) continue;
        AttachmentRow& row = attachments_[model.attachments.slot[a]];
        const auto body = static_cast<std::size_t>(model.attachments.body[a]);
        const Real seconds = is_implicit(model, body) ? step_.whole_step : step_.kick;
        ImpulseAndMoment of_step = scratch.forces.reactions[a];
        if (was_asleep[body]) {
            const Real part = row.still_seconds > 0 ? seconds / row.still_seconds : 0;
            of_step = {part * row.sums_at_rest.impulse, part * row.sums_at_rest.moment};
        } else if (stayed_still(model, body)) {
            row.sums_at_rest += of_step;
            row.still_seconds += seconds;
        } else {
            row.sums_at_rest = {};
            row.still_seconds = 0;
        }
        row.sums += of_step;
        row.peak.add(of_step.impulse, 0);
        row.peak.end_step(seconds);
    }
}

void ForceLedger::add_step(const Model& model, std::span<const std::uint8_t> was_asleep, StepScratch& scratch) {
    step_ = {scratch.parameters.h, scratch.parameters.kick_time};
    call_.whole_step += step_.whole_step;
    call_.kick += step_.kick;
    add_pairs(model, was_asleep, scratch);
    add_reactions(model, was_asleep, scratch);
    for (const Index n : model.attachments.node)
        scratch.forces.held_velocity[static_cast<std::size_t>(n)] = model.nodes.velocity[static_cast<std::size_t>(n)];
}

void ForceLedger::add_drift(const Model& model, Real seconds, StepScratch& scratch) {
    // Attachments are visited in reverse order, as in measure_reactions. If several attachments hold a node, the node
    // counts for the last of them.
    for (std::size_t a = model.attachments.slot.size(); a-- > 0;) {
        const Range nodes = model.attachments.nodes[a];
        // rigid bodies are left out, because their node masses do not give their momentum
        if (model.is_rigid(static_cast<std::size_t>(model.attachments.body[a]))) continue;
        // attachments along single directions are left out, because a drift does not change the velocities of their
        // nodes
        if (!holds_completely(model.attachments.held[a])) continue;
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

const ForceLedger::Peak& ForceLedger::body(std::uint32_t slot) const {
    static const Peak none;
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
