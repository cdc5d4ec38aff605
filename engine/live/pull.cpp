#include "engine/live/pull.h"

#include <algorithm>
#include <numbers>

#include "engine/output/frame.h"
#include "engine/world/control/control.h"
#include "engine/world/validate.h"

namespace skerry {

namespace {

/// Points of a body at which a pull holds it. A rigid body is held at `point` only. A deformable body is also held at
/// several surface nodes, which are far from each other but near `point`. A force at a single node would distort soft
/// elements.
std::vector<Vec3> held_points(const World& world, BodyHandle body, const Vec3& point) {
    constexpr std::size_t most = 12;
    constexpr Real reach = 0.25;  // largest distance of held points, as a fraction of the diagonal of the bounding box
    std::vector<Vec3> held{point};
    if (world.dynamics(body) == BodyDynamics::rigid) return held;
    const std::span<const Vec3> nodes = world.positions(body);
    Vec3 lower = point, upper = point;
    for (const Vec3& x : nodes) {
        lower = lower.cwiseMin(x);
        upper = upper.cwiseMax(x);
    }
    std::vector<std::pair<Real, Vec3>> near;  // distance to the nearest held point, and position [m]
    for (const std::array<Index, 3>& face : world.surface(body))
        for (const Index node : face) {
            const Vec3& x = nodes[static_cast<std::size_t>(node)];
            if (const Real distance = (x - point).norm(); distance <= reach * (upper - lower).norm())
                near.emplace_back(distance, x);
        }
    while (held.size() < most && !near.empty()) {
        const auto farthest = std::ranges::max_element(near, {}, &std::pair<Real, Vec3>::first);
        if (farthest->first == 0) break;
        held.push_back(farthest->second);
        for (auto& [distance, x] : near) distance = std::min(distance, (x - held.back()).norm());
    }
    return held;
}

/// Refuses points whose distance from the body could overflow, or is not a number.
void require_near(const char* field, const Vec3& point) {
    if (!(point.array().abs() <= 1e9).all()) refuse("pull", field, shown(point), "coordinates between -1e9 and 1e9 m");
}

}  // namespace

void Pull::begin(World& world, BodyHandle body, const Vec3& point, const Vec3& target) {
    constexpr Real frequency = 2;        // natural frequency of a free body on the spring [Hz]
    constexpr Real most_gravities = 50;  // greatest force, as a multiple of the weight of the body
    constexpr Real gravity = 9.81;       // gravity that defines this weight [m/s^2]
    const Real mass = world.mass(body);
    require_near("point", point);
    require_near("to", target);
    QueryFilter only_body{.colliders = false, .except_bodies = world.bodies()};
    std::erase(only_body.except_bodies, body);
    const std::optional<SurfaceHit> held = world.nearest_point(point, infinity, only_body);
    const Real omega = 2 * std::numbers::pi_v<Real> * frequency;
    Pull next;
    const std::vector<Vec3> points = held_points(world, body, held ? held->point : point);
    try {
        for (const Vec3& at : points) {
            const Real share = 1 / static_cast<Real>(points.size());
            next.offset_.emplace_back(at - points.front());
            next.springs_.push_back(Springs(world).add({.first = {.body = body, .point = at},
                                                        .second = {.point = target + next.offset_.back()},
                                                        .stiffness = share * mass * omega * omega,
                                                        .rest_length = 0,
                                                        .strength = share * most_gravities * mass * gravity}));
        }
        // The field damps a free body critically. A damper at the point would shorten the step of a fine mesh much more
        // than springs and field together do (by about 3 %, for an implicit body by 25 %).
        next.drag_ = Loads(world).add(DragField{.body = body, .rate = 2 * omega});
    } catch (...) {
        next.end(world);
        throw;
    }
    end(world);
    *this = std::move(next);
}

void Pull::move(World& world, const Vec3& target) {
    require_near("to", target);
    Springs springs(world);
    for (std::size_t s = 0; s < springs_.size(); ++s)
        if (springs.alive(springs_[s])) springs.set_second(springs_[s], {.point = target + offset_[s]});
}

void Pull::end(World& world) {
    Springs springs(world);
    for (const SpringHandle spring : springs_)
        if (springs.alive(spring)) springs.remove(spring);
    if (Loads loads(world); loads.alive(drag_)) loads.remove(drag_);
    *this = {};
}

std::optional<PullState> Pull::state(const World& world) const {
    const WorldState& state = WorldAccess::state_of(world);
    std::optional<PullState> pull;
    for (const SpringHandle spring : springs_) {
        if (state.model.spring_map.row(spring) == no_index) continue;  // the owner of the world has removed this spring
        const SpringState now = spring_state(state, spring);
        if (!pull) pull = {.force = 0, .length = now.length};
        pull->force += now.force;
    }
    return pull;
}

bool Pull::has(const LineFrame& line) const {
    return line.kind == LineKind::spring && std::ranges::any_of(springs_, [&](SpringHandle spring) {
               return spring.slot == line.slot && spring.generation == line.generation;
           });
}

}  // namespace skerry
