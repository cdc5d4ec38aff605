// Bodies that are put back into their rest shapes, and worlds that are put back into a saved state (World::reset).
#include <Eigen/Dense>
#include <catch2/catch.hpp>
#include <numbers>

#include "engine/world/world_state.h"
#include "skerry/cable.h"
#include "skerry/cavity.h"
#include "skerry/joint.h"
#include "skerry/load.h"
#include "skerry/spring.h"
#include "skerry/surface.h"
#include "skerry/tie.h"
#include "systems/geometry/rotation.h"
#include "tests/support/same_bits.h"
#include "tests/support/sliver_box.h"
#include "tests/support/temporary_folder.h"
#include "tests/support/worlds.h"

namespace skerry::test::reset_test {

namespace {

constexpr BodyDynamics deformable = BodyDynamics::explicit_elastic, implicit = BodyDynamics::implicit_elastic,
                       rigid = BodyDynamics::rigid;

/// A cube in free space that is pressed between its upper and lower faces, or thrown if it is rigid.
struct Cube {
    World world;
    BodyHandle body;
    std::vector<Vec3> start;
    std::array<std::vector<Index>, 2> face;

    explicit Cube(BodyDynamics dynamics, Real loss_factor, int threads = 1)
        : world({.gravity = {0, 0, 0}, .backend = Backend::threads, .threads = threads}) {
        const Mesh mesh = mesh::box({0.1, 0.1, 0.1}, {4, 4, 4});
        const auto material = world.add_material({.young_modulus = 1e5,
                                                  .poisson_ratio = 0.4,
                                                  .density = 1000,
                                                  .loss_factor = dynamics == implicit ? 0 : loss_factor});
        body = world.add_body(mesh, {.material = material,
                                     .position = {0.3, 0, 1},
                                     .rotation = {0.2, 0.1, 0.7},
                                     .dynamics = dynamics,
                                     .name = "cube"});
        start.assign(world.positions(body).begin(), world.positions(body).end());
        for (std::size_t n = 0; n < mesh.nodes.size(); ++n)
            if (std::abs(mesh.nodes[n].z()) > 0.049) face[mesh.nodes[n].z() > 0].push_back(static_cast<Index>(n));
    }

    /// Deforms the cube by a third in 0.1 s and holds it while part of its stress relaxes, or throws a rigid cube.
    void disturb(Real seconds = 0.5) {
        if (world.dynamics(body) == rigid) {
            world.set_velocity(body, {1, 0, 0}, {0, 3, 0});
            REQUIRE(world.advance(0.3).ok());
            return;
        }
        const auto lower = world.attach(body, face[0]), upper = world.attach(body, face[1]);
        world.move_to(upper, {.position = {0, 0.01, -0.03}}, 0.1);
        REQUIRE(world.advance(seconds).ok());
        world.remove(lower);
        world.remove(upper);
    }

    Real farthest_from(std::span<const Vec3> position) const {
        Real most = 0;
        const auto now = world.positions(body);
        for (std::size_t n = 0; n < position.size(); ++n) most = std::max(most, (now[n] - position[n]).norm());
        return most;
    }
};

// rounding errors of positions of about 1 m, in 0.2 s of motion
constexpr Real rounding = 1e-12;

Real largest_warm_start(World& world) {
    Real largest = 0;
    for (const Vec3& impulse : WorldAccess::state_of(world).cache.warm_start.impulse)
        largest = std::max(largest, impulse.norm());
    return largest;
}

/// Largest difference of the start frames of the elements of a body from the frame of its rest shape, which has not
/// turned since the elements were built at a rotation by 180 degrees about x.
Real frame_error(World& world, BodyHandle body) {
    const Model& model = WorldAccess::state_of(world).model;
    const Range blocks = model.bodies.blocks[static_cast<std::size_t>(model.row(body, "test"))];
    Real error = 0;
    for (Index b = blocks.begin; b < blocks.end; ++b)
        for (std::size_t l = 0; l < element_lanes; ++l)
            error = std::max(error, 1 - std::abs(model.elements.rotation[static_cast<std::size_t>(b)][1][l]));
    return error;
}

}  // namespace

TEST_CASE("a body that is reset stays in its rest shape, with any losses and dynamics", "[scene][long]") {
    for (const BodyDynamics dynamics : {deformable, implicit, rigid})
        for (const Real loss : {0.0, 0.05, 0.3}) {
            CAPTURE(name_of(dynamics), loss);
            Cube cube(dynamics, loss);
            cube.disturb();
            REQUIRE(cube.farthest_from(cube.start) > 0.01);
            cube.world.reset(cube.body);
            CHECK(cube.farthest_from(cube.start) < rounding);
            CHECK(cube.world.energy().kinetic == 0);
            for (int k = 0; k < 20; ++k) {
                REQUIRE(cube.world.advance(0.01).ok());
                REQUIRE(cube.farthest_from(cube.start) < rounding);
            }
            CHECK(cube.world.energy().elastic < 1e-20);
        }
}

TEST_CASE("a body can be reset at another pose", "[scene]") {
    for (const BodyDynamics dynamics : {deformable, implicit, rigid}) {
        CAPTURE(name_of(dynamics));
        Cube cube(dynamics, 0.3);
        cube.disturb();
        const Pose pose{{-0.2, 0.5, 0}, {0, 2.5, 1}};
        cube.world.reset(cube.body, pose);
        const Mat3 turn = rotation_matrix(pose.rotation) * rotation_matrix({0.2, 0.1, 0.7}).transpose();
        std::vector<Vec3> wanted;
        for (const Vec3& x : cube.start) wanted.push_back(pose.position + turn * (x - Vec3(0.3, 0, 1)));
        REQUIRE(cube.world.advance(0.2).ok());
        CHECK(cube.farthest_from(wanted) < rounding);
    }
}

TEST_CASE("a held body is reset with its attachment", "[scene]") {
    for (const BodyDynamics dynamics : {deformable, implicit, rigid}) {
        CAPTURE(name_of(dynamics));
        Cube cube(dynamics, 0.3);
        const auto held = cube.world.attach(cube.body, cube.face[0]);
        cube.world.move_to(held, {.position = {0, 0.05, 0}}, 0.05);
        REQUIRE(cube.world.advance(0.1).ok());
        REQUIRE(cube.farthest_from(cube.start) > 0.01);
        cube.world.reset(cube.body);
        REQUIRE(cube.world.advance(0.2).ok());
        CHECK(cube.farthest_from(cube.start) < rounding);
    }
}

TEST_CASE("a world that is reset starts again: sleepers wake, and contacts and joints forget their impulses",
          "[scene]") {
    World world({.threads = 1});
    const auto rubber = world.add_material({.young_modulus = 1e5, .friction = 0.5, .loss_factor = 0.3}),
               without_losses = world.add_material({.young_modulus = 1e5, .friction = 0.5});
    const Mesh mesh = mesh::box({0.1, 0.1, 0.1}, {2, 2, 2});
    world.add_collider(Plane{});
    std::vector<BodyHandle> bodies;
    for (const BodyDynamics dynamics : {deformable, implicit, rigid})
        bodies.push_back(world.add_body(mesh, {.material = dynamics == implicit ? without_losses : rubber,
                                               .position = {0.3 * static_cast<Real>(bodies.size()), 0, 0.06},
                                               .dynamics = dynamics}));
    const auto hung = world.add_body(mesh, {.material = rubber, .position = {0, 1, 1}, .dynamics = rigid});
    const auto joint =
        Joints(world).add({.kind = JointKind::hinge, .first = hung, .point = {0.3, 1, 1}, .axis = {0, 1, 0}});
    REQUIRE(world.advance(3).ok());
    for (const BodyHandle body : bodies) REQUIRE(world.asleep(body));
    REQUIRE(std::abs(Joints(world).state(joint).coordinate) > 0.1);
    world.reset();
    for (const BodyHandle body : bodies) {
        CHECK_FALSE(world.asleep(body));
        CHECK(world.center_of_mass(body).z() == Approx(0.06).epsilon(1e-12));
    }
    CHECK(largest_warm_start(world) == 0);
    CHECK(Joints(world).state(joint).force.norm() == 0);
    CHECK(Joints(world).state(joint).coordinate == Approx(0).margin(1e-12));
    const Real time = world.time();
    REQUIRE(world.advance(0.02).ok());
    CHECK(world.time() > time);
    for (const BodyHandle body :
         bodies)  // free fall; symplectic Euler is g h t / 2 off after a first step of another length
        CHECK(world.center_of_mass(body).z() == Approx(0.06 - standard_gravity * 0.02 * 0.02 / 2).margin(1e-3));
    REQUIRE(world.advance(3).ok());
    for (const BodyHandle body : bodies) CHECK(world.asleep(body));
}

TEST_CASE("the implicit elements of a body are chosen again when it is reset", "[scene]") {
    World world({.gravity = {0, 0, 0}, .threads = 1});
    const auto body =
        world.add_body(sliver_box(0.2, 8, 0.01, 0.005), {.material = world.add_material({.young_modulus = 1e5})});
    const Real step = world.stable_step();
    REQUIRE(world.report().clusters > 0);
    REQUIRE_FALSE(WorldAccess::state_of(world).model.clusters_open);
    world.reset(body);
    CHECK(WorldAccess::state_of(world).model.clusters_open);
    CHECK(world.stable_step() == Approx(step).epsilon(1e-9));
}

TEST_CASE("a world can go back to a clone, bit by bit, with its handles and callbacks", "[determinism]") {
    Cube cube(deformable, 0.3);
    int steps = 0;
    cube.world.watch_steps([&](const StepReport&) { ++steps; });
    cube.disturb();
    const World saved = cube.world.clone();
    REQUIRE(cube.world.advance(0.05).ok());
    const std::uint64_t after = cube.world.state_hash();
    const Real time = cube.world.time();
    cube.world.reset(saved);
    CHECK(cube.world.time() < time);
    CHECK(cube.world.state_hash() == saved.state_hash());
    const int before = steps;
    REQUIRE(cube.world.advance(0.05).ok());
    CHECK(cube.world.state_hash() == after);
    CHECK(steps > before);
    CHECK(cube.world.name(cube.body) == "cube");
    const World other;
    CHECK_THROWS_WITH(cube.world.reset(other), Catch::Contains("reset") && Catch::Contains("clone()"));
    CHECK(cube.world.state_hash() == after);
}

TEST_CASE("handles of objects that were added after a clone become stale when the world goes back to it", "[scene]") {
    Cube cube(deformable, 0);
    const Mesh mesh = mesh::box({0.1, 0.1, 0.1}, {1, 1, 1});
    const auto material = cube.world.add_material({});
    const auto add = [&] {
        return cube.world.add_body(mesh, {.material = material, .position = {3, 0, 0}, .dynamics = rigid});
    };
    const BodyHandle removed = add();
    cube.world.remove(removed);
    const World saved = cube.world.clone();
    const BodyHandle later = add();
    const ColliderHandle plane = cube.world.add_collider(Plane{});
    const JointHandle joint = Joints(cube.world).add({.first = later});
    cube.world.reset(saved);
    CHECK_FALSE(cube.world.alive(later));
    const BodyHandle again = add();
    Joints(cube.world).add({.first = again});
    cube.world.add_collider(Plane{});
    CHECK(cube.world.alive(cube.body));
    CHECK(cube.world.alive(again));
    CHECK_FALSE(cube.world.alive(removed));
    CHECK_FALSE(cube.world.alive(later));
    CHECK_FALSE(cube.world.alive(plane));
    CHECK_FALSE(Joints(cube.world).alive(joint));

    // Handles of joints, ties, cables and other objects that act on bodies stay stale, too.
    World& world = cube.world;
    const auto stays_stale = [&](auto&& view, auto&& add_one) {
        const auto first = add_one();
        REQUIRE(view.alive(first));
        world.reset(saved);
        const auto second = add_one();
        CHECK(view.alive(second));
        CHECK_FALSE(view.alive(first));
        world.reset(saved);
    };
    const Anchor on_cube{.body = cube.body, .point = world.positions(cube.body)[0]};
    Ties ties(world);
    stays_stale(ties, [&] { return ties.add({.body = cube.body, .nodes = {0}}); });
    Cables cables(world);
    stays_stale(cables, [&] { return cables.add({.points = {{}, on_cube}, .drive = {.tension = 1}}); });
    Springs springs(world);
    stays_stale(springs, [&] { return springs.add({.second = on_cube, .stiffness = 1}); });
    Loads loads(world);
    stays_stale(loads, [&] { return loads.add(GravityScale{.scale = 1}); });
    SurfaceSets sets(world);
    stays_stale(sets, [&] { return sets.add({.body = cube.body, .nodes = {0}, .surface = {.friction = 0.1}}); });
    Cavities cavities(world);
    const auto add_gas = [&] {
        const auto faces = world.surface(cube.body);
        return cavities.add(
            {.body = cube.body, .faces = std::vector{faces[0]}, .filling = GasFilling{}, .volume = 1e-3});
    };
    stays_stale(cavities, add_gas);
    stays_stale(cavities, [&] { return cavities.add({.first = add_gas(), .conductance = 1e-9}); });

    // A slot that the clone uses has a new handle when it is reused after the reset, too.
    cube.world.remove(cube.body);
    const BodyHandle reused = add();
    REQUIRE(reused.slot == cube.body.slot);
    cube.world.reset(saved);
    CHECK(cube.world.alive(cube.body));
    cube.world.remove(cube.body);
    const TemporaryFolder folder;
    cube.world.save(folder.path() / "world.skerry");
    cube.world = World::load(folder.path() / "world.skerry");
    add();
    CHECK_FALSE(cube.world.alive(cube.body));
    CHECK_FALSE(cube.world.alive(reused));
}

TEST_CASE("a body that was turned round and changed its dynamics is reset without strain", "[scene]") {
    World world({.gravity = {0, 0, 0}});
    const auto material =
        world.add_material({.young_modulus = 1e5, .loss_factor = 0, .model = MaterialModel::corotational});
    const BodyHandle body =
        world.add_body(mesh::box({0.1, 0.2, 0.3}, {2, 2, 2}), {.material = material, .dynamics = deformable});
    const std::vector<Vec3> start(world.positions(body).begin(), world.positions(body).end());
    world.set_pose(body, {.rotation = {std::numbers::pi, 0, 0}});
    world.set_dynamics(body, rigid);
    world.set_dynamics(body, deformable);
    world.reset(body);
    CHECK(frame_error(world, body) < 1e-12);
    REQUIRE(world.advance(0.05).ok());
    for (std::size_t n = 0; n < start.size(); ++n) CHECK((world.positions(body)[n] - start[n]).norm() < 1e-12);
}

TEST_CASE("a reset at a pose that is not finite, or of a removed body, is refused", "[scene]") {
    Cube cube(deformable, 0);
    const std::uint64_t before = cube.world.state_hash();
    CHECK_THROWS_WITH(cube.world.reset(cube.body, {.position = {0, 0, infinity}}),
                      Catch::Contains("'cube'") && Catch::Contains("position"));
    CHECK(cube.world.state_hash() == before);
    cube.world.remove(cube.body);
    CHECK_THROWS_WITH(cube.world.reset(cube.body), Catch::Contains("reset"));
}

TEST_CASE("a body is reset to the same bits on any number of threads, in a clone and after loading", "[determinism]") {
    for (const BodyDynamics dynamics : {deformable, implicit, rigid})
        check_same_bits(
            [dynamics](int threads) {
                Cube cube(dynamics, 0.3, threads);
                cube.disturb(0.15);
                return cube;
            },
            [](World& world) {
                world.reset(world.bodies().front());
                world.set_gravity({0, 0, -standard_gravity});
                REQUIRE(world.advance(0.05).ok());
            });
}

}  // namespace skerry::test::reset_test
