// Setting the motion of colliders and attachments during the run.
#include <catch2/catch.hpp>

#include <numbers>

#include "engine/world/tuning.h"
#include "systems/geometry/rotation.h"
#include "tests/support/temporary_folder.h"
#include "tests/support/worlds.h"

namespace skerry::test::control_motion_test {

namespace {

Settings weightless() {
    Settings settings;
    settings.gravity = Vec3::Zero();
    return settings;
}

struct BallOnBox {
    World world;
    BodyHandle ball;
    ColliderHandle box;

    explicit BallOnBox(const Settings& settings = {}, bool mesh = false, const Tuning& tuning = {})
        : world(tuned_world(settings, tuning)) {
        const auto rubber = world.add_material({.young_modulus = 5e4, .friction = 0.5, .damping = 20});
        const Vec3 size(0.3, 0.3, 0.05);
        box = mesh ? world.add_collider(mesh::boundary(mesh::box(size, {2, 2, 1})), {.name = "box"})
                   : world.add_collider(Box{size}, {.name = "box"});
        ball = world.add_body(mesh::ball(0.05, 4), {.material = rubber, .position = {0, 0, 0.08}, .name = "ball"});
    }
};

std::uint64_t hash_after(World& world, Real seconds) {
    REQUIRE(world.advance(seconds).ok());
    return world.state_hash();
}

constexpr Real rounding = 1e-12;

}  // namespace

TEST_CASE("a collider moves by the velocity that was set last, from where it is", "[scene]") {
    for (const bool mesh : {false, true}) {
        BallOnBox scene(weightless(), mesh);
        World& world = scene.world;
        REQUIRE(world.advance(0.01).ok());
        world.set_velocity(scene.box, {0.1, 0, -0.2}, {0, 0, 2});
        REQUIRE(world.advance(0.5).ok());
        CHECK((world.pose(scene.box).position - Vec3(0.05, 0, -0.1)).norm() < rounding);
        CHECK((world.pose(scene.box).rotation - Vec3(0, 0, 1)).norm() < rounding);
        world.set_velocity(scene.box, {0, 0.3, 0});
        REQUIRE(world.advance(0.1).ok());
        CHECK((world.pose(scene.box).position - Vec3(0.05, 0.03, -0.1)).norm() < rounding);
        CHECK((world.pose(scene.box).rotation - Vec3(0, 0, 1)).norm() < rounding);
    }
}

TEST_CASE("a velocity that is set moves a collider as one that it was added with", "[scene]") {
    const auto final_height = [](bool live) {
        World world(weightless());
        const auto rubber = world.add_material({.young_modulus = 5e4});
        const auto ball = world.add_body(mesh::ball(0.05, 4), {.material = rubber, .position = {0, 0, 0.08}});
        const Vec3 up(0, 0, 0.5);
        const auto box = world.add_collider(Box{{0.3, 0.3, 0.05}}, {.motion = {.velocity = live ? Vec3::Zero() : up}});
        if (live) world.set_velocity(box, up);
        REQUIRE(world.advance(0.2).ok());
        return std::pair(world.center_of_mass(ball).z(), world.positions(ball)[0]);
    };
    CHECK(final_height(true) == final_height(false));
    CHECK(final_height(true).first > 0.13);
}

TEST_CASE("a collider that is moved to a pose is there at the end of advance, on the shorter way, and then stops",
          "[scene]") {
    constexpr Real pi = std::numbers::pi;
    for (const bool mesh : {false, true}) {
        BallOnBox scene(weightless(), mesh);
        World& world = scene.world;
        const Real dt = 1e-3;
        for (const Pose& pose : {Pose{{0.01, 0, -0.02}, {0, 0, 0.9 * pi}}, Pose{{0, 0.01, -0.02}, {0, 0, -0.9 * pi}},
                                 Pose{{0, 0, -0.05}, {0.3, 0.4, 0.5}}, Pose{{0, 0, -0.05}, {0, 0, 0}}}) {
            const Mat3 from = rotation_matrix(world.pose(scene.box).rotation);
            world.move_to(scene.box, pose, dt);
            REQUIRE(world.advance(dt / 2).ok());
            const Mat3 half = rotation_matrix(world.pose(scene.box).rotation);
            const Real whole = rotation_vector(rotation_matrix(pose.rotation) * from.transpose()).norm();
            CHECK(rotation_vector(half * from.transpose()).norm() == Approx(whole / 2));
            REQUIRE(world.advance(dt / 2).ok());
            CHECK((world.pose(scene.box).position - pose.position).norm() < rounding);
            CHECK((rotation_matrix(world.pose(scene.box).rotation) - rotation_matrix(pose.rotation)).norm() < rounding);
        }
        REQUIRE(world.advance(0.1).ok());
        CHECK((world.pose(scene.box).position - Vec3(0, 0, -0.05)).norm() < rounding);
    }
}

TEST_CASE("a collider with a script of keys can be taken over, and others keep theirs", "[scene]") {
    World world(weightless());
    const Motion keys{.velocity = Vec3::Zero(),
                      .angular_velocity = Vec3::Zero(),
                      .keys = {{0, {0, 0, 0}, {0, 0, 0}}, {1, {1, 0, 0}, {0, 0, 0}}, {2, {1, 1, 0}, {0, 0, 0}}}};
    std::vector<ColliderHandle> boxes;
    for (int i = 0; i < 3; ++i) boxes.push_back(world.add_collider(Box{}, {.motion = keys}));
    const auto rubber = world.add_material({});
    world.add_body(mesh::ball(0.05, 2), {.material = rubber, .position = {0, 0, 9}});
    REQUIRE(world.advance(0.5).ok());
    world.set_velocity(boxes[0], {0, 0, 1});
    world.move_to(boxes[1], {{5, 0, 0}, {0, 0, 0}}, 0.5);
    REQUIRE(world.advance(0.5).ok());
    CHECK((world.pose(boxes[0]).position - Vec3(0.5, 0, 0.5)).norm() < rounding);
    CHECK((world.pose(boxes[1]).position - Vec3(5, 0, 0)).norm() < rounding);
    CHECK((world.pose(boxes[2]).position - Vec3(1, 0, 0)).norm() < rounding);
    world.remove(boxes[1]);
    REQUIRE(world.advance(0.5).ok());
    CHECK((world.pose(boxes[2]).position - Vec3(1, 0.5, 0)).norm() < rounding);
}

TEST_CASE("an attachment is led by the velocity that is set, to a target and to a pose", "[scene]") {
    World world(weightless());
    const auto rubber = world.add_material({.young_modulus = 1e5, .damping = 60});
    const Mesh mesh = mesh::box({0.2, 0.05, 0.05}, {8, 2, 2});
    const auto bar = world.add_body(mesh, {.material = rubber});
    std::vector<Index> end;
    for (std::size_t n = 0; n < mesh.nodes.size(); ++n)
        if (mesh.nodes[n].x() > 0.1 - 1e-9) end.push_back(static_cast<Index>(n));
    const auto hold = world.attach(bar, end, {}, {0.1, 0, 0});
    const auto at_end = [&] {
        return Vec3(world.positions(bar)[static_cast<std::size_t>(end[0])] -
                    mesh.nodes[static_cast<std::size_t>(end[0])]);
    };
    world.set_velocity(hold, {0.1, 0, 0});
    REQUIRE(world.advance(0.1).ok());
    CHECK((at_end() - Vec3(0.01, 0, 0)).norm() < rounding);
    world.move_to(hold, {{0.1, 0.02, 0}, {0, 0, 0}}, 0.05);
    REQUIRE(world.advance(0.05).ok());
    CHECK((at_end() - Vec3(0, 0.02, 0)).norm() < rounding);
    world.set_pose(hold, {{0.1, 0.021, 0}, {0, 0, 0}});
    CHECK((at_end() - Vec3(0, 0.021, 0)).norm() < rounding);
    CHECK((world.pose(hold).position - Vec3(0.1, 0.021, 0)).norm() < rounding);
    REQUIRE(world.advance(0.05).ok());
    CHECK((at_end() - Vec3(0, 0.021, 0)).norm() < rounding);
    const std::uint64_t before = world.state_hash();
    CHECK_THROWS_WITH(world.set_pose(hold, {{-0.2, 0, 0}, {0, 0, 0}}), Catch::Contains("tetrahedron"));
    CHECK(world.state_hash() == before);
}

TEST_CASE("a teleport touches nothing on the way, and overlaps at its end are treated as at a start", "[scene]") {
    for (const bool mesh : {false, true}) {
        BallOnBox scene(weightless(), mesh);
        World& world = scene.world;
        REQUIRE(world.advance(0.05).ok());
        const Vec3 before = world.center_of_mass(scene.ball);
        world.set_pose(scene.box, {{0, 0, 0.3}, {0, 0, 0}});  // the box passes through the ball
        REQUIRE(world.advance(0.05).ok());
        CHECK((world.center_of_mass(scene.ball) - before).norm() < 1e-9);
        world.set_velocity(scene.box, {0, 0, -1});
        REQUIRE(world.advance(0.25).ok());
        CHECK(world.center_of_mass(scene.ball).z() < before.z() - 0.01);
        // Moves the box into the ball, which has made steps and stays where it is.
        world.set_pose(scene.box, {world.center_of_mass(scene.ball) + Vec3(0, 0, 0.06), {0, 0, 0}});
        CHECK_THROWS_WITH(world.advance(1e-3), Catch::Contains("ball") && Catch::Contains("box"));
    }
}

TEST_CASE("a setter that gives the value that was there changes no bit", "[scene][determinism]") {
    const auto run = [](bool set) {
        Settings settings;
        settings.sleep_time = 0.1;
        BallOnBox scene(settings, true, {.sleep_speed = 1e-3});
        World& world = scene.world;
        const auto material = world.add_material({.young_modulus = 2e5});
        const auto bar = world.add_body(mesh::box({0.1, 0.02, 0.02}, {4, 1, 1}),
                                        {.material = material, .position = {0.6, 0, 0.2}, .name = "bar"});
        const auto hold = world.attach(bar, std::vector<Index>{0, 1}, {.velocity = {0, 0, 0.01}});
        world.move_to(scene.box, {{0, 0, 0.01}, {0, 0, 0.1}}, 0.05);
        for (int i = 0; i < 40; ++i) {
            REQUIRE(world.advance(0.01).ok());
            if (i == 6) world.set_velocity(scene.box, {0, 0, 0.05}, {0, 0, 0.2});
            if (i == 8) world.set_velocity(scene.box, {0, 0, 0});
            if (!set) continue;
            if (i > 8) world.set_velocity(scene.box, Vec3::Zero());
            world.set_pose(scene.box, {world.pose(scene.box).position, world.pose(scene.box).rotation});
            world.set_pose(hold, {world.pose(hold).position, world.pose(hold).rotation});
            world.set_velocity(hold, {0, 0, 0.01});
            for (const BodyHandle body : world.bodies()) {
                const std::vector<Vec3> x(world.positions(body).begin(), world.positions(body).end()),
                    v(world.velocities(body).begin(), world.velocities(body).end());
                world.set_positions(body, x);
                world.set_velocities(body, v);
                world.set_loads(body, std::vector<Vec3>(x.size(), Vec3::Zero()));
                world.set_surface_properties(body, {});
                world.set_collision_groups(body, 1, 0xffffffffu);
                world.set_collision(body, scene.box, true);
            }
            world.set_collision(scene.ball, bar, true);
            world.set_collision(scene.ball, scene.ball, false);
            world.set_collision_groups(scene.box, 1, 0xffffffffu);
            world.set_surface_properties(scene.box, {});
            world.set_gravity(world.settings().gravity);
            world.set_material(material, world.material(material));
        }
        return std::pair(world.state_hash(), world.report().pair_searches);
    };
    CHECK(run(true) == run(false));
}

TEST_CASE("a target that is set again as it was changes no bit", "[scene][determinism]") {
    BallOnBox one, other;
    one.world.move_to(one.box, {{0, 0, 0.02}, {0, 0, 0}}, 0.125);
    other.world.move_to(other.box, {{0, 0, 0.02}, {0, 0, 0}}, 0.125);
    REQUIRE(hash_after(one.world, 0.0625) == hash_after(other.world, 0.0625));
    other.world.move_to(other.box, {{0, 0, 0.02}, {0, 0, 0}}, 0.0625);
    CHECK(hash_after(one.world, 0.0625) == hash_after(other.world, 0.0625));
    other.world.move_to(other.box, {{0, 0, 0.02}, {0, 0, 0}}, 0.1);
    CHECK(hash_after(one.world, 0.0625) == hash_after(other.world, 0.0625));
}

TEST_CASE("refused calls name the object and change nothing", "[scene]") {
    BallOnBox scene;
    World& world = scene.world;
    REQUIRE(world.advance(0.01).ok());
    const std::uint64_t before = world.state_hash();
    const Real nan = std::nan("");
    using Catch::Contains;
    CHECK_THROWS_WITH(world.set_velocity(scene.box, {nan, 0, 0}), Contains("collider 'box'") && Contains("velocity"));
    CHECK_THROWS_WITH(world.set_velocity(scene.box, {0, 0, 0}, {0, nan, 0}), Contains("angular_velocity"));
    CHECK_THROWS_WITH(world.move_to(scene.box, {}, 0), Contains("duration") && Contains("a time > 0"));
    CHECK_THROWS_WITH(world.move_to(scene.box, {{nan, 0, 0}, {0, 0, 0}}, 1), Contains("position"));
    CHECK_THROWS_WITH(world.set_pose(scene.box, {{0, 0, 0}, {nan, 0, 0}}), Contains("rotation"));
    CHECK_THROWS_WITH(world.set_velocity(ColliderHandle{}, {0, 0, 0}), Contains("set_velocity"));
    CHECK_THROWS_WITH(world.set_velocity(AttachmentHandle{}, {0, 0, 0}), Contains("set_velocity"));
    CHECK(world.state_hash() == before);
}

TEST_CASE("a body at rest on a collider wakes when the collider gets a motion", "[scene]") {
    for (const bool mesh : {false, true})
        for (const Real speed : {0.1, -0.1}) {
            World world = tuned_world({.sleep_time = 0.1}, {.sleep_speed = 5e-3});
            const auto rubber =
                world.add_material({.young_modulus = 5e4, .density = 500, .friction = 0.5, .damping = 20});
            const Vec3 size(0.3, 0.3, 0.05);
            const auto box =
                mesh ? world.add_collider(mesh::boundary(mesh::box(size, {2, 2, 1}))) : world.add_collider(Box{size});
            const auto block =
                world.add_body(mesh::box({0.1, 0.1, 0.05}, {3, 3, 2}), {.material = rubber, .position = {0, 0, 0.051}});
            for (int i = 0; i < 300 && !world.asleep(block); ++i) REQUIRE(world.advance(0.01).ok());
            REQUIRE(world.asleep(block));
            const Real before = world.center_of_mass(block).z();
            world.set_velocity(box, {0, 0, speed});
            REQUIRE(world.advance(0.2).ok());
            CHECK(world.center_of_mass(block).z() - before == Approx(0.2 * speed).margin(2e-3));
        }
}

TEST_CASE("worlds that are controlled go on with the same bits on any number of threads, copied, saved and loaded",
          "[scene][determinism]") {
    const auto start = [](int threads) {
        Settings settings;
        settings.threads = threads;
        return BallOnBox(settings, true);
    };
    const auto control = [](World& world, const BallOnBox& scene, int from, int to) {
        for (int i = from; i < to; ++i) {
            if (i % 7 == 3)
                world.set_velocity(scene.box, {0.01 * i, 0, 0.05 * std::sin(0.5 * i)}, {0, 0, 0.1 * i});
            else if (i % 7 == 5)
                world.move_to(scene.box, {{0, 0, 0.001 * i}, {0, 0.01 * i, 0}}, 0.01);
            REQUIRE(world.advance(0.005).ok());
        }
        return world.state_hash();
    };
    BallOnBox one = start(1), two = start(2);
    CHECK(control(one.world, one, 0, 30) == control(two.world, two, 0, 30));
    World copy = one.world.clone();
    const TemporaryFolder folder;
    const std::filesystem::path file = folder.path() / "world.skerry";
    one.world.save(file);
    World loaded = World::load(file);
    const std::uint64_t expected = control(one.world, one, 30, 60);
    CHECK(control(copy, one, 30, 60) == expected);
    CHECK(control(loaded, one, 30, 60) == expected);
}

}  // namespace skerry::test::control_motion_test
