#include "systems/dynamics/motion/update_sleep.h"

#include <algorithm>
#include <atomic>

#include "components/check.h"
#include "jobs/parallel_for.h"
#include "systems/dynamics/motion/stillness.h"
#include "systems/dynamics/rigid/rigid_motion.h"

namespace skerry {

namespace {

// Number of bodies per job. A moving body takes little time, a still body a few microseconds.
constexpr std::size_t watched_per_block = 64;

/// Joins bodies that touch, and bodies that BodyLinks connects (for example by a joint), into sets. Marks bodies that
/// touch a moving collider in `stays_awake`.
void join_touching(const TouchInputs& touches, const RestInputs& bodies, SleepMemory& memory) {
    for (std::size_t c = 0; c < touches.state.size(); ++c) {
        if (touches.state[c] == ContactState::open) continue;
        const Index first = touches.first_body[c], second = touches.second_body[c];
        if (touches.surface_velocity[c] != Vec3::Zero()) memory.stays_awake[first] = 1;
        if (second == no_index) continue;
        if (bodies.kind[second] == BodyKind::kinematic) {
            if (bodies.max_speed[second] != 0) memory.stays_awake[first] = 1;
            continue;
        }
        memory.touching.join(first, second);
    }
    for (std::size_t link = 0; link < touches.linked_first.size(); ++link)
        memory.touching.join(touches.linked_first[link], touches.linked_second[link]);
}

void stop_rigid(const RestInputs& bodies, std::size_t r, const RestOutputs& state, SleepLosses& losses) {
    const Vec3 turn = spin_of(bodies.rigid_rotation[r], bodies.rigid_moments[r], state.angular_momentum[r]);
    if (!bodies.held(static_cast<Index>(r))) {  // a held body moves with its attachment, so its energy does not count
        losses.energy +=
            (state.momentum[r].squaredNorm() / bodies.rigid_mass[r] + state.angular_momentum[r].dot(turn)) / 2;
        losses.momentum += state.momentum[r];
    }
    state.momentum[r] = state.angular_momentum[r] = Vec3::Zero();
}

/// Sets the deformation velocities of an implicit body in its frame to zero.
void stop_deforming(const RestInputs& bodies, std::size_t body, const RestOutputs& state, SleepLosses& losses) {
    const Range rows = bodies.body_implicit[body];
    const bool held = bodies.held(bodies.rigid(body));
    for (Index row = rows.begin; row < rows.end; ++row) {
        const Index n = bodies.nodes[body].begin + row - rows.begin;
        if (bodies.inverse_mass[n] > 0) {
            losses.energy += bodies.mass[n] * state.deforming[row].squaredNorm() / 2;
            if (held) losses.momentum += bodies.mass[n] * state.velocity[n];
        }
        state.deforming[row] = Vec3::Zero();
    }
}

void put_to_rest(const RestInputs& bodies, std::size_t body, const RestOutputs& state, SleepLosses& losses) {
    const Index rigid = bodies.rigid(body);
    if (rigid != no_index) {
        stop_rigid(bodies, static_cast<std::size_t>(rigid), state, losses);
        stop_deforming(bodies, body, state, losses);
    }
    for (Index n = bodies.nodes[body].begin; n < bodies.nodes[body].end; ++n) {
        if (bodies.inverse_mass[n] > 0 && rigid == no_index) {
            losses.energy += bodies.mass[n] * state.velocity[n].squaredNorm() / 2;
            losses.momentum += bodies.mass[n] * state.velocity[n];
        }
        state.velocity[n] = state.velocity_next[n] = Vec3::Zero();
    }
    state.asleep[body] = 1;
}

}  // namespace

void mark_pressed(const PressInputs& contacts, Column<std::uint8_t>& pressed) {
    pressed.assign(contacts.asleep.size(), 0);
    for (std::size_t c = 0; c < contacts.first_body.size(); ++c) {
        if (!contacts.warm_impulse.empty() && contacts.warm_impulse[c] == Vec3::Zero()) continue;
        pressed[contacts.first_body[c]] = 1;
        if (contacts.second_body[c] != no_index) pressed[contacts.second_body[c]] = 1;
    }
}

bool wake_bodies(const TouchInputs& touches, std::span<const std::uint8_t> pressed,
                 std::span<const std::uint8_t> driven, std::span<const Index> attached_body,
                 std::span<const RigidMotion> attached_motion, std::span<std::uint8_t> asleep,
                 std::span<Real> still_time) {
    // Usually no body sleeps. This case returns early, because the update of positions waits for this function.
    if (std::ranges::all_of(asleep, [](std::uint8_t each) { return each == 0; })) return false;
    bool any = false;
    const auto wake = [&](Index body) {
        if (body == no_index || !asleep[body]) return;
        asleep[body] = 0;
        still_time[body] = 0;
        any = true;
    };
    for (std::size_t c = 0; c < touches.state.size(); ++c) {
        if (touches.state[c] == ContactState::open && !(touches.gap[c] < 0)) continue;
        wake(touches.first_body[c]);
        wake(touches.second_body[c]);
    }
    for (const std::span<const std::uint8_t> marked : {pressed, driven})
        for (std::size_t b = 0; b < marked.size(); ++b)
            if (marked[b]) wake(static_cast<Index>(b));
    for (std::size_t a = 0; a < attached_body.size(); ++a)
        if (!attached_motion[a].stands_still()) wake(attached_body[a]);
    for (std::size_t link = 0; link < touches.linked_first.size(); ++link) {
        const Index first = touches.linked_first[link], second = touches.linked_second[link];
        if (asleep[first] == asleep[second]) continue;
        wake(first);
        wake(second);
    }
    return any;
}

void find_still_sets(Executor& executor, const TouchInputs& touches, const RestInputs& bodies,
                     const SleepSettings& settings, Real h, SleepMemory& memory, const RestOutputs& state) {
    const std::size_t count = bodies.kind.size();
    SKERRY_CHECK(state.asleep.size() == count && state.still_time.size() == count);
    // A moving body must not fall asleep even if the sleep time is zero.
    const auto is_ready = [&](std::size_t b) {
        return state.still_time[b] >= settings.time && state.still_time[b] > 0;
    };
    std::atomic<bool> any_ready{false};
    parallel_for(executor, count, watched_per_block, [&](std::size_t begin, std::size_t end) {
        bool ready = false;
        for (std::size_t b = begin; b < end; ++b) {
            if (state.asleep[b] || bodies.kind[b] == BodyKind::kinematic) continue;
            if (settings.own_limits)
                watch_stillness(bodies, settings, b, h, state);
            else
                state.still_time[b] = bodies.max_speed[b] < settings.speed ? state.still_time[b] + h : 0;
            ready |= is_ready(b);
        }
        if (ready) any_ready.store(true, std::memory_order_relaxed);
    });
    memory.any_ready = any_ready.load();
    if (!memory.any_ready) return;
    memory.touching.start(count);
    memory.stays_awake.assign(count, 0);
    for (std::size_t b = 0; b < count; ++b)
        memory.stays_awake[b] = bodies.kind[b] == BodyKind::deformable && !state.asleep[b] && !is_ready(b);
    for (std::size_t a = 0; a < bodies.attached_body.size(); ++a)
        if (!bodies.attached_motion[a].stands_still()) memory.stays_awake[bodies.attached_body[a]] = 1;
    for (std::size_t b = 0; b < bodies.driven.size(); ++b)
        if (bodies.driven[b]) memory.stays_awake[b] = 1;
    join_touching(touches, bodies, memory);
    for (std::size_t b = 0; b < count; ++b)
        if (memory.stays_awake[b]) memory.stays_awake[memory.touching.root(static_cast<Index>(b))] = 1;
}

SleepLosses rest_bodies(const RestInputs& bodies, SleepMemory& memory, const RestOutputs& state) {
    SleepLosses losses, ghost_losses;
    if (!memory.any_ready) return losses;
    for (std::size_t b = 0; b < bodies.kind.size(); ++b) {
        if (state.asleep[b] || bodies.kind[b] != BodyKind::deformable ||
            memory.stays_awake[memory.touching.root(static_cast<Index>(b))])
            continue;
        put_to_rest(bodies, b, state, bodies.ghosts.contain(static_cast<Index>(b)) ? ghost_losses : losses);
        ++losses.bodies;
    }
    return losses;
}

}  // namespace skerry
