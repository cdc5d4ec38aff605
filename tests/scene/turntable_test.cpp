// Bodies on rotating surfaces: friction holds them on circles (docs/methods/contact.md 3.1).
#include <Eigen/Geometry>
#include <catch2/catch.hpp>
#include <cmath>
#include <numbers>

#include "tests/support/worlds.h"

namespace skerry::test::turntable_test {

namespace {

constexpr Real turn_rate = 3.7, seconds = 1.5, half_edge = 0.05;  // [rad/s], [s], [m]
const Vec3 spin{0, 0, turn_rate};
const Mesh cube = mesh::box({2 * half_edge, 2 * half_edge, 2 * half_edge}, {2, 2, 2});
const MaterialSettings rubber{.young_modulus = 1e6, .density = 1000, .friction = 1};

Settings steps_of(Real h) {
    Settings settings = accurate({0, 0, -standard_gravity}, 1e-10);
    settings.step_size = h;
    return settings;
}

Vec3 mean_position(const World& world, BodyHandle body) {
    Vec3 sum = Vec3::Zero();
    for (const Vec3& x : world.positions(body)) sum += x;
    return sum / static_cast<Real>(world.positions(body).size());
}

Real distance_from_axis(const Vec3& x) {
    return std::hypot(x.x(), x.y());
}

/// A cube at rest on a rotating disc, which moves with the disc from the start.
struct Ride {
    World world;
    BodyHandle body;

    Ride(BodyDynamics dynamics, Real h, Real radius) : world(steps_of(h)) {
        const MaterialHandle material = world.add_material(rubber);
        const Vec3 position{radius, 0, half_edge};
        body = world.add_body(cube, {.material = material,
                                     .position = position,
                                     .velocity = spin.cross(position),
                                     .angular_velocity = spin,
                                     .dynamics = dynamics});
    }
};

}  // namespace

TEST_CASE("a cube that sticks to a turntable moves on a circle", "[scene]") {
    constexpr Real radius = 0.2, h = 1.0 / 120;
    const auto dynamics = GENERATE(BodyDynamics::rigid, BodyDynamics::implicit_elastic);
    const auto table = GENERATE(0, 1, 2);
    CAPTURE(dynamics, table);
    Ride ride(dynamics, h, radius);
    const MaterialHandle material = ride.world.add_material(rubber);
    const Motion motion{.angular_velocity = spin};
    const Vec3 below{0, 0, -0.05};
    const Vec3 table_size{0.8, 0.8, 0.1};
    if (table == 0) ride.world.add_collider(Box{table_size}, {.position = below, .motion = motion});
    if (table == 1)
        ride.world.add_collider(mesh::boundary(mesh::box(table_size, {2, 2, 1})),
                                {.position = below, .motion = motion});
    if (table == 2) {
        const BodyHandle disc = ride.world.add_body(
            mesh::box(table_size, {2, 2, 1}),
            {.material = material, .position = below, .angular_velocity = spin, .dynamics = BodyDynamics::rigid});
        ride.world.attach(disc, std::vector<Index>{0, 1, 2, 3, 4}, motion);
    }
    REQUIRE(ride.world.advance(seconds).ok());
    const Vec3 end = mean_position(ride.world, ride.body);
    CHECK(distance_from_axis(end) == Approx(radius).epsilon(1e-3));
    // the error is of order 2 in the step length
    const Real angle = turn_rate * seconds, step_angle = turn_rate * h;
    CHECK(std::atan2(end.y(), end.x()) == Approx(angle - 2 * std::numbers::pi).margin(angle * step_angle * step_angle));
}

TEST_CASE("a ball that rolls on a turntable moves on a circle at two sevenths of its angular velocity", "[scene]") {
    // E. W. Weckesser, A ball rolling on a freely spinning turntable, American Journal of Physics 65 (1997), 736
    constexpr Real radius = 0.05, rate = 2 * turn_rate / 7, speed = 0.1;
    const Vec3 position{0.1, 0, radius}, velocity{0, speed, 0};
    World world(steps_of(1.0 / 120));
    const MaterialHandle material = world.add_material(rubber);
    // no slip: velocity + ball_spin x (-radius e_z) = spin x position
    const Vec3 slip = spin.cross(position) - velocity, ball_spin = Vec3::UnitZ().cross(-slip) / radius;
    const BodyHandle ball = world.add_body(Sphere{radius}, {.material = material,
                                                            .position = position,
                                                            .velocity = velocity,
                                                            .angular_velocity = ball_spin,
                                                            .dynamics = BodyDynamics::rigid});
    world.add_collider(Box{{1, 1, 0.1}}, {.position = {0, 0, -0.05}, .motion = {.angular_velocity = spin}});
    REQUIRE(world.advance(2 * std::numbers::pi / rate / 2).ok());
    // after half a turn the ball is opposite to its start, as seen from the centre of its circle
    const Vec3 opposite = position - 2 * speed / rate * Vec3::UnitX();
    CHECK((world.positions(ball)[0] - opposite).norm() < 1e-3 * speed / rate);
}

}  // namespace skerry::test::turntable_test
