// Inputs, results and ends of rollouts. tests/determinism compares their values with those of a loop.
#include <catch2/catch.hpp>
#include <cmath>
#include <limits>
#include <stdexcept>
#include <thread>

#include "skerry/cable.h"
#include "skerry/cavity.h"
#include "skerry/fibre.h"
#include "skerry/joint.h"
#include "skerry/load.h"
#include "skerry/rollout.h"
#include "skerry/spring.h"

namespace skerry::test::rollout_test {

namespace {

constexpr Real none = std::numeric_limits<Real>::quiet_NaN();

/// A soft cube that falls onto a plane, a rigid lever on a hinge, and a slider of the same size beside it.
struct Yard {
    World world;
    MaterialHandle rubber;
    BodyHandle cube, lever, sled;
    ColliderHandle floor;
    AttachmentHandle clamp;
    JointHandle hinge, slider;

    Yard() {
        rubber = world.add_material({.young_modulus = 1e5, .friction = 0.5, .loss_factor = 0.1});
        floor = world.add_collider(Plane{}, {.name = "floor"});
        cube = world.add_body(mesh::box({0.1, 0.1, 0.1}, {2, 2, 2}),
                              {.material = rubber, .position = {0, 0, 0.5}, .name = "cube"});
        const BodySettings rigid{
            .material = rubber, .position = {1, 0, 0.5}, .dynamics = BodyDynamics::rigid, .name = "lever"};
        lever = world.add_body(mesh::box({0.2, 0.05, 0.05}, {2, 1, 1}), rigid);
        BodySettings beside = rigid;
        beside.position.y() = 1;
        beside.name = "sled";
        sled = world.add_body(mesh::box({0.2, 0.05, 0.05}, {2, 1, 1}), beside);
        const std::vector<Index> corner{0, 1, 2};
        clamp = world.attach(cube, corner);
        Joints joints(world);
        hinge = joints.add({.kind = JointKind::hinge,
                            .first = lever,
                            .point = {0.9, 0, 0.5},
                            .axis = {0, 1, 0},
                            .motor = JointMotor{.position = 0, .strength = 20, .fastest = 2}});
        slider = joints.add({.kind = JointKind::slider, .first = sled, .point = {1, 1, 0.5}, .axis = {1, 0, 0}});
    }
};

RolloutSettings calls(std::size_t intervals, std::vector<RolloutControl> controls,
                      std::vector<RecordedProbe> record = {}) {
    return {
        .intervals = intervals, .dt = 0.01, .controls = std::move(controls), .record = std::move(record), .threads = 2};
}

void check_refused(const Yard& yard, const RolloutSettings& settings, const std::vector<std::string>& parts,
                   std::size_t worlds = 2) {
    std::string message;
    try {
        rollout(yard.world, worlds, settings);
    } catch (const SceneError& error) {
        message = error.what();
    }
    INFO(message);
    REQUIRE_FALSE(message.empty());
    for (const std::string& part : parts) CHECK_THAT(message, Catch::Contains(part));
}

}  // namespace

TEST_CASE("settings and controls of a rollout are refused with the control, the world, the interval and the reason",
          "[unit]") {
    const Yard yard;
    std::vector<Real> poses(2 * 5 * 6, 0);
    const RolloutControl pose{PoseControl{yard.floor}, poses};
    check_refused(yard, calls(5, {}), {"worlds", "at least one"}, 0);
    check_refused(yard, calls(0, {}), {"intervals", "0"});
    check_refused(yard, calls(std::numeric_limits<std::size_t>::max() / 2, {}), {"intervals", "2147483647"});
    for (const Real dt : {0.0, -1.0, none, infinity}) {
        RolloutSettings settings = calls(5, {});
        settings.dt = dt;
        check_refused(yard, settings, {"dt", "> 0"});
    }
    RolloutSettings negative = calls(5, {});
    negative.threads = -3;
    check_refused(yard, negative, {"threads", "-3"});
    World late = yard.world.clone();
    REQUIRE(late.advance(0.1).ok());
    RolloutSettings tiny = calls(5, {});
    tiny.dt = 1e-18;
    CHECK_NOTHROW(rollout(yard.world, 1, tiny));
    CHECK_THROWS_WITH(rollout(std::vector<const World*>{&yard.world, &late}, tiny),
                      Catch::Contains("dt: found 1e-18, expected") && Catch::Contains("0.1 s, the time of world 1"));

    check_refused(yard, calls(6, {pose}), {"controls[0] (pose of collider 'floor')", "60 values", "72", "36"});
    poses[31] = none;
    check_refused(yard, calls(5, {pose}),
                  {"controls[0] (pose of collider 'floor')", "world 1, interval 0, number 1", "nan", "finite"});
    poses[31] = 0;
    check_refused(yard, calls(5, {pose, {VelocityControl{yard.floor}, poses}}),
                  {"controls[1] (velocity of collider 'floor')", "controls[0] also controls"});
    const std::vector<Real> targets(5, 1), forces(5 * 3, 1);
    check_refused(yard,
                  calls(5, {{MotorSpeedControl{yard.hinge}, targets}, {MotorPositionControl{yard.hinge}, targets}}),
                  {"controls[1] (motor position of joint 'joint_0')", "controls[0]"});
    check_refused(yard, calls(5, {{MotorSpeedControl{yard.slider}, targets}}),
                  {"controls[0]", "joint 'joint_1'", "no motor", "set_motor"});
    check_refused(yard, calls(5, {{BodyForceControl{yard.cube}, forces}, {NodeForceControl{yard.cube}, forces}}),
                  {"controls[1] (forces on the nodes of body 'cube')", "controls[0]"});
    check_refused(yard, calls(5, {{NodeForceControl{yard.cube}, forces}}),
                  {"15 values", "numbers " + std::to_string(3 * yard.world.positions(yard.cube).size())});
    check_refused(yard, calls(5, {{GravityControl{}, forces}, {GravityControl{}, forces}}),
                  {"controls[1] (gravity)", "controls[0]"});
    check_refused(yard, calls(5, {{PoseControl{ColliderHandle{}}, poses}}), {"controls[0]", "world 0", "collider"});
    check_refused(yard, calls(5, {}, {{"gone", BodyForceProbe{yard.cube, ColliderHandle{}}}}), {"\"gone\""});
    check_refused(yard, calls(5, {}, {{"one", EnergyProbe{}}, {"one", EnergyProbe{}}}), {"\"one\"", "different name"});
    check_refused(yard, calls(5, {}, {{"far", StressProbe{yard.cube, {999}}}}), {"\"far\"", "node 999"});

    CHECK_NOTHROW(rollout(yard.world, 2, calls(5, {pose})));
}

TEST_CASE("worlds of a rollout must be copies of one world", "[unit]") {
    const Yard yard, other;
    World added = yard.world.clone(), removed = yard.world.clone(), more = yard.world.clone();
    removed.remove(yard.clamp);
    const BodyHandle small = added.add_body(mesh::box({0.1, 0.1, 0.1}, {1, 1, 1}), {.material = yard.rubber});
    const BodyHandle large = more.add_body(mesh::box({0.1, 0.1, 0.1}, {3, 3, 3}), {.material = yard.rubber});
    REQUIRE(small == large);
    const std::vector<Real> poses(6, 0), forces(3 * added.positions(small).size(), 0);
    const auto refused = [](const std::vector<const World*>& worlds, const RolloutSettings& settings,
                            const std::string& part) {
        CHECK_THROWS_WITH(rollout(worlds, settings), Catch::Contains(part));
    };
    refused({&yard.world, &other.world}, calls(1, {{PoseControl{yard.floor}, poses}}),
            "controls[0]: number of values per interval: world 1: ");
    refused({&yard.world, &removed}, calls(1, {{PoseControl{yard.clamp}, poses}}),
            "controls[0]: number of values per interval: world 1: ");
    try {
        rollout(std::vector<const World*>{&yard.world, &removed}, calls(1, {{PoseControl{yard.clamp}, poses}}));
    } catch (const SceneError& error) {
        CHECK(error.complaint().object == "controls[0]: number of values per interval");
        CHECK(error.complaint().field == "world 1: attachment");
        CHECK_FALSE(error.complaint().expected.empty());
    }
    refused({&added, &more}, calls(1, {{NodeForceControl{small}, forces}}),
            "world 1: found 192, expected 24 as in world 0");
    refused({&added, &more}, calls(1, {}, {{"nodes", NodesProbe{small}}}),
            "world 1: found 192, expected 24 as in world 0");
    refused({&yard.world, nullptr}, calls(1, {}), "null pointer");
}

TEST_CASE("every control has the effect of its function", "[unit]") {
    Yard yard;
    const Anchor of_cube{.body = yard.cube, .point = {0, 0, 0.5}}, above{.point = {0, 0, 1}};
    const auto spring = Springs(yard.world).add({.first = of_cube, .second = above, .stiffness = 10});
    const auto shake = Loads(yard.world).add(AccelerationField{.acceleration = {0, 0, 9}, .scale = 0});
    const auto muscle = Fibres(yard.world).add({.body = yard.cube});
    Cables cables(yard.world);
    const auto pulled = cables.add({.points = {of_cube, above}, .drive = {.tension = TimeTable(0)}}),
               wound = cables.add({.points = {{.body = yard.lever, .point = {1, 0, 0.5}}, {.point = {1, 0, 0}}},
                                   .drive = {.rate = TimeTable(0)}});
    Cavities cavities(yard.world);
    const std::vector faces{yard.world.surface(yard.cube)[0]};
    const auto pressed = cavities.add({.body = yard.cube, .faces = faces, .filling = TimeTable(0)}),
               gas = cavities.add({.body = yard.cube, .faces = faces, .filling = GasFilling{}, .volume = 1e-3}),
               liquid = cavities.add({.body = yard.cube,
                                      .faces = faces,
                                      .filling = LiquidFilling{.bulk_modulus = 1e3, .ambient = 0},
                                      .volume = 1e-3});
    const auto vent = cavities.add(PipeSettings{.first = gas, .conductance = 1e-6});
    constexpr std::size_t intervals = 4;
    const auto end_of = [&](const RolloutControl& control) {
        RolloutSettings settings = calls(intervals, {control});
        settings.keep_worlds = true;
        RolloutResult result = rollout(yard.world, 1, settings);
        REQUIRE(result.status[0].ok());
        return result.worlds[0].state_hash();
    };
    const auto end_by_hand = [&](auto&& command) {
        World world = yard.world.clone();
        for (std::size_t i = 0; i < intervals; ++i) {
            command(world, static_cast<Real>(i + 1));
            REQUIRE(world.advance(0.01).ok());
        }
        return world.state_hash();
    };
    std::vector<Real> six, three, one, nodes;
    const std::size_t node_count = yard.world.positions(yard.cube).size();
    for (std::size_t i = 1; i <= intervals; ++i) {
        const Real t = static_cast<Real>(i);
        six.insert(six.end(), {1e-3 * t, 0, -1e-3 * t, 0, 0.01 * t, 0});
        three.insert(three.end(), {0, 0.1 * t, -t});
        one.push_back(0.02 * t);
        for (std::size_t n = 0; n < node_count; ++n)
            nodes.insert(nodes.end(), {0, 1e-3 * t, 1e-4 * static_cast<Real>(n)});
    }
    const auto pose = [](Real t) { return Pose{{1e-3 * t, 0, -1e-3 * t}, {0, 0.01 * t, 0}}; };
    CHECK(end_of({PoseControl{yard.floor}, six}) ==
          end_by_hand([&](World& world, Real t) { world.move_to(yard.floor, pose(t), 0.01); }));
    CHECK(end_of({PoseControl{yard.clamp}, six}) ==
          end_by_hand([&](World& world, Real t) { world.move_to(yard.clamp, pose(t), 0.01); }));
    CHECK(end_of({VelocityControl{yard.floor}, six}) == end_by_hand([&](World& world, Real t) {
              world.set_velocity(yard.floor, pose(t).position, pose(t).rotation);
          }));
    CHECK(end_of({VelocityControl{yard.clamp}, six}) == end_by_hand([&](World& world, Real t) {
              world.set_velocity(yard.clamp, pose(t).position, pose(t).rotation);
          }));
    CHECK(end_of({MotorSpeedControl{yard.hinge}, one}) == end_by_hand([&](World& world, Real t) {
              Joints(world).set_motor(yard.hinge, JointMotor{.speed = 0.02 * t, .strength = 20, .fastest = 2});
          }));
    CHECK(end_of({MotorPositionControl{yard.hinge}, one}) == end_by_hand([&](World& world, Real t) {
              Joints(world).set_motor(yard.hinge, JointMotor{.position = 0.02 * t, .strength = 20, .fastest = 2});
          }));
    CHECK(end_of({GravityControl{}, three}) == end_by_hand([&](World& world, Real t) {
              world.set_gravity({0, 0.1 * t, -t});
          }));
    CHECK(end_of({NodeForceControl{yard.cube}, nodes}) == end_by_hand([&](World& world, Real t) {
              std::vector<Vec3> load;
              for (std::size_t n = 0; n < node_count; ++n) load.push_back({0, 1e-3 * t, 1e-4 * static_cast<Real>(n)});
              world.set_loads(yard.cube, load);
          }));
    CHECK(end_of({PoseControl{yard.floor}, six}) != end_by_hand([](World&, Real) {}));

    const auto same_value = [&](auto object, auto&& command) {
        CHECK(end_of({ValueControl{object}, one}) ==
              end_by_hand([&](World& world, Real t) { command(world, TimeTable(0.02 * t)); }));
        CHECK(end_of({ValueControl{object}, one}) != end_by_hand([](World&, Real) {}));
    };
    same_value(spring, [&](World& world, const TimeTable& x) { Springs(world).set_rest_length(spring, x); });
    same_value(shake, [&](World& world, const TimeTable& x) { Loads(world).set_scale(shake, x); });
    same_value(muscle, [&](World& world, const TimeTable& x) { Fibres(world).set_tension(muscle, x); });
    same_value(pulled, [&](World& world, const TimeTable& x) { Cables(world).set_drive(pulled, {.tension = x}); });
    same_value(wound, [&](World& world, const TimeTable& x) { Cables(world).set_drive(wound, {.rate = x}); });
    same_value(pressed, [&](World& world, const TimeTable& x) { Cavities(world).set_pressure(pressed, x); });
    same_value(gas, [&](World& world, const TimeTable& x) { Cavities(world).set_inflow(gas, x); });
    same_value(liquid, [&](World& world, const TimeTable& x) { Cavities(world).set_liquid_volume(liquid, x); });
    same_value(vent, [&](World& world, const TimeTable& x) { Cavities(world).set_reservoir(vent, x); });
}

TEST_CASE("a force on a body accelerates its centre of mass and does not rotate it", "[unit]") {
    World world({.gravity = {0, 0, 0}});
    const auto rubber = world.add_material({.young_modulus = 1e6});
    Mesh uneven = mesh::box({0.3, 0.1, 0.2}, {3, 1, 2});  // the mean of its nodes is not its centre of mass
    for (Vec3& node : uneven.nodes) node.x() += 2 * node.x() * node.x();
    const BodyHandle box = world.add_body(uneven, {.material = rubber, .dynamics = BodyDynamics::rigid});
    const std::vector<Real> force{0, 0, 2, 0, 0, 2, 0, 0, 0};
    const RolloutResult result = rollout(
        world, 1, calls(3, {{BodyForceControl{box}, force}}, {{"box", VelocityProbe{box}}, {"pose", PoseProbe{box}}}));
    REQUIRE(result.status[0].ok());
    const std::vector<Real>& velocity = result.series[0].values;
    const Real reached = 2 * 0.02 / world.mass(box);
    CHECK(velocity[2 * 6 + 2] == Approx(reached).epsilon(1e-9));
    for (const std::size_t zero : {0, 1, 3, 4, 5}) CHECK(std::abs(velocity[2 * 6 + zero]) < 1e-9 * reached);
    CHECK(result.series[1].columns[3].heading() == "pose.rotation_x [rad]");
    for (const std::size_t angle : {3, 4, 5}) CHECK(std::abs(result.series[1].values[2 * 6 + angle]) < 1e-12);
}

TEST_CASE("a world whose step is refused ends with a reason and rows of NaN, and the others continue", "[unit]") {
    const Yard yard;
    constexpr std::size_t worlds = 4, intervals = 6;
    std::vector<Real> force(worlds * intervals * 3, 0);
    for (std::size_t i = 3; i < intervals; ++i)
        force[(2 * intervals + i) * 3] = 1e300;  // in world 2, from interval 3 on
    RolloutSettings settings =
        calls(intervals, {{BodyForceControl{yard.cube}, force}}, {{"cube", BodyProbe{yard.cube}}});
    settings.keep_worlds = true;
    const RolloutResult result = rollout(yard.world, worlds, settings);
    for (std::size_t w = 0; w < worlds; ++w) {
        CAPTURE(w, result.status[w].message());
        CHECK(result.status[w].ok() == (w != 2));
        CHECK(result.status[w].intervals == (w == 2 ? 3 : intervals));
        for (std::size_t i = 0; i < intervals; ++i) {
            CHECK(std::isnan(result.time[w * intervals + i]) == (w == 2 && i >= 3));
            for (std::size_t c = 0; c < 9; ++c)
                CHECK(std::isnan(result.series[0].values[(w * intervals + i) * 9 + c]) == (w == 2 && i >= 3));
        }
    }
    CHECK_THAT(result.status[2].message(), Catch::Contains("cube"));
    CHECK(result.status[2].report.body == yard.cube);
    REQUIRE(result.worlds.size() == worlds);
    CHECK(result.worlds[2].time() == Approx(0.03));
}

TEST_CASE("a world that advance refuses to start ends with the message, and the others go on", "[unit]") {
    Settings settings;
    settings.start_overlaps = StartOverlaps::refuse;
    World world(settings);
    const auto rubber = world.add_material({.young_modulus = 1e5});
    world.add_collider(Plane{});
    const BodyHandle cube = world.add_body(mesh::box({0.1, 0.1, 0.1}, {2, 2, 2}),
                                           {.material = rubber, .position = {0, 0, 0.5}, .name = "cube"});
    RolloutSettings run = calls(2, {}, {{"cube", BodyProbe{cube}}});
    run.prepare = [&](World& copy, std::size_t number) {
        if (number == 1) copy.set_pose(cube, Pose{{0, 0, 0.02}, {0, 0, 0}});
    };
    const RolloutResult result = rollout(world, 3, run);
    CHECK(result.status[0].ok());
    CHECK(result.status[2].ok());
    CHECK_FALSE(result.status[1].ok());
    CHECK(result.status[1].intervals == 0);
    CHECK_THAT(result.status[1].message(), Catch::Contains("cube") && Catch::Contains("overlap"));
}

TEST_CASE("a world in which a control fails ends with the name of the control, and the others go on", "[unit]") {
    const Yard yard;
    const std::vector<Real> poses(3 * 6, 0), targets(3, 0.1);
    RolloutSettings settings = calls(3, {{MotorSpeedControl{yard.hinge}, targets}, {PoseControl{yard.clamp}, poses}});
    settings.prepare = [&](World& copy, std::size_t number) {
        if (number == 1) copy.remove(yard.clamp);
    };
    const RolloutResult result = rollout(yard.world, 3, settings);
    CHECK(result.status[0].ok());
    CHECK(result.status[2].ok());
    CHECK(result.status[1].intervals == 0);
    CHECK_THAT(result.status[1].message(), Catch::StartsWith("controls[1]: ") && Catch::Contains("attachment"));
}

TEST_CASE("`go_on` may read the worlds of a rollout but not change them", "[unit]") {
    Yard yard;
    RolloutSettings settings = calls(1000000, {});
    const std::uint64_t before = yard.world.state_hash();
    const auto run = [&](auto&& call) {
        settings.go_on = [&](const RolloutProgress&) {
            call();
            return false;
        };
        rollout(yard.world, 2, settings);
    };
    const auto refuses = [&](auto&& change) {
        CHECK_THROWS_WITH(run(change), Catch::Contains("found a call during advance() or rollout()"));
    };
    refuses([&] { yard.world.advance(0.01); });
    refuses([&] { yard.world.set_gravity({0, 0, 0}); });
    refuses([&] { rollout(yard.world, 1, calls(1, {})); });
    CHECK_NOTHROW(run([&] { CHECK(yard.world.contacts().empty()); }));
    CHECK(yard.world.state_hash() == before);
    CHECK(yard.world.advance(0.01).ok());
}

TEST_CASE("an exception of `prepare` ends a rollout", "[unit]") {
    const Yard yard;
    RolloutSettings settings = calls(3, {});
    settings.prepare = [](World&, std::size_t number) {
        if (number >= 2) throw std::runtime_error("world " + std::to_string(number));
    };
    CHECK_THROWS_WITH(rollout(yard.world, 8, settings), "world 2");
}

TEST_CASE("`go_on` runs on the calling thread, counts up, and ends a rollout within an interval", "[unit]") {
    const Yard yard;
    const std::thread::id caller = std::this_thread::get_id();
    RolloutSettings settings = calls(1000000, {}, {{"energy", EnergyProbe{}}});  // to the end it takes hours
    settings.keep_worlds = true;
    std::size_t polls = 0, done = 0;
    bool wait = true;  // true: goes on until an interval is completed
    settings.go_on = [&](const RolloutProgress& progress) {
        CHECK(std::this_thread::get_id() == caller);
        CHECK(progress.worlds == 3);
        CHECK(progress.worlds_done == 0);
        CHECK(progress.intervals_done >= done);
        done = progress.intervals_done;
        return ++polls < 10 || (wait && done == 0);
    };
    const auto check_stopped = [&] {
        const RolloutResult result = rollout(yard.world, 3, settings);
        CHECK(result.worlds.empty());
        for (const RolloutStatus& status : result.status) {
            CHECK(status.report.status == StepStatus::stopped);
            CHECK(status.intervals < settings.intervals);
        }
        CHECK(std::isnan(result.series[0].values.back()));
        return result.status[0].intervals;
    };
    CHECK(check_stopped() > 0);
    CHECK(polls >= 10);
    CHECK(done > 0);

    settings.intervals = 1;
    settings.dt = 1e5;
    settings.threads = 3;
    polls = done = 0;
    wait = false;
    CHECK(check_stopped() == 0);

    settings.go_on = [](const RolloutProgress&) -> bool { throw std::runtime_error("interrupted"); };
    CHECK_THROWS_WITH(rollout(yard.world, 3, settings), "interrupted");
}

TEST_CASE("a rollout in which contacts stay badly unsolved says so", "[unit]") {
    Settings settings;
    settings.max_iterations = 1;
    settings.method = SolverMethod::pgs;
    settings.tolerance = 1e-9;
    World world(settings);
    const auto rubber = world.add_material({.young_modulus = 1e6, .friction = 0.8});
    world.add_collider(Plane{});
    for (int i = 0; i < 10; ++i)
        world.add_body(mesh::box({0.2, 0.2, 0.1}, {1, 1, 1}),
                       {.material = rubber, .position = {0, 0, 0.051 + 0.101 * i}, .dynamics = BodyDynamics::rigid});
    const RolloutResult result = rollout(world, 1, calls(20, {}));
    World by_hand = world.clone();
    for (int i = 0; i < 20; ++i) REQUIRE(by_hand.advance(0.01).ok());
    CHECK_FALSE(by_hand.report().distrust().empty());
    CHECK(result.status[0].distrust == by_hand.report().distrust());
}

}  // namespace skerry::test::rollout_test
