// Stiff implicit bodies at rest, in contact, and against rigid bodies (docs/accuracy.md, items 58 to 63).
#include <algorithm>
#include <catch2/catch.hpp>
#include <cmath>
#include <numbers>
#include <vector>

#include "tests/support/accuracy.h"
#include "tests/support/graded_half_ball.h"
#include "tests/support/worlds.h"

namespace skerry::test::stiff_test {

using accuracy::Tolerance;

namespace {

constexpr Real g = standard_gravity, pi = std::numbers::pi;

const Mesh cube = mesh::box({0.1, 0.1, 0.1}, {2, 2, 2});

World with_step(const Vec3& gravity, Real tolerance, Real h, Real theta = 1) {
    Settings settings = accurate(gravity, tolerance);
    settings.step_size = h;
    settings.theta = theta;
    return World(settings);
}

/// Mean of ten half periods of the first mode of a free rod, with a phase of z per step [s]
Real period_of_rod(Real theta, Real z) {
    constexpr Real length = 1, modulus = 1e6, density = 1000;
    const Real period = 2 * length * std::sqrt(density / modulus), h = z * period / (2 * pi);
    World world = with_step(Vec3::Zero(), 1e-3, h, theta);
    const Mesh rod = mesh::box({length, 0.05, 0.05}, {20, 1, 1});
    std::vector<Vec3> stretched;
    for (const Vec3& x : rod.nodes) stretched.push_back(x + Vec3(1e-3 * std::sin(pi * x.x() / length), 0, 0));
    const auto material = world.add_material({.young_modulus = modulus, .poisson_ratio = 0, .density = density});
    const auto body = world.add_body(rod, {.material = material, .dynamics = BodyDynamics::implicit_elastic});
    world.set_positions(body, stretched);
    std::vector<Real> passages;
    Real before = 1e-3;
    while (passages.size() < 11) {
        REQUIRE(world.advance(h).ok());
        const Real now = world.positions(body).back().x() - rod.nodes.back().x();
        if (before * now < 0) passages.push_back(world.time() - h * now / (now - before));
        before = now;
    }
    return (passages[10] - passages[0]) / 5;
}

/// Velocity, and spin times size, of a cube that fell on a corner, as it leaves the floor [m/s]
Eigen::Matrix<Real, 6, 1> after_impact(Real modulus, BodyDynamics dynamics) {
    World world = with_step({0, 0, -g}, 1e-13, 1e-3);
    const auto material = world.add_material({.young_modulus = modulus, .poisson_ratio = 0.3, .friction = 0.3});
    world.add_collider(Plane{});
    const auto body = world.add_body(cube, {.material = material,
                                            .position = {0, 0, 0.1},
                                            .rotation = {0.5, 0.3, 0.1},
                                            .velocity = {0.4, 0.1, -1},
                                            .angular_velocity = {1, -2, 0.5},
                                            .contact_distance = 0,
                                            .dynamics = dynamics});
    REQUIRE(world.advance(0.04).ok());
    Eigen::Matrix<Real, 6, 1> motion;
    const WorldReport report = world.report();
    const Real mass = world.mass(body);
    motion << report.momentum / mass,
        (report.angular_momentum - world.center_of_mass(body).cross(report.momentum)) / (mass * 0.1 / 6);
    return motion;
}

/// Contact force and radius over Hertz's, for an implicit ball of 0.1 m that is pressed on a plane until the contact
/// radius should be a tenth of that, with `fine` elements in it.
struct Flattened {
    Real force, radius;
};

Flattened flatten(int fine, Real h, int steps) {
    constexpr Real a = 0.01, radius = 0.1, modulus = 1e9, nu = 0.3, reduced = modulus / (1 - nu * nu);
    Mesh mesh = graded_half_ball({.a = a, .fine = fine, .growth = 2.5, .radius = 4 * radius});
    roll_up(mesh, radius);
    World world = with_step(Vec3::Zero(), 1e-6, h);
    const auto material = world.add_material({.young_modulus = modulus, .poisson_ratio = nu, .friction = 0});
    world.add_collider(Plane{});
    const auto ball =
        world.add_body(mesh, {.material = material, .contact_distance = 0, .dynamics = BodyDynamics::implicit_elastic});
    const Real force = 4.0 / 3 * reduced * a * a * a / radius;
    world.set_gravity({0, 0, -force / world.mass(ball)});
    REQUIRE(world.advance(steps * h).ok());
    Real sum = 0, moment = 0;
    for (const Contact& contact : world.contacts()) {
        sum += contact.impulse.z() / h;
        moment += contact.impulse.z() / h * contact.point.head<2>().squaredNorm();
    }
    return {sum / force, std::sqrt(2.5 * moment / sum) / a};  // the mean of r^2 under Hertz's pressure is 2 a^2 / 5
}

}  // namespace

TEST_CASE("the period of an implicit rod is longer as theta says", "[scene][accuracy]") {
    constexpr Real z = 0.1;
    // Ratio to the period of the mesh: a step turns the mode by atan2(z, 1 - theta (1 - theta) z^2).
    const auto longer = [](Real theta) { return z / std::atan2(z, 1 - theta * (1 - theta) * z * z); };
    const Real own = period_of_rod(0.5, z) / longer(0.5);
    for (const Real theta : {1.0, 0.75, 0.55})
        accuracy::check({.item = 58,
                         .name = "first mode of a free rod, z = 0.1, period over that of the mesh - 1, theta = " +
                                 std::to_string(theta).substr(0, 4),
                         .formula = "z / atan(z / (1 - theta (1 - theta) z^2)) - 1",
                         .expected = longer(theta) - 1,
                         .found = period_of_rod(theta, z) / own - 1,
                         .tolerance = 0.05});
}

TEST_CASE("an implicit cube becomes the rigid one as it stiffens", "[scene][accuracy]") {
    const auto rigid = after_impact(1e9, BodyDynamics::rigid);
    REQUIRE(rigid[2] > -1);  // without the floor the cube would fall at 1.4 m/s
    const auto apart = [&](Real modulus) {
        return (after_impact(modulus, BodyDynamics::implicit_elastic) - rigid).norm();
    };
    const Real coarse = apart(1e10), fine = apart(1e12);
    accuracy::check({.item = 59,
                     .name = "cube of 0.1 m that falls on a corner, E = 1e12, velocity and spin over those of the "
                             "rigid one - 1, h = 1e-3 s",
                     .formula = "0 as E grows",
                     .found = fine / rigid.norm(),
                     .tolerance = 1e-5,
                     .kind = Tolerance::absolute});
    accuracy::check({.item = 59,
                     .name = "the same, order of that in 1/E, E = 1e10 and 1e12",
                     .formula = "1",
                     .expected = 1,
                     .found = std::log10(coarse / fine) / 2,
                     .tolerance = 0.05,
                     .kind = Tolerance::absolute});
}

TEST_CASE("a heavy implicit block on a light one presses on the floor with both weights", "[scene][accuracy]") {
    struct Case {
        Real modulus, h;
        const char* name;
    };
    for (const Case& test_case : {Case{1e9, 1e-3, "E = 1e9, h = 1/1000 s"}, Case{1e9, 1.0 / 60, "E = 1e9, h = 1/60 s"},
                                  Case{1e11, 1.0 / 60, "E = 1e11, h = 1/60 s"}}) {
        World world = with_step({0, 0, -g}, 1e-8, test_case.h);
        const auto stand = [&](Real density, Real height) {
            const auto material =
                world.add_material({.young_modulus = test_case.modulus, .poisson_ratio = 0.3, .density = density});
            world.add_body(cube, {.material = material,
                                  .position = {0, 0, height},
                                  .contact_distance = 0,
                                  .dynamics = BodyDynamics::implicit_elastic});
        };
        stand(10, 0.05);
        stand(1e5, 0.15);
        world.add_collider(Plane{});
        const StepReport report = world.advance(0.2);
        REQUIRE(report.ok());
        REQUIRE(report.unconverged == 0);
        Real floor = 0;
        for (const Contact& contact : world.contacts())
            if (contact.second == BodyHandle{}) floor += contact.impulse.z() / test_case.h;
        accuracy::check(
            {.item = 45,
             .name = std::string("implicit cubes of 100 kg on 0.01 kg, force of the floor (N), ") + test_case.name,
             .formula = "(M + m) g",
             .expected = (100 + 0.01) * g,
             .found = floor,
             .tolerance = 1e-3});
        accuracy::check({.item = 45,
                         .name = std::string("the same, largest overlap in 0.2 s (m), ") + test_case.name,
                         .formula = "0",
                         .found = report.max_penetration,
                         .tolerance = 1e-8,
                         .kind = Tolerance::absolute});
    }
}

TEST_CASE("three implicit balls in a row pass the first one's speed on", "[scene][accuracy]") {
    constexpr Real radius = 0.05, modulus = 1e7, density = 1000;
    // omega h = 0.1 for the lowest mode of a ball, omega = 2.65 sqrt(mu / rho) / R
    const Real h = 0.1 * radius / (2.65 * std::sqrt(modulus / 2.6 / density));
    World world = with_step(Vec3::Zero(), 1e-8, h, 0.55);
    const auto material =
        world.add_material({.young_modulus = modulus, .poisson_ratio = 0.3, .density = density, .friction = 0});
    const Mesh ball = mesh::ball(radius, 6);
    std::vector<BodyHandle> row;
    for (int k = 0; k < 3; ++k)
        row.push_back(world.add_body(ball, {.material = material,
                                            .position = {2.01 * radius * k, 0, 0},
                                            .velocity = {k == 0 ? 1.0 : 0.0, 0, 0},
                                            .contact_distance = 0,
                                            .dynamics = BodyDynamics::implicit_elastic}));
    const Vec3 start = world.report().momentum;
    REQUIRE(world.advance(0.016).ok());
    const std::vector<Real> mass = node_masses(world, row[2], ball, density);
    accuracy::check({.item = 60,
                     .name = "row of three implicit balls, gaps R/100, omega h = 0.1, theta = 0.55, speed of the last "
                             "one over that of the first before",
                     .formula = "1 as the balls' own vibrations take less and less",
                     .expected = 1,
                     .found = mean_velocity(world, row[2], mass).x(),
                     .tolerance = 0.1,
                     .kind = Tolerance::absolute});
    accuracy::check({.item = 60,
                     .name = "the same, change of momentum over itself",
                     .formula = "0",
                     .found = (world.report().momentum - start).norm() / start.norm(),
                     .tolerance = 1e-12,
                     .kind = Tolerance::absolute});
}

TEST_CASE("explicit, implicit and rigid bodies exchange momentum to rounding", "[scene][accuracy]") {
    World world = with_step(Vec3::Zero(), 1e-8, 1e-3);
    // Densities [kg/m^3]; the masses are 1, 7 and 40 kg.
    const auto soft = world.add_material({.young_modulus = 1e5}),
               stiff = world.add_material({.young_modulus = 1e9, .poisson_ratio = 0.3, .density = 7000}),
               hard = world.add_material({.density = 40000});
    struct Kind {
        BodyDynamics dynamics;
        MaterialHandle material;
    };
    const Kind explicit_one{BodyDynamics::explicit_elastic, soft}, implicit{BodyDynamics::implicit_elastic, stiff},
        rigid{BodyDynamics::rigid, hard};
    Real scale = 0;  // of the thrown bodies [kg m/s]
    int k = 0;
    for (const Kind& kind : {implicit, explicit_one, rigid, implicit, rigid, explicit_one}) {
        const Real speed = k == 0 ? 2 : k == 5 ? -2 : 0;
        const auto body = world.add_body(cube, {.material = kind.material,
                                                .position = {0.11 * k, 0.01 * k, 0.005 * k},
                                                .velocity = {speed, 0, 0},
                                                .angular_velocity = {0.3, 0.2 * k, 0.5},
                                                .dynamics = kind.dynamics});
        scale += std::abs(speed) * world.mass(body);
        ++k;
    }
    Vec3 before = world.report().momentum;
    Real worst = 0;
    for (int step = 0; step < 300; ++step) {
        REQUIRE(world.advance(1e-3).ok());
        const Vec3 now = world.report().momentum;
        worst = std::max(worst, (now - before).norm() / scale);
        before = now;
    }
    REQUIRE(world.report().mean_contacts > 5);
    accuracy::check({.item = 61,
                     .name = "explicit, implicit and rigid cubes of 1, 7 and 40 kg that hit each other, change of "
                             "momentum, worst of 300 calls, over sum m |v|",
                     .formula = "0",
                     .found = worst,
                     .tolerance = 1e-13,
                     .kind = Tolerance::absolute});
}

TEST_CASE("implicit bodies solved apart move as if solved together", "[scene][accuracy]") {
    constexpr Real h = 1e-3;
    const auto velocities = [&](ContactRegions regions) {
        Settings settings = accurate({0, 0, -g}, 1e-10);
        settings.step_size = h;
        settings.contact_regions = regions;
        World world(settings);
        world.add_collider(Plane{});
        int k = 0;
        for (const Real modulus : {1e5, 1e7, 1e9}) {
            const auto material = world.add_material({.young_modulus = modulus, .poisson_ratio = 0.3});
            for (const Real height : {0.051, 0.152})
                world.add_body(cube, {.material = material,
                                      .position = {0.2 * k, 0.01 * k, height},
                                      .velocity = {0.3, 0.1 * k, -0.5},
                                      .angular_velocity = {0.2, 0.1, 0.3},
                                      .contact_distance = 0,
                                      .dynamics = BodyDynamics::implicit_elastic});
            ++k;
        }
        const StepReport report = world.advance(4 * h);
        REQUIRE(report.ok());
        REQUIRE(report.contacts > 100);
        REQUIRE(report.unconverged == 0);
        std::vector<Vec3> all;
        for (const BodyHandle body : world.bodies())
            for (const Vec3& v : world.velocities(body)) all.push_back(v);
        return all;
    };
    const std::vector<Vec3> apart = velocities(ContactRegions::separate), together = velocities(ContactRegions::global);
    Real most = 0;
    for (std::size_t n = 0; n < apart.size(); ++n) most = std::max(most, (apart[n] - together[n]).norm());
    accuracy::check({.item = 63,
                     .name = "three stacks of two implicit cubes, E = 1e5, 1e7 and 1e9, that land, velocities of "
                             "regions apart less those of one region, after 4 steps (m/s)",
                     .formula = "0; 10 times the tolerance of a region",
                     .found = most,
                     .tolerance = 1e-9,
                     .kind = Tolerance::absolute});
}

TEST_CASE("an implicit ball is pressed flat as Hertz says, whatever the step", "[scene][accuracy][slow]") {
    const Flattened coarse = flatten(2, 1e-3, 10), fine = flatten(3, 1e-3, 10), slow = flatten(2, 5e-4, 30);
    accuracy::check({.item = 62,
                     .name = "implicit ball pressed on a plane, a / R = 0.1, 3 elements to the contact radius, force "
                             "of the plane over the weight",
                     .formula = "1",
                     .expected = 1,
                     .found = fine.force,
                     .tolerance = 1e-3});
    accuracy::check({.item = 62,
                     .name = "the same, contact radius over the formula",
                     .formula = "(3 F R / (4 E*))^(1/3)",
                     .expected = 1,
                     .found = fine.radius,
                     .tolerance = 0.06});
    accuracy::check({.item = 62,
                     .name = "the same, limit of 2 and 3 elements to the contact radius",
                     .formula = "(3 F R / (4 E*))^(1/3)",
                     .expected = 1,
                     .found = (9 * fine.radius - 4 * coarse.radius) / 5,
                     .tolerance = 0.01});
    accuracy::check({.item = 62,
                     .name = "the same, 2 elements, contact radius with h = 5e-4 s over that with h = 1e-3 s",
                     .formula = "1, statics do not know the step",
                     .expected = 1,
                     .found = slow.radius / coarse.radius,
                     .tolerance = 1e-3});
}

}  // namespace skerry::test::stiff_test
