// Joints that mimic other joints, against closed forms (docs/methods/joints.md 5).
#include <array>
#include <catch2/catch.hpp>
#include <cmath>

#include "skerry/joint.h"
#include "tests/support/temporary_folder.h"
#include "tests/support/worlds.h"

namespace skerry::test::joint_mimic_test {

namespace {

using Catch::Matchers::Contains;

Settings settings_of(const Vec3& gravity, Index threads = 1, bool sleep = false) {
    Settings settings = accurate(gravity, 1e-12);
    settings.step_size = 1.0 / 500;
    settings.threads = threads;
    settings.sleep = sleep;
    return settings;
}

/// A free palm with two fingers of different mass on sliders along +y and -y. The second finger mimics the first, which
/// a motor opens. The palm turns.
struct Gripper {
    World world;
    BodyHandle palm, first, second;
    JointHandle leader, follower;

    explicit Gripper(Index threads = 1) : world(settings_of(Vec3::Zero(), threads)) {
        const MaterialHandle material = world.add_material({}), dense = world.add_material({.density = 3000});
        const auto add = [&](const Vec3& size, const Vec3& position, MaterialHandle body_material) {
            return world.add_body(mesh::box(size, {1, 1, 1}),
                                  {.material = body_material, .position = position, .dynamics = BodyDynamics::rigid});
        };
        palm = add({0.1, 0.2, 0.05}, {0, 0, 0}, material);
        first = add({0.02, 0.02, 0.1}, {0, 0.03, 0.08}, material);
        second = add({0.02, 0.02, 0.1}, {0, -0.03, 0.08}, dense);
        const auto join = [&](BodyHandle finger, Real side, std::optional<JointMotor> motor) {
            return Joints(world).add({.kind = JointKind::slider,
                                      .first = finger,
                                      .second = palm,
                                      .point = {0, 0.03 * side, 0.03},
                                      .axis = {0, side, 0},
                                      .motor = motor});
        };
        leader = join(first, 1, JointMotor{.speed = 0.05, .strength = 5});
        follower = join(second, -1, {});
        Joints(world).set_mimic(follower, JointMimic{.leader = leader});
        world.set_velocity(palm, {0.1, 0, 0}, {0.5, 1, 3});
    }
    JointState of_leader() { return Joints(world).state(leader); }
    JointState of_follower() { return Joints(world).state(follower); }
};

/// A rack of `mass` [kg] on a vertical slider and a wheel on a hinge, both on the world. The rack moves by `ratio` per
/// angle of the wheel [m/rad].
struct Rack {
    static constexpr Real mass = 2, inertia = 2e-3, ratio = 0.05;  // [kg], [kg m^2], [m/rad]
    World world;
    BodyHandle rack, wheel;
    JointHandle slider, hinge;

    explicit Rack(const Vec3& gravity = {0, 0, -standard_gravity}, bool sleep = false, Real offset = 0)
        : world(settings_of(gravity, 1, sleep)) {
        constexpr Real side = 0.1;
        const auto cube = [&](Real density, const Vec3& place) {
            return world.add_body(mesh::box({side, side, side}, {1, 1, 1}),
                                  {.material = world.add_material({.density = density}),
                                   .position = place,
                                   .dynamics = BodyDynamics::rigid});
        };
        rack = cube(mass / (side * side * side), {0, 0, 0});
        wheel = cube(inertia * 6 / std::pow(side, 5), {0, 0.5, 0});  // I = m side^2 / 6
        slider = Joints(world).add({.kind = JointKind::slider, .first = rack});
        hinge = Joints(world).add({.kind = JointKind::hinge, .first = wheel, .point = {0, 0.5, 0}, .axis = {1, 0, 0}});
        Joints(world).set_mimic(slider, JointMimic{.leader = hinge, .ratio = ratio, .offset = offset});
    }
};

}  // namespace

TEST_CASE("fingers that mimic each other move alike, and momentum is kept", "[scene][joints]") {
    Gripper gripper;
    const WorldReport start = gripper.world.report();
    Real most_apart = 0, most_faster = 0;
    for (int k = 0; k < 100; ++k) {
        REQUIRE(gripper.world.advance(0.005).ok());
        const JointState leader = gripper.of_leader(), follower = gripper.of_follower();
        most_apart = std::max(most_apart, std::abs(follower.coordinate - leader.coordinate));
        most_faster = std::max(most_faster, std::abs(follower.speed - leader.speed));
    }
    CHECK(gripper.of_leader().coordinate > 0.02);
    // Errors per step: (omega h)^3 times the distance from the centre, and h omega^2 times this distance.
    constexpr Real angle = 3.3 / 500, reach = 0.1;  // [rad], [m]
    CHECK(most_apart < angle * angle * angle * reach);
    CHECK(most_faster < 3.3 * angle * reach);
    const WorldReport end = gripper.world.report();
    CHECK((end.momentum - start.momentum).norm() < 1e-13 * start.momentum.norm());
    CHECK((end.angular_momentum - start.angular_momentum).norm() < 1e-12 * start.angular_momentum.norm());
    CHECK(end.energy_error_share < 1e-6);
}

TEST_CASE("without rotation, joints that mimic have equal speeds to rounding", "[scene][joints]") {
    Gripper gripper;
    gripper.world.set_velocity(gripper.palm, Vec3::Zero(), Vec3::Zero());
    REQUIRE(gripper.world.advance(0.3).ok());
    CHECK(gripper.of_leader().speed == Approx(0.05).epsilon(1e-4));
    CHECK(std::abs(gripper.of_follower().speed - gripper.of_leader().speed) < 1e-10);
}

TEST_CASE("a rack falls with the inertia of the wheel that it turns", "[scene][joints]") {
    Rack fall;
    const Real mass = Rack::mass + Rack::inertia / (Rack::ratio * Rack::ratio);  // [kg]
    const Real acceleration = -Rack::mass * standard_gravity / mass;
    REQUIRE(fall.world.advance(0.2).ok());
    const JointState rack = Joints(fall.world).state(fall.slider), wheel = Joints(fall.world).state(fall.hinge);
    // The joint rows hold to the tolerance of the solver.
    CHECK(rack.speed == Approx(acceleration * 0.2).epsilon(1e-9));
    CHECK(wheel.speed == Approx(rack.speed / Rack::ratio).epsilon(1e-9));
    CHECK(wheel.coordinate == Approx(rack.coordinate / Rack::ratio).epsilon(1e-9));
    CHECK(rack.mimic == Approx(Rack::mass * (standard_gravity + acceleration)).epsilon(1e-9));
    CHECK(fall.world.report().energy_error_share < 1e-9);
}

TEST_CASE("a joint moves to the offset of its mimic at a bounded speed", "[scene][joints]") {
    Rack still(Vec3::Zero(), false, 0.01);
    REQUIRE(still.world.advance(1).ok());
    const Real rack = Joints(still.world).state(still.slider).coordinate,
               wheel = Joints(still.world).state(still.hinge).coordinate;
    CHECK(rack == Approx(Rack::ratio * wheel + 0.01).margin(1e-10));
    // The impulse divides the offset in the ratio of the mobilities.
    const Real share = Rack::ratio * Rack::ratio / Rack::inertia;
    CHECK(rack == Approx(0.01 / (1 + share * Rack::mass)).epsilon(1e-3));
}

TEST_CASE("a mimic forgets its impulse when a body of its leader is reset", "[scene][joints]") {
    Rack fall;
    REQUIRE(fall.world.advance(0.1).ok());
    REQUIRE(Joints(fall.world).state(fall.slider).mimic > 1);
    fall.world.reset(fall.wheel);
    CHECK(Joints(fall.world).state(fall.slider).mimic == 0);
}

TEST_CASE("a joint mimics a leader between bodies that impulses cannot move", "[scene][joints]") {
    Rack held(Vec3::Zero());
    held.world.attach(held.wheel, std::array<Index, 4>{0, 1, 2, 4}, Motion{.angular_velocity = {2, 0, 0}}, {0, 0.5, 0});
    REQUIRE(held.world.advance(0.1).ok());
    CHECK(Joints(held.world).state(held.slider).speed == Approx(2 * Rack::ratio).epsilon(1e-9));
    CHECK(Joints(held.world).state(held.slider).coordinate == Approx(0.2 * Rack::ratio).epsilon(1e-6));
}

TEST_CASE("a mimic at rest converges although the squares of its velocities underflow", "[scene][joints]") {
    Settings settings;
    settings.gravity = Vec3::Zero();
    settings.threads = 1;
    World world(settings);
    const MaterialHandle material = world.add_material({.young_modulus = 1e6, .poisson_ratio = 0.3, .density = 1000});
    const auto add = [&](const Vec3& size, const std::array<int, 3>& cells, const Vec3& place) {
        return world.add_body(mesh::box(size, cells),
                              {.material = material, .position = place, .dynamics = BodyDynamics::rigid});
    };
    const BodyHandle base = add({0.02, 0.3, 0.02}, {1, 2, 1}, {0, 0.15, 0});
    world.attach(base, std::array<Index, 4>{0, 1, 2, 4});
    const auto arm = [&](Real y) {
        return Joints(world).add({.kind = JointKind::hinge,
                                  .first = add({0.1, 0.02, 0.02}, {2, 1, 1}, {0.06, y, 0}),
                                  .second = base,
                                  .point = {0, y, 0},
                                  .axis = {0, 1, 0}});
    };
    const JointHandle leader = arm(0.05);
    Joints(world).set_mimic(arm(0.25), JointMimic{.leader = leader});
    REQUIRE(world.advance(2).ok());
    CHECK(world.report().worst_error < 1e-3);
}

TEST_CASE("an unsolved region of joints is not said to have contacts", "[scene][joints]") {
    WorldReport report;
    report.worst_error = 1;
    CHECK(report.distrust().find("a region of joints or cables without contacts was left unsolved") == 0);
    report.worst_region = 3;
    CHECK(report.distrust().find("a contact region of 3 contacts was left unsolved") == 0);
}

TEST_CASE("mechanisms that only a mimic couples sleep and wake together", "[scene][joints]") {
    Rack rack({0, 0, -standard_gravity}, true);
    Joints(rack.world).set_motor(rack.hinge, JointMotor{.speed = 0, .strength = 10});
    REQUIRE(rack.world.advance(2).ok());
    CHECK(Joints(rack.world).state(rack.hinge).motor == Approx(Rack::mass * standard_gravity * Rack::ratio));
    REQUIRE(rack.world.asleep(rack.rack));
    REQUIRE(rack.world.asleep(rack.wheel));
    Joints(rack.world).set_motor(rack.hinge, JointMotor{.speed = 1, .strength = 10});
    REQUIRE(rack.world.advance(0.1).ok());
    CHECK_FALSE(rack.world.asleep(rack.rack));
    CHECK(Joints(rack.world).state(rack.slider).speed == Approx(Rack::ratio).epsilon(1e-6));
}

TEST_CASE("a world with mimics goes on bit by bit when it is cloned or saved, on any number of workers",
          "[scene][joints]") {
    Gripper one, three(3);
    REQUIRE(one.world.advance(0.1).ok());
    REQUIRE(three.world.advance(0.1).ok());
    CHECK(one.world.state_hash() == three.world.state_hash());
    TemporaryFolder folder;
    one.world.save(folder.path() / "gripper.skerry");
    World loaded = World::load(folder.path() / "gripper.skerry"), copy = one.world.clone();
    CHECK(Joints(loaded).mimic(one.follower) == Joints(one.world).mimic(one.follower));
    for (World* world : {&one.world, &three.world, &loaded, &copy}) REQUIRE(world->advance(0.1).ok());
    for (World* world : {&three.world, &loaded, &copy}) CHECK(world->state_hash() == one.world.state_hash());
}

TEST_CASE("a mimic survives the removal of other joints and ends with its leader", "[scene][joints]") {
    Gripper gripper;
    Joints joints(gripper.world);
    const JointHandle reverse =
        joints.add({.kind = JointKind::slider, .first = gripper.palm, .axis = {1, 0, 0}});  // moves to row 1
    joints.set_mimic(reverse, JointMimic{.leader = gripper.follower, .ratio = -2, .offset = 0.5});
    gripper.world.remove(gripper.first);
    CHECK_FALSE(joints.mimic(gripper.follower));
    const std::optional<JointMimic> mimic = joints.mimic(reverse);
    REQUIRE(mimic);
    CHECK(*mimic == JointMimic{.leader = gripper.follower, .ratio = -2, .offset = 0.5});
    REQUIRE(gripper.world.advance(0.01).ok());
    joints.set_mimic(reverse, {});
    CHECK_FALSE(joints.mimic(reverse));
}

TEST_CASE("a mimic names what is wrong with it", "[scene][joints]") {
    Gripper gripper;
    Joints joints(gripper.world);
    const JointHandle fixed = joints.add({.kind = JointKind::fixed, .first = gripper.palm});
    const auto refused = [&](JointHandle joint, const JointMimic& mimic, const char* text) {
        const std::uint64_t before = gripper.world.state_hash();
        CHECK_THROWS_WITH(joints.set_mimic(joint, mimic), Contains(text));
        CHECK(gripper.world.state_hash() == before);
    };
    refused(fixed, {.leader = gripper.leader}, "a fixed joint");
    refused(gripper.leader, {.leader = fixed}, "a fixed joint");
    refused(gripper.leader, {.leader = gripper.leader}, "this joint itself");
    refused(gripper.leader, {.leader = gripper.follower}, "a joint that mimics this joint");
    refused(gripper.follower, {.leader = gripper.leader, .ratio = 0}, "mimic.ratio");
    refused(gripper.follower, {.leader = gripper.leader, .offset = infinity}, "mimic.offset");
    const std::uint64_t before = gripper.world.state_hash();
    CHECK_THROWS_WITH(joints.set_mimic(gripper.leader, JointMimic{.leader = gripper.follower}),
                      !Contains("mimic.leader"));  // scenes have no such key
    CHECK(gripper.world.state_hash() == before);
}

TEST_CASE("joints that mimic each other need limits with a common position", "[scene][joints]") {
    Gripper gripper;
    Joints joints(gripper.world);
    const JointHandle third =
        joints.add({.kind = JointKind::slider, .first = gripper.palm, .axis = {1, 0, 0}, .lower = 0.1});
    joints.set_limits(gripper.leader, 0.0, 0.2);
    // third = 0.5 follower - 0.05 = 0.5 leader - 0.05, from -0.05 to 0.05
    const JointMimic mimic{.leader = gripper.follower, .ratio = 0.5, .offset = -0.05};
    CHECK_THROWS_WITH(joints.set_mimic(third, mimic),
                      Contains("joint: mimic: found limits") && Contains("at least 0.1 and at most 0.05"));
    CHECK_FALSE(joints.mimic(third));
    joints.set_limits(third, 0.05, {});
    joints.set_mimic(third, mimic);
    CHECK_THROWS_WITH(joints.set_limits(gripper.leader, -1.0, 0.1),
                      Contains("joint: lower, upper: found limits") && Contains("at least 0.2 and at most 0.1"));
    CHECK(joints.limits(gripper.leader).upper == 0.2);
    joints.set_mimic(third, {});
    joints.set_limits(gripper.leader, -1.0, 0.1);
}

TEST_CASE("a joint starts at the coordinate that it is given", "[scene][joints]") {
    for (const JointKind kind : {JointKind::hinge, JointKind::slider}) {
        World world(settings_of(Vec3::Zero()));
        const BodyHandle body = world.add_body(
            mesh::box({0.1, 0.1, 0.1}, {1, 1, 1}),
            {.material = world.add_material({}), .position = {0.3, 0, 0}, .dynamics = BodyDynamics::rigid});
        const JointHandle joint =
            Joints(world).add({.kind = kind,
                               .first = body,
                               .axis = {0, 0, 1},
                               .coordinate = 0.4,
                               .motor = JointMotor{.position = 0, .strength = 1e3, .fastest = 1}});
        CHECK(Joints(world).state(joint).coordinate == Approx(0.4));
        CHECK(Joints(world).state(joint).error < 1e-15);
        REQUIRE(world.advance(1).ok());
        CHECK(Joints(world).state(joint).coordinate == Approx(0).margin(1e-9));
        const Vec3 expected =
            kind == JointKind::hinge ? Vec3(0.3 * std::cos(0.4), -0.3 * std::sin(0.4), 0) : Vec3(0.3, 0, -0.4);
        CHECK((world.center_of_mass(body) - expected).norm() < 1e-6);
    }
}

}  // namespace skerry::test::joint_mimic_test
