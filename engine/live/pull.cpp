#include "engine/live/pull.h"

#include <algorithm>
#include <numbers>

#include "engine/world/control/control.h"

namespace skerry {

void Pull::begin(World& world, BodyHandle body, const Vec3& point, const Vec3& target) {
    constexpr Real frequency = 2;        // of a free body on the spring [Hz]
    constexpr Real most_gravities = 50;  // greatest force, in weights of the body
    constexpr Real gravity = 9.81;       // of these weights [m/s^2]
    const Real mass = world.mass(body);
    QueryFilter only_body{.colliders = false, .except_bodies = world.bodies()};
    std::erase(only_body.except_bodies, body);
    const std::optional<SurfaceHit> held = world.nearest_point(point, infinity, only_body);
    const Real omega = 2 * std::numbers::pi_v<Real> * frequency;
    const SpringHandle spring = Springs(world).add({.first = {.body = body, .point = held ? held->point : point},
                                                    .second = {.point = target},
                                                    .stiffness = mass * omega * omega,
                                                    .rest_length = 0,
                                                    .strength = most_gravities * mass * gravity});
    end(world);
    spring_ = spring;
    drag_ = Loads(world).add(DragField{.body = body, .rate = 2 * omega});
}

void Pull::move(World& world, const Vec3& target) {
    if (Springs springs(world); springs.alive(spring_)) springs.set_second(spring_, {.point = target});
}

void Pull::end(World& world) {
    if (Springs springs(world); springs.alive(spring_)) springs.remove(spring_);
    if (Loads loads(world); loads.alive(drag_)) loads.remove(drag_);
}

std::optional<PullState> Pull::state(const World& world) const {
    const WorldState& state = WorldAccess::state_of(world);
    if (state.model.spring_map.row(spring_) == no_index) return {};
    const SpringState now = spring_state(state, spring_);
    return PullState{.force = now.force, .length = now.length};
}

}  // namespace skerry
