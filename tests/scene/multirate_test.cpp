// Multirate stepping: fewer element forces, the same motion (docs/methods/stable_step.md 7, docs/integration.md).
#include <catch2/catch.hpp>

#include <algorithm>

#include "jobs/executor.h"
#include "tests/support/multirate_worlds.h"
#include "tests/support/worlds.h"

namespace skerry::test::multirate_test {

namespace {

World sliver_world(bool multirate, MaterialModel model = MaterialModel::stable_neo_hookean,
                   Backend backend = Backend::automatic, int threads = 0) {
    Settings settings;
    settings.gravity = Vec3::Zero();
    settings.clusters = false;
    settings.multirate = multirate;
    settings.backend = backend;
    settings.threads = threads;
    World world(settings);
    const auto material =
        world.add_material(test::lossless({.young_modulus = 1e5, .poisson_ratio = 0.3, .model = model}));
    stir(world, world.add_body(sliver_mesh(), {.material = material, .element = ElementKind::linear}), sliver_mesh());
    return world;
}

/// A stiff ball that falls onto a soft block on a floor: the block's steps could be sixteen times as long.
World stiff_on_soft(bool multirate, Backend backend = Backend::automatic, int threads = 0, Real step_safety = 1) {
    Settings settings;
    settings.step_safety = step_safety;
    settings.multirate = multirate;
    settings.backend = backend;
    settings.threads = threads;
    World world(settings);
    const auto soft =
        world.add_material(test::lossless({.young_modulus = 2e4, .poisson_ratio = 0.3, .friction = 0.4, .damping = 2}));
    const auto stiff =
        world.add_material(test::lossless({.young_modulus = 1e7, .poisson_ratio = 0.3, .friction = 0.4, .damping = 2}));
    world.add_collider(Plane{});
    world.add_body(mesh::box({0.2, 0.2, 0.1}, {6, 6, 3}),
                   {.material = soft, .position = {0, 0, 0.052}, .element = ElementKind::linear, .name = "soft"});
    world.add_body(mesh::ball(0.04, 4), {.material = stiff,
                                         .position = {0.01, 0, 0.15},
                                         .velocity = {0.2, 0, -0.5},
                                         .element = ElementKind::linear,
                                         .name = "stiff"});
    return world;
}

/// A bar on end that falls onto its soft end; the other quarter, a hundred times as stiff, has steps ten times as
/// short. A smaller one has masses in its frame, with which one level costs less.
World mixed_bar(Integrator integrator = Integrator::symplectic_euler) {
    Settings settings;
    settings.multirate = true;
    settings.integrator = integrator;
    World world(settings);
    const auto soft = world.add_material({.young_modulus = 5e4, .poisson_ratio = 0.3, .friction = 0.4});
    const auto stiff = world.add_material({.young_modulus = 5e6, .poisson_ratio = 0.3, .friction = 0.4});
    world.add_collider(Plane{});
    Mesh mesh = mesh::box({0.1, 0.1, 0.2}, {10, 10, 20});
    for (const auto& t : mesh.tetrahedra) {
        Real height = 0;
        for (const Index corner : t) height += mesh.nodes[static_cast<std::size_t>(corner)].z();
        mesh.label.push_back(height > 0.2 ? 1 : 0);
    }
    world.add_body(mesh, {.material = soft,
                          .materials = {{0, soft}, {1, stiff}},
                          .position = {0, 0, 0.15},
                          .rotation = {0.3, 0.1, 0},
                          .velocity = {0, 0, -2},
                          .name = "bar"});
    return world;
}

/// A soft ball with slivers, thrown at the floor at a speed at which its elements are flat before a coarse impulse.
World thrown_slivers(bool clusters) {
    Settings settings;
    settings.multirate = true;
    settings.clusters = clusters;
    World world(settings);
    const auto material = world.add_material({.young_modulus = 5e4, .poisson_ratio = 0.45, .density = 900});
    world.add_collider(Plane{});
    world.add_body(sliver_mesh(), {.material = material,
                                   .position = {0, 0, 0.1},
                                   .rotation = {0.4, 0.3, 0},
                                   .velocity = {0, 0, -10},
                                   .element = ElementKind::linear,
                                   .name = "box"});
    return world;
}

Real rms_distance(std::span<const Vec3> a, std::span<const Vec3> b) {
    REQUIRE(a.size() == b.size());
    Real sum = 0;
    for (std::size_t n = 0; n < a.size(); ++n) sum += (a[n] - b[n]).squaredNorm();
    return std::sqrt(sum / static_cast<Real>(a.size()));
}

}  // namespace

TEST_CASE("slivers get their impulses often and everything else seldom", "[scene]") {
    World world = sliver_world(true), single = sliver_world(false);
    // The stable step is that of the slivers, with and without; without levels shares of mass make it a little longer.
    CHECK(world.stable_step() <= single.stable_step());
    CHECK(world.stable_step() >= 0.8 * single.stable_step());
    REQUIRE(world.advance(0.01).ok());
    const WorldReport report = world.report();
    REQUIRE(report.level_elements.size() >= 4);
    std::uint64_t sum = 0, fine = 0;
    for (std::size_t l = 0; l < report.level_elements.size(); ++l) {
        sum += report.level_elements[l];
        if (l < 2) fine += report.level_elements[l];
    }
    CHECK(sum == report.elements);
    CHECK(fine > 0);
    CHECK(20 * fine < sum);
    CHECK(report.element_steps == report.steps * report.elements);
    CHECK(report.element_impulses < report.element_steps / 6);
    CHECK(single.report().level_elements.empty());
}

TEST_CASE("elements of many levels keep momentum and angular momentum to rounding", "[scene]") {
    const auto model = GENERATE(MaterialModel::corotational, MaterialModel::stable_neo_hookean);
    World world = sliver_world(true, model);
    const WorldReport before = world.report();
    REQUIRE(world.advance(0.02).ok());
    const WorldReport after = world.report();
    REQUIRE(after.level_elements.size() >= 4);
    const Real steps = static_cast<Real>(after.steps);
    // Rounding of one step times the number of steps. The box has no momentum as a whole: its size is sum m |v| = mass
    // * 0.3 m/s.
    const Real mass = world.mass(world.bodies()[0]);
    CHECK((after.momentum - before.momentum).norm() <= 1e-13 * mass * 0.3 * steps);
    // A corotational element's frame is found to 1e-10, and so is its torque: it has the tolerance of that.
    const Real torque = model == MaterialModel::corotational ? 1e-12 : 1e-13;
    CHECK((after.angular_momentum - before.angular_momentum).norm() <= torque * before.angular_momentum.norm() * steps);
}

/// Sums in another order: blocks of elements are compact with multirate (BlockOrder).
constexpr Real rounding = 1e-12;  // m, of bodies of a decimetre

TEST_CASE("without slivers to care for, multirate changes nothing but the order of sums", "[scene]") {
    const auto run = [](bool multirate) {
        Settings settings;
        settings.multirate = multirate;
        World world(settings);
        const auto material = world.add_material(
            test::lossless({.young_modulus = 1e5, .friction = 0.5, .model = MaterialModel::corotational}));
        world.add_collider(Plane{});
        const auto body =
            world.add_body(mesh::box({0.1, 0.1, 0.1}, {3, 3, 3}),
                           {.material = material, .position = {0, 0, 0.06}, .element = ElementKind::linear});
        REQUIRE(world.advance(0.15).ok());
        REQUIRE(world.report().max_contacts > 0);
        if (multirate) REQUIRE(world.report().level_elements.size() == 1);
        // nor what is said of the energy: velocities are brought up to date with and without
        return std::pair(std::vector<Vec3>(world.positions(body).begin(), world.positions(body).end()),
                         world.report().energy_error);
    };
    const auto [with, error_with] = run(true);
    const auto [without, error_without] = run(false);
    for (std::size_t n = 0; n < with.size(); ++n) CHECK((with[n] - without[n]).norm() < rounding);
    CHECK(error_with == Approx(error_without).epsilon(1e-6));
}

TEST_CASE("multirate on slivers converges with order 2, with the error of a mesh that has none", "[scene]") {
    const Mesh regular = mirrored_box(box_size, box_cells);
    const auto positions = [&](const Mesh& mesh, bool multirate, Real safety, Integrator integrator) {
        Settings settings;
        settings.gravity = Vec3::Zero();
        settings.clusters = false;
        settings.multirate = multirate;
        settings.step_safety = safety;
        settings.integrator = integrator;
        World world(settings);
        const auto material = world.add_material(test::lossless({.young_modulus = 1e5, .poisson_ratio = 0.3}));
        const auto body = world.add_body(mesh, {.material = material, .element = ElementKind::linear});
        stir(world, body, mesh);
        REQUIRE(world.advance(0.02).ok());
        return std::vector<Vec3>(world.positions(body).begin(), world.positions(body).end());
    };
    const auto error = [&](const Mesh& mesh, bool multirate, Real safety) {
        const Real fine = 1.0 / 16;  // by leapfrog: 256 times less
        return rms_distance(positions(mesh, multirate, safety, Integrator::symplectic_euler),
                            positions(mesh, false, fine, Integrator::leapfrog));
    };
    const Real coarse = error(sliver_mesh(), true, 1), middle = error(sliver_mesh(), true, 0.5),
               without = error(regular, false, 1);
    INFO(coarse << " m, at half the step " << middle << " m; one step without slivers " << without << " m");
    // One step for all, sixteen times shorter than good elements need, has an error far below: that is what it wastes.
    CHECK(coarse < without);
    CHECK(std::log2(coarse / middle) == Approx(2).margin(0.3));
}

TEST_CASE("energy stays where it is over 1e5 steps with slivers of all frequencies", "[scene][slow]") {
    World world = sliver_world(true);
    const Real start = total_energy(world), h = world.stable_step();
    for (int part = 0; part < 10; ++part) {
        const StepReport report = world.advance(1e4 * h);
        REQUIRE(report.ok());
        REQUIRE(report.shortened == 0);
        // Symplectic: what is not lost to the slivers' viscosity (1 % in all here) oscillates by less than 1 %.
        // Resonance would double the energy of a sliver some twenty times in this run.
        CHECK(total_energy(world) < 1.01 * start);
        CHECK(total_energy(world) > 0.97 * start);
    }
    CHECK(world.report().steps > 95000);
}

TEST_CASE("a soft block under a stiff ball is looked at seldom and moves as it should", "[scene]") {
    World multirate = stiff_on_soft(true), single = stiff_on_soft(false);
    const Real seconds = 0.12;
    REQUIRE(multirate.advance(seconds).ok());
    REQUIRE(single.advance(seconds).ok());
    REQUIRE(single.report().max_contacts > 5);
    const WorldReport report = multirate.report();
    // the ball, whose steps these are, has 0.37 of the elements
    CHECK(static_cast<Real>(report.element_impulses) < 0.55 * static_cast<Real>(report.element_steps));
    CHECK(report.max_penetration <= single.report().max_penetration + 1e-5);
    const auto apart = [](const World& a, const World& b) {
        Real most = 0;
        for (std::size_t i = 0; i < a.bodies().size(); ++i)
            most = std::max(most, (a.center_of_mass(a.bodies()[i]) - b.center_of_mass(b.bodies()[i])).norm());
        return most;
    };
    // What the two make of the impact differs; with a quarter of the step by little.
    const Real coarse = apart(multirate, single);
    CHECK(total_energy(multirate) == Approx(total_energy(single)).epsilon(0.15));
    CHECK(coarse < 5e-4);
    World fine_multirate = stiff_on_soft(true, Backend::automatic, 0, 0.25),
          fine_single = stiff_on_soft(false, Backend::automatic, 0, 0.25);
    REQUIRE(fine_multirate.advance(seconds).ok());
    REQUIRE(fine_single.advance(seconds).ok());
    CHECK(total_energy(fine_multirate) == Approx(total_energy(fine_single)).epsilon(0.01));
    CHECK(apart(fine_multirate, fine_single) < std::min(coarse, 2e-4));
}

TEST_CASE("energy of multirate adds up where contacts act on coarse elements", "[scene]") {
    const Real safety = GENERATE(1.0, 0.5);
    World world = stiff_on_soft(true, Backend::automatic, 0, safety);
    REQUIRE(world.advance(0.12).ok());
    const WorldReport report = world.report();
    INFO(report.energy_error << " J, " << 100 * report.energy_error_share << " %");
    REQUIRE(report.max_contacts > 5);
    REQUIRE(5 * report.element_impulses < 3 * report.element_steps);
    // Impulses of coarse elements at nodes that a contact stops within the step were told as dissipated many times
    // over: 8.2 % and 5.7 %.
    CHECK(report.energy_error_share < 0.01);
}

TEST_CASE("energy of multirate adds up in a body a quarter of which is a hundred times as stiff", "[scene]") {
    World world = mixed_bar(GENERATE(Integrator::symplectic_euler, Integrator::leapfrog));
    REQUIRE(world.advance(0.12).ok());
    const WorldReport report = world.report();
    INFO(report.energy_error << " J, " << 100 * report.energy_error_share << " %");
    REQUIRE(report.level_elements.size() >= 3);
    REQUIRE(report.max_contacts > 5);
    // Impulses of the soft side at nodes of the stiff one were in time with its modes: 5.4 %.
    CHECK(report.energy_error_share < 0.01);
}

TEST_CASE("energy of multirate adds up in an impact that is quick for coarse elements", "[scene]") {
    const bool clusters = GENERATE(false, true);
    World world = thrown_slivers(clusters);
    REQUIRE(world.advance(0.04).ok());
    const WorldReport report = world.report();
    INFO(report.energy_error << " J, " << 100 * report.energy_error_share << " %, shortened " << report.shortened);
    if (clusters)
        REQUIRE(report.clusters > 0);
    else
        REQUIRE(report.level_elements.size() >= 3);
    REQUIRE(report.max_contacts > 5);
    CHECK(report.energy_error_share < 0.01);
}

TEST_CASE("the viscosity of fine elements among coarse is told as dissipated", "[scene]") {
    World world = sliver_world(true);
    const Real start = total_energy(world);
    REQUIRE(world.advance(0.05).ok());
    const WorldReport report = world.report();
    // nothing else takes energy here, but for what swings with the place in a cycle
    CHECK(report.energy.dissipated > 0);
    CHECK(report.energy.dissipated == report.dissipated);
    CHECK(report.energy_error_share < 5e-3);
    CHECK(total_energy(world) < start);
}

TEST_CASE("multirate steps have the same bits for 1, 2 and 4 workers", "[scene][determinism]") {
    const auto hash = [](World world) {
        REQUIRE(world.advance(0.02).ok());
        return world.state_hash();
    };
    const std::uint64_t slivers = hash(sliver_world(true, MaterialModel::corotational, Backend::serial, 1));
    const std::uint64_t scene = hash(stiff_on_soft(true, Backend::serial, 1));
    constexpr auto euler = Integrator::symplectic_euler;
    const std::uint64_t clusters = hash(ball_on_slivers(true, euler, Backend::serial, 1));
    for (Backend backend : available_backends())
        for (int threads : {1, 2, 4}) {
            INFO(name_of(backend) << " with " << threads);
            CHECK(hash(sliver_world(true, MaterialModel::corotational, backend, threads)) == slivers);
            CHECK(hash(stiff_on_soft(true, backend, threads)) == scene);
            CHECK(hash(ball_on_slivers(true, euler, backend, threads)) == clusters);
        }
}

TEST_CASE("stresses and surfaces of a body sorted by level are those of its tetrahedra", "[scene]") {
    World world = sliver_world(true), single = sliver_world(false);
    const auto body = world.bodies()[0], same = single.bodies()[0];
    REQUIRE(std::equal(world.tetrahedra(body).begin(), world.tetrahedra(body).end(), single.tetrahedra(same).begin()));
    REQUIRE(std::equal(world.surface(body).begin(), world.surface(body).end(), single.surface(same).begin()));
    const Real h = world.stable_step();
    for (World* w : {&world, &single}) REQUIRE(w->advance(16 * h).ok());
    const std::vector<Real> stress = world.von_mises_stress(body), expected = single.von_mises_stress(same);
    const Real scale = *std::max_element(expected.begin(), expected.end());
    REQUIRE(scale > 0);
    // After one cycle the states differ by what one impulse in the middle differs from many. Slivers magnify that: most
    // are compared.
    std::size_t near = 0;
    for (std::size_t t = 0; t < stress.size(); ++t) near += std::abs(stress[t] - expected[t]) < 0.02 * scale;
    CHECK(100 * near > 97 * stress.size());
}

TEST_CASE("bodies come and go between steps of many levels", "[scene]") {
    World world = sliver_world(true);
    const auto first = world.bodies()[0];
    REQUIRE(world.advance(0.003).ok());
    const auto material = world.add_material(test::lossless({.young_modulus = 1e6}));
    const auto second =
        world.add_body(sliver_mesh(), {.material = material, .position = {0.5, 0, 0}, .velocity = {1, 0, 0}});
    REQUIRE(world.advance(0.003).ok());
    const WorldReport both = world.report();
    world.remove(first);
    REQUIRE(world.advance(0.003).ok());
    CHECK(world.center_of_mass(second).x() == Approx(0.5 + 0.006).margin(1e-12));
    const WorldReport one = world.report();
    std::uint64_t sum_both = 0, sum_one = 0;
    for (std::uint64_t count : both.level_elements) sum_both += count;
    for (std::uint64_t count : one.level_elements) sum_one += count;
    CHECK(sum_both == 2 * sliver_mesh().tetrahedra.size());
    CHECK(sum_one == sliver_mesh().tetrahedra.size());
}

TEST_CASE("steps shortened within a cycle, and a call broken off, lose no impulse", "[scene]") {
    // A hammer blow in mid-run makes steps too long; momentum tells of every impulse given twice or not at all to one
    // of its four corners, and the height of a resting block of every imbalance between weight, floor and elements.
    World world = sliver_world(true);
    const auto body = world.bodies()[0];
    const Real h = world.stable_step();
    REQUIRE(world.advance(5 * h).ok());
    const Mesh& mesh = sliver_mesh();
    std::vector<Vec3> velocity(world.velocities(body).begin(), world.velocities(body).end());
    for (std::size_t n = 0; n < velocity.size(); ++n)
        if (mesh.nodes[n].x() > 0.049) velocity[n].x() -= 4;
    world.set_velocities(body, velocity);
    const WorldReport before = world.report();
    const StepReport hit = world.advance(64 * h);
    REQUIRE(hit.ok());
    REQUIRE(hit.shortened > 0);
    REQUIRE(world.advance(64 * h).ok());
    const WorldReport after = world.report();
    CHECK((after.momentum - before.momentum).norm() <= 1e-13 * before.momentum.norm() * static_cast<Real>(after.steps));
    // A load that no step can follow breaks the call off and changes nothing; the run goes on after it.
    std::vector<Vec3> huge(mesh.nodes.size(), Vec3::Zero());
    huge[0] = {1e300, 0, 1e300};
    world.set_loads(body, huge);
    const std::uint64_t hash = world.state_hash();
    CHECK_FALSE(world.advance(10 * h).ok());
    CHECK(world.state_hash() == hash);
    world.set_loads(body, std::vector<Vec3>(mesh.nodes.size(), Vec3::Zero()));
    CHECK(world.advance(64 * h).ok());
}

TEST_CASE("forward Euler and multirate exclude each other, and the message says why", "[scene]") {
    Settings settings;
    settings.integrator = Integrator::forward_euler;
    settings.multirate = true;
    CHECK_THROWS_WITH(World(settings), Catch::Contains("multirate") && Catch::Contains("forward_euler"));
}

}  // namespace skerry::test::multirate_test
