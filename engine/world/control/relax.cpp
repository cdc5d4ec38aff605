// Static equilibrium by dynamic relaxation with kinetic damping (docs/methods/loads.md 3).
#include "skerry/relax.h"

#include <algorithm>
#include <cmath>
#include <optional>
#include <utility>
#include <vector>

#include "components/union_find.h"
#include "engine/base/complaint.h"
#include "engine/world/control/control.h"
#include "engine/world/edit/rigid_bodies.h"
#include "engine/world/step/step.h"
#include "engine/world/validate.h"
#include "engine/world/world_state.h"
#include "jobs/arithmetic_scope.h"
#include "systems/dynamics/motion/move_colliders.h"

namespace skerry {

namespace {

// Number of successive steps in which all bodies must be in balance. One step is not enough, because in a vibration the
// forces balance for a moment.
constexpr int calm_steps = 10;

/// Makes the time table of a row constant: all its keys get one value.
void hold_keys(auto& table, std::size_t row, Real value) {
    const std::span<const TimeKey> keys = table.keys_of(row);
    const auto first = static_cast<std::size_t>(keys.data() - std::as_const(table.key).data());
    for (std::size_t k = first; k < first + keys.size(); ++k) table.key[k].value = value;
}

/// Makes all time tables constant, with their values at the time `t`. Stops the flow of gas into cavities and through
/// pipes, stops cables that are driven by a rate, and prevents ties from breaking.
void hold_values(Model& model, Real t) {
    model.for_each_joining([&](const char*, auto& table, auto&) {
        if constexpr (requires { table.keys_of(0); })
            for (std::size_t row = 0; row < table.slot.size(); ++row) {
                const std::span<const TimeKey> keys = table.keys_of(row);
                if (!keys.empty()) hold_keys(table, row, value_at(keys, t));
            }
    });
    for (std::size_t c = 0; c < model.cavities.size(); ++c)
        if (model.cavities.law[c] == CavityLaw::gas) hold_keys(model.cavities, c, 0);
    for (std::size_t c = 0; c < model.cables.size(); ++c)
        if (model.cables.control[c] == CableControl::rate) hold_keys(model.cables, c, 0);
    std::ranges::fill(model.pipes.conductance, 0);
    std::ranges::fill(model.ties.break_force, infinity);
}

/// Sets loads of nodes, forces, tractions, acceleration fields, prescribed pressures, and tensions of cables and fibres
/// to `load_fraction` times their values at the time `t`. Gravity factors and drag keep their values. `full_loads`: the
/// model before hold_values(), with the full values.
void set_load_fraction(Model& model, const Model& full_loads, Real t, Real load_fraction) {
    const auto scale_keys = [&](auto& table, const auto& from, std::size_t row) {
        hold_keys(table, row, load_fraction * value_at(from.keys_of(row), t));
    };
    for (std::size_t l = 0; l < model.loads.size(); ++l)
        if (const LoadKind kind = model.loads.kind[l];
            kind == LoadKind::force || kind == LoadKind::traction || kind == LoadKind::acceleration)
            scale_keys(model.loads, full_loads.loads, l);
    for (std::size_t c = 0; c < model.cavities.size(); ++c)
        if (model.cavities.law[c] == CavityLaw::pressure) scale_keys(model.cavities, full_loads.cavities, c);
    for (std::size_t c = 0; c < model.cables.size(); ++c)
        if (model.cables.control[c] == CableControl::tension) scale_keys(model.cables, full_loads.cables, c);
    for (std::size_t f = 0; f < model.fibres.size(); ++f) scale_keys(model.fibres, full_loads.fibres, f);
    for (std::size_t n = 0; n < model.nodes.load.size(); ++n)
        model.nodes.load[n] = load_fraction * full_loads.nodes.load[n];
    note_forces(model);
}

/// Stops colliders or attachments at their poses at the time `t`.
void hold_poses(auto& table, Real t) {
    for (std::size_t row = 0; row < table.script.size(); ++row) {
        const RigidPose pose = pose_at(table.script[row], table.keyframe, table.initial[row], t);
        table.initial[row] = {pose.position, pose.rotation, Vec3::Zero(), Vec3::Zero()};
        table.script[row] = {
            .velocity = Vec3::Zero(), .angular_velocity = Vec3::Zero(), .key_begin = 0, .key_end = 0, .start = t};
    }
}

/// Gives colliders or attachments the motion that they have in `source`.
void take_motion(auto& target, const auto& source) {
    target.script = source.script;
    target.initial = source.initial;
    target.motion = source.motion;
}

/// Gives a cable the work and the dissipated energy that it has in the world `source`, so that the relaxation adds
/// nothing to them.
void take_work(WorldState& target, const WorldState& source, std::size_t cable) {
    const CableHandle handle = target.model.cable_map.handle_of_slot(target.model.cables.slot[cable]);
    const CableState before = cable_state(source, handle), now = cable_state(target, handle);
    target.model.cables.work[cable] += before.work - now.work;
    target.model.cables.dissipated[cable] += before.dissipated - now.dissipated;
}

/// Undoes hold_values(), and restores the flows of pipes. `source`: the model before hold_values().
void take_values(Model& target, Model& source) {
    std::vector<Column<TimeKey>*> columns;
    const auto visit_keys = [](Model& model, auto&& visit) {
        model.for_each_joining([&](const char*, auto& table, auto&) {
            if constexpr (requires { table.keys_of(0); }) visit(table.key);
        });
    };
    visit_keys(target, [&](Column<TimeKey>& key) { columns.push_back(&key); });
    std::size_t table = 0;
    visit_keys(source, [&](Column<TimeKey>& key) { *columns[table++] = key; });
    target.pipes.conductance = source.pipes.conductance;
    target.pipes.flow = source.pipes.flow;
    target.ties.break_force = source.ties.break_force;
}

/// Sets Settings::sleep and Settings::tolerance, and the step parameters that follow from them. Called before a
/// relaxation, and after it to restore the values of the user.
void set_for_relaxation(WorldState& world, bool sleep, Real tolerance) {
    world.model.settings.sleep = sleep;
    world.model.settings.tolerance = tolerance;
    // time for which the forces of the last step acted [s]; not reset, because the contact forces of that step are
    // still computed with it
    const Real kick_time = world.scratch.parameters.kick_time;
    world.scratch.parameters = step_parameters(world.model.settings, world.model.tuning);
    world.scratch.parameters.kick_time = kick_time;
}

/// Gives the relaxed world the run record that the world had before the relaxation. Only the list of contacts is built
/// again.
void keep_record(RunRecord& before, RunRecord& now) {
    now.counters = before.counters;
    now.self_crossings = std::move(before.self_crossings);
    now.limits = before.limits;
    now.held = before.held;
    now.balance = before.balance;
    now.balance.close();
    now.tracing = before.tracing;
    now.forces = before.forces;
    std::swap(now.problem_watch, before.problem_watch);
    std::swap(now.step_watch, before.step_watch);
    now.contact_view_is_current = false;
}

void stop_body(Model& model, std::size_t body) {
    if (model.has_frame(body)) {
        std::ranges::fill(rows_of(model.implicit_nodes.velocity, model.bodies.implicit[body]), Vec3::Zero());
        std::ranges::fill(rows_of(model.implicit_nodes.left, model.bodies.implicit[body]), Vec3::Zero());
        stop_rigid_body(model, body);
    } else {
        relax_fully(model, body);
    }
    std::ranges::fill(rows_of(model.nodes.velocity, model.bodies.nodes[body]), Vec3::Zero());
}

/// Forces and motion of a body in one step.
struct BodyBalance {
    Real out_of_balance = 0;  // sum of the out-of-balance forces on its nodes [N]
    Real forces = 0;          // sum of the magnitudes of weights, loads and contact forces [N]
    Real momentum = 0;        // sum of the magnitudes of the momenta of its nodes [kg m/s]
    Real kinetic = 0;         // [J]
    Real speed = 0;           // largest speed of a node [m/s]
};

class Relaxation {
public:
    Relaxation(World& world, const RelaxSettings& settings)
        : world_(world), state_(WorldAccess::state_of(world)), settings_(settings) {
        const std::size_t count = state_.model.bodies.slot.size();
        sets_.start(count);
        for (std::size_t link = 0; link < state_.model.links.first.size(); ++link)
            sets_.join(state_.model.links.first[link], state_.model.links.second[link]);
        kinetic_before_.assign(count, 0);
        for (std::size_t b = 0; b < count; ++b)
            if (moves(b)) stop_body(state_.model, b);
    }

    /// Makes steps until the bodies are in equilibrium, `max_steps` steps are taken, a step fails, or go_on() returns
    /// false. Adds the steps to the report. Returns true if the bodies have reached equilibrium.
    bool run(const std::function<bool(const RelaxReport&)>& go_on, RelaxReport& report) {
        bool balanced = false;
        int calm = 0;
        Real calm_time = 0;  // [s]
        for (int taken = 0; taken < settings_.max_steps;) {
            const NodeTable& nodes = state_.model.nodes;
            before_.assign(nodes.velocity.begin(), nodes.velocity.end());
            const Real start = state_.clock.time;
            const StepReport step = world_.advance(trusted());
            taken += step.steps;
            report.steps += step.steps;
            report.message = step.ok() ? std::string() : step.message();
            if (!step.ok()) return false;
            const Real h = state_.clock.time - start;
            report.seconds += h;
            measure_bodies(h);
            calm_time += h;
            const bool in_balance = find_worst(calm_time, report);
            calm = in_balance ? calm + 1 : 0;
            if (!in_balance) calm_time = 0;
            balanced = calm >= calm_steps;
            if (balanced || !go_on(std::as_const(report))) break;
            damp();
        }
        for (std::size_t b = 0; b < bodies_.size(); ++b)
            if (moves(b)) stop_body(state_.model, b);
        return balanced;
    }

private:
    bool moves(std::size_t body) const {
        const Model& model = state_.model;
        return model.bodies.kind[body] == BodyKind::deformable && !(model.is_rigid(body) && model.is_held(body));
    }

    Real trusted() const {
        const Real step = longest_allowed_step(state_.model);
        return std::isfinite(step) ? step : 1.0 / 120;
    }

    void measure_bodies(Real h) {
        const Model& model = state_.model;
        const NodeTable& nodes = model.nodes;
        bodies_.assign(model.bodies.slot.size(), {});
        for (std::size_t n = 0; n < nodes.position.size(); ++n) {
            BodyBalance& balance = bodies_[static_cast<std::size_t>(nodes.body[n])];
            if (!(nodes.inverse_mass[n] > 0)) continue;
            const Real mass = model.weight_of_node(n), speed = nodes.velocity[n].norm();
            Vec3 external_force = mass * model.settings.gravity;
            if (model.forced) external_force += nodes.applied_force[n];
            balance.forces += external_force.norm();
            balance.out_of_balance += mass * (nodes.velocity[n] - before_[n]).norm() / h;
            balance.momentum += mass * speed;
            balance.kinetic += mass * speed * speed / 2;
            balance.speed = std::max(balance.speed, speed);
        }
        const ContactTable& contacts = state_.scratch.contacts;
        for (std::size_t c = 0; c < contacts.size(); ++c) {
            const Real force = contacts.impulse[c].norm() / h;
            bodies_[static_cast<std::size_t>(contacts.first_body[c])].forces += force;
            if (contacts.second_body[c] != no_index)
                bodies_[static_cast<std::size_t>(contacts.second_body[c])].forces += force;
        }
        for (const BodyBalance& balance : bodies_) largest_ = std::max(largest_, balance.out_of_balance);
    }

    /// Returns true if all bodies are in equilibrium (docs/methods/loads.md 3). Reports the body with the largest
    /// residual: the out-of-balance force divided by the forces on the body. `time`: time for which all bodies have
    /// been in balance [s].
    bool find_worst(Real time, RelaxReport& report) const {
        report.residual = report.speed = 0;
        report.worst.reset();
        bool in_balance = true;
        for (std::size_t b = 0; b < bodies_.size(); ++b) {
            if (!moves(b)) continue;
            const BodyBalance& balance = bodies_[b];
            // without weight, loads and contacts, the body is compared with the largest out-of-balance force
            const Real scale = balance.forces > 0 ? balance.forces : largest_;
            const Real residual = scale > 0 ? balance.out_of_balance / scale : 0;
            in_balance &= residual <= settings_.tolerance && balance.momentum <= settings_.tolerance * scale * time;
            if (report.worst && residual <= report.residual) continue;
            report.residual = residual;
            report.speed = balance.speed;
            report.worst = state_.model.body_map.handle_of_slot(state_.model.bodies.slot[b]);
            report.worst_name = state_.model.body_records[b].name;
        }
        return in_balance;
    }

    /// Kinetic damping: stops each set of joined bodies whose kinetic energy has fallen in this step. At a maximum of
    /// kinetic energy the set is near its equilibrium.
    void damp() {
        const std::size_t count = bodies_.size();
        kinetic_now_.assign(count, 0);
        for (std::size_t b = 0; b < count; ++b) kinetic_now_[root(b)] += bodies_[b].kinetic;
        for (std::size_t b = 0; b < count; ++b)
            if (moves(b) && kinetic_now_[root(b)] < kinetic_before_[root(b)]) stop_body(state_.model, b);
        for (std::size_t b = 0; b < count; ++b)
            kinetic_before_[b] = kinetic_now_[b] < kinetic_before_[b] ? 0 : kinetic_now_[b];
    }
    std::size_t root(std::size_t body) { return static_cast<std::size_t>(sets_.root(static_cast<Index>(body))); }

    World& world_;
    WorldState& state_;
    RelaxSettings settings_;
    UnionFind sets_;                   // sets of bodies that joints, ties and the like connect
    std::vector<Vec3> before_;         // velocities of all nodes before the step [m/s]
    std::vector<BodyBalance> bodies_;  // by body
    // Kinetic energies of the sets of joined bodies, at the index of the root of a set in `sets_` [J]: kinetic_before_
    // before this step, kinetic_now_ after it.
    std::vector<Real> kinetic_before_, kinetic_now_{};
    Real largest_ = 0;  // largest out-of-balance force of a body so far [N]
};

/// Stops everything that is prescribed as a function of time, and wakes all bodies.
void prepare(WorldState& world, Real t, Real tolerance) {
    set_for_relaxation(world, false, tolerance);
    hold_values(world.model, t);
    hold_poses(world.model.colliders, t);
    hold_poses(world.model.attachments, t);
    world.model.wake_all();
    note_changed_seams(world.model);
}

/// Relaxes `copy` with growing fractions of the loads of `unrelaxed`, until the full loads are reached. If a relaxation
/// fails, returns to the last equilibrium and halves the increment of the loads.
RelaxReport grow_loads(World& copy, const WorldState& unrelaxed, const RelaxSettings& settings,
                       const std::function<bool(const RelaxReport&)>& go_on) {
    constexpr Real smallest = 1.0 / 64;  // smallest increment of the loads, as a fraction of a load step
    RelaxReport report;
    bool stopped = false;
    const auto watch = [&](const RelaxReport& so_far) {
        stopped = go_on && !go_on(so_far);
        return !stopped;
    };
    const bool grows = settings.load_steps > 1;
    const Real load_step = 1.0 / settings.load_steps;
    Real increment = load_step;
    std::optional<World> balanced;  // the world in the last equilibrium
    if (grows) balanced = copy.clone();
    while (!report.converged) {
        const Real remaining_load = 1 - report.load,
                   load = remaining_load < 1.5 * increment ? 1 : report.load + increment;
        set_load_fraction(WorldAccess::state_of(copy).model, unrelaxed.model, unrelaxed.clock.time, load);
        if (Relaxation(copy, settings).run(watch, report)) {
            report.load = load;
            report.converged = load == 1;
            if (grows) balanced = copy.clone();
            continue;
        }
        increment /= 2;
        if (stopped || !grows || increment < smallest * load_step) break;
        copy = balanced->clone();
    }
    return report;
}

}  // namespace

RelaxReport relax(World& world, const RelaxSettings& settings, const std::function<bool(const RelaxReport&)>& go_on) {
    if (!(settings.tolerance > 0 && settings.tolerance < 1))
        refuse("relax", "tolerance", short_text(settings.tolerance), "a number > 0 and < 1");
    if (settings.max_steps < 1) refuse("relax", "max_steps", std::to_string(settings.max_steps), "a number >= 1");
    if (settings.load_steps < 1) refuse("relax", "load_steps", std::to_string(settings.load_steps), "a number >= 1");
    WorldAccess::state_of(world).require_between_steps("relax");
    const ArithmeticScope arithmetic;  // the decisions must not depend on the floating-point mode of the caller
    world.settle_start();
    World copy = world.clone();
    WorldState& before = WorldAccess::state_of(world);
    const Settings& user_settings = before.model.settings;
    prepare(WorldAccess::state_of(copy), before.clock.time, std::min(user_settings.tolerance, settings.tolerance / 10));
    const RelaxReport report = grow_loads(copy, before, settings, go_on);
    if (!report.converged) return report;
    WorldState& now = WorldAccess::state_of(copy);
    take_values(now.model, before.model);
    take_motion(now.model.colliders, before.model.colliders);
    take_motion(now.model.attachments, before.model.attachments);
    set_for_relaxation(now, user_settings.sleep, user_settings.tolerance);
    now.model.settings.backend = user_settings.backend;
    now.model.settings.threads = user_settings.threads;
    now.clock = before.clock;
    for (std::size_t c = 0; c < now.model.cables.size(); ++c) take_work(now, before, c);
    std::swap(now.executor, before.executor);
    keep_record(before.record, now.record);
    world = std::move(copy);
    return report;
}

}  // namespace skerry
