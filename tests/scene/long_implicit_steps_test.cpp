// Implicit bodies with longer steps than the explicit bodies beside them (docs/methods/implicit_bodies.md 9).
#include <catch2/catch.hpp>
#include <cmath>

#include "engine/world/world_state.h"
#include "tests/support/temporary_folder.h"
#include "tests/support/worlds.h"

namespace skerry::test::long_implicit_steps_test {

namespace {

const Mesh cube = mesh::box({0.1, 0.1, 0.1}, {2, 2, 2});

Settings settings_of(Real h, Real implicit_step, const Vec3& gravity) {
    Settings settings = accurate(gravity, 1e-10);
    settings.step_size = h;
    settings.implicit_step = implicit_step;
    return settings;
}

/// A soft explicit cube that flies at a stiff, rotating implicit one, which may be light.
struct Hit {
    World world;
    BodyHandle stiff, soft;

    explicit Hit(const Settings& settings, Real density = 1000, const Vec3& spin = {1, 2, 3}, Real modulus = 1e8)
        : world(settings) {
        const auto steel = world.add_material({.young_modulus = modulus, .poisson_ratio = 0.3, .density = density});
        const auto rubber = world.add_material({.young_modulus = 1e5, .loss_factor = 0, .bulk_viscosity = 0});
        stiff = world.add_body(
            cube, {.material = steel, .angular_velocity = spin, .dynamics = BodyDynamics::implicit_elastic});
        soft = world.add_body(cube, {.material = rubber, .position = {0.013, 0.02, 0.112}, .velocity = {0.1, 0, -1}});
    }
};

/// A soft explicit cube on a stiff implicit one on a floor; each starts just above its support.
struct Stack {
    World world;
    BodyHandle stiff, soft;

    explicit Stack(const Settings& settings, Real density) : world(settings) {
        const auto steel = world.add_material({.young_modulus = 1e8, .poisson_ratio = 0.3, .density = density});
        const auto rubber = world.add_material({.young_modulus = 1e5});
        world.add_collider(Plane{});
        stiff = world.add_body(
            cube, {.material = steel, .position = {0, 0, 0.0505}, .dynamics = BodyDynamics::implicit_elastic});
        soft = world.add_body(cube, {.material = rubber, .position = {0.01, 0.005, 0.152}});
    }
    Real energy() const {
        const Energy energy = world.report().energy;
        return energy.kinetic + energy.elastic + energy.potential;
    }
};

constexpr Real h = 2e-4;

}  // namespace

TEST_CASE("a long step of one step is that of all others, to the bit", "[scene][implicit]") {
    Hit plain(settings_of(h, 0, Vec3::Zero())), of_one(settings_of(h, h, Vec3::Zero()));
    for (int k = 0; k < 20; ++k) {
        REQUIRE(plain.world.advance(10 * h).ok());
        REQUIRE(of_one.world.advance(10 * h).ok());
        REQUIRE(plain.world.state_hash() == of_one.world.state_hash());
    }
    CHECK(plain.world.report().mean_contacts > 0);
}

TEST_CASE("a long step ends as one implicit step with the sum of all impulses does", "[scene][implicit]") {
    constexpr int short_steps = 8;
    constexpr Real length = short_steps * h;
    Settings settings = settings_of(h, length, Vec3::Zero());
    settings.theta = GENERATE(1.0, 0.6);
    Hit scene(settings);
    WorldState& state = WorldAccess::state_of(scene.world);
    ImplicitNodeTable& table = state.model.implicit_nodes;
    const std::size_t count = table.displacement.size();
    std::vector<Vec3> sum(count), velocity(count), displacement(count);
    RigidBodyTable& rigid = state.model.rigid_bodies;
    Mat3 turn = Mat3::Identity();
    bool touched = false;
    scene.world.watch_steps([&](const StepReport&) {
        for (std::size_t n = 0; n < count; ++n) {
            sum[n] += turn.transpose() * table.contact_impulse[n];
            touched |= !table.contact_impulse[n].isZero(0);
        }
        turn = rigid.rotation[0] * rigid.axes[0].transpose();
    });
    const Real theta = settings.theta;
    for (int k = 0; k < 20; ++k) {
        std::ranges::fill(sum, Vec3::Zero());
        std::ranges::copy(table.velocity, velocity.begin());
        std::ranges::copy(table.displacement, displacement.begin());
        turn = rigid.rotation[0] * rigid.axes[0].transpose();
        const StepReport report = scene.world.advance(length);
        REQUIRE(report.ok());
        REQUIRE(report.steps == short_steps);
        StiffBody& stiff = state.model.stiff_bodies[0];
        REQUIRE(stiff.prepare(1, theta * theta * length * length));
        std::vector<Vec3> impulse(count), force(count);
        for (std::size_t n = 0; n < count; ++n)
            impulse[static_cast<std::size_t>(stiff.order_index(n))] = displacement[n];
        stiff.elastic_forces(impulse, force);
        for (std::size_t n = 0; n < count; ++n) {
            const auto p = static_cast<std::size_t>(stiff.order_index(n));
            impulse[p] = stiff.mass(p) * velocity[n] + theta * (sum[n] - length * force[p]);
        }
        stiff.respond(impulse);
        Real largest = 1e-9;
        for (const Vec3& of_node : impulse) largest = std::max(largest, of_node.norm());
        for (std::size_t n = 0; n < count; ++n) {
            const Vec3 during = impulse[static_cast<std::size_t>(stiff.order_index(n))];
            CHECK((table.displacement[n] - displacement[n] - length * during).norm() < 1e-12 * largest * length);
            CHECK((table.velocity[n] - velocity[n] - (during - velocity[n]) / theta).norm() < 1e-11 * largest);
        }
    }
    CHECK(touched);
}

TEST_CASE("long steps keep momenta, gain no energy, and nothing overlaps", "[scene][implicit][long]") {
    const Real density = GENERATE(3000.0, 300.0, 30.0);
    const int short_steps = GENERATE(1, 7, 40);
    const Real modulus = GENERATE(1e8, 1e6);
    CAPTURE(density, short_steps, modulus);
    Hit scene(settings_of(h, short_steps * h, Vec3::Zero()), density, Vec3::Zero(), modulus);
    const WorldReport before = scene.world.report();
    Real deepest = 0;  // largest violation of the contact distance [m]
    for (int k = 0; k < 30; ++k) {
        const StepReport report = scene.world.advance(40 * h);
        REQUIRE(report.ok());
        deepest = std::max(deepest, report.max_gap_violation);
        const WorldReport now = scene.world.report();
        REQUIRE((now.momentum - before.momentum).norm() < 1e-12 * before.momentum.norm());
        REQUIRE(now.energy.kinetic + now.energy.elastic < before.energy.kinetic * (1 + 1e-3));
    }
    // Bodies move 0.2 mm in a step. New contacts are pressed in by half of one step, in short steps, too.
    CHECK(deepest < 1.5e-4);
    CHECK(scene.world.report().mean_contacts > 0);
}

TEST_CASE("a body on a light implicit body gains no energy by long steps", "[scene][implicit][slow]") {
    const Real density = GENERATE(1000.0, 30.0);
    const int short_steps = GENERATE(16, 40);
    CAPTURE(density, short_steps);
    Stack scene(settings_of(h, short_steps * h, {0, 0, -standard_gravity}), density);
    const Real start = scene.energy(), mass = scene.world.mass(scene.soft) + scene.world.mass(scene.stiff);
    const Real scale = mass * standard_gravity * 0.1;
    Real deepest = 0;
    for (int k = 0; k < 100; ++k) {
        const StepReport report = scene.world.advance(80 * h);
        REQUIRE(report.ok());
        deepest = std::max(deepest, report.max_penetration);
        REQUIRE(scene.energy() < start + 1e-4 * scale);
    }
    CHECK(deepest == 0);
    CHECK(scene.world.report().energy.kinetic < 1e-6 * scale);
    // The floor carries both bodies. The upper one still vibrates.
    Real weight = 0;
    for (const Contact& contact : scene.world.contacts())
        if (!scene.world.alive(contact.second)) weight += contact.impulse.z() / h;
    CHECK(weight == Approx(mass * standard_gravity).epsilon(1e-3));
}

TEST_CASE("long steps are of first order", "[scene][implicit][long]") {
    // A soft ball on a light block that is not much stiffer; the steps resolve all of its vibrations.
    constexpr Real h_fine = 5e-6;
    const auto speed = [](Real implicit_step) {
        World world(settings_of(h_fine, implicit_step, Vec3::Zero()));
        const auto stiffer = world.add_material({.young_modulus = 1e6, .poisson_ratio = 0.3, .density = 300});
        const auto rubber = world.add_material({.young_modulus = 1e5, .loss_factor = 0, .bulk_viscosity = 0});
        world.add_body(cube, {.material = stiffer, .dynamics = BodyDynamics::implicit_elastic});
        const auto ball = world.add_body(
            mesh::ball(0.04, 3), {.material = rubber, .position = {0.003, 0.002, 0.092}, .velocity = {0, 0, -1}});
        REQUIRE(world.advance(0.032).ok());
        Vec3 mean = Vec3::Zero();
        for (const Vec3& v : world.velocities(ball)) mean += v;
        return mean.z() / static_cast<Real>(world.velocities(ball).size());
    };
    const Real exact = speed(h_fine), twice = speed(2 * h_fine), three_times = speed(3 * h_fine);
    CAPTURE(exact, twice, three_times);
    CHECK(std::abs(twice - exact) < 5e-3);
    CHECK((three_times - exact) / (twice - exact) == Approx(2).margin(0.3));
}

TEST_CASE("energy of implicit bodies in long steps adds up to rounding", "[scene][implicit]") {
    Settings settings = settings_of(h, 9 * h, Vec3::Zero());
    settings.theta = GENERATE(1.0, 0.6);
    World world(settings);
    const auto steel = world.add_material({.young_modulus = 1e8, .poisson_ratio = 0.3});
    world.add_body(cube, {.material = steel,
                          .velocity = {2, 0, 0},
                          .angular_velocity = {1, 2, 3},
                          .dynamics = BodyDynamics::implicit_elastic});
    world.add_body(cube,
                   {.material = steel, .position = {0.13, 0.02, 0.01}, .dynamics = BodyDynamics::implicit_elastic});
    const Real before = world.report().energy.kinetic;
    for (int k = 0; k < 20; ++k) REQUIRE(world.advance(0.005 + 1e-4 * k).ok());
    const WorldReport after = world.report();
    CHECK(after.mean_contacts > 0);
    CHECK(after.energy.kinetic + after.energy.elastic + after.energy.dissipated == Approx(before).epsilon(1e-11));
    CHECK(after.energy_error_share < 1e-11);
}

TEST_CASE("worlds with long steps go on bit by bit, on any number of workers, saved within one, too",
          "[scene][implicit][long]") {
    Settings settings = settings_of(h, 12 * h, {0, 0, -standard_gravity});
    Stack reference(settings, 100);
    settings.threads = 3;
    Stack with_three(settings, 100);
    int steps = 0;
    const auto some = [&steps](const StepReport&) { return ++steps <= 29; };  // ends in the middle of a long step
    for (Stack* scene : {&reference, &with_three}) {
        steps = 0;
        REQUIRE(scene->world.advance(0.02, some).status == StepStatus::stopped);
    }
    const TemporaryFolder folder;
    reference.world.save(folder.path() / "world");
    World loaded = World::load(folder.path() / "world"), cloned = reference.world.clone();
    for (World* world : {&reference.world, &with_three.world, &loaded, &cloned})
        for (int k = 0; k < 30; ++k) REQUIRE(world->advance(24 * h).ok());
    CHECK(reference.world.report().mean_contacts > 0);
    for (World* world : {&with_three.world, &loaded, &cloned})
        CHECK(world->state_hash() == reference.world.state_hash());
}

TEST_CASE("a long step that ends early loses energy, as the whole one does", "[scene][implicit]") {
    constexpr int short_steps = 10;
    Settings settings = settings_of(h, short_steps * h, Vec3::Zero());
    settings.theta = GENERATE(1.0, 0.5);
    World world(settings);
    const auto weak = world.add_material({.young_modulus = 1e5, .poisson_ratio = 0.3});
    world.add_body(cube, {.material = weak, .dynamics = BodyDynamics::implicit_elastic});
    WorldState& state = WorldAccess::state_of(world);
    std::span<Vec3> velocity = state.model.implicit_nodes.velocity;
    for (std::size_t n = 0; n < velocity.size(); ++n) velocity[n].x() = n % 2 == 0 ? 0.02 : -0.02;
    state.model.stiff_bodies[0].remove_rigid_motion(velocity);
    const auto energy = [&world] {
        const Energy now = world.report().energy;
        return now.kinetic + now.elastic;
    };
    REQUIRE(energy() > 0);
    Real before = energy();
    for (int wanted = 1; wanted < 3 * short_steps; ++wanted) {
        int steps = 0;
        const StepReport report =
            world.advance(2 * short_steps * h, [&](const StepReport&) { return ++steps <= wanted % short_steps; });
        REQUIRE(report.status == StepStatus::stopped);
        CAPTURE(wanted);
        CHECK(energy() <= before * (1 + 1e-12));
        before = energy();
    }
    CHECK(before > 0);
    CHECK(world.report().energy_error_share < 1e-11);
}

TEST_CASE("a step that is refused in the midst of a long one changes nothing", "[scene][implicit][long]") {
    Stack scene(settings_of(h, 12 * h, {0, 0, -standard_gravity}), 100);
    for (int k = 0; k < 10; ++k) REQUIRE(scene.world.advance(24 * h).ok());
    WorldState& state = WorldAccess::state_of(scene.world);
    NodeTable& nodes = state.model.nodes;
    const auto broken = static_cast<std::size_t>(state.model.bodies.nodes[1].begin);
    int steps = 0;
    Vec3 kept = Vec3::Zero();
    std::vector<Vec3> displacement, velocity;
    scene.world.watch_steps([&](const StepReport&) {
        if (++steps != 5) return;
        kept = nodes.velocity[broken];
        nodes.velocity[broken].setConstant(std::nan(""));
        displacement.assign(state.model.implicit_nodes.displacement.begin(),
                            state.model.implicit_nodes.displacement.end());
        velocity.assign(state.model.implicit_nodes.velocity.begin(), state.model.implicit_nodes.velocity.end());
    });
    const StepReport report = scene.world.advance(24 * h);
    CHECK(report.status == StepStatus::not_finite);
    CHECK(report.steps == 5);
    CHECK(std::ranges::equal(state.model.implicit_nodes.displacement, displacement));
    CHECK(std::ranges::equal(state.model.implicit_nodes.velocity, velocity));
    nodes.velocity[broken] = kept;
    const Real before = scene.energy();
    for (int k = 0; k < 20; ++k) REQUIRE(scene.world.advance(24 * h).ok());
    CHECK(scene.energy() < before + 1e-6);
}

TEST_CASE("large, sleeping or held bodies take no long steps, and return to them later", "[scene][implicit][long]") {
    Settings settings = settings_of(h, 10 * h, {0, 0, -standard_gravity});
    SECTION("large strain") {
        World world(settings);
        const auto weak = world.add_material({.young_modulus = 3e6, .poisson_ratio = 0.3});
        world.add_collider(Plane{});
        const auto body = world.add_body(cube, {.material = weak,
                                                .position = {0, 0, 0.051},
                                                .velocity = {0, 0, -8},
                                                .dynamics = BodyDynamics::implicit_elastic});
        REQUIRE(world.advance(0.1).ok());
        CHECK(world.report().large_strain_steps > 0);
        CHECK(world.report().energy_error_share < 1e-3);
        REQUIRE(world.advance(2).ok());
        CHECK(world.center_of_mass(body).z() == Approx(0.05).epsilon(0.02));
    }
    SECTION("asleep") {
        settings.sleep = true;
        Stack scene(settings, 1000);
        REQUIRE(scene.world.advance(3).ok());
        REQUIRE(scene.world.asleep(scene.stiff));
        scene.world.set_velocity(scene.soft, {0, 0, 1});
        const Real start = scene.energy();
        for (int k = 0; k < 50; ++k) {
            REQUIRE(scene.world.advance(0.02).ok());
            REQUIRE(scene.energy() < start + 1e-4);
        }
        CHECK(scene.world.report().energy_error_share < 1e-2);
    }
}

TEST_CASE("steps of implicit bodies are refused where they have no meaning", "[scene][implicit]") {
    Settings settings;
    settings.implicit_step = -1;
    CHECK_THROWS_WITH(World(settings), Catch::Contains("implicit_step") && Catch::Contains("-1"));
    settings.implicit_step = 0.01;
    settings.integrator = Integrator::leapfrog;
    CHECK_THROWS_WITH(World(settings), Catch::Contains("implicit_step") && Catch::Contains("symplectic_euler"));
}

TEST_CASE("a fine stiff cube that lands in long steps is solved to the tolerance", "[scene][implicit][slow]") {
    constexpr Real length = 1.0 / 120;
    constexpr int short_steps = 12, long_steps = 4;
    Settings settings;
    settings.step_size = length / short_steps;
    settings.implicit_step = length;
    World world(settings);
    const auto stiff =
        world.add_material({.young_modulus = 1e9, .poisson_ratio = 0.3, .density = 1000, .friction = 0.5});
    world.add_collider(Plane{});
    world.add_body(mesh::box({0.4, 0.4, 0.4}, {10, 10, 10}),
                   {.material = stiff, .position = {0, 0, 0.2}, .dynamics = BodyDynamics::implicit_elastic});
    const StepReport report = world.advance(long_steps * length);
    REQUIRE(report.ok());
    CHECK(world.contacts().size() >= 121);
    CHECK(report.unconverged == 0);
}

}  // namespace skerry::test::long_implicit_steps_test
