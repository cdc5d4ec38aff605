// Forces reported for contacts and attachments, compared with their effect on the motion.
#include <catch2/catch.hpp>

#include <Eigen/Geometry>
#include <algorithm>
#include <numeric>

#include "engine/world/tuning.h"
#include "tests/support/sliver_box.h"
#include "tests/support/temporary_folder.h"
#include "tests/support/worlds.h"

namespace skerry::test::forces_test {

namespace {

/// Momentum, and angular momentum about the origin, of all nodes of a body.
struct Momenta {
    Vec3 linear = Vec3::Zero(), angular = Vec3::Zero();

    Momenta(const World& world, BodyHandle body, const Mesh& mesh, Real density) {
        const std::vector<Real> mass = node_masses(world, body, mesh, density);
        const auto x = world.positions(body), v = world.velocities(body);
        for (std::size_t n = 0; n < mass.size(); ++n) {
            linear += mass[n] * v[n];
            angular += mass[n] * x[n].cross(v[n]);
        }
    }
};

std::vector<Index> nodes_where(const World& world, BodyHandle body, auto&& is_chosen) {
    std::vector<Index> found;
    const auto nodes = world.positions(body);
    for (std::size_t n = 0; n < nodes.size(); ++n)
        if (is_chosen(nodes[n])) found.push_back(static_cast<Index>(n));
    return found;
}

/// Two stacked blocks on a moving plane and a mesh collider, and a bar with a held and a turned end.
struct BusyWorld {
    World world;
    Mesh block = mesh::box({0.2, 0.2, 0.1}, {4, 4, 2}), beam = mesh::box({0.4, 0.05, 0.05}, {8, 1, 1});
    BodyHandle low, high, bar;
    AttachmentHandle held, led;
    ColliderHandle plane, slab;
    Vec3 load = {0.01, 0.02, 0};  // on each node of `low` [N]

    explicit BusyWorld(const Settings& settings, bool loaded = true) : world(settings) {
        const auto rubber = world.add_material({.young_modulus = 5e4, .friction = 0.4});
        plane = world.add_collider(Plane{}, {.motion = {.velocity = {0.2, 0, 0.05}}});
        slab = world.add_collider(mesh::boundary(mesh::box({0.3, 0.3, 0.02}, {1, 1, 1})),
                                  {.position = {0.25, 0, 0.02}, .contact_distance = 0.002});
        low = world.add_body(block, {.material = rubber, .position = {0, 0, 0.12}, .contact_distance = 0.002});
        high = world.add_body(
            block,
            {.material = rubber, .position = {0.02, 0, 0.24}, .velocity = {0, 0.3, -1}, .contact_distance = 0.002});
        bar = world.add_body(beam, {.material = rubber, .position = {0, 1, 0.4}});
        held = world.attach(bar, nodes_where(world, bar, [](const Vec3& x) { return x.x() < -0.19; }));
        led = world.attach(bar, nodes_where(world, bar, [](const Vec3& x) { return x.x() > 0.19; }),
                           {.velocity = {0.1, 0, 0.2}, .angular_velocity = {1, 0, 0}});
        if (!loaded) load.setZero();
        if (loaded) world.set_loads(low, std::vector<Vec3>(block.nodes.size(), load));
    }
};

Settings with(Integrator integrator) {
    Settings settings;
    settings.integrator = integrator;
    return settings;
}

constexpr Real density = 1000;  // the default density [kg/m^3]

}  // namespace

TEST_CASE("impulses of contacts and attachments, weight and loads are the change of momentum of every body",
          "[scene]") {
    for (const Settings& settings : {with(Integrator::symplectic_euler), with(Integrator::leapfrog)}) {
        INFO(name_of(settings.integrator));
        BusyWorld busy(settings);
        World& world = busy.world;
        world.measure_forces(true);
        const std::vector<std::pair<BodyHandle, const Mesh*>> bodies{
            {busy.low, &busy.block}, {busy.high, &busy.block}, {busy.bar, &busy.beam}};
        Real met = 0, last = 0;  // `last`: step before the call, or the first step of all [s]
        world.watch_steps([&last](const StepReport& step) { last = last > 0 ? last : step.step_size; });
        for (int call = 0; call < 12; ++call) {
            std::vector<Momenta> before;
            for (const auto& [body, mesh] : bodies) before.emplace_back(world, body, *mesh, density);
            const Real dt = call % 2 == 0 ? 1.0 / 60 : 0.011;
            const StepReport step = world.advance(dt);
            REQUIRE(step.ok());
            REQUIRE(step.steps > 1);
            const Forces forces = world.forces();
            for (std::size_t b = 0; b < bodies.size(); ++b) {
                const auto [body, mesh] = bodies[b];
                const Momenta after(world, body, *mesh, density);
                const Real acted = forces.on(body).seconds;
                Vec3 impulse = forces.on(body).impulse + acted * world.mass(body) * world.settings().gravity;
                if (body == busy.low) impulse += acted * static_cast<Real>(mesh->nodes.size()) * busy.load;
                if (body == busy.bar) impulse += forces.by(busy.held).impulse + forces.by(busy.led).impulse;
                const Real scale =
                    after.linear.norm() + forces.on(body).pressing_impulse + dt * world.mass(body) * standard_gravity;
                INFO("body " << b << ", call " << call);
                CHECK((after.linear - before[b].linear - impulse).norm() < 1e-12 * scale);
            }
            // The forces act from half a step before the call to half a step before its end.
            const bool behind = settings.integrator == Integrator::symplectic_euler;
            CHECK(forces.on(busy.low).seconds ==
                  Approx(dt + (behind ? (last - step.step_size) / 2 : 0)).epsilon(1e-12));
            last = step.step_size;
            met += forces.on(busy.low, busy.high).pressing_impulse * forces.on(busy.low, busy.slab).pressing_impulse;
        }
        CHECK(met > 0);
    }
}

TEST_CASE("moments of contacts and attachments are the change of angular momentum", "[scene]") {
    for (const Integrator integrator : {Integrator::symplectic_euler, Integrator::leapfrog}) {
        INFO(name_of(integrator));
        Settings settings = with(integrator);
        settings.gravity.setZero();  // the moment of gravity is not reported
        // Push-out moves bodies without momentum and so changes their angular momentum; a solver residual does so, too.
        settings.recovery_speed = 1e-12;
        settings.tolerance = 1e-12;
        settings.max_iterations = 20000;
        BusyWorld busy(settings, false);
        World& world = busy.world;
        const Vec3 far(0.3, -0.2, 5);
        world.measure_forces(true, far);
        const std::vector<std::pair<BodyHandle, const Mesh*>> bodies{
            {busy.low, &busy.block}, {busy.high, &busy.block}, {busy.bar, &busy.beam}};
        for (int call = 0; call < 12; ++call) {
            std::vector<Momenta> before;
            for (const auto& [body, mesh] : bodies) before.emplace_back(world, body, *mesh, density);
            REQUIRE(world.advance(1.0 / 60).ok());
            const Forces forces = world.forces();
            for (std::size_t b = 0; b < bodies.size(); ++b) {
                const auto [body, mesh] = bodies[b];
                const Momenta after(world, body, *mesh, density);
                Vec3 moment = forces.on(body).moment_about(Vec3::Zero());
                if (body == busy.bar)
                    moment += forces.by(busy.held).moment_about(Vec3::Zero()) +
                              forces.by(busy.led).moment_about(Vec3::Zero());
                const Real seconds = forces.on(body).seconds;
                const Real scale = after.angular.norm() + 5 * (after.linear.norm() + before[b].linear.norm() + 1e-3 +
                                                               forces.on(body).pressing_impulse);
                INFO("body " << b << ", call " << call);
                CHECK((after.angular - before[b].angular - seconds * moment).norm() < 1e-11 * scale);
            }
        }
        CHECK(world.report().mean_contacts > 1);
    }
}

TEST_CASE("partners of a contact get opposite impulses to the last bit, and sums are those of the pairs", "[scene]") {
    BusyWorld busy(with(Integrator::leapfrog));
    World& world = busy.world;
    world.measure_forces(true);
    REQUIRE(world.advance(0.3).ok());
    const Forces forces = world.forces();
    CHECK(forces.on(busy.low, busy.high).impulse == -forces.on(busy.high, busy.low).impulse);
    CHECK(forces.on(busy.low, busy.slab).impulse == -forces.on(busy.slab, busy.low).impulse);
    CHECK(forces.on(busy.low, busy.high).contacts == forces.on(busy.high, busy.low).contacts);
    Vec3 all = Vec3::Zero(), on_slab = Vec3::Zero();
    for (const PairForces& pair : forces.pairs()) {
        CHECK(pair.on_first.pressing_impulse > 0);
        CHECK(pair.on_first.largest_force >= pair.on_first.force().norm());
        CHECK(pair.on_first.most_contacts >= pair.on_first.contacts);
        if (pair.first == busy.low || pair.second == busy.low)
            all += pair.first == busy.low ? pair.on_first.impulse : Vec3(-pair.on_first.impulse);
        if (pair.collider == busy.slab) on_slab -= pair.on_first.impulse;
    }
    CHECK(all == forces.on(busy.low).impulse);
    CHECK(on_slab == forces.on(busy.slab).impulse);
    // The moments differ by friction times the contact distance.
    const ForceReport one = forces.on(busy.low, busy.high), other = forces.on(busy.high, busy.low);
    CHECK((one.moment_impulse + other.moment_impulse).norm() <= 0.01 * one.pressing_impulse);
    CHECK(forces.on(busy.bar).impulse == Vec3::Zero());
}

TEST_CASE("forces have the same bits on any number of threads", "[scene]") {
    std::vector<Vec3> first;
    for (const int threads : {1, 2, 3}) {
        Settings settings = with(Integrator::symplectic_euler);
        settings.threads = threads;
        BusyWorld busy(settings);
        busy.world.measure_forces(true);
        REQUIRE(busy.world.advance(0.3).ok());
        std::vector<Vec3> found{busy.world.forces().by(busy.led).impulse, busy.world.forces().by(busy.led).moment()};
        for (const PairForces& pair : busy.world.forces().pairs()) {
            found.push_back(pair.on_first.impulse);
            found.push_back(pair.on_first.moment_impulse);
            found.push_back(pair.on_first.largest_force * Vec3::UnitX());
        }
        REQUIRE(found.size() > 8);
        if (first.empty()) first = found;
        CHECK(found == first);
    }
}

TEST_CASE("a block on a slope presses by its weight's normal part and holds by the rest", "[scene]") {
    for (const Real degrees : {0.0, 15.0}) {
        Settings settings = accurate(tilted_gravity(degrees));
        BlockOnPlane slope(settings, {.young_modulus = 1e6, .friction = 0.6, .damping = 60});
        slope.settle(0.3);
        slope.world.measure_forces(true);
        REQUIRE(slope.world.advance(0.2).ok());
        const ForceReport on = slope.world.forces().on(slope.block);
        const Real weight = slope.world.mass(slope.block) * standard_gravity;
        CHECK((on.force() + slope.world.mass(slope.block) * settings.gravity).norm() < 1e-4 * weight);
        CHECK(on.friction_impulse.x() / on.seconds ==
              Approx(settings.gravity.x() / standard_gravity * -weight).margin(1e-4 * weight));
        CHECK(on.pressing_impulse / on.seconds == Approx(-settings.gravity.z() / standard_gravity * weight));
        CHECK(on.contacts > 3);
        CHECK(on.largest_force < 1.02 * weight);
        // Nothing turns the block about its centre of mass.
        const Vec3 centre = slope.world.center_of_mass(slope.block);
        CHECK(on.moment_about(centre).norm() < 1e-4 * weight * 0.1);
    }
}

TEST_CASE("a step that was tried again counts once", "[scene]") {
    Settings settings = with(Integrator::symplectic_euler);
    World world(settings);
    const auto soft = world.add_material({.young_modulus = 2e4});
    const Mesh ball = mesh::ball(0.05, 4);
    const auto plane = world.add_collider(Plane{});
    const auto body = world.add_body(ball, {.material = soft, .position = {0, 0, 0.2}, .velocity = {3, 0, -40}});
    world.measure_forces(true);
    const Momenta before(world, body, ball, density);
    Real first = 0;
    world.watch_steps([&first](const StepReport& step) { first = first > 0 ? first : step.step_size; });
    const StepReport step = world.advance(0.02);
    REQUIRE(step.ok());
    REQUIRE(step.shortened + step.retried > 3);
    const Momenta after(world, body, ball, density);
    const ForceReport on = world.forces().on(body);
    CHECK(on.seconds == Approx(0.02 + (first - step.step_size) / 2).epsilon(1e-12));
    CHECK((after.linear - before.linear - on.impulse - on.seconds * world.mass(body) * settings.gravity).norm() <
          1e-12 * on.pressing_impulse);
    CHECK(on.impulse == world.forces().on(body, plane).impulse);
}

TEST_CASE("a hanging body pulls at its support by its weight, also with clusters, damping and losses",
          "[scene][long]") {
    for (const bool slivers : {false, true})
        for (const Real damping : {0.0, 30.0}) {
            INFO((slivers ? "slivers, damping " : "damping ") << damping);
            Settings settings;
            settings.sleep = false;  // sleep would freeze the rest of the vibration
            World world(settings);
            const auto rubber =
                world.add_material({.young_modulus = 1e5, .damping = damping, .loss_factor = damping > 0 ? 0.05 : 0.3});
            const Mesh mesh = slivers ? sliver_box(0.2, 6, 0.02, 0.002) : mesh::box({0.2, 0.1, 0.1}, {4, 2, 2});
            const auto body = world.add_body(mesh, {.material = rubber, .name = "bar"});
            const auto nodes = world.positions(body);
            const Real left = std::ranges::min(nodes, {}, [](const Vec3& x) { return x.x(); }).x();
            std::vector<Index> held = nodes_where(world, body, [&](const Vec3& x) { return x.x() < left + 1e-9; });
            // Slivers: corners of flat tetrahedra are held, too, so that implicit elements hang from held nodes.
            for (const auto& t : slivers ? mesh.tetrahedra : std::vector<std::array<Index, 4>>{}) {
                const auto from = [&](std::size_t k) -> Vec3 { return nodes[t[k]] - nodes[t[0]]; };
                const bool flat = from(1).cross(from(2)).dot(from(3)) < 0.05 * std::pow(0.2 / 6, 3);
                if (flat && std::ranges::find(held, t[0]) == held.end() && nodes[t[0]].x() < 0) held.push_back(t[0]);
            }
            const auto hold = world.attach(body, held);
            world.measure_forces(true);
            REQUIRE(world.advance(3).ok());
            if (slivers) REQUIRE(world.report().clusters > 0);
            Real worst = 0;
            const Real weight = world.mass(body) * standard_gravity;
            for (int call = 0; call < 5; ++call) {
                const Momenta before(world, body, mesh, density);
                REQUIRE(world.advance(0.1).ok());
                const ForceReport by = world.forces().by(hold);
                const Momenta after(world, body, mesh, density);
                const Vec3 change = after.linear - before.linear;
                if (damping == 0)
                    CHECK((change - by.impulse - by.seconds * world.mass(body) * settings.gravity).norm() <
                          1e-12 * 0.1 * weight);
                worst = std::max(worst, (by.force() + world.mass(body) * settings.gravity).norm());
                // The body hangs beside the attachment, which also carries the moment of its weight.
                const Vec3 lever = world.center_of_mass(body);
                if (damping > 0)
                    CHECK((by.moment() + lever.cross(world.mass(body) * settings.gravity)).norm() <
                          1e-3 * weight * 0.2);
            }
            CHECK(worst < (damping > 0 ? 1e-5 : 0.2) * weight);
            // Forces of implicit elements on held nodes are in the reaction, but not in the run's momentum balance.
            if (damping == 0 && !slivers) CHECK(world.report().momentum_error_share < 1e-12);
            if (slivers) CHECK(std::isnan(world.report().momentum_error_share));
        }
}

TEST_CASE("an attachment that turns a bar gives the force that keeps it on its circle", "[scene][long]") {
    Settings settings;
    settings.gravity.setZero();
    World world(settings);
    const auto stiff = world.add_material({.young_modulus = 2e7, .loss_factor = 0.2});
    const Mesh mesh = mesh::box({0.4, 0.05, 0.05}, {8, 1, 1});
    const Real rate = 3;  // rad/s
    const auto bar =
        world.add_body(mesh, {.material = stiff, .velocity = {0, 0.2 * rate, 0}, .angular_velocity = {0, 0, rate}});
    const auto hold = world.attach(bar, nodes_where(world, bar, [](const Vec3& x) { return x.x() < -0.19; }),
                                   {.angular_velocity = {0, 0, rate}}, {-0.2, 0, 0});
    world.measure_forces(true, {-0.2, 0, 0});
    REQUIRE(world.advance(2).ok());
    Real worst = 0;
    for (int call = 0; call < 10; ++call) {
        REQUIRE(world.advance(0.01).ok());
        const ForceReport by = world.forces().by(hold);
        const Vec3 inward = (Vec3(-0.2, 0, 0) - world.center_of_mass(bar)).normalized();
        worst = std::max(worst, std::abs(by.force().dot(inward) / (world.mass(bar) * rate * rate * 0.2) - 1));
        CHECK(by.moment().head<2>().norm() < 1e-2);
    }
    CHECK(worst < 0.03);
}

TEST_CASE("the reaction of a sleeping held body contains its loads, also in a world from a file", "[scene]") {
    World world = tuned_world({}, {.sleep_speed = 1e-3});
    const auto rubber = world.add_material({.young_modulus = 1e5, .damping = 20});
    const Mesh block = mesh::box({0.2, 0.2, 0.1}, {3, 3, 2});
    const auto body = world.add_body(block, {.material = rubber});
    const auto hold = world.attach(body, nodes_where(world, body, [](const Vec3& x) { return x.z() < -0.049; }));
    world.set_loads(body, std::vector<Vec3>(block.nodes.size(), Vec3(0.05, 0, 0)));
    while (!world.asleep(body) && world.time() < 10) REQUIRE(world.advance(0.1).ok());
    REQUIRE(world.asleep(body));
    const TemporaryFolder folder;
    world.save(folder.path() / "world");
    World from_file = World::load(folder.path() / "world");
    const Vec3 expected{-0.05 * static_cast<Real>(block.nodes.size()), 0, world.mass(body) * standard_gravity};
    for (World* each : {&world, &from_file}) {
        each->measure_forces(true);
        REQUIRE(each->advance(0.1).ok());
        CHECK((each->forces().by(hold).force() - expected).norm() < 1e-2 * expected.norm());
    }
    CHECK(world.forces().by(hold).impulse == from_file.forces().by(hold).impulse);
}

TEST_CASE("support forces of a body at rest are those of its last step", "[scene]") {
    constexpr Real sleep_speed = 1e-3;  // [m/s]
    World world = tuned_world({}, {.sleep_speed = sleep_speed});
    const auto rubber = world.add_material({.young_modulus = 1e5, .damping = 20});
    const auto floor = world.add_collider(Plane{});
    const Mesh block = mesh::box({0.2, 0.2, 0.1}, {3, 3, 2});
    const auto low = world.add_body(block, {.material = rubber, .position = {0, 0, 0.051}});
    const auto high = world.add_body(block, {.material = rubber, .position = {0, 0, 0.155}});
    world.measure_forces(true);
    while (!world.asleep(low) && world.time() < 10) REQUIRE(world.advance(0.1).ok());
    REQUIRE(world.asleep(high));
    const Real weight = world.mass(low) * standard_gravity;
    const Real tolerance = world.mass(low) * sleep_speed / world.settings().sleep_time;
    for (int call = 0; call < 3; ++call) {
        REQUIRE(world.advance(0.1).ok());
        REQUIRE(world.asleep(low));
        const Forces forces = world.forces();
        CHECK(forces.on(low, floor).force().z() == Approx(2 * weight).margin(2 * tolerance));
        CHECK(forces.on(high, low).force().z() == Approx(weight).margin(tolerance));
        CHECK(forces.on(high).moment_about(world.center_of_mass(high)).norm() < 0.01 * weight * 0.1);
        CHECK(forces.on(floor).impulse == forces.on(floor, low).impulse);
        CHECK(forces.on(low).contacts > 3);
        CHECK(forces.on(low).seconds == Approx(0.1));
        CHECK(world.clone().forces().on(low).impulse == forces.on(low).impulse);
    }
    // Measuring that starts during sleep reports the forces of the last step before sleep.
    const Vec3 mean = world.forces().on(low, floor).force();
    world.measure_forces(true);
    REQUIRE(world.advance(0.1).ok());
    CHECK((world.forces().on(low, floor).force() - mean).norm() < 0.02 * 2 * weight);
    CHECK(world.forces().on(low).contacts > 3);
    world.wake(low);
    world.wake(high);
    REQUIRE(world.advance(0.1).ok());
    CHECK(world.forces().on(low, floor).force().z() == Approx(2 * weight).epsilon(0.01));
}

TEST_CASE("a mat carries the same weight before and after it falls asleep", "[scene]") {
    // The mat creeps to rest, so that its time of stillness is set back before it falls asleep.
    World world{Settings{}};
    const auto rubber = world.add_material({.young_modulus = 1e5, .poisson_ratio = 0, .loss_factor = 0.2});
    const auto steel = world.add_material({.young_modulus = 2e11, .density = 7800});
    const auto floor = world.add_collider(Plane{});
    const auto mat =
        world.add_body(mesh::box({0.1, 0.1, 0.05}, {4, 4, 2}), {.material = rubber, .position = {0, 0, 0.0255}});
    const auto block =
        world.add_body(mesh::box({0.1, 0.1, 0.1}, {2, 2, 2}), {.material = steel, .position = {0, 0, 0.102}});
    world.measure_forces(true);
    while (!world.asleep(mat) && world.time() < 10) REQUIRE(world.advance(1.0 / 60).ok());
    REQUIRE(world.asleep(block));
    REQUIRE(world.advance(0.1).ok());
    const Real weight = world.mass(block) * standard_gravity;
    CHECK(world.forces().on(block, mat).force().z() == Approx(weight).epsilon(0.01));
    CHECK(world.forces().on(mat, floor).force().z() ==
          Approx(weight + world.mass(mat) * standard_gravity).epsilon(0.01));
}

TEST_CASE("a ball that fell presses by its weight alone while it sleeps", "[scene]") {
    // The impact leaves a part of its momentum to the step after it, which brings the ball to rest.
    World world{Settings{}};
    const auto wood = world.add_material({.young_modulus = 1e9});
    const auto floor = world.add_collider(Plane{});
    const auto ball = world.add_body(Sphere{0.02}, {.material = wood, .position = {0, 0, 0.3}});
    world.measure_forces(true);
    while (!world.asleep(ball) && world.time() < 3) REQUIRE(world.advance(1.0 / 60).ok());
    REQUIRE(world.asleep(ball));
    REQUIRE(world.advance(0.1).ok());
    CHECK(world.forces().on(ball, floor).force().z() == Approx(world.mass(ball) * standard_gravity).epsilon(1e-6));
}

TEST_CASE("an attachment that has stopped carries the weight alone while its body sleeps", "[scene]") {
    // In its first step at rest the attachment takes the momentum of the body.
    for (const BodyDynamics dynamics :
         {BodyDynamics::explicit_elastic, BodyDynamics::implicit_elastic, BodyDynamics::rigid}) {
        CAPTURE(name_of(dynamics));
        World world{Settings{}};
        const auto wood = world.add_material({.young_modulus = 1e9});
        const Mesh cube = mesh::box({0.1, 0.1, 0.1}, {1, 1, 1});
        const auto body = world.add_body(cube, {.material = wood, .dynamics = dynamics});
        std::vector<Index> all(cube.nodes.size());
        std::iota(all.begin(), all.end(), 0);
        const auto hold = world.attach(body, all, {.velocity = {0, 0, 1}});
        world.measure_forces(true);
        REQUIRE(world.advance(0.1).ok());
        world.set_velocity(hold, Vec3::Zero());
        while (!world.asleep(body) && world.time() < 3) REQUIRE(world.advance(1.0 / 60).ok());
        REQUIRE(world.asleep(body));
        REQUIRE(world.advance(0.1).ok());
        const Vec3 force = world.forces().by(hold).force();
        CHECK(force.z() == Approx(world.mass(body) * standard_gravity).epsilon(1e-6));
        CHECK(force.head<2>().norm() < 1e-6 * force.z());
    }
}

TEST_CASE("measuring changes no step, costs nothing if it is off, and reading then fails with a message", "[scene]") {
    BusyWorld one(with(Integrator::leapfrog)), other(with(Integrator::leapfrog));
    one.world.measure_forces(true);
    REQUIRE(one.world.advance(0.1).ok());
    REQUIRE(other.world.advance(0.1).ok());
    CHECK(one.world.state_hash() == other.world.state_hash());
    CHECK_THROWS_WITH(other.world.forces(), Catch::Contains("a call of measure_forces"));
    CHECK_THROWS_WITH(one.world.measure_forces(true, {0, 0, std::nan("")}), Catch::Contains("moment_point"));
    const ForceReport on = one.world.forces().on(one.low);
    CHECK_THROWS_AS(one.world.forces().on(BodyHandle{}), SceneError);
    CHECK_THROWS_AS(one.world.forces().on(other.low), SceneError);
    one.world.remove(one.high);
    CHECK(one.world.forces().on(one.low).seconds == on.seconds);
    CHECK_THROWS_AS(one.world.forces().on(one.high), SceneError);
    // A slot that is used again starts with zero forces.
    one.world.remove(one.bar);
    const auto again = one.world.add_body(one.block, {.material = one.world.add_material({}), .position = {0, 0, 3}});
    CHECK(one.world.forces().on(again).impulse == Vec3::Zero());
    REQUIRE(one.world.advance(0.01).ok());
    CHECK(one.world.forces().on(again).contacts == 0);
    one.world.measure_forces(false);
    CHECK_FALSE(one.world.measures_forces());
}

TEST_CASE("self-contact adds nothing to the force on a body, but its amount is reported", "[scene]") {
    Settings settings;
    settings.gravity.setZero();
    World world(settings);
    const auto rubber = world.add_material({.young_modulus = 1e5});
    // Two separate blocks of one body fly at each other.
    Mesh two = mesh::box({0.1, 0.1, 0.1}, {2, 2, 2});
    const Mesh one = two;
    for (const Vec3& x : one.nodes) two.nodes.push_back(x + Vec3(0.11, 0, 0));
    for (const auto& t : one.tetrahedra) {
        auto moved = t;
        for (Index& n : moved) n += static_cast<Index>(one.nodes.size());
        two.tetrahedra.push_back(moved);
    }
    const auto body = world.add_body(two, {.material = rubber, .self_contact = true});
    std::vector<Vec3> velocity(two.nodes.size(), Vec3(0.5, 0, 0));
    for (std::size_t n = one.nodes.size(); n < velocity.size(); ++n) velocity[n] = {-0.5, 0, 0};
    world.set_velocities(body, velocity);
    world.measure_forces(true);
    REQUIRE(world.advance(0.1).ok());
    const Forces forces = world.forces();
    CHECK(forces.on(body).impulse.norm() < 1e-14);
    // Each half changes its momentum of 0.5 kg m/s to about the opposite.
    CHECK(forces.on(body).pressing_impulse > 0.5);
    CHECK(forces.on(body, body).pressing_impulse == forces.on(body).pressing_impulse);
    CHECK(forces.on(body, body).most_contacts > 0);
}

}  // namespace skerry::test::forces_test
