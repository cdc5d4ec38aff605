// Rigid bodies that roll, rock and jam (docs/accuracy.md, items 55 to 57, 64).
#include <Eigen/Dense>
#include <Eigen/Geometry>
#include <algorithm>
#include <catch2/catch.hpp>
#include <cmath>
#include <numbers>
#include <vector>

#include "tests/support/accuracy.h"
#include "tests/support/worlds.h"

namespace skerry::test::rolling_test {

using accuracy::Tolerance;

namespace {

constexpr Real g = standard_gravity, pi = std::numbers::pi;

/// A wheel of radius 0.1 m with its axis along y and a node at each of the given rim angles (ascending, from straight
/// down) [rad].
Mesh wheel(const std::vector<Real>& angles) {
    constexpr Real radius = 0.1, half = 0.02;
    const Index rim = static_cast<Index>(angles.size());
    Mesh mesh;
    for (const Real y : {-half, half}) {
        for (const Real angle : angles) mesh.nodes.emplace_back(radius * std::sin(angle), y, -radius * std::cos(angle));
        mesh.nodes.emplace_back(0, y, 0);
    }
    const Index other = rim + 1;
    for (Index k = 0; k < rim; ++k) {
        // A wedge between two radii, cut into three tetrahedra.
        const Index a = rim, b = k, c = (k + 1) % rim;
        for (std::array<Index, 4> t : {std::array<Index, 4>{a, b, c, a + other},
                                       {b, c, a + other, b + other},
                                       {c, a + other, b + other, c + other}}) {
            const auto at = [&](std::size_t i) { return mesh.nodes[static_cast<std::size_t>(t[i])]; };
            Mat3 sides;
            sides << at(1) - at(0), at(2) - at(0), at(3) - at(0);
            if (sides.determinant() < 0) std::swap(t[0], t[1]);
            mesh.tetrahedra.push_back(t);
        }
    }
    return mesh;
}

/// Mean accelerations of a body released on a slope [m/s^2, rad/s^2]
struct Rolled {
    Real acceleration, spin;
};

Rolled roll(Real degrees, Real mu, Real h) {
    constexpr Real radius = 0.1, seconds = 0.1;  // m, s
    // Rim angles: fine where the wheel will touch, from `back` on [rad].
    constexpr Real back = -0.02, part = 0.14, fine = 2e-4, coarse = 0.025;
    std::vector<Real> angles;
    for (int k = 0; k * fine < part; ++k) angles.push_back(back + k * fine);
    const int others = static_cast<int>((2 * pi - part) / coarse);
    for (int k = 0; k < others; ++k) angles.push_back(back + part + k * (2 * pi - part) / others);
    Settings settings = accurate(tilted_gravity(degrees), 1e-10);
    settings.step_size = h;
    World world(settings);
    const auto material = world.add_material({.friction = mu});
    world.add_collider(Plane{});
    const auto body = world.add_body(
        wheel(angles),
        {.material = material, .position = {0, 0, radius}, .contact_distance = 0, .dynamics = BodyDynamics::rigid});
    REQUIRE(world.advance(seconds).ok());
    const WorldReport report = world.report();
    const Real mass = world.mass(body);
    const Vec3 own = report.angular_momentum - world.center_of_mass(body).cross(report.momentum);
    return {report.momentum.x() / mass / seconds, own.y() / (mass * radius * radius / 2) / seconds};
}

enum class Slope { plane, mesh };

/// Releases a rigid sphere on a slope. The means are over a second.
Rolled roll_sphere(Real degrees, Real mu, Slope slope) {
    constexpr Real radius = 0.1, seconds = 1, kept = 1e-3;  // m, s, m
    Settings settings = accurate(tilted_gravity(degrees), 1e-10);
    settings.step_size = 0.01;
    World world(settings);
    const auto material = world.add_material({.friction = mu});
    if (slope == Slope::plane)
        world.add_collider(Plane{.point = {0, 0, kept / 2}});
    else
        world.add_collider(mesh::boundary(mesh::box({8, 1, 0.2}, {40, 5, 1})),
                           {.position = {0, 0, -0.1}, .contact_distance = kept});
    const auto body = world.add_body(Sphere{radius}, {.material = material,
                                                      .position = {-3, 0.07, radius + kept},
                                                      .contact_distance = kept,
                                                      .dynamics = BodyDynamics::rigid});
    REQUIRE(world.advance(seconds).ok());
    const WorldReport report = world.report();
    const Real mass = world.mass(body);
    const Vec3 own = report.angular_momentum - world.center_of_mass(body).cross(report.momentum);
    return {report.momentum.x() / mass / seconds, own.y() / (mass * radius * radius * 2 / 5) / seconds};
}

}  // namespace

TEST_CASE("a rigid sphere rolls down a slope, and slips where friction is too small", "[scene][accuracy]") {
    constexpr Real radius = 0.1;
    const Real gentle = 10 * pi / 180, steep = 30 * pi / 180;
    for (const Slope slope : {Slope::plane, Slope::mesh}) {
        const std::string on = slope == Slope::plane ? "plane" : "mesh of 980 triangles";
        accuracy::check({.item = 64,
                         .name = "rigid sphere on a " + on + " of 10 degrees, mu = 0.5, acceleration (m/s^2)",
                         .formula = "(5/7) g sin(b), mu >= (2/7) tan(b)",
                         .expected = 5.0 / 7 * g * std::sin(gentle),
                         .found = roll_sphere(10, 0.5, slope).acceleration,
                         .tolerance = 1e-8});
        const Rolled slipping = roll_sphere(30, 0.1, slope);
        accuracy::check({.item = 64,
                         .name = "the same on 30 degrees, mu = 0.1, acceleration (m/s^2)",
                         .formula = "g (sin(b) - mu cos(b)), mu < (2/7) tan(b)",
                         .expected = g * (std::sin(steep) - 0.1 * std::cos(steep)),
                         .found = slipping.acceleration,
                         .tolerance = 1e-8});
        accuracy::check({.item = 64,
                         .name = "the same, angular acceleration (rad/s^2)",
                         .formula = "(5/2) mu g cos(b) / R",
                         .expected = 2.5 * 0.1 * g * std::cos(steep) / radius,
                         .found = slipping.spin,
                         .tolerance = 1e-8});
    }
}

TEST_CASE("a rigid wheel rolls down a slope, and slips where friction is too small", "[scene][accuracy]") {
    constexpr Real radius = 0.1;
    const Real gentle = 10 * pi / 180, steep = 30 * pi / 180;
    const Real law = 2.0 / 3 * g * std::sin(gentle);
    const Real coarse = roll(10, 0.5, 2e-4).acceleration, fine = roll(10, 0.5, 1e-4).acceleration;
    accuracy::check({.item = 55,
                     .name = "rigid wheel on 10 degrees, mu = 0.5, acceleration (m/s^2), h = 1e-4 s",
                     .formula = "(2/3) g sin(b), mu >= tan(b)/3",
                     .expected = law,
                     .found = fine,
                     .tolerance = 1e-3,
                     .note = "The floor carries the wheel where it touched at the beginning of the step, so that its "
                             "weight holds it back: an error of the order of the step."});
    accuracy::check({.item = 55,
                     .name = "the same, order in the step, 2e-4 s and 1e-4 s",
                     .formula = "1",
                     .expected = 1,
                     .found = std::log2((law - coarse) / (law - fine)),
                     .tolerance = 0.15,
                     .kind = Tolerance::absolute});
    const Rolled slipping = roll(30, 0.1, 1e-4);
    accuracy::check({.item = 55,
                     .name = "rigid wheel on 30 degrees, mu = 0.1, acceleration (m/s^2)",
                     .formula = "g (sin(b) - mu cos(b)), mu < tan(b)/3",
                     .expected = g * (std::sin(steep) - 0.1 * std::cos(steep)),
                     .found = slipping.acceleration,
                     .tolerance = 1e-5});
    accuracy::check({.item = 55,
                     .name = "the same, angular acceleration (rad/s^2)",
                     .formula = "2 mu g cos(b) / R",
                     .expected = 2 * 0.1 * g * std::cos(steep) / radius,
                     .found = slipping.spin,
                     .tolerance = 2e-3});
}

TEST_CASE("a rigid plate rocks on a round back without slip", "[scene][accuracy]") {
    constexpr Real radius = 0.2, length = 0.4, thickness = 0.05, tilt = 0.02, h = 2e-4;  // m, m, m, rad, s
    Settings settings = accurate({0, 0, -g}, 1e-10);
    settings.step_size = h;
    World world(settings);
    const auto material = world.add_material({.friction = 1});
    world.add_collider(Cylinder{radius, 2}, {.rotation = {pi / 2, 0, 0}});
    // The plate is rolled by `tilt`: the contact point is radius * tilt away from the middle of the plate.
    const Vec3 normal(std::sin(tilt), 0, std::cos(tilt)), along(std::cos(tilt), 0, -std::sin(tilt));
    const auto plate = world.add_body(mesh::box({length, 0.1, thickness}, {2, 1, 1}),
                                      {.material = material,
                                       .position = (radius + thickness / 2) * normal - radius * tilt * along,
                                       .rotation = {0, tilt, 0},
                                       .contact_distance = 0,
                                       .dynamics = BodyDynamics::rigid});
    std::vector<Real> passages;  // times at which the plate is level [s]
    Real before = tilt, most = 0;
    while (passages.size() < 5 && world.time() < 5) {
        REQUIRE(world.advance(h).ok());
        const Real now = world.pose(plate).rotation.y();
        if (before * now < 0) passages.push_back(world.time() - h * now / (now - before));
        if (passages.size() == 4) most = std::max(most, std::abs(now));
        before = now;
    }
    REQUIRE(passages.size() == 5);
    const Real half = thickness / 2, squared = (length * length + thickness * thickness) / 12;
    accuracy::check({.item = 56,
                     .name = "rigid plate that rocks on a cylinder by 0.02 rad, two periods (s)",
                     .formula = "4 pi sqrt((k^2 + b^2) / (g (R - b)))",
                     .expected = 4 * pi * std::sqrt((squared + half * half) / (g * (radius - half))),
                     .found = passages[4] - passages[0],
                     .tolerance = 2e-3});
    accuracy::check({.item = 56,
                     .name = "the same, amplitude of the fifth swing (rad)",
                     .formula = "that of the first: nothing slips",
                     .expected = tilt,
                     .found = most,
                     .tolerance = 0.01});
}

TEST_CASE("a rigid rod of Painleve's jams with a finite impulse", "[scene][accuracy]") {
    constexpr Real length = 1, width = 0.02, mu = 1.6, speed = 2, h = 1e-3;  // m, m, -, m/s, s
    const Real angle = std::atan(2.0), sine = std::sin(angle), cosine = std::cos(angle);
    // The rod stands on one corner, since with two on the floor one may jam and the other lift.
    Mesh mesh = mesh::box({length, width, width}, {10, 1, 1});
    const Mat3 quarter = Eigen::AngleAxis<Real>(pi / 4, Vec3::UnitX()).toRotationMatrix();
    for (Vec3& x : mesh.nodes) x = quarter * x;
    const Real half = width / std::numbers::sqrt2;
    const Vec3 arm(-length / 2 * cosine + half * sine, 0, -length / 2 * sine - half * cosine);  // to the corner [m]
    Real gain = 0, refused = 0;
    for (const Real direction : {-1.0, 1.0}) {
        Settings settings = accurate({0, 0, -g}, 1e-10);
        settings.step_size = h;
        World world(settings);
        const auto material = world.add_material({.friction = mu});
        world.add_collider(Plane{});
        const auto rod = world.add_body(mesh, {.material = material,
                                               .position = {0, 0, -arm.z()},
                                               .rotation = {0, -angle, 0},
                                               .velocity = {direction * speed, 0, 0},
                                               .contact_distance = 0,
                                               .dynamics = BodyDynamics::rigid});
        const auto energy = [&] { return world.energy().kinetic + world.energy().potential; };
        const Real start = energy(), mass = world.mass(rod);
        Real before = start;
        Vec3 first = Vec3::Zero();
        for (int step = 0; step < 300; ++step) {  // ends before the rod falls flat
            const StepReport report = world.advance(h);
            refused += !report.ok() || report.unconverged > 0;
            gain = std::max(gain, (energy() - before) / start);
            before = energy();
            if (step == 0)
                for (const Contact& contact : world.contacts()) first += contact.impulse;
        }
        if (direction > 0) continue;
        REQUIRE(1 + 3 * cosine * (cosine - mu * sine) < 0);
        const Real squared = (length * length + width * width) / 12;  // squared radius of gyration
        Eigen::Matrix2d w;
        w << 1 + arm.z() * arm.z() / squared, -arm.x() * arm.z() / squared, -arm.x() * arm.z() / squared,
            1 + arm.x() * arm.x() / squared;
        const Eigen::Vector2d stuck = mass * w.inverse() * Eigen::Vector2d(speed, g * h);
        accuracy::check({.item = 57,
                         .name = "rigid rod at tan(a) = 2 that slides into a jam, mu = 1.6, friction of the first "
                                 "step (N s), h = 1e-3 s",
                         .formula = "W r = -u, (1 + 3 cos(a)^2)/4 m v of a thin rod",
                         .expected = stuck[0],
                         .found = first.x(),
                         .tolerance = 1e-8});
        accuracy::check({.item = 57,
                         .name = "the same, normal impulse of the first step (N s)",
                         .formula = "W r = -u, (3/4) sin(a) cos(a) m v of a thin rod",
                         .expected = stuck[1],
                         .found = first.z(),
                         .tolerance = 1e-8});
    }
    accuracy::check({.item = 57,
                     .name = "the same, slid in either direction, steps of 300 that were refused or not converged",
                     .formula = "0",
                     .found = refused,
                     .tolerance = 0,
                     .kind = Tolerance::absolute});
    accuracy::check({.item = 57,
                     .name = "the same, worst gain of a step over the energy",
                     .formula = "<= 0",
                     .found = gain,
                     .tolerance = 1e-12,
                     .kind = Tolerance::absolute});
}

}  // namespace skerry::test::rolling_test
