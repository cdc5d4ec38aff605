#include "systems/dynamics/motion/update_sleep.h"

#include "components/check.h"

namespace skerry {

namespace {

/// Joins what touches, and marks as restless what a moving collider touches.
void join_touching(const TouchInputs& touches, const RestInputs& bodies, SleepMemory& memory) {
    for (std::size_t c = 0; c < touches.state.size(); ++c) {
        if (touches.state[c] == ContactState::open) continue;
        const Index first = touches.first_body[c], second = touches.second_body[c];
        if (touches.surface_velocity[c] != Vec3::Zero()) memory.restless[first] = 1;
        if (second == no_index) continue;
        if (bodies.kind[second] == BodyKind::kinematic) {
            if (bodies.max_speed[second] != 0) memory.restless[first] = 1;
            continue;
        }
        memory.touching.join(first, second);
    }
}

void put_to_rest(const RestInputs& bodies, std::size_t body, std::span<Vec3> velocity, std::span<Vec3> velocity_next,
                 TakenByRest& taken) {
    for (Index n = bodies.nodes[body].begin; n < bodies.nodes[body].end; ++n) {
        if (bodies.inverse_mass[n] > 0) {
            taken.energy += bodies.mass[n] * velocity[n].squaredNorm() / 2;
            taken.momentum += bodies.mass[n] * velocity[n];
        }
        velocity[n] = velocity_next[n] = Vec3::Zero();
    }
    ++taken.bodies;
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
                 std::span<const Index> attached_body, std::span<const RigidMotion> attached_motion,
                 std::span<std::uint8_t> asleep, std::span<Real> still_time) {
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
    for (std::size_t b = 0; b < pressed.size(); ++b)
        if (pressed[b]) wake(static_cast<Index>(b));
    for (std::size_t a = 0; a < attached_body.size(); ++a)
        if (attached_motion[a].velocity != Vec3::Zero() || attached_motion[a].angular_velocity != Vec3::Zero())
            wake(attached_body[a]);
    return any;
}

TakenByRest rest_bodies(const TouchInputs& touches, const RestInputs& bodies, const SleepSettings& settings, Real h,
                        SleepMemory& memory, std::span<std::uint8_t> asleep, std::span<Real> still_time,
                        std::span<Vec3> velocity, std::span<Vec3> velocity_next) {
    const std::size_t count = bodies.kind.size();
    SKERRY_CHECK(asleep.size() == count && still_time.size() == count);
    TakenByRest taken;
    bool ready = false;
    for (std::size_t b = 0; b < count; ++b) {
        if (asleep[b] || bodies.kind[b] == BodyKind::kinematic) continue;
        still_time[b] = bodies.max_speed[b] < settings.speed ? still_time[b] + h : 0;
        ready |= still_time[b] >= settings.time;
    }
    if (!ready) return taken;
    memory.touching.start(count);
    memory.restless.assign(count, 0);
    for (std::size_t b = 0; b < count; ++b)
        memory.restless[b] = bodies.kind[b] == BodyKind::deformable && !asleep[b] && still_time[b] < settings.time;
    join_touching(touches, bodies, memory);
    for (std::size_t b = 0; b < count; ++b)
        if (memory.restless[b]) memory.restless[memory.touching.root(static_cast<Index>(b))] = 1;
    for (std::size_t b = 0; b < count; ++b) {
        if (asleep[b] || bodies.kind[b] == BodyKind::kinematic ||
            memory.restless[memory.touching.root(static_cast<Index>(b))])
            continue;
        asleep[b] = 1;
        put_to_rest(bodies, b, velocity, velocity_next, taken);
    }
    return taken;
}

}  // namespace skerry
