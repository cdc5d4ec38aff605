// Handles and results of the last step, while bodies and colliders are added and removed and worlds are moved.
#include <array>
#include <catch2/catch.hpp>
#include <utility>
#include <vector>

#include "engine/world/tuning.h"
#include "skerry/problem.h"
#include "tests/support/worlds.h"

namespace skerry::test::world_life_test {

namespace {

/// Three boxes side by side on a plane.
struct ThreeBoxes {
    World world;
    MaterialHandle rubber;
    ColliderHandle floor;
    std::vector<BodyHandle> box;

    ThreeBoxes() : rubber(world.add_material({})), floor(world.add_collider(Plane{})) {
        for (int i = 0; i < 3; ++i) box.push_back(add(i));
        REQUIRE(world.advance(0.02).ok());
    }
    BodyHandle add(int place) {
        return world.add_body(mesh::box({0.1, 0.1, 0.1}, {1, 1, 1}),
                              {.material = rubber, .position = {0.3 * place, 0, 0.052}, .contact_distance = 0.002});
    }
    std::vector<Contact> contacts_of(BodyHandle body) const {
        std::vector<Contact> found;
        for (const Contact& contact : world.contacts())
            if (contact.first == body || contact.second == body) found.push_back(contact);
        return found;
    }
};

void check_same(const std::vector<Contact>& now, const std::vector<Contact>& before) {
    REQUIRE(now.size() == before.size());
    for (std::size_t c = 0; c < now.size(); ++c) {
        CHECK(now[c].first == before[c].first);
        CHECK(now[c].collider == before[c].collider);
        CHECK(now[c].node == before[c].node);
        CHECK(now[c].impulse == before[c].impulse);
        CHECK(now[c].point == before[c].point);
    }
}

}  // namespace

TEST_CASE("contacts of the others stay when a body is removed, and those of it go", "[scene]") {
    ThreeBoxes scene;
    const auto first = scene.contacts_of(scene.box[0]), last = scene.contacts_of(scene.box[2]);
    REQUIRE(first.size() >= 4);
    REQUIRE(scene.contacts_of(scene.box[1]).size() >= 4);
    scene.world.remove(scene.box[1]);
    check_same(scene.contacts_of(scene.box[0]), first);
    check_same(scene.contacts_of(scene.box[2]), last);
    CHECK(scene.contacts_of(scene.box[1]).empty());
    CHECK(scene.world.contacts().size() == first.size() + last.size());
    for (const Contact& contact : scene.world.contacts()) {
        CHECK(scene.world.alive(contact.first));
        CHECK(scene.world.alive(contact.collider));
    }
}

TEST_CASE("contacts stay when something is added, and those of a collider go with it", "[scene]") {
    ThreeBoxes scene;
    const auto first = scene.contacts_of(scene.box[0]);
    const BodyHandle added = scene.add(5);
    const ColliderHandle ball = scene.world.add_collider(Sphere{}, {.position = {0, 0, 9}});
    const Index node = 0;
    const AttachmentHandle held = scene.world.attach(added, {&node, 1});
    check_same(scene.contacts_of(scene.box[0]), first);
    scene.world.remove(held);
    scene.world.remove(ball);
    check_same(scene.contacts_of(scene.box[0]), first);
    scene.world.remove(scene.floor);
    CHECK(scene.world.contacts().empty());
    REQUIRE(scene.world.advance(0.001).ok());
    CHECK(scene.world.contacts().empty());
}

TEST_CASE("a world is changed and advanced between steps only, also by callbacks", "[scene]") {
    ThreeBoxes scene;
    World& world = scene.world;
    int calls = 0;
    const auto try_all = [&] {
        ++calls;
        CHECK_THROWS_WITH(world.advance(0.01), Catch::Contains("advance: found a call during advance()"));
        CHECK_THROWS_WITH(scene.add(7), Catch::Contains("add_body: found a call during advance()"));
        CHECK_THROWS_AS(world.add_material({}), SceneError);
        CHECK_THROWS_AS(world.add_collider(Plane{}), SceneError);
        CHECK_THROWS_AS(world.attach(scene.box[0], std::array<Index, 1>{0}), SceneError);
        CHECK_THROWS_AS(world.remove(scene.box[0]), SceneError);
        CHECK_THROWS_AS(world.remove(scene.floor), SceneError);
        CHECK_FALSE(world.contacts().empty());
    };
    const std::uint64_t steps = world.report().steps;
    world.watch_contact_problems([&](const StepProblem&) { try_all(); });
    REQUIRE(world.advance(2 * world.stable_step()).ok());
    world.watch_contact_problems({});
    REQUIRE(world
                .advance(2 * world.stable_step(),
                         [&](const StepReport&) {
                             try_all();
                             return true;
                         })
                .ok());
    CHECK(calls == static_cast<int>(world.report().steps - steps));
    CHECK(world.bodies().size() == 3);
    world.remove(scene.box[0]);  // allowed again between calls, also after a call that ended with an exception
    CHECK_THROWS_AS(world.advance(0.01, [](const StepReport&) -> bool { throw SceneError("mine"); }), SceneError);
    world.remove(scene.box[1]);
    CHECK(world.advance(0.01).ok());
}

TEST_CASE("advance ends between two steps when a callback requests it, and continues from there", "[scene]") {
    for (const Integrator integrator : {Integrator::symplectic_euler, Integrator::leapfrog}) {
        CAPTURE(name_of(integrator));
        Settings settings;
        settings.integrator = integrator;
        BlockOnPlane stopped(settings, {}), whole(settings, {});
        const Real h = stopped.world.stable_step();
        const StepReport report =
            stopped.world.advance(100 * h, [](const StepReport& so_far) { return so_far.steps < 7; });
        CHECK(report.status == StepStatus::stopped);
        CHECK_FALSE(report.ok());
        CHECK(report.steps == 7);
        CHECK(stopped.world.time() == Approx(7 * h));
        CHECK_THAT(report.message(), Catch::Contains("stopped"));
        REQUIRE(stopped.world.advance(100 * h - stopped.world.time()).ok());
        REQUIRE(whole.world.advance(100 * h).ok());
        CHECK(stopped.world.time() == Approx(whole.world.time()));
        const Vec3 apart = stopped.world.center_of_mass(stopped.block) - whole.world.center_of_mass(whole.block);
        CHECK(apart.norm() < 1e-9);  // [m]; step times differ by rounding
        const std::uint64_t before = stopped.world.state_hash();
        const StepReport none = stopped.world.advance(h, [](const StepReport&) { return false; });
        CHECK(none.steps == 0);
        CHECK(none.status == StepStatus::stopped);
        CHECK(stopped.world.state_hash() == before);
    }
}

TEST_CASE("a handle of another world names nothing", "[scene]") {
    ThreeBoxes one, other;
    REQUIRE(one.box[1].slot == other.box[1].slot);
    CHECK(one.box[1] != other.box[1]);
    CHECK(one.world.alive(one.box[1]));
    CHECK_FALSE(one.world.alive(other.box[1]));
    CHECK_FALSE(one.world.alive(other.floor));
    CHECK_THROWS_WITH(one.world.positions(other.box[1]),
                      Catch::Contains("positions: body: found a handle without an object"));
    CHECK_THROWS_AS(one.world.remove(other.floor), SceneError);
    CHECK_THROWS_AS(one.world.add_body(mesh::box({1, 1, 1}, {1, 1, 1}), {.material = other.rubber}), SceneError);
    CHECK(one.world.bodies() == one.box);
}

TEST_CASE("handles move with a moved world, and the empty world refuses all calls", "[scene]") {
    ThreeBoxes scene;
    World moved = std::move(scene.world);
    CHECK(moved.alive(scene.box[0]));
    CHECK(moved.advance(0.001).ok());
    const World& left = scene.world;
    const auto said = Catch::Contains("world: found a moved-from world");
    CHECK_THROWS_WITH(scene.world.advance(0.001), said);
    CHECK_THROWS_WITH(scene.world.add_material({}), said);
    CHECK_THROWS_WITH(scene.world.remove(scene.box[0]), said);
    CHECK_THROWS_WITH(left.alive(scene.box[0]), said);
    CHECK_THROWS_WITH(left.contacts(), said);
    CHECK_THROWS_WITH(left.time(), said);
    CHECK_THROWS_WITH(left.report(), said);
    CHECK_THROWS_WITH(left.state_hash(), said);
    CHECK_THROWS_WITH(left.bodies(), said);
    scene.world = std::move(moved);
    CHECK(scene.world.alive(scene.box[0]));
    CHECK(scene.world.advance(0.001).ok());
}

TEST_CASE("many changes in a row give the same bits as with a query after each change", "[scene]") {
    const auto built = [](auto look) {
        Settings settings;
        settings.start_overlaps = StartOverlaps::ignore;  // some balls are added overlapping others
        settings.sleep_time = 0.02;
        World world = tuned_world(settings, {.sleep_speed = 0.05});
        const auto rubber = world.add_material({.young_modulus = 3e4});
        const ColliderHandle floor = world.add_collider(Plane{});
        const Mesh mesh = mesh::ball(0.05, 3);
        std::vector<BodyHandle> balls;
        const auto add = [&](int i) {
            balls.push_back(world.add_body(mesh, {.material = rubber, .position = {0.11 * (i % 3), 0.02 * i, 0.055}}));
            look(world);
        };
        for (int i = 0; i < 5; ++i) add(i);
        REQUIRE(world.advance(0.2).ok());
        world.set_velocities(balls[0], std::vector<Vec3>(mesh.nodes.size(), Vec3(0.1, 0, 0.2)));
        world.remove(balls[1]);
        look(world);
        for (int i = 5; i < 8; ++i) add(i);
        const AttachmentHandle held = world.attach(balls[2], std::array<Index, 2>{0, 1});
        look(world);
        world.add_collider(mesh::boundary(mesh::box({0.1, 0.1, 0.1}, {1, 1, 1})), {.position = {0.05, 0.3, 0.2}});
        look(world);
        const ColliderHandle wall = world.add_collider(Box{}, {.position = {2, 0, 0}});
        look(world);
        world.remove(wall);
        world.remove(floor);
        look(world);
        world.add_collider(Plane{});
        look(world);
        for (const BodyHandle ball : {balls[0], balls[2], balls[6]}) CHECK_FALSE(world.asleep(ball));
        world.remove(held);
        REQUIRE(world.advance(0.1).ok());
        return world.state_hash();
    };
    const std::uint64_t expected = built([](World&) {});
    CHECK(built([](World& world) { world.stable_step(); }) == expected);
    CHECK(built([](World& world) {
              world.report();
              world.state_hash();
          }) == expected);
}

TEST_CASE("bodies of one mesh have the same bits whether data of the first are reused or computed again", "[scene]") {
    // Turned and unturned bodies, linear and smoothed elements, several materials: stored data are separate or rotated.
    const auto falls = [](bool look) {
        World world;
        const std::array<MaterialHandle, 3> material{
            world.add_material({.young_modulus = 1e5}),
            world.add_material({.young_modulus = 2e5, .loss_factor = 0.1}),
            world.add_material({.young_modulus = 1e5, .model = MaterialModel::linear}),
        };
        const std::array<Mesh, 3> mesh{mesh::ball(0.05, 3), mesh::box({0.1, 0.1, 0.05}, {3, 3, 2}),
                                       mesh::ball(0.06, 3)};
        std::vector<BodyHandle> bodies;
        for (int i = 0; i < 24; ++i) {
            const auto at = static_cast<std::size_t>(i);
            const Vec3 turn = i % 4 == 0 ? Vec3(0, 0, 0) : Vec3(0.3 * i, 0.2, -0.1 * i);
            bodies.push_back(
                world.add_body(mesh[at % 3], {.material = material[at / 3 % 3],
                                              .position = {0.2 * (i % 5), 0.2 * (i / 5), 0.3},
                                              .rotation = turn,
                                              .angular_velocity = {5, 0, 3},
                                              .element = i < 12 ? ElementKind::linear : ElementKind::smoothed}));
            if (look) CHECK(world.positions(bodies.back()).size() == mesh[at % 3].nodes.size());  // completes set-up
        }
        const Real step = world.stable_step();
        REQUIRE(world.advance(0.01).ok());
        return std::pair(step, world.state_hash());
    };
    CHECK(falls(false) == falls(true));
}

}  // namespace skerry::test::world_life_test
