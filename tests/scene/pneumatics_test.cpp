// Soft bodies under air pressure in contact: a finger on a wall, and the shipped scenes of a gripper and of a tyre.
#include <Eigen/Geometry>
#include <algorithm>
#include <catch2/catch.hpp>
#include <cmath>
#include <numbers>

#include "components/key_lists.h"
#include "skerry/cavity.h"
#include "skerry/materials.h"
#include "skerry/scene.h"
#include "skerry/sets.h"
#include "tests/support/draws.h"
#include "tests/support/same_bits.h"
#include "tests/support/worlds.h"

namespace skerry::test::pneumatics_test {

namespace {

const std::string folder = SKERRY_SOURCE_DIR "/scenes/";

/// A silicone finger that hangs from its clamp, 10 mm beside a wall. Air bends it towards the wall. The material is
/// damped, so that the finger is at rest soon after the pressure is constant.
struct Finger {
    World world;
    BodyHandle body;
    ColliderHandle wall;
    CavityHandle air;

    explicit Finger(const TimeTable& pressure, std::optional<Real> step = {})
        : world({.step_size = step, .sleep = false}) {
        MaterialSettings silicone = named_material("silicone_dragon_skin_10");
        silicone.poisson_ratio = 0.4;
        silicone.friction = 0.3;
        silicone.damping = 60;
        body = world.add_body(mesh::read(folder + "meshes/air_finger.msh"),
                              {.material = world.add_material(silicone), .rotation = {0, std::numbers::pi / 2, 0}});
        world.attach(body, Sets(world).nodes(body, "clamp"));
        wall = world.add_collider(Plane{.normal = {1, 0, 0}, .point = {-0.01, 0, 0}});
        air = Cavities(world).add({.body = body, .faces = Sets(world).faces(body, "chambers"), .filling = pressure});
        world.measure_forces(true);
    }
    /// Advances by `seconds` and returns the mean force on the wall [N].
    Real press(Real seconds) {
        REQUIRE(world.advance(seconds).ok());
        return world.forces().on(body, wall).force().x();
    }
};

constexpr Real low = 6e3, high = 12e3;  // pressures of a finger at rest [Pa]
const TimeTable in_two_stages({{0, 0}, {0.1, low}, {0.25, low}, {0.35, high}});

}  // namespace

TEST_CASE("a pneumatic finger presses a wall harder at a higher pressure, and no harder if its host repeats the value",
          "[scene][cavities][long]") {
    Finger once(in_two_stages);
    once.press(0.23);
    const Real before = once.press(0.02);
    once.press(0.23);
    const Real after = once.press(0.02);
    CHECK(before > 0.02);
    CHECK(after > 2 * before);
    CHECK(once.press(0.02) == Approx(after).epsilon(0.005));
    CHECK(once.world.energy().kinetic < 1e-7);
    CHECK(once.world.report().energy_error_share < 1e-4);

    Finger often(in_two_stages);
    for (int ms = 0; ms < 500; ++ms) {
        Cavities(often.world).set_pressure(often.air, value_at(in_two_stages.keys, often.world.time()));
        often.press(1e-3);
    }
    CHECK(often.press(0.02) == Approx(after).epsilon(0.005));
}

TEST_CASE("a pneumatic finger under constant pressure neither gains energy nor moves in ten seconds, at any step",
          "[scene][cavities]") {
    if (!full_tests()) return;
    Finger finger(in_two_stages);
    finger.press(1);
    const Real error = finger.world.report().energy_error_share, start = finger.press(0.1),
               volume = Cavities(finger.world).state(finger.air).volume;
    for (int second = 0; second < 10; ++second) {
        CHECK(finger.press(1) == Approx(start).epsilon(1e-4));
        CHECK(finger.world.energy().kinetic < 1e-12);
    }
    CHECK(Cavities(finger.world).state(finger.air).volume == Approx(volume).epsilon(1e-6));
    CHECK(finger.world.report().energy_error_share == Approx(error).epsilon(1e-3));
    Finger fine(in_two_stages, finger.world.stable_step() / 10);
    fine.press(1);
    CHECK(fine.press(0.1) == Approx(start).epsilon(1e-3));
}

TEST_CASE("two pneumatic fingers lift a cube, and hold it with its weight and enough friction",
          "[scene][cavities][long]") {
    // The ordinary test grips and lifts at once, and holds for a moment.
    const std::string lift = R"(=[{"time": 0.18, "position": [0, 0, 0]}, {"time": 0.33, "position": [0, 0, 0.01]}])";
    const std::string blow = ".pressure=[[0, 0], [0.12, 1.5e4]]";
    const bool full = full_tests();
    const Real held = full ? 3 : 0.37, set_down = full ? 12 : 0.52;  // [s]
    const int window = full ? 1000 : 150;                            // time over which forces are averaged [ms]
    // Sleep is off, so that the bodies move during the ten seconds.
    std::vector<std::string> changes{"settings.sleep=false"};
    if (!full)
        changes.insert(changes.end(), {"bodies[0].pin[0].motion.keys" + lift, "bodies[1].pin[0].motion.keys" + lift,
                                       "cavities[0]" + blow, "cavities[1]" + blow});
    Scene scene = load_scene(folder + "gripper.json", {.assignments = changes});
    World& world = scene.world;
    const std::vector<BodyHandle> bodies = world.bodies();
    const BodyHandle right = bodies[0], left = bodies[1], cube = bodies[2];
    const Real weight = world.mass(cube) * standard_gravity;
    CHECK(world.mass(cube) == Approx(2e-3));
    world.measure_forces(true);
    REQUIRE(world.advance(held).ok());
    const Real height = world.center_of_mass(cube).z();
    CHECK(height > (full ? 0.07 : 0.017));
    // The host sets the present pressure again every millisecond.
    Cavities cavities(world);
    const Real pressure = cavities.state(cavities.all()[0]).pressure;
    while (world.time() < set_down - 1e-9) {
        Vec3 by_right = Vec3::Zero(), by_left = Vec3::Zero();  // mean forces on the cube [N]
        Real pressing = 0;
        for (int ms = 0; ms < window; ++ms) {
            for (const CavityHandle air : cavities.all()) cavities.set_pressure(air, pressure);
            REQUIRE(world.advance(1e-3).ok());
            const ForceReport right_now = world.forces().on(cube, right), left_now = world.forces().on(cube, left);
            by_right += right_now.impulse / (1e-3 * window);
            by_left += left_now.impulse / (1e-3 * window);
            pressing += (right_now.pressing_impulse + left_now.pressing_impulse) / (1e-3 * window);
        }
        CHECK(0.8 * pressing > 3 * weight);
        CHECK(by_right.z() + by_left.z() == Approx(weight).epsilon(full ? 1e-3 : 0.1));
        CHECK(by_right.x() == Approx(-by_left.x()).epsilon(full ? 1e-3 : 0.05));
        CHECK(world.center_of_mass(cube).z() == Approx(height).margin(full ? 1e-4 : 3e-3));
    }
    if (full) {
        for (const CavityHandle air : cavities.all())
            cavities.set_pressure(air, TimeTable({{13.2, pressure}, {14, 0}}));
        REQUIRE(world.advance(scene.seconds - world.time()).ok());
        const Vec3 end = world.center_of_mass(cube);
        CHECK(end.z() == Approx(0.0125).margin(5e-4));
        CHECK(end.head<2>().norm() < 2e-3);
        CHECK(world.forces().on(cube, right).contacts == 0);
    }
    CHECK(world.report().energy_error_share < 1e-3);
}

namespace {

/// Volume between the inner wall of a tyre and the centre of its rim, up to a constant that depends on the rim only
/// [m^3].
Real inner_volume(World& world, BodyHandle tyre, const Vec3& center) {
    Real six = 0;
    for (const auto& face : Sets(world).faces(tyre, "inside")) {
        Mat3 x;
        for (int k = 0; k < 3; ++k)
            x.col(k) = world.positions(tyre)[static_cast<std::size_t>(face[static_cast<std::size_t>(k)])] - center;
        six -= x.determinant();
    }
    return six / 6;
}

}  // namespace

TEST_CASE("a tyre on a rim rolls without slip, and its air has the volume between the two",
          "[scene][cavities][ties][long]") {
    Scene scene = load_scene(folder + "tyre.json");
    World& world = scene.world;
    const BodyHandle tyre = world.bodies()[0], rim = world.bodies()[1];
    const CavityHandle air = Cavities(world).all()[0];
    const Vec3 up = Vec3(0.05234, 0, 0.99863).normalized(), ahead = Vec3::UnitY().cross(up);
    const Real start = Cavities(world).state(air).volume, rest = inner_volume(world, tyre, world.center_of_mass(rim));
    // Between the edges of the inner wall lies a prism with 46 sides. Its sides, seen from the centre, enclose two
    // thirds of its volume, which are not filled with air.
    constexpr Real edge_radius = 0.12 - 0.038 / 2, edge_distance = 0.038 * std::numbers::sqrt3;  // [m]
    const Real prism = 23 * edge_radius * edge_radius * std::sin(std::numbers::pi / 23) * edge_distance;
    CHECK(start == Approx(rest - prism * 2 / 3).epsilon(1e-4));
    const auto check_air = [&] {
        const CavityState state = Cavities(world).state(air);
        const Real change = inner_volume(world, tyre, world.center_of_mass(rim)) - rest;
        // Ties hold the edges of the inner wall within 1e-6 m, and the ring between the edges has an area of 0.04 m^2.
        CHECK(state.volume - start == Approx(change).margin(4e-8));
        CHECK((state.pressure + standard_pressure) * std::pow(state.volume, 1.4) ==
              Approx((3e4 + standard_pressure) * std::pow(start, 1.4)).epsilon(1e-9));
        CHECK(state.force.norm() < 1e-5 * state.pressure * std::cbrt(start * start));
    };
    REQUIRE(world.advance(0.1).ok());
    check_air();
    CHECK(std::abs(Cavities(world).state(air).volume - start) > 0.01 * start);
    if (!full_tests()) return;

    // From here to the bump, the wheel rolls through a distance that an angle and an effective radius explain. The
    // radius of a tyre that rolls freely is between the radii with and without the load.
    const Vec3 from = world.center_of_mass(rim);
    Real angle = 0, height = 0, load = 0, free_radius = 0;
    constexpr int samples = 300;
    world.measure_forces(true);
    for (int i = 0; i < samples; ++i) {
        REQUIRE(world.advance(2e-3).ok());
        angle += 2e-3 * world.velocity(rim).angular_velocity.y();
        const Vec3 center = world.center_of_mass(rim);
        height += center.dot(up) / samples;
        load += world.forces().on(tyre).force().dot(up) / samples;
        for (const Vec3& x : world.positions(tyre)) free_radius = std::max(free_radius, (x - center).norm());
    }
    const Real radius = (world.center_of_mass(rim) - from).dot(ahead) / angle;
    CAPTURE(height, free_radius);
    CHECK(radius > height);
    CHECK(radius < free_radius);
    CHECK(load == Approx((world.mass(tyre) + world.mass(rim)) * standard_gravity * up.z()).epsilon(0.05));
    REQUIRE(world.advance(scene.seconds - world.time()).ok());
    check_air();
    CHECK(world.center_of_mass(rim).x() > 2);
    CHECK(std::abs(world.center_of_mass(rim).y()) < 1e-3);
    CHECK(world.report().energy_error_share < 1e-4);
}

TEST_CASE("a tyre that rolls has the same bits on any number of threads, in copies and in files",
          "[scene][cavities][ties][determinism][long]") {
    check_same_bits(
        [](int threads) {
            Scene scene = load_scene(folder + "tyre.json", {.threads = threads});
            REQUIRE(scene.world.advance(0.01).ok());
            CHECK_FALSE(scene.world.contacts().empty());
            return scene;
        },
        [](World& world) { REQUIRE(world.advance(0.005).ok()); });
}

}  // namespace skerry::test::pneumatics_test
