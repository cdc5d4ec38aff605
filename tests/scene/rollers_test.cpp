// Attachments that hold nodes along single directions, as roller supports do.
#include <catch2/catch.hpp>
#include <numeric>

#include "tests/support/message_of.h"
#include "tests/support/worlds.h"

namespace skerry::test::rollers_test {

using Catch::Matchers::Contains;

namespace {

constexpr Real young = 1e5, poisson = 0.3, stretch = 1e-3;
const Vec3 bar_size{0.2, 0.1, 0.1};

MaterialSettings linear(Real damping = 0) {
    return lossless(
        {.young_modulus = young, .poisson_ratio = poisson, .damping = damping, .model = MaterialModel::linear});
}

std::vector<Index> nodes_at(const Mesh& mesh, Index axis, Real coordinate) {
    std::vector<Index> nodes;
    for (std::size_t n = 0; n < mesh.nodes.size(); ++n)
        if (std::abs(mesh.nodes[n][axis] - coordinate) < 1e-9) nodes.push_back(static_cast<Index>(n));
    return nodes;
}

/// A bar with rollers on the three faces at its negative ends, and on the end at positive x, which moves by `motion`.
struct RolledBar {
    World world;
    Mesh mesh;
    BodyHandle body;
    AttachmentHandle left, right;

    RolledBar(const Settings& settings, const MaterialSettings& material, const Motion& motion = {},
              BodyDynamics dynamics = BodyDynamics::explicit_elastic)
        : world(settings), mesh(mesh::box(bar_size, {4, 2, 2})) {
        body = world.add_body(mesh, {.material = world.add_material(material), .dynamics = dynamics});
        left = world.attach(body, nodes_at(mesh, 0, -0.1), {}, Vec3::Zero(), {Vec3::UnitX()});
        world.attach(body, nodes_at(mesh, 1, -0.05), {}, Vec3::Zero(), {Vec3::UnitY()});
        world.attach(body, nodes_at(mesh, 2, -0.05), {}, Vec3::Zero(), {Vec3::UnitZ()});
        right = world.attach(body, nodes_at(mesh, 0, 0.1), motion, Vec3::Zero(), {Vec3::UnitX()});
    }
    /// Positions in uniaxial stress: the stretch along x, and the contraction that Poisson's ratio gives.
    std::vector<Vec3> stretched() const {
        std::vector<Vec3> positions = mesh.nodes;
        for (Vec3& x : positions) {
            x.x() += stretch * (x.x() + 0.1);
            x.y() -= poisson * stretch * (x.y() + 0.05);
            x.z() -= poisson * stretch * (x.z() + 0.05);
        }
        return positions;
    }
};

Settings weightless() {
    return accurate(Vec3::Zero());
}

}  // namespace

TEST_CASE("a bar on rollers in uniaxial stress stays there, and the reactions of its ends are equal", "[scene]") {
    RolledBar bar(weightless(), linear());
    bar.world.set_positions(bar.body, bar.stretched());
    bar.world.measure_forces(true);
    REQUIRE(bar.world.advance(0.05).ok());
    const Real force = young * stretch * 0.1 * 0.1;  // of the linear law, which refers to the rest shape
    for (const Mat3& sigma : bar.world.stress(bar.body)) {
        Mat3 expected = Mat3::Zero();
        expected(0, 0) = young * stretch / ((1 - poisson * stretch) * (1 - poisson * stretch));  // on the present area
        CHECK((sigma - expected).norm() < 1e-9 * expected(0, 0));
    }
    const Vec3 left = bar.world.forces().by(bar.left).force(), right = bar.world.forces().by(bar.right).force();
    CHECK((right - Vec3(force, 0, 0)).norm() < 1e-9 * force);
    CHECK((left + right).norm() < 1e-9 * force);
}

TEST_CASE("a bar that rollers stretch slowly comes to rest in uniaxial stress", "[scene]") {
    const Motion motion{.keys = {{.time = 0, .position = {0, 0, 0}}, {.time = 0.2, .position = {0.2 * stretch, 0, 0}}}};
    std::vector<Vec3> last;
    for (const Real share : {1.0, 0.1}) {
        Settings settings = weightless();
        settings.step_size = share * RolledBar(weightless(), linear(200)).world.stable_step();
        RolledBar bar(settings, linear(200), motion);
        REQUIRE(bar.world.advance(0.6).ok());
        const std::vector<Vec3> expected = bar.stretched();
        for (std::size_t n = 0; n < expected.size(); ++n)
            CHECK((bar.world.positions(bar.body)[n] - expected[n]).norm() < 1e-9 * 0.2);
    }
}

TEST_CASE("momentum and energy add up on rollers that move and carry weight", "[scene]") {
    const Motion motion{.velocity = {0.05, 0, 0}};
    for (const Real safety : {1.0, 0.25}) {
        Settings settings;
        settings.step_size = safety * RolledBar(weightless(), linear()).world.stable_step();
        RolledBar bar(settings, linear(), motion);
        bar.world.set_loads(bar.body, std::vector<Vec3>(bar.mesh.nodes.size(), Vec3(0.01, 0.02, 0)));
        REQUIRE(bar.world.advance(0.3).ok());
        const WorldReport report = bar.world.report();
        CHECK(report.momentum_error_share < 1e-13 * std::sqrt(static_cast<Real>(report.steps)));
        CHECK(report.energy_error_share < 1e-3);
    }
}

TEST_CASE("momentum and energy add up if a moving pin holds nodes that rollers hold too", "[scene]") {
    const Mesh mesh = mesh::box(bar_size, {4, 2, 2});
    World world(weightless());
    const BodyHandle body =
        world.add_body(mesh, {.material = world.add_material(linear()), .dynamics = BodyDynamics::explicit_elastic});
    world.attach(body, nodes_at(mesh, 0, -0.1), {.velocity = {0.05, 0, 0}});
    world.attach(body, nodes_at(mesh, 2, -0.05), {}, Vec3::Zero(), {Vec3::UnitZ()});
    world.set_loads(body, std::vector<Vec3>(mesh.nodes.size(), Vec3(0.01, 0.02, -0.01)));
    REQUIRE(world.advance(0.1).ok());
    const WorldReport report = world.report();
    CHECK(report.momentum_error_share < 1e-13 * std::sqrt(static_cast<Real>(report.steps)));
    CHECK(report.energy_error_share < 1e-3);
}

TEST_CASE("momentum adds up if a pin moves a whole body", "[scene]") {
    World world(weightless());
    const Mesh mesh = mesh::box(bar_size, {4, 2, 2});
    const BodyHandle body = world.add_body(
        mesh, {.material = world.add_material(linear()), .dynamics = BodyDynamics::explicit_elastic});
    world.attach(body, nodes_where(mesh, [](const Vec3&) { return true; }), {.velocity = {1, 0, 0}});
    REQUIRE(world.advance(0.1).ok());
    CHECK(world.report().momentum_error_share < 1e-9);
}

TEST_CASE("with leapfrog the balance accounts for the work of a roller that accelerates a loaded block", "[scene]") {
    Motion motion;
    for (int k = 0; k <= 30; ++k) motion.keys.push_back({.time = 0.01 * k, .position = {1e-4 * k * k, 0, 0}});
    Settings settings = accurate({3, 0, 0});
    settings.step_size = 1e-3;
    settings.integrator = Integrator::leapfrog;
    World world(settings);
    const Mesh mesh = mesh::box({0.1, 0.1, 0.1}, {1, 1, 1});
    const BodyHandle body = world.add_body(mesh, {.material = world.add_material(linear())});
    std::vector<Index> all(mesh.nodes.size());
    std::iota(all.begin(), all.end(), Index{0});
    world.attach(body, all, motion, Vec3::Zero(), {Vec3::UnitX()});
    world.set_loads(body, std::vector<Vec3>(all.size(), Vec3(2, 0, 0)));
    REQUIRE(world.advance(0.25).ok());
    CHECK(world.report().energy_error_share < 1e-10);
}

TEST_CASE("momentum adds up and nothing leaves its rollers when a ball strikes them", "[scene]") {
    RolledBar bar({}, linear());
    bar.world.add_body(
        mesh::ball(0.03, 4),
        {.material = bar.world.add_material(linear()), .position = {0, -0.03, 0.082}, .velocity = {0, 0.3, -1}});
    Real farthest = 0;  // distance of a node from its roller in any step [m]
    bar.world.watch_steps([&](const StepReport&) {
        for (const Index n : nodes_at(bar.mesh, 1, -0.05))
            farthest =
                std::max(farthest, std::abs(bar.world.positions(bar.body)[static_cast<std::size_t>(n)].y() + 0.05));
    });
    REQUIRE(bar.world.advance(0.1).ok());
    CHECK(farthest < 1e-12);
    const WorldReport report = bar.world.report();
    REQUIRE(report.mean_contacts > 0);
    CHECK(report.momentum_error_share < 1e-13 * std::sqrt(static_cast<Real>(report.steps)));
    CHECK(report.energy_error_share < 1e-2);
}

TEST_CASE("a block on rollers resists a blow along them like a held block, and contact takes its reaction", "[scene]") {
    const Mesh mesh = mesh::box({0.2, 0.2, 0.1}, {2, 2, 1});
    std::vector<Index> all(mesh.nodes.size());
    std::iota(all.begin(), all.end(), Index{0});
    const auto strike = [&](const std::vector<Vec3>& directions) {
        World world(accurate(Vec3::Zero(), 1e-10));
        const MaterialHandle smooth = world.add_material({.young_modulus = young, .friction = 0, .restitution = 0});
        const BodyHandle block = world.add_body(mesh, {.material = smooth, .dynamics = BodyDynamics::explicit_elastic});
        world.attach(block, all, {}, Vec3::Zero(), directions);
        // A vertex of the ball comes down on the middle of the block.
        const BodyHandle ball = world.add_body(mesh::ball(0.03, 2), {.material = smooth,
                                                                     .position = {0.02, 0.03, 0.081},
                                                                     .velocity = {0, 0, -1},
                                                                     .dynamics = BodyDynamics::rigid});
        REQUIRE(world.advance(0.003).ok());
        CHECK(world.report().mean_contacts > 0);
        CHECK(world.report().momentum_error_share < 1e-13);
        CHECK(world.report().energy_error_share < 1e-6);
        return world.velocity(ball).velocity.z();
    };
    CHECK(strike({Vec3::UnitZ()}) == Approx(strike({})).margin(1e-6));
}

TEST_CASE("rollers that lift a block carry and lift another block on it", "[scene][long]") {
    World world(accurate({0, 0, -standard_gravity}, 1e-10));
    const MaterialHandle smooth = world.add_material({.young_modulus = young, .friction = 0, .damping = 100});
    const Mesh mesh = mesh::box({0.1, 0.1, 0.1}, {2, 2, 2});
    const BodyHandle below = world.add_body(mesh, {.material = smooth, .dynamics = BodyDynamics::explicit_elastic}),
                     above = world.add_body(
                         mesh, {.material = smooth, .position = {0, 0, 0.102}, .dynamics = BodyDynamics::rigid});
    std::vector<Index> all(mesh.nodes.size());
    std::iota(all.begin(), all.end(), Index{0});
    const AttachmentHandle rollers = world.attach(below, all, {.velocity = {0, 0, 0.1}}, Vec3::Zero(), {Vec3::UnitZ()});
    world.measure_forces(true);
    REQUIRE(world.advance(0.3).ok());
    // The mean force carries the weight, and gives both blocks their speed.
    const Real mass = world.mass(below) + world.mass(above);
    CHECK(world.forces().by(rollers).force().z() == Approx(mass * (standard_gravity + 0.1 / 0.3)).epsilon(1e-6));
    CHECK(world.report().energy_error_share < 1e-3);
}

TEST_CASE("rollers that press a block into a plane prevail, and every step converges", "[scene]") {
    World world(accurate(Vec3::Zero()));
    const Mesh mesh = mesh::box({0.1, 0.1, 0.1}, {2, 2, 2});
    const BodyHandle block =
        world.add_body(mesh, {.material = world.add_material(linear()), .dynamics = BodyDynamics::explicit_elastic});
    std::vector<Index> all(mesh.nodes.size());
    std::iota(all.begin(), all.end(), Index{0});
    world.attach(block, all, {.velocity = {0, 0, -0.01}}, Vec3::Zero(), {Vec3::UnitZ()});
    world.add_collider(Plane{{0, 0, 1}, {0, 0, -0.0505}});
    REQUIRE(world.advance(0.1).ok());
    CHECK(world.report().mean_contacts > 0);
    CHECK(world.report().unconverged == 0);
    for (std::size_t n = 0; n < mesh.nodes.size(); ++n)
        CHECK(std::abs(world.positions(block)[n].z() - mesh.nodes[n].z() + 1e-3) < 1e-12);
}

TEST_CASE("nodes on rollers that touch a plane never cross it while the block leans against a wall", "[scene]") {
    World world(Settings{});
    const Mesh mesh = mesh::box({0.1, 0.1, 0.1}, {3, 3, 3});
    const BodyHandle block = world.add_body(
        mesh, {.material = world.add_material({.young_modulus = young, .poisson_ratio = poisson, .damping = 20}),
               .position = {0, 0, 0.05},
               .contact_distance = 0.002});
    const std::vector<Index> bottom = nodes_at(mesh, 2, -0.05);
    world.attach(block, bottom, {}, Vec3::Zero(), {Vec3::UnitZ()});
    world.add_collider(Plane{});
    world.add_collider(Plane{{-1, 0, 0}, {0.052, 0, 0}});
    world.set_gravity({5, 0, -standard_gravity});
    REQUIRE(world.advance(0.2).ok());
    CHECK(world.report().mean_contacts > 16);  // the floor and the wall
    CHECK(world.report().crossings_found == 0);
    for (const Index n : bottom) CHECK(world.positions(block)[static_cast<std::size_t>(n)].z() == 0);
}

TEST_CASE("a node on an inclined roller moves along the incline only", "[scene]") {
    World world(weightless());
    const Mesh mesh = mesh::box({0.1, 0.1, 0.1}, {1, 1, 1});
    const auto body = world.add_body(mesh, {.material = world.add_material(linear())});
    const Vec3 normal = Vec3(1, 0, 2).normalized();
    std::vector<Index> all;
    for (std::size_t n = 0; n < mesh.nodes.size(); ++n) all.push_back(static_cast<Index>(n));
    const auto roller = world.attach(body, all, {}, Vec3::Zero(), {3 * normal});
    CHECK((world.directions(roller).at(0) - normal).norm() < 1e-15);
    world.set_gravity({0, 0, -9.81});
    const Real h = world.stable_step();
    world.measure_forces(true);
    const StepReport report = world.advance(100 * h);
    REQUIRE(report.ok());
    // All nodes slide down the incline like a point mass.
    const Vec3 down = Vec3(0, 0, -9.81) - normal.dot(Vec3(0, 0, -9.81)) * normal;
    for (const Vec3& v : world.velocities(body)) CHECK((v - world.time() * down).norm() < 1e-9 * v.norm());
    const Real weight = world.mass(body) * 9.81;
    CHECK((world.forces().by(roller).force() - normal.z() * weight * normal).norm() < 1e-9 * weight);
    world.remove(roller);
    CHECK(world.attachments().empty());
}

TEST_CASE("a roller that jumps moves its nodes along the held direction only", "[scene]") {
    RolledBar bar(weightless(), linear());
    bar.world.set_pose(bar.right, {.position = {1e-3, 0.5, 0.5}});
    const std::vector<Index> moved = bar.world.nodes(bar.right);
    for (const Index n : moved) {
        const auto at = static_cast<std::size_t>(n);
        CHECK((bar.world.positions(bar.body)[at] - bar.mesh.nodes[at] - Vec3(1e-3, 0, 0)).norm() < 1e-15);
    }
}

TEST_CASE("rollers survive saving and cloning, and give the same bits on any number of workers", "[scene]") {
    Settings settings;
    settings.threads = 1;
    RolledBar bar(settings, linear(), {.velocity = {0.05, 0, 0}});
    // It lies across a row of nodes that a roller holds.
    bar.world.add_body(mesh::ball(0.03, 4),
                       {.material = bar.world.add_material(linear()), .position = {0, -0.03, 0.08}});
    REQUIRE(bar.world.advance(0.05).ok());
    REQUIRE(bar.world.report().mean_contacts > 0);
    World loaded = World::from_bytes(bar.world.to_bytes(), {.threads = 3}), copy = bar.world.clone();
    for (World* world : {&bar.world, &loaded, &copy}) REQUIRE(world->advance(0.05).ok());
    CHECK(loaded.state_hash() == bar.world.state_hash());
    CHECK(copy.state_hash() == bar.world.state_hash());
    CHECK(loaded.directions(bar.left) == std::vector<Vec3>{Vec3::UnitX()});
}

TEST_CASE("a bar that sleeps on rollers shows its reactions", "[scene]") {
    Settings settings;
    settings.sleep_time = 0.05;
    RolledBar bar(settings, linear(200));
    bar.world.measure_forces(true);
    for (int i = 0; i < 40 && !bar.world.asleep(bar.body); ++i) REQUIRE(bar.world.advance(0.05).ok());
    REQUIRE(bar.world.asleep(bar.body));
    const auto weight_on_rollers = [](World& world) {
        Real sum = 0;
        REQUIRE(world.advance(0.05).ok());
        for (const AttachmentHandle attachment : world.attachments()) sum += world.forces().by(attachment).force().z();
        return sum;
    };
    const Real weight = bar.world.mass(bar.body) * 9.81;
    CHECK(weight_on_rollers(bar.world) == Approx(weight).epsilon(0.01));
    CHECK(bar.world.report().momentum_error_share < 1e-12);  // steps without stages add nothing
    // measured anew from the state of the sleeping body
    World loaded = World::from_bytes(bar.world.to_bytes());
    loaded.measure_forces(true);
    CHECK(weight_on_rollers(loaded) == Approx(weight).epsilon(0.01));
    bar.world.set_velocity(bar.right, {0.1, 0, 0});
    REQUIRE(bar.world.advance(0.01).ok());
    CHECK_FALSE(bar.world.asleep(bar.body));
}

TEST_CASE("rollers of rigid and implicit bodies and oblique directions are refused", "[scene]") {
    CHECK_THAT(message_of([] { RolledBar(weightless(), linear(), {}, BodyDynamics::rigid); }),
               Contains("attach: directions: found the rigid body") && Contains("joint"));
    CHECK_THAT(message_of([] { RolledBar(weightless(), linear(), {}, BodyDynamics::implicit_elastic); }),
               Contains("attach: directions: found the implicit body") && Contains("a tie of kind slide"));
    RolledBar bar(weightless(), linear());
    const auto attach = [&](const std::vector<Vec3>& directions, const Motion& motion = {}) {
        return message_of(
            [&] { bar.world.attach(bar.body, nodes_at(bar.mesh, 0, 0.1), motion, Vec3::Zero(), directions); });
    };
    CHECK_THAT(attach({{1, 1, 0}}), Contains("holds along an oblique direction"));
    CHECK_THAT(attach({{0, 0, 1}, {0, 1, 1}}), Contains("found (0, 1, 1), expected a direction perpendicular"));
    CHECK_THAT(attach({{0, 0, 0}}), Contains("a vector of length 0"));
    CHECK_THAT(attach({{0, 0, 1}}, {.angular_velocity = {1, 0, 0}}), Contains("a motion with a rotation"));
    CHECK(attach({{0, 0, 1}}).empty());
    CHECK(attach({{1, 0, 0}, {0, 0, 1}, {0, 1, 0}}).empty());
}

}  // namespace skerry::test::rollers_test
