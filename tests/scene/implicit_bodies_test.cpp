// Implicit bodies in whole steps (docs/methods/implicit_bodies.md).
#include <Eigen/Geometry>
#include <catch2/catch.hpp>
#include <cmath>
#include <numbers>

#include "tests/support/same_bits.h"
#include "tests/support/worlds.h"

namespace skerry::test::implicit_bodies_test {

namespace {

const Mesh cube = mesh::box({0.1, 0.1, 0.1}, {2, 2, 2});

struct ImplicitCube {
    World world;
    MaterialHandle material;
    BodyHandle body;

    explicit ImplicitCube(const Settings& settings, BodySettings body_settings = {}, const MaterialSettings& of = {},
                          const Mesh& mesh = cube)
        : world(settings), material(world.add_material(of)) {
        body_settings.material = material;
        body_settings.dynamics = BodyDynamics::implicit_elastic;
        body = world.add_body(mesh, body_settings);
    }
};

Settings without_gravity(Real h) {
    Settings settings;
    settings.gravity = Vec3::Zero();
    settings.step_size = h;
    return settings;
}

/// An implicit block on a plane tilted by `degrees`, at rest.
ImplicitCube on_incline(Real degrees, Real mu, Real h, Real modulus) {
    Settings settings = accurate(tilted_gravity(degrees), 1e-10);
    settings.step_size = h;
    ImplicitCube scene(settings, {.position = {0, 0, 0.025}, .contact_distance = 0},
                       {.young_modulus = modulus, .poisson_ratio = 0.3, .friction = mu},
                       mesh::box({0.1, 0.1, 0.05}, {2, 2, 1}));
    scene.world.add_collider(Plane{});
    return scene;
}

/// Two implicit cubes, one thrown at the other, and an explicit elastic one beside them.
struct Collision {
    World world;
    std::array<BodyHandle, 3> body;

    explicit Collision(int threads = 1, bool with_explicit = true, Real theta = 1) : world(settings(threads, theta)) {
        const auto stiff = world.add_material({.young_modulus = 1e8, .poisson_ratio = 0.3});
        const auto soft = world.add_material({.young_modulus = 1e5});
        body[0] = world.add_body(cube, {.material = stiff,
                                        .velocity = {2, 0, 0},
                                        .angular_velocity = {1, 2, 3},
                                        .dynamics = BodyDynamics::implicit_elastic});
        body[1] = world.add_body(
            cube, {.material = stiff, .position = {0.13, 0.02, 0.01}, .dynamics = BodyDynamics::implicit_elastic});
        if (with_explicit) body[2] = world.add_body(cube, {.material = soft, .position = {0.27, 0, 0}});
    }
    static Settings settings(int threads, Real theta) {
        Settings settings;
        settings.gravity = Vec3::Zero();
        settings.threads = threads;
        settings.theta = theta;
        return settings;
    }
};

}  // namespace

TEST_CASE("a free implicit body keeps its momenta, and loses no energy of its spin", "[scene][implicit]") {
    const Mesh brick = mesh::box({0.1, 0.2, 0.3}, {1, 2, 3});
    ImplicitCube scene(without_gravity(1.0 / 60), {.velocity = {0.1, 0.2, 0.3}, .angular_velocity = {0.2, 6, 0.3}},
                       {.young_modulus = 1e8}, brick);
    const WorldReport before = scene.world.report();
    REQUIRE(scene.world.advance(20).ok());
    const WorldReport after = scene.world.report();
    CHECK((after.momentum - before.momentum).norm() < 1e-14 * before.momentum.norm());
    CHECK((after.angular_momentum - before.angular_momentum).norm() < 1e-12 * before.angular_momentum.norm());
    CHECK(std::abs(after.energy.kinetic / before.energy.kinetic - 1) < 1e-3);
    CHECK(after.energy.elastic < 1e-20);
    const Real mass = 6;  // a solid brick with the density of water
    CHECK(before.angular_momentum.y() == Approx(6 * mass * (0.01 + 0.09) / 12).epsilon(1e-12));
}

TEST_CASE("an implicit block stands below the friction angle without creep, and slides above it by the law",
          "[scene][implicit][long]") {
    const Real mu = 0.3, critical = std::atan(mu) * 180 / std::numbers::pi;
    for (const Real modulus : {1e7, 1e9, 2e11})
        for (const Real h : {1.0 / 60, 1.0 / 1000}) {
            CAPTURE(modulus, h);
            ImplicitCube still = on_incline(critical - 0.1, mu, h, modulus);
            REQUIRE(still.world.advance(1).ok());
            const Vec3 start = still.world.center_of_mass(still.body);
            REQUIRE(still.world.advance(1).ok());
            CHECK((still.world.center_of_mass(still.body) - start).norm() < 1e-9);

            ImplicitCube slides = on_incline(critical + 0.1, mu, h, modulus);
            const auto speed = [&] { return slides.world.report().momentum.x() / 0.5; };
            REQUIRE(slides.world.advance(1).ok());
            const Real before = speed();
            REQUIRE(slides.world.advance(1).ok());
            const Real angle = (critical + 0.1) * std::numbers::pi / 180;
            const Real expected = standard_gravity * (std::sin(angle) - mu * std::cos(angle));
            CHECK(speed() - before == Approx(expected).epsilon(1e-3));
        }
}

TEST_CASE("an implicit body in equilibrium stays where it is, whatever the step", "[scene][implicit]") {
    Settings settings = accurate({0, 0, -standard_gravity}, 1e-10);
    settings.step_size = 1e-3;
    ImplicitCube scene(settings, {.position = {0, 0, 0.05}, .contact_distance = 0}, {.young_modulus = 1e6});
    scene.world.add_collider(Plane{});
    REQUIRE(scene.world.advance(2).ok());
    const std::vector<Vec3> still(scene.world.positions(scene.body).begin(), scene.world.positions(scene.body).end());
    Real force = 0;
    for (const Contact& contact : scene.world.contacts()) force += contact.impulse.z() / 1e-3;
    CHECK(force == Approx(standard_gravity).epsilon(1e-9));
    // It is compressed like a column under its weight: rho g L^2 / (2 E), where the floor lets it widen.
    CHECK(scene.world.positions(scene.body)[0].z() < 0.1 - 0.3 * 1000 * standard_gravity * 0.01 / 2e6);
    REQUIRE(scene.world.advance(1).ok());
    for (std::size_t n = 0; n < still.size(); ++n)
        CHECK((scene.world.positions(scene.body)[n] - still[n]).norm() < 1e-12);
}

TEST_CASE("implicit bodies exchange momentum with each other and with explicit ones, and energy adds up",
          "[scene][implicit]") {
    Collision scene;
    const WorldReport before = scene.world.report();
    REQUIRE(scene.world.advance(0.3).ok());
    const WorldReport after = scene.world.report();
    CHECK(after.mean_contacts > 0);
    CHECK((after.momentum - before.momentum).norm() < 1e-12 * before.momentum.norm());
    // The contact distance separates the two points of each impulse, which gives a small moment.
    CHECK((after.angular_momentum - before.angular_momentum).norm() < 2e-3 * before.momentum.norm() * 0.1);
    CHECK(after.energy.kinetic + after.energy.elastic < before.energy.kinetic);
    CHECK(after.energy_error_share < 1e-2);  // error of the explicit body
    CHECK(scene.world.velocities(scene.body[2])[0].x() > 0.1);
}

TEST_CASE("energy of implicit bodies that hit each other adds up to rounding", "[scene][implicit]") {
    Collision scene(1, false, GENERATE(1.0, 0.75, 0.55, 0.5));
    const WorldReport before = scene.world.report();
    REQUIRE(scene.world.advance(0.1).ok());
    const WorldReport after = scene.world.report();
    CHECK(after.mean_contacts > 0);
    CHECK(after.energy.dissipated > 0.1 * before.energy.kinetic);
    CHECK(after.energy.kinetic + after.energy.elastic + after.energy.dissipated ==
          Approx(before.energy.kinetic).epsilon(1e-12));
    CHECK(after.energy_error_share < 1e-12);
}

TEST_CASE("a world with implicit bodies goes on bit by bit when it is cloned or saved, on any number of workers",
          "[scene][implicit]") {
    const auto simulate = [](int threads) {
        Collision scene(threads);
        REQUIRE(scene.world.advance(0.02).ok());
        return scene;
    };
    check_same_bits(simulate, [](World& world) { REQUIRE(world.advance(0.2).ok()); });
}

TEST_CASE("an implicit body vibrates as a rod does, damped as theta says", "[scene][implicit]") {
    // First longitudinal mode of a free rod: period 2 L sqrt(rho/E) with nu = 0
    const Real length = 1, modulus = 1e6, density = 1000, period = 2 * length * std::sqrt(density / modulus);
    constexpr int steps = 100;  // per period
    const Mesh rod = mesh::box({length, 0.05, 0.05}, {20, 1, 1});
    std::vector<Vec3> stretched;
    for (const Vec3& x : rod.nodes)
        stretched.push_back(x + Vec3(1e-3 * std::sin(std::numbers::pi * x.x() / length), 0, 0));
    const Real theta = GENERATE(1.0, 0.75, 0.55, 0.5);
    CAPTURE(theta);
    Settings settings = without_gravity(period / steps);
    settings.theta = theta;
    ImplicitCube scene(settings, {}, {.young_modulus = modulus, .poisson_ratio = 0, .density = density}, rod);
    scene.world.set_positions(scene.body, stretched);
    const auto end = [&] { return scene.world.positions(scene.body).back().x() - rod.nodes.back().x(); };
    CHECK(end() == Approx(1e-3).epsilon(1e-9));
    const Real start = scene.world.report().energy.elastic;
    Real crossing = 0;  // time of the first crossing, a quarter of the period [s]
    for (int k = 0; k < steps && crossing == 0; ++k) {
        const Real before = end();
        REQUIRE(scene.world.advance(period / steps).ok());
        if (end() <= 0) crossing = period / steps * (k + before / (before - end()));
    }
    CHECK(crossing == Approx(period / 4).epsilon(theta == 1 ? 0.04 : 0.02));
    REQUIRE(scene.world.advance(2 * period - scene.world.time()).ok());
    const WorldReport report = scene.world.report();
    const Real z = 2 * std::numbers::pi / steps;
    const Real kept = std::pow((1 + (1 - theta) * (1 - theta) * z * z) / (1 + theta * theta * z * z), 2 * steps);
    CHECK((report.energy.kinetic + report.energy.elastic) / start == Approx(kept).epsilon(0.03));
    CHECK(report.energy.kinetic + report.energy.elastic + report.energy.dissipated == Approx(start).epsilon(1e-9));
}

TEST_CASE("stacks of implicit and rigid blocks come to rest, implicit ones by Newton steps", "[scene][implicit]") {
    const auto dynamics = GENERATE(BodyDynamics::implicit_elastic, BodyDynamics::rigid);
    CAPTURE(name_of(dynamics));
    const auto unconverged = [&](SolverMethod method, Real& speed) {
        Settings settings;
        settings.step_size = 0.01;
        settings.tolerance = 1e-6;
        settings.method = method;
        World world(settings);
        const auto stiff = world.add_material({.young_modulus = 1e8, .poisson_ratio = 0.3, .friction = 0.5});
        world.add_collider(Plane{});
        const Mesh block = mesh::box({0.2, 0.2, 0.1}, {2, 2, 1});
        for (int k = 0; k < 6; ++k)
            world.add_body(block, {.material = stiff, .position = {0, 0, 0.06 + 0.11 * k}, .dynamics = dynamics});
        const StepReport report = world.advance(1);
        REQUIRE(report.ok());
        speed = 0;
        for (const BodyHandle body : world.bodies())
            for (const Vec3& v : world.velocities(body)) speed = std::max(speed, v.norm());
        return report.unconverged;
    };
    Real speed = 0, swept_speed = 0;
    const Index with = unconverged(SolverMethod::automatic, speed),
                without = unconverged(SolverMethod::ags, swept_speed);
    // Sweeps suffice for so small a stack of rigid blocks.
    if (dynamics == BodyDynamics::implicit_elastic) CHECK(4 * with < without);
    CHECK(speed < 2e-6);
}

TEST_CASE("a soft stack that lands is solved by Newton steps where sweeps do not", "[scene][implicit][long]") {
    const auto unconverged = [](SolverMethod method) {
        Settings settings;
        settings.step_size = 0.01;
        settings.method = method;
        World world(settings);
        const auto soft = world.add_material({.young_modulus = 1e6, .poisson_ratio = 0.3, .friction = 0.5});
        world.add_collider(Plane{});
        const Mesh block = mesh::box({0.2, 0.2, 0.1}, {4, 4, 2});
        for (int k = 0; k < 8; ++k)
            world.add_body(
                block,
                {.material = soft, .position = {0, 0, 0.06 + 0.11 * k}, .dynamics = BodyDynamics::implicit_elastic});
        const StepReport report = world.advance(0.15);
        REQUIRE(report.ok());
        return report.unconverged;
    };
    CHECK(unconverged(SolverMethod::automatic) == 0);
    CHECK(unconverged(SolverMethod::ags) > 0);
}

TEST_CASE("stiff implicit blocks that land on each other are solved as if they moved as wholes first",
          "[scene][implicit][long]") {
    // With few iterations, sweeps and Newton steps alone leave 32 regions of the stack unconverged. In the stack whose
    // lowest block is held, 35 are left if the coarse correction moves that block as a whole, too.
    const auto unconverged = [](int count, Index most, bool held) {
        Settings settings;
        settings.step_size = 0.01;
        settings.sleep = false;
        settings.max_iterations = most;
        World world(settings);
        const auto stiff = world.add_material({.young_modulus = 1e8, .poisson_ratio = 0.3, .friction = 0.5});
        world.add_collider(Plane{});
        const Mesh block = mesh::box({0.2, 0.2, 0.1}, {4, 4, 2});
        for (int k = 0; k < count; ++k)
            world.add_body(
                block,
                {.material = stiff, .position = {0, 0, 0.06 + 0.11 * k}, .dynamics = BodyDynamics::implicit_elastic});
        std::vector<Index> lowest;
        for (std::size_t n = 0; n < block.nodes.size(); ++n)
            if (block.nodes[n].z() < -0.049) lowest.push_back(static_cast<Index>(n));
        if (held) world.attach(world.bodies()[0], lowest);
        const StepReport report = world.advance(0.4);
        REQUIRE(report.ok());
        return report.unconverged;
    };
    CHECK(unconverged(8, 40, false) < 20);
    CHECK(unconverged(6, 20, true) < 18);
}

TEST_CASE("contacts that Newton steps turn round are stopped", "[scene][implicit][long]") {
    // With few iterations, 31 regions are left unconverged if such contacts go on sliding.
    Settings settings;
    settings.step_size = 0.002;
    settings.tolerance = 1e-6;
    settings.max_iterations = 60;
    settings.sleep = false;
    World world(settings);
    const auto stiff = world.add_material({.young_modulus = 1e8, .poisson_ratio = 0.3, .friction = 0.5});
    world.add_collider(Plane{});
    const Mesh block = mesh::box({0.2, 0.2, 0.1}, {4, 4, 2});
    for (int k = 0; k < 8; ++k)
        world.add_body(
            block,
            {.material = stiff, .position = {0, 0, 0.06 + 0.11 * k}, .dynamics = BodyDynamics::implicit_elastic});
    const StepReport report = world.advance(0.3);
    REQUIRE(report.ok());
    CHECK(report.unconverged < 10);
}

TEST_CASE("a stack at rest whose contacts come and go by the last bits goes on from their impulses",
          "[scene][implicit][long]") {
    Settings settings;
    settings.step_size = 0.01;
    settings.tolerance = 1e-6;
    settings.sleep = false;
    World world(settings);
    const auto stiff = world.add_material({.young_modulus = 1e8, .poisson_ratio = 0.3, .friction = 0.5});
    world.add_collider(Plane{});
    const Mesh block = mesh::box({0.2, 0.2, 0.1}, {4, 4, 2});
    for (int k = 0; k < 6; ++k)
        world.add_body(
            block,
            {.material = stiff, .position = {0, 0, 0.06 + 0.11 * k}, .dynamics = BodyDynamics::implicit_elastic});
    REQUIRE(world.advance(0.5).ok());
    const WorldReport landed = world.report();
    REQUIRE(world.advance(0.5).ok());
    const WorldReport rested = world.report();
    CHECK(rested.iteration_sum - landed.iteration_sum < 10 * (rested.steps - landed.steps));
}

TEST_CASE("theta is refused where it has no meaning", "[scene][implicit]") {
    Settings settings;
    settings.theta = 0.4;
    CHECK_THROWS_WITH(World(settings), Catch::Contains("theta") && Catch::Contains("from 0.5 to 1"));
    settings.theta = 0.6;
    settings.integrator = Integrator::leapfrog;
    CHECK_THROWS_WITH(World(settings), Catch::Contains("theta") && Catch::Contains("symplectic_euler"));
}

TEST_CASE("an implicit body that is set by hand keeps its deformation", "[scene][implicit]") {
    ImplicitCube scene(without_gravity(1e-3), {}, {.young_modulus = 1e6});
    std::vector<Vec3> position, velocity;
    const Mat3 turn = Eigen::AngleAxis<Real>(0.7, Vec3(1, 2, 3).normalized()).toRotationMatrix();
    for (const Vec3& x : cube.nodes) {
        position.push_back(Vec3(1, 2, 3) + turn * Vec3(1.01 * x.x(), x.y(), x.z() + 0.1 * x.x() * x.x()));
        velocity.push_back(Vec3(0.1, 0.2, 0.3) + Vec3(1, 0, 2).cross(position.back()) + turn * (0.5 * x));
    }
    scene.world.set_positions(scene.body, position);
    scene.world.set_velocities(scene.body, velocity);
    for (std::size_t n = 0; n < position.size(); ++n) {
        CHECK((scene.world.positions(scene.body)[n] - position[n]).norm() < 1e-12);
        // The spin of the solid equals that of the nodes if they rotate as a whole.
        CHECK((scene.world.velocities(scene.body)[n] - velocity[n]).norm() < 1e-3);
    }
    CHECK(scene.world.dynamics(scene.body) == BodyDynamics::implicit_elastic);
    const Energy before = scene.world.report().energy;
    CHECK(before.elastic > 0);
    REQUIRE(scene.world.advance(0.5).ok());
    CHECK(scene.world.report().energy.elastic < 1e-3 * before.elastic);  // the vibration has died away
}

TEST_CASE("a load on a node of an implicit body deforms it as its stiffness says", "[scene][implicit]") {
    ImplicitCube scene(without_gravity(1e-2), {}, {.young_modulus = 1e6});
    // Two opposite forces squeeze the cube between opposite corners.
    std::vector<Vec3> load(cube.nodes.size(), Vec3::Zero());
    std::size_t high = 0, low = 0;
    for (std::size_t n = 0; n < cube.nodes.size(); ++n) {
        if (cube.nodes[n].sum() > cube.nodes[high].sum()) high = n;
        if (cube.nodes[n].sum() < cube.nodes[low].sum()) low = n;
    }
    const Vec3 force = 0.5 * (cube.nodes[low] - cube.nodes[high]).normalized();
    load[high] = force;
    load[low] = -force;
    scene.world.set_loads(scene.body, load);
    REQUIRE(scene.world.advance(5).ok());
    const std::span<const Vec3> position = scene.world.positions(scene.body);
    const Vec3 squeezed = (position[high] - cube.nodes[high]) - (position[low] - cube.nodes[low]);
    // Clapeyron: the energy is the work of slowly applied loads.
    CHECK(scene.world.report().energy.elastic == Approx(force.dot(squeezed) / 2).epsilon(1e-9));
    CHECK(scene.world.report().energy.kinetic < 1e-20);
}

TEST_CASE("stress and strain of an implicit body turn with it", "[scene][implicit]") {
    // nu = 0: a stretch of 1e-5 along x gives a stress of E times that, and none across.
    ImplicitCube scene(without_gravity(1e-3), {}, {.young_modulus = 1e6, .poisson_ratio = 0});
    const Mat3 turn = Eigen::AngleAxis<Real>(0.7, Vec3(1, 2, 3).normalized()).toRotationMatrix();
    std::vector<Vec3> position;
    for (const Vec3& x : cube.nodes) position.push_back(turn * Vec3((1 + 1e-5) * x.x(), x.y(), x.z()));
    scene.world.set_positions(scene.body, position);
    const Mat3 along = turn.col(0) * turn.col(0).transpose();
    for (const Mat3& stress : scene.world.stress(scene.body)) CHECK((stress - 10 * along).norm() < 1e-3);
    for (const Mat3& strain : scene.world.strain(scene.body)) CHECK((strain - 1e-5 * along).norm() < 1e-9);

    scene.world.set_material(scene.material, {.young_modulus = 2e6, .poisson_ratio = 0});
    for (const Mat3& stress : scene.world.stress(scene.body)) CHECK((stress - 20 * along).norm() < 2e-3);
    CHECK(scene.world.report().energy.elastic == Approx(2e6 * 1e-10 * 1e-3 / 2).epsilon(1e-3));
}

TEST_CASE("settings that implicit bodies do not support are refused by name", "[scene][implicit]") {
    ImplicitCube scene(Settings{});
    CHECK_THROWS_WITH(
        scene.world.add_body(
            cube, {.material = scene.material, .self_contact = true, .dynamics = BodyDynamics::implicit_elastic}),
        Catch::Contains("self_contact") && Catch::Contains("the dynamics implicit"));
}

TEST_CASE("an implicit body comes to rest, sleeps, and wakes when it is hit", "[scene][implicit]") {
    Settings settings;
    settings.step_size = 1.0 / 240;
    settings.sleep = true;
    ImplicitCube scene(settings, {.position = {0, 0, 0.06}}, {.young_modulus = 1e8});
    scene.world.add_collider(Plane{});
    REQUIRE(scene.world.advance(3).ok());
    CHECK(scene.world.asleep(scene.body));
    const WorldReport asleep = scene.world.report();
    CHECK(asleep.energy.kinetic == 0);
    CHECK(asleep.energy_error_share < 1e-3);
    scene.world.add_body(cube, {.material = scene.material,
                                .position = {0.02, 0, 0.25},
                                .velocity = {0, 0, -1},
                                .dynamics = BodyDynamics::implicit_elastic});
    REQUIRE(scene.world.advance(0.2).ok());
    CHECK(!scene.world.asleep(scene.body));
}

TEST_CASE("rows of implicit bodies follow when others go", "[scene][implicit]") {
    const auto scene = [](bool with_first) {
        ImplicitCube far_cube(without_gravity(1e-3), {.position = {-9, 0, 0}}, {.young_modulus = 1e6});
        const BodySettings second{.material = far_cube.material,
                                  .position = {0, 0, 0},
                                  .velocity = {1, 0, 0},
                                  .dynamics = BodyDynamics::implicit_elastic};
        const BodyHandle body = far_cube.world.add_body(cube, second);
        far_cube.world.add_collider(Plane{.normal = {-1, 0, 0}}, {.position = {0.06, 0, 0}});
        if (with_first) far_cube.world.remove(far_cube.body);
        REQUIRE(far_cube.world.advance(0.1).ok());
        return std::vector<Vec3>(far_cube.world.positions(body).begin(), far_cube.world.positions(body).end());
    };
    CHECK(scene(true) == scene(false));
}

TEST_CASE("leapfrog moves implicit bodies, too", "[scene][implicit]") {
    Settings settings;
    settings.step_size = 1.0 / 128;
    settings.integrator = Integrator::leapfrog;
    ImplicitCube scene(settings, {.position = {0, 0, 1}, .angular_velocity = {0, 3, 1}}, {.young_modulus = 1e7});
    scene.world.add_collider(Plane{});
    REQUIRE(scene.world.advance(0.4).ok());
    CHECK(scene.world.center_of_mass(scene.body).z() == Approx(1 - standard_gravity * 0.08).epsilon(1e-12));
    REQUIRE(scene.world.advance(1).ok());
    CHECK(scene.world.center_of_mass(scene.body).z() > 0.04);
}

}  // namespace skerry::test::implicit_bodies_test
