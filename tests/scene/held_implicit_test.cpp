// Implicit bodies that attachments hold and move (docs/methods/implicit_bodies.md 7).
#include <Eigen/Geometry>
#include <catch2/catch.hpp>
#include <cmath>
#include <numbers>

#include "tests/support/temporary_folder.h"
#include "tests/support/worlds.h"

namespace skerry::test::held_implicit_test {

namespace {

/// Nodes with the smallest x, or with the largest.
std::vector<Index> end_of(const Mesh& mesh, bool far = false) {
    Real end = 0;
    for (const Vec3& x : mesh.nodes) end = far ? std::max(end, x.x()) : std::min(end, x.x());
    std::vector<Index> nodes;
    for (std::size_t n = 0; n < mesh.nodes.size(); ++n)
        if (std::abs(mesh.nodes[n].x() - end) < 1e-9) nodes.push_back(static_cast<Index>(n));
    return nodes;
}

Settings settings_of(Real h, Real theta, const Vec3& gravity) {
    Settings settings;
    settings.gravity = gravity;
    settings.step_size = h;
    settings.theta = theta;
    return settings;
}

const Mesh bar = mesh::box({0.4, 0.1, 0.1}, {4, 1, 1});

/// A bar along x that is held at one end.
struct Cantilever {
    World world;
    MaterialHandle material;
    BodyHandle body;
    AttachmentHandle hold;

    explicit Cantilever(const Settings& settings, const MaterialSettings& material_settings, const Motion& motion = {},
                        BodyDynamics dynamics = BodyDynamics::implicit_elastic, const Mesh& mesh = bar)
        : world(settings), material(world.add_material(material_settings)) {
        body = world.add_body(mesh, {.material = material, .dynamics = dynamics});
        hold = world.attach(body, end_of(mesh), motion);
    }
    Vec3 tip(const Mesh& mesh = bar) const {
        return world.positions(body)[static_cast<std::size_t>(end_of(mesh, true).front())];
    }
};

Mat3 turn_by(const Vec3& rotation) {
    const Real angle = rotation.norm();
    return angle == 0 ? Mat3(Mat3::Identity()) : Eigen::AngleAxis<Real>(angle, rotation / angle).toRotationMatrix();
}

}  // namespace

TEST_CASE("a held implicit body hangs as far down as an explicit one", "[scene][implicit]") {
    const auto sag = [](BodyDynamics dynamics) {
        // The load is so light that the response is linear.
        Settings settings = settings_of(0.02, 1, {0, 0.5e-3, -1e-3});
        if (dynamics == BodyDynamics::explicit_elastic) settings.step_size.reset();
        settings.sleep = false;  // sleep would stop the last part of the sinking
        Cantilever scene(settings, {.young_modulus = 1e5, .poisson_ratio = 0.3, .damping = 15}, {}, dynamics);
        const Vec3 start = scene.tip();
        REQUIRE(scene.world.advance(6).ok());
        return Vec3(scene.tip() - start);
    };
    const Vec3 implicit = sag(BodyDynamics::implicit_elastic), by_explicit = sag(BodyDynamics::explicit_elastic);
    CHECK(implicit.z() < -1e-6);
    CHECK((implicit - by_explicit).norm() < 1e-4 * implicit.norm());
}

TEST_CASE("a cantilever keeps its amplitude over five periods of fifty steps", "[scene][implicit]") {
    const Mesh mesh = mesh::box({1, 0.1, 0.1}, {10, 1, 1});
    const auto remaining_amplitude = [&](Real theta, Real& period) {
        const Real h = period / 50;
        Cantilever scene(settings_of(h, theta, {0, 0, -standard_gravity}), {.young_modulus = 1e9, .poisson_ratio = 0.3},
                         {}, BodyDynamics::implicit_elastic, mesh);
        const Real start = scene.tip(mesh).z();
        std::vector<Real> sag{0};
        for (int k = 0; k < 320; ++k) {
            REQUIRE(scene.world.advance(h).ok());
            sag.push_back(start - scene.tip(mesh).z());
        }
        // The first peak of the sag is half a period after the start.
        const auto peak = std::max_element(sag.begin(), sag.begin() + 60);
        period = 2 * h * static_cast<Real>(peak - sag.begin());
        const auto fifth = sag.begin() + static_cast<std::ptrdiff_t>(4 * period / h);
        const auto end = std::min(fifth + static_cast<std::ptrdiff_t>(period / h) + 1, sag.end());
        const auto [low, high] = std::minmax_element(fifth, end);
        return (*high - *low) / *peak;
    };
    Real period = 0.05;
    (void)remaining_amplitude(0.5, period);
    CHECK(period == Approx(0.05).epsilon(0.3));
    CHECK(remaining_amplitude(0.5, period) > 0.95);
    CHECK(remaining_amplitude(0.51, period) > 0.9);
    CHECK(remaining_amplitude(1, period) < 0.2);
}

TEST_CASE("energy and momentum of a held implicit body add up to rounding", "[scene][implicit]") {
    const auto model = GENERATE(MaterialModel::linear, MaterialModel::stable_neo_hookean);
    const bool linear = model == MaterialModel::linear;
    for (const Real theta : {0.5, 0.55, 1.0})
        for (const Vec3& velocity : {Vec3(0, 0, 0), Vec3(0.2, 0, 0.1)}) {
            CAPTURE(linear, theta, velocity.transpose());
            Cantilever scene(settings_of(1.0 / 200, theta, {0, 0, -standard_gravity}),
                             {.young_modulus = 1e6, .poisson_ratio = 0.3, .model = model}, {.velocity = velocity});
            std::vector<Vec3> load(scene.world.positions(scene.body).size(), Vec3::Zero());
            load.back() = {0.5, 1, 0};
            scene.world.set_loads(scene.body, load);
            REQUIRE(scene.world.advance(0.5).ok());
            const WorldReport report = scene.world.report();
            CHECK(report.balanced_steps == report.steps);
            CHECK(report.energy_error_share < 1e-11);
            CHECK(report.momentum_error_share < 1e-11);
            CHECK(report.energy.elastic > 1e-3);
            CHECK((report.large_strain_steps == 0) == linear);
            if (theta > 0.5)
                CHECK(report.energy.dissipated > (linear || theta == 1 ? 1e-3 : 0));
            else if (linear)
                CHECK(report.energy.dissipated == 0);
        }
}

TEST_CASE("damping of a held implicit body adds up, too", "[scene][implicit]") {
    Cantilever scene(settings_of(1.0 / 200, 0.5, {0, 0, -standard_gravity}),
                     {.young_modulus = 1e6, .poisson_ratio = 0.3, .damping = 3});
    REQUIRE(scene.world.advance(0.5).ok());
    const WorldReport report = scene.world.report();
    CHECK(report.energy_error_share < 1e-11);
    CHECK(report.energy.dissipated > 1e-3);
}

TEST_CASE("an implicit body goes where its attachment goes, and rests there as it was", "[scene][implicit]") {
    const Vec3 shift(0.3, -0.2, 0.5), rotation(0.6, -1.2, 0.9);
    for (const Integrator integrator : {Integrator::symplectic_euler, Integrator::leapfrog}) {
        Settings settings = settings_of(1.0 / 128, 1, Vec3::Zero());
        settings.integrator = integrator;
        Cantilever scene(settings, {.young_modulus = 1e6, .poisson_ratio = 0.3, .damping = 5},
                         {.keys = {{0, {0, 0, 0}, {0, 0, 0}}, {0.5, shift, rotation}}});
        REQUIRE(scene.world.advance(0.25).ok());
        const auto led = [&](Real part) {
            Real worst = 0;
            const auto now = scene.world.positions(scene.body);
            for (const Index n : end_of(bar)) {
                const auto at = static_cast<std::size_t>(n);
                worst = std::max(worst, (now[at] - (part * shift + turn_by(part * rotation) * bar.nodes[at])).norm());
            }
            return worst;
        };
        CHECK(led(0.5) < 1e-13);
        CHECK((scene.tip() - (0.5 * shift + turn_by(0.5 * rotation) * bar.nodes[end_of(bar, true).front()])).norm() <
              0.02);
        REQUIRE(scene.world.advance(8).ok());
        CHECK(led(1) < 1e-13);
        const auto now = scene.world.positions(scene.body);
        for (std::size_t n = 0; n < now.size(); ++n)
            CHECK((now[n] - (shift + turn_by(rotation) * bar.nodes[n])).norm() < 1e-8);
    }
}

TEST_CASE("a spinning attachment stretches the held implicit body", "[scene][implicit]") {
    // u' = rho w^2 (L^2 - x^2)/(2 E) from the axis: u(L) = rho w^2 L^3/(3 E)
    const Mesh rod = mesh::box({0.4, 0.1, 0.1}, {8, 2, 2});
    const Real omega = 10, E = 1e8;
    Settings settings = settings_of(1e-3, 1, Vec3::Zero());
    World world(settings);
    const auto material = world.add_material({.young_modulus = E, .poisson_ratio = 0, .damping = 0});
    // The rod spins about its end.
    const auto body = world.add_body(rod, {.material = material,
                                           .position = {0.2, 0, 0},
                                           .velocity = {0, 0.2 * omega, 0},
                                           .angular_velocity = {0, 0, omega},
                                           .dynamics = BodyDynamics::implicit_elastic});
    const auto hold = world.attach(body, end_of(rod), {.angular_velocity = {0, 0, omega}});
    REQUIRE(world.advance(1).ok());
    std::size_t tip = 0;
    for (std::size_t n = 0; n < rod.nodes.size(); ++n)
        if ((rod.nodes[n] - Vec3(0.2, 0, 0)).norm() < 1e-9) tip = n;
    const Real radius = world.positions(body)[tip].norm();
    const Real stretch = 1000 * omega * omega * 0.4 * 0.4 * 0.4 / (3 * E);
    CHECK(radius - 0.4 == Approx(stretch).epsilon(0.03));
    world.measure_forces(true);
    REQUIRE(world.advance(0.02).ok());
    const Vec3 force = world.forces().by(hold).force();
    CHECK(force.norm() == Approx(world.mass(body) * omega * omega * 0.2).epsilon(0.02));
    // The attachment supplies the energy that backward Euler takes from a rotation. The error is rounding of forces
    // at 1e8 Pa over 1,000 steps.
    CHECK(world.report().energy_error_share < 1e-8);
}

TEST_CASE("the reaction of an attachment is the impulse on its implicit body, less all other impulses",
          "[scene][implicit]") {
    const Real h = 1.0 / 250;
    for (const Real theta : {0.5, 1.0}) {
        Cantilever scene(
            settings_of(h, theta, {0, 0, -standard_gravity}), {.young_modulus = 1e6},
            {.keys = {{0, {0, 0, 0}, {0, 0, 0}}, {0.5, {0.1, 0, 0}, {0.5, 1, 0}}, {1, {0.1, 0.2, 0}, {0.5, 1, 2}}}});
        World& world = scene.world;
        std::vector<Vec3> load(world.positions(scene.body).size(), Vec3::Zero());
        load[3] = {0, 4, 1};
        world.set_loads(scene.body, load);
        const Vec3 about(0.1, -0.2, 0.3);
        world.measure_forces(true, about);
        REQUIRE(world.advance(0.1).ok());
        const WorldReport before = world.report();
        Vec3 loads = Vec3::Zero(), moments = Vec3::Zero();
        const Vec3 weight(0, 0, -world.mass(scene.body) * standard_gravity);
        world.watch_steps([&, seen = std::pair(world.center_of_mass(scene.body), Vec3(world.positions(scene.body)[3]))](
                              const StepReport&) mutable {
            loads += h * (weight + load[3]);
            moments += h * ((seen.first - about).cross(weight) + (seen.second - about).cross(load[3]));
            seen = {world.center_of_mass(scene.body), world.positions(scene.body)[3]};
        });
        REQUIRE(world.advance(0.3).ok());
        world.watch_steps({});
        const WorldReport after = world.report();
        const ForceReport reaction = world.forces().by(scene.hold);
        // Rounding of internal forces at 1e6 Pa, over 75 steps.
        CHECK((reaction.impulse - (after.momentum - before.momentum - loads)).norm() < 1e-10);
        CHECK(reaction.impulse.norm() > 1);
        const auto about_point = [&](const WorldReport& report) {
            return Vec3(report.angular_momentum - about.cross(report.momentum));
        };
        const Real off = (reaction.moment_impulse - (about_point(after) - about_point(before) - moments)).norm();
        // If theta is 1, the velocities of a step are those at its end, and the lever arms are exact.
        CHECK(off < (theta == 1 ? 1e-10 : 0.01 * reaction.moment_impulse.norm()));
    }
}

TEST_CASE("an implicit body that is attached and let go keeps its places, velocities and momentum",
          "[scene][implicit]") {
    World world(settings_of(1.0 / 200, 0.5, Vec3::Zero()));
    const auto material = world.add_material({.young_modulus = 1e7, .poisson_ratio = 0.3});
    const auto body = world.add_body(bar, {.material = material,
                                           .position = {0.1, 0.2, 0.3},
                                           .rotation = {0.3, 0.5, -0.2},
                                           .velocity = {0, 0, 0.2},
                                           .angular_velocity = {0, 1, 0},
                                           .dynamics = BodyDynamics::implicit_elastic});
    REQUIRE(world.advance(0.1).ok());
    const auto copy = [&](auto span) { return std::vector<Vec3>(span.begin(), span.end()); };
    std::vector<Vec3> place = copy(world.positions(body)), velocity = copy(world.velocities(body));
    const auto hold = world.attach(body, end_of(bar), {.velocity = {0.1, 0, 0}});
    const auto differ = [&](Real of_place, Real of_velocity) {
        for (std::size_t n = 0; n < place.size(); ++n) {
            CHECK((world.positions(body)[n] - place[n]).norm() <= of_place);
            const bool held = std::abs(bar.nodes[n].x() + 0.2) < 1e-9;
            if (!held) CHECK((world.velocities(body)[n] - velocity[n]).norm() <= of_velocity);
        }
    };
    differ(0, 0);
    REQUIRE(world.advance(1.0 / 200).ok());
    for (const Index n : end_of(bar))
        CHECK((world.positions(body)[static_cast<std::size_t>(n)] - place[static_cast<std::size_t>(n)] -
               Vec3(0.0005, 0, 0))
                  .norm() < 1e-14);
    REQUIRE(world.advance(0.3).ok());
    place = copy(world.positions(body));
    velocity = copy(world.velocities(body));
    const std::vector<Real> mass = node_masses(world, body, bar, 1000);
    Vec3 momentum = Vec3::Zero();
    for (std::size_t n = 0; n < mass.size(); ++n) momentum += mass[n] * velocity[n];
    world.remove(hold);
    differ(0, 2e-2 * momentum.norm());  // the split omits terms of the order of the strain
    CHECK((world.report().momentum - momentum).norm() < 1e-13);
    REQUIRE(world.advance(0.2).ok());
    CHECK((world.report().momentum - momentum).norm() < 1e-13);
    CHECK(world.report().energy_error_share < 1e-9);
}

TEST_CASE("a body that lies on a held implicit body rests and bends it", "[scene][implicit][long]") {
    const Mesh cube = mesh::box({0.1, 0.1, 0.1}, {2, 2, 2});
    for (const BodyDynamics falling :
         {BodyDynamics::rigid, BodyDynamics::implicit_elastic, BodyDynamics::explicit_elastic}) {
        Cantilever scene(accurate(), {.young_modulus = 1e7, .poisson_ratio = 0.3, .friction = 0.6, .damping = 5});
        World& world = scene.world;
        const auto on =
            world.add_body(cube, {.material = scene.material, .position = {0.12, 0.01, 0.108}, .dynamics = falling});
        REQUIRE(world.advance(2).ok());
        CHECK(world.center_of_mass(on).z() > 0.09);
        CHECK(world.center_of_mass(on).z() < 0.102);
        CHECK(scene.tip().z() < bar.nodes[static_cast<std::size_t>(end_of(bar, true).front())].z() - 1e-4);
        world.measure_forces(true);
        REQUIRE(world.advance(0.5).ok());
        const Real weight = standard_gravity * (world.mass(on) + world.mass(scene.body));
        const ForceReport reaction = world.forces().by(scene.hold);
        CHECK(reaction.force().z() == Approx(weight).epsilon(1e-3));
        CHECK(reaction.moment().y() ==
              Approx(-standard_gravity * (world.mass(on) * world.center_of_mass(on).x() +
                                          world.mass(scene.body) * world.center_of_mass(scene.body).x()))
                  .epsilon(5e-3));
        CHECK(world.report().energy_error_share < 1e-2);
    }
}

TEST_CASE("a bar between two attachments is stretched as they part", "[scene][implicit]") {
    World world(settings_of(0.01, 1, Vec3::Zero()));
    const Real E = 1e7;
    const auto material = world.add_material({.young_modulus = E, .poisson_ratio = 0, .damping = 20});
    const auto body = world.add_body(bar, {.material = material, .dynamics = BodyDynamics::implicit_elastic});
    const auto left = world.attach(body, end_of(bar));
    const auto right =
        world.attach(body, end_of(bar, true), {.keys = {{0, {0, 0, 0}, {0, 0, 0}}, {1, {4e-4, 0, 0}, {0, 0, 0}}}});
    world.measure_forces(true);
    REQUIRE(world.advance(4).ok());
    REQUIRE(world.advance(0.1).ok());
    const Real force = E * 0.01 * 1e-3;  // E times area times strain
    CHECK(world.forces().by(right).force().x() == Approx(force).epsilon(1e-3));
    CHECK(world.forces().by(left).force().x() == Approx(-force).epsilon(1e-3));
    // The remaining attachment takes over the frame, and the bar shrinks to its rest length.
    world.remove(right);
    REQUIRE(world.advance(4).ok());
    for (std::size_t n = 0; n < bar.nodes.size(); ++n) CHECK((world.positions(body)[n] - bar.nodes[n]).norm() < 1e-9);
}

TEST_CASE("held implicit bodies go on bit by bit when they are cloned or saved, on any number of workers",
          "[scene][implicit]") {
    const Mesh cube = mesh::box({0.1, 0.1, 0.1}, {2, 2, 2});
    struct Scene {
        World world;
        MaterialHandle material;
        AttachmentHandle hold;
    };
    const auto make = [&](int threads) {
        Settings settings = settings_of(1.0 / 240, 0.55, {0, 0, -standard_gravity});
        settings.threads = threads;
        Scene scene{World(settings), {}, {}};
        World& world = scene.world;
        scene.material = world.add_material({.young_modulus = 1e7});
        const auto gone = world.add_body(cube, {.material = scene.material, .position = {-3, 0, 0}});
        const auto body = world.add_body(bar, {.material = scene.material, .dynamics = BodyDynamics::implicit_elastic});
        scene.hold = world.attach(body, end_of(bar), {.velocity = {0, 0, 0.1}, .angular_velocity = {0, 0, 0.5}});
        world.add_body(
            cube, {.material = scene.material, .position = {0.1, 0, 0.12}, .dynamics = BodyDynamics::implicit_elastic});
        world.remove(gone);
        return scene;
    };
    Scene one = make(1), four = make(4);
    REQUIRE(one.world.advance(0.3).ok());
    REQUIRE(four.world.advance(0.3).ok());
    CHECK(one.world.state_hash() == four.world.state_hash());
    World copy = one.world.clone();
    const TemporaryFolder folder;
    one.world.save(folder.path() / "world");
    World loaded = World::load(folder.path() / "world");
    for (World* world : {&one.world, &copy, &loaded}) {
        world->set_material(one.material, {.young_modulus = 1e7, .density = 2000});
        REQUIRE(world->advance(0.1).ok());
        world->remove(one.hold);
        REQUIRE(world->advance(0.1).ok());
    }
    CHECK(copy.state_hash() == one.world.state_hash());
    CHECK(loaded.state_hash() == one.world.state_hash());
}

TEST_CASE("held implicit bodies rest, say what holds them then, and wake when they are led", "[scene][implicit]") {
    Settings settings = settings_of(1.0 / 240, 1, {0, 0, -standard_gravity});
    settings.sleep = true;
    Cantilever scene(settings, {.young_modulus = 1e7, .damping = 10});
    World& world = scene.world;
    REQUIRE(world.advance(5).ok());
    REQUIRE(world.asleep(scene.body));
    CHECK(world.report().energy_error_share < 1e-6);
    world.measure_forces(true);
    REQUIRE(world.advance(0.1).ok());
    const ForceReport reaction = world.forces().by(scene.hold);
    const Real weight = standard_gravity * world.mass(scene.body);
    CHECK(reaction.force().z() == Approx(weight).epsilon(1e-3));
    CHECK(reaction.moment().y() == Approx(-weight * world.center_of_mass(scene.body).x()).margin(1e-3 * weight));
    const Vec3 tip = scene.tip();
    world.set_velocity(scene.hold, {0, 0, 0.3});
    REQUIRE(world.advance(0.2).ok());
    CHECK(!world.asleep(scene.body));
    CHECK(scene.tip().z() == Approx(tip.z() + 0.06).margin(5e-3));
}

TEST_CASE("held implicit bodies move with their attachments when they are put elsewhere", "[scene][implicit]") {
    Cantilever scene(settings_of(0.01, 1, Vec3::Zero()), {.young_modulus = 1e7, .damping = 10});
    World& world = scene.world;
    const auto is_at = [&](const Vec3& place, const Vec3& rotation) {
        REQUIRE(world.advance(0.05).ok());
        for (std::size_t n = 0; n < bar.nodes.size(); ++n)
            CHECK((world.positions(scene.body)[n] - (place + turn_by(rotation) * bar.nodes[n])).norm() < 1e-12);
    };
    is_at({0, 0, 0}, {0, 0, 0});
    world.set_pose(scene.hold, {{1, 2, 3}, {0.4, 0, 0}});
    is_at({1, 2, 3}, {0.4, 0, 0});
    world.set_pose(scene.body, {{0, 0, 1}, {0, 0.3, 0}});
    is_at({0, 0, 1}, {0, 0.3, 0});
}

TEST_CASE("nodes that do not hold the frame of an implicit body are refused", "[scene][implicit]") {
    World world{Settings{}};
    const auto material = world.add_material({});
    const auto nut =
        world.add_body(bar, {.material = material, .dynamics = BodyDynamics::implicit_elastic, .name = "nut"});
    std::vector<Index> edge;
    for (std::size_t n = 0; n < bar.nodes.size(); ++n)
        if (bar.nodes[n].y() < 0 && bar.nodes[n].z() < 0) edge.push_back(static_cast<Index>(n));
    REQUIRE(edge.size() == 5);
    for (const std::vector<Index>& nodes : {std::vector<Index>{0}, {0, 1}, {0, 1, 0, 1}, edge})
        CHECK_THROWS_WITH(world.attach(nut, nodes), Catch::Matchers::Contains("the implicit body 'nut'") &&
                                                        Catch::Matchers::Contains("to hold the body's rotating frame"));
    CHECK_NOTHROW(world.attach(nut, end_of(bar)));
}

}  // namespace skerry::test::held_implicit_test
