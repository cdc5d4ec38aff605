// Cables in whole steps, against closed forms (docs/methods/cables.md).
#include <algorithm>
#include <catch2/catch.hpp>
#include <cmath>
#include <numbers>

#include "engine/world/world_state.h"
#include "skerry/cable.h"
#include "tests/support/mapped_box.h"
#include "tests/support/message_of.h"
#include "tests/support/same_bits.h"
#include "tests/support/worlds.h"

namespace skerry::test::cables_test {

namespace {

constexpr Real length = 0.2, side = 0.02, stiffness = 1e6;  // of a bar along x [m, Pa]
const Real area = side * side;                              // [m^2]
const Mesh bar = mesh::box({length, side, side}, {20, 2, 2});

/// A bar whose end at -length/2 is held, with a cable along x from end to end, at the height `offset`.
struct HeldBar {
    World world;
    BodyHandle body;
    CableHandle cable;

    HeldBar(const CableDrive& drive, BodyDynamics dynamics, Real offset = 0, const Mesh& mesh = bar,
            Settings settings = accurate(Vec3::Zero(), 1e-10), Real damping = 60)
        : world(settings) {
        body = world.add_body(mesh, {.material = world.add_material({.young_modulus = stiffness,
                                                                     .poisson_ratio = 0,
                                                                     .damping = damping,
                                                                     .loss_factor = 0,
                                                                     .model = MaterialModel::linear}),
                                     .dynamics = dynamics});
        world.attach(body, nodes_where(mesh, [](const Vec3& x) { return x.x() < -length / 2 + 1e-9; }));
        cable = Cables(world).add({.points = {{.body = body, .point = {-length / 2, 0, offset}},
                                              {.body = body, .point = {length / 2, 0, offset}}},
                                   .drive = drive});
    }
    CableState state() { return Cables(world).state(cable); }
    /// Mean displacement of the nodes of the section at `x` [m].
    Vec3 displacement(const Mesh& mesh, Real x) const {
        const std::vector<Index> section =
            nodes_where(mesh, [&](const Vec3& position) { return std::abs(position.x() - x) < 1e-9; });
        Vec3 sum = Vec3::Zero();
        for (const Index n : section)
            sum += world.positions(body)[static_cast<std::size_t>(n)] - mesh.nodes[static_cast<std::size_t>(n)];
        return sum / static_cast<Real>(section.size());
    }
};

/// A rigid cube at `position`.
BodyHandle add_cube(World& world, const Vec3& position, Real size = 0.1, Real density = 1000) {
    return world.add_body(
        mesh::box(Vec3::Constant(size), {1, 1, 1}),
        {.material = world.add_material({.density = density}), .position = position, .dynamics = BodyDynamics::rigid});
}

Settings with_step(Real h, const Vec3& gravity = Vec3::Zero(), Index threads = 1) {
    Settings settings = accurate(gravity, 1e-12);
    settings.step_size = h;
    settings.threads = threads;
    return settings;
}

/// A cable with the tension `tension` that begins at the world, bends by 30 degrees at each of three points of the
/// world, and ends at a cube of 1 kg, which hangs on it.
struct Wrap {
    static constexpr Real friction = 0.4, mass = 1;
    const Real ratio = std::exp(friction * std::numbers::pi / 2);
    World world;
    BodyHandle cube;
    CableHandle cable;

    Wrap(Real tension, Real gravity, Real h = 1e-3) : world(with_step(h, {0, 0, -gravity})) {
        cube = add_cube(world, {0, 0, -1});
        std::vector<Anchor> points{{.point = {-1, 0, 0.5}}};
        Vec3 at(-0.5, 0, 0.5);
        for (int k = 1; k <= 3; ++k) {
            points.push_back({.point = at});
            const Real angle = -k * std::numbers::pi / 6;
            at += 0.1 * Vec3(std::cos(angle), 0, std::sin(angle));
        }
        // the last segment hangs straight down to the centre of the cube
        const Vec3 last = points.back().point;
        world.set_pose(cube, {.position = {last.x(), 0, -1}});
        points.push_back({.body = cube, .point = {last.x(), 0, -1}});
        cable = Cables(world).add({.points = points, .drive = {.tension = tension}, .friction = friction});
    }
    CableState state() { return Cables(world).state(cable); }
    Real speed() { return world.velocity(cube).velocity.z(); }
};

}  // namespace

TEST_CASE("a cable along the axis of a bar shortens it by F L / (E A)", "[scene][cables]") {
    const Real force = 1e-3 * stiffness * area, x = 0.05, shortening = 1e-3 * (x + length / 2);
    for (const BodyDynamics dynamics : {BodyDynamics::explicit_elastic, BodyDynamics::implicit_elastic}) {
        HeldBar bar_with({.tension = force}, dynamics);
        REQUIRE(bar_with.world.advance(0.6).ok());
        CHECK(-bar_with.displacement(bar, x).x() == Approx(shortening).epsilon(0.01));
        CHECK(bar_with.state().tension == std::vector<Real>{force});
        const Real tip = length - bar_with.state().length;

        // A prescribed length needs the same tension.
        HeldBar by_length({.length = length - tip}, dynamics);
        REQUIRE(by_length.world.advance(0.6).ok());
        CHECK(by_length.state().tension[0] == Approx(force).epsilon(1e-5));
        CHECK(by_length.state().length == Approx(length - tip).epsilon(1e-9));
        // So does the same length drawn in at a constant rate.
        HeldBar by_rate({.rate = TimeTable({{0.1, -tip / 0.1}, {0.1 + 1e-9, 0}})}, dynamics);
        REQUIRE(by_rate.world.advance(0.8).ok());
        CHECK(by_rate.state().tension[0] == Approx(force).epsilon(1e-5));
    }
}

TEST_CASE("a cable beside the axis of a bar bends it with the curvature F e / (E I)", "[scene][cables]") {
    // The force is small, because the deflection changes the moment arm.
    const Real offset = 0.4 * side, inertia = area * area / 12, force = 1e-5 * stiffness * area, d = length / 4;
    const Mesh fine = mesh::box({length, side, side}, {40, 4, 4});
    HeldBar bent({.tension = force}, BodyDynamics::implicit_elastic, offset, fine);
    REQUIRE(bent.world.advance(2).ok());
    const auto rotation = [&](Real x) {  // of the section at x, from the top towards the held end [rad]
        Real sum = 0, squares = 0;
        for (const Index n :
             nodes_where(fine, [&](const Vec3& position) { return std::abs(position.x() - x) < 1e-9; })) {
            const Vec3& at = fine.nodes[static_cast<std::size_t>(n)];
            sum -= at.z() * (bent.world.positions(bent.body)[static_cast<std::size_t>(n)] - at).x();
            squares += at.z() * at.z();
        }
        return sum / squares;
    };
    CHECK((rotation(d) - rotation(-d)) / (2 * d) == Approx(force * offset / (stiffness * inertia)).epsilon(0.01));
}

TEST_CASE("tensions of a cable that slides around points have the ratio exp(mu theta)", "[scene][cables]") {
    const Real tension = 5;
    // The cable is drawn in: the tension at the cube is smaller.
    Wrap drawn(tension, 0);
    REQUIRE(drawn.world.advance(0.05).ok());
    CHECK(drawn.state().tension.back() * drawn.ratio == Approx(tension).epsilon(1e-12));
    CHECK(drawn.speed() == Approx(0.05 * tension / drawn.ratio / Wrap::mass).epsilon(1e-3));
    CHECK(drawn.state().dissipated ==
          Approx(tension * (1 - 1 / drawn.ratio) * (drawn.world.pose(drawn.cube).position.z() + 1)).epsilon(1e-9));
    // Positions move with the velocity of the end of a step; the loss of the run uses the mean velocity.
    CHECK(drawn.world.energy().dissipated == Approx(drawn.state().dissipated).epsilon(0.03));
    // The weight of the cube draws the cable out: the tension at the cube is greater.
    const Real heavy = 2 * tension * drawn.ratio / Wrap::mass;
    Wrap out(tension, heavy);
    REQUIRE(out.world.advance(0.05).ok());
    CHECK(out.state().tension.back() == Approx(tension * out.ratio).epsilon(1e-12));
    CHECK(out.speed() == Approx(-0.05 * heavy / 2).epsilon(1e-3));
    CHECK(out.state().work < 0);
    CHECK(out.state().dissipated > 0);
    // Between these limits the cable sticks and carries the weight.
    for (const Real factor : {0.6, 1.0, 1.8}) {
        Wrap stuck(tension, factor * tension / Wrap::mass);
        REQUIRE(stuck.world.advance(0.05).ok());
        CHECK(stuck.state().tension.back() == Approx(factor * tension).epsilon(1e-9));
        CHECK(std::abs(stuck.speed()) < 1e-9);
    }
}

TEST_CASE("the work of a cable becomes elastic energy, motion and losses", "[scene][cables]") {
    const Real tension = 1e-2 * stiffness * area;
    for (const CableDrive& drive : {CableDrive{.tension = TimeTable({{0, 0}, {0.05, tension}})},
                                    CableDrive{.length = TimeTable({{0, length}, {0.05, 0.99 * length}})}})
        for (const BodyDynamics dynamics : {BodyDynamics::explicit_elastic, BodyDynamics::implicit_elastic}) {
            HeldBar bar_with(drive, dynamics, 0, bar, with_step(2e-4), 0);
            REQUIRE(bar_with.world.advance(0.1).ok());
            const WorldReport report = bar_with.world.report();
            CHECK(report.energy_error_share < 2e-3);
            const Energy energy = bar_with.world.energy();
            REQUIRE(energy.elastic > 0);
            CHECK(bar_with.state().work == Approx(energy.elastic + energy.kinetic + energy.dissipated).epsilon(0.01));
        }
}

TEST_CASE("a mass on a taut cable swings at its frequency and gains no energy at the stable step", "[scene][cables]") {
    const Real tension = 1e5, half = 0.5, mass = 1, speed = 0.01;
    const Real rate = std::sqrt(2 * tension / (half * mass));  // circular frequency [rad/s]
    World world(accurate(Vec3::Zero(), 1e-12));
    const BodyHandle cube = add_cube(world, {0, 0, 0});
    Cables(world).add(
        {.points = {{.point = {-half, 0, 0}}, {.body = cube, .point = {0, 0, 0}}, {.point = {half, 0, 0}}},
         .drive = {.tension = tension}});
    world.set_velocity(cube, {0, 0, speed});
    int crossings = 0;
    Real largest = 0, before = 0, last = 0;
    while (crossings < 400) {
        REQUIRE(world.advance(1e-4).ok());
        const Real now = world.center_of_mass(cube).z();
        if (before != 0 && (now > 0) != (before > 0)) {
            ++crossings;
            last = world.time() - 1e-4 * now / (now - before);
        }
        largest = std::max(largest, std::abs(now));
        before = now;
    }
    CHECK(last == Approx(400 * std::numbers::pi / rate).epsilon(1e-3));
    CHECK(largest == Approx(speed / rate).epsilon(1e-2));
    REQUIRE(world.advance(20).ok());  // in steps as long as the stable step allows
    CHECK(std::abs(world.center_of_mass(cube).z()) < 2 * speed / rate);
}

TEST_CASE("a slack cable does not push", "[scene][cables]") {
    World world(with_step(1e-3));
    const BodyHandle cube = add_cube(world, {0, 0, -1});
    const CableHandle cable = Cables(world).add(
        {.points = {{.point = {0, 0, 0}}, {.body = cube, .point = {0, 0, -1}}}, .drive = {.length = 1.2}});
    world.set_velocity(cube, {0, 0, -1});
    while (world.time() < 0.19) {
        REQUIRE(world.advance(0.01).ok());
        REQUIRE(Cables(world).state(cable).tension[0] == 0);
    }
    CHECK(world.velocity(cube).velocity.z() == -1);
    REQUIRE(world.advance(0.1).ok());
    CHECK(Cables(world).state(cable).length == Approx(1.2).epsilon(1e-9));
    CHECK(std::abs(world.velocity(cube).velocity.z()) < 1e-9);  // stopped without rebound
    // Drawn towards the first point, the cable becomes slack again.
    world.set_velocity(cube, {0, 0, 1});
    REQUIRE(world.advance(0.1).ok());
    CHECK(Cables(world).state(cable).tension[0] == 0);
    CHECK(world.velocity(cube).velocity.z() == 1);
}

TEST_CASE("a cable that nothing can shorten stays without tension", "[scene][cables]") {
    World world(with_step(1e-3));
    const BodyHandle cube = add_cube(world, {0, 0, 0});
    const CableHandle cable = Cables(world).add(
        {.points = {{.point = {0.13, 0.27, 0.9}}, {.body = cube, .point = {0, 0, 0}}, {.point = {-0.39, -0.81, -2.7}}},
         .drive = {.rate = -0.1},
         .friction = 0.2});
    REQUIRE(world.advance(0.1).ok());
    CHECK(Cables(world).state(cable).tension == std::vector<Real>{0, 0});
    CHECK(world.velocity(cube).velocity.norm() == 0);
}

namespace {

/// A soft bar and a rigid cube that a cable with friction draws together while they spin, beside an obstacle.
struct Flying {
    World world;
    BodyHandle soft, cube, stiff;
    CableHandle cable;

    explicit Flying(const CableDrive& drive, Real friction = 0.3, Real h = 1e-4, Index threads = 1)
        : world(with_step(h, Vec3::Zero(), threads)) {
        const MaterialHandle rubber = world.add_material({.young_modulus = 1e5});
        soft = world.add_body(mesh::box({0.2, 0.05, 0.05}, {8, 2, 2}),
                              {.material = rubber, .angular_velocity = {0, 1, 2}});
        stiff = world.add_body(mesh::box({0.05, 0.05, 0.2}, {2, 2, 4}),
                               {.material = world.add_material({.young_modulus = 1e7, .loss_factor = 0}),
                                .position = {0.3, 0.02, 0},
                                .dynamics = BodyDynamics::implicit_elastic});
        cube = add_cube(world, {0.1, 0.3, 0.1});
        cable = Cables(world).add({.points = {{.body = soft, .point = {-0.07, 0.01, 0.01}},
                                              {.body = cube, .point = {0.1, 0.3, 0.1}},
                                              {.body = stiff, .point = {0.3, 0.02, 0.06}},
                                              {.body = soft, .point = {0.06, 0, 0}}},
                                   .drive = drive,
                                   .friction = friction});
    }
};

}  // namespace

TEST_CASE("a cable between free bodies changes no momentum", "[scene][cables]") {
    for (const CableDrive& drive : {CableDrive{.tension = 2}, CableDrive{.rate = -0.5}})
        for (const Real friction : {0.0, 0.3}) {
            Flying flying(drive, friction);
            const Twist before = flying.world.velocity(flying.cube);
            const auto momentum = [&] {
                Vec3 sum = Vec3::Zero();
                for (const BodyHandle body : {flying.soft, flying.cube, flying.stiff})
                    sum += flying.world.mass(body) * flying.world.velocity(body).velocity;
                return sum;
            };
            const Vec3 momentum_before = momentum();
            REQUIRE(flying.world.advance(0.1).ok());
            CHECK((flying.world.velocity(flying.cube).velocity - before.velocity).norm() > 0.01);
            CHECK((momentum() - momentum_before).norm() < 1e-13);
            const WorldReport report = flying.world.report();
            CHECK(report.momentum_error_share < 1e-13 * std::sqrt(static_cast<Real>(report.steps)));
            CHECK(report.energy_error_share < 5e-3);
        }
}

TEST_CASE("a tenth of the step gives the same motion of a cable with friction", "[scene][cables]") {
    std::vector<Vec3> place;
    for (const Real h : {1e-4, 1e-5}) {
        Flying flying({.rate = TimeTable({{0, 0}, {0.05, -0.5}})}, 0.3, h);
        REQUIRE(flying.world.advance(0.05).ok());
        CHECK(Cables(flying.world).state(flying.cable).tension[0] > 0);
        place.push_back(flying.world.pose(flying.cube).position);
    }
    CHECK((place[0] - place[1]).norm() < 1e-4 * (place[1] - Vec3(0.1, 0.3, 0.1)).norm() + 1e-6);
}

TEST_CASE("a world with cables continues with the same bits", "[scene][cables]") {
    for (const CableDrive& drive : {CableDrive{.tension = 2}, CableDrive{.rate = -0.5}})
        check_same_bits(
            [&](Index threads) {
                Flying flying(drive, 0.3, 1e-4, threads == 1 ? 1 : 3);
                REQUIRE(flying.world.advance(0.01).ok());
                CHECK(Cables(flying.world).state(flying.cable).tension[0] > 0);
                return flying;
            },
            [](World& world) { REQUIRE(world.advance(0.01).ok()); });
}

TEST_CASE("a cable presses a cube onto a plane, and contact and cable are solved together", "[scene][cables]") {
    World world(with_step(1e-3, {0, 0, -9.81}));
    world.add_collider(Plane{});
    const Real gap = 0.02 * 0.1;
    const BodyHandle cube = add_cube(world, {0, 0, 0.05 + gap});
    // The cable runs from the cube down through the plane to the world, and is 1 mm shorter than the contact allows.
    const CableHandle cable =
        Cables(world).add({.points = {{.point = {0.2, 0, -0.1}}, {.body = cube, .point = {0, 0, 0.05 + gap}}},
                           .drive = {.tension = TimeTable({{0, 0}, {0.1, 4}})},
                           .friction = 0.1});
    REQUIRE(world.advance(0.5).ok());
    CHECK(world.velocity(cube).velocity.norm() < 1e-9);
    Vec3 support = Vec3::Zero();
    world.advance(1e-3);
    for (const Contact& contact : world.contacts()) support += contact.force();
    const CableState state = Cables(world).state(cable);
    const Vec3 pull = state.tension[0] * (state.points[0].point - state.points[1].point).normalized();
    CHECK((support + pull + Vec3(0, 0, -9.81)).norm() < 1e-6);
}

TEST_CASE("removing a body removes its cables, and other cables stay", "[scene][cables]") {
    Flying flying({.tension = 2});
    Cables cables(flying.world);
    const CableHandle other =
        cables.add({.points = {{.point = {0.1, 1, 0.1}}, {.body = flying.cube, .point = {0.1, 0.3, 0.1}}},
                    .drive = {.length = TimeTable({{0, 1}, {1, 0.5}})}});
    flying.world.remove(flying.soft);
    CHECK_FALSE(cables.alive(flying.cable));
    REQUIRE(cables.alive(other));
    REQUIRE(flying.world.advance(0.01).ok());
    CHECK(cables.state(other).points.size() == 2);
    cables.remove(other);
    CHECK(cables.all().empty());
    REQUIRE(flying.world.advance(0.01).ok());
}

TEST_CASE("a change of its cable wakes a body", "[scene][cables]") {
    Settings settings;
    settings.sleep_time = 0.05;
    World world(settings);
    world.add_collider(Plane{});
    const BodyHandle cube = add_cube(world, {0, 0, 0.052});
    Cables cables(world);
    const CableHandle cable = cables.add({.points = {{.point = {0, 0, 1}}, {.body = cube, .point = {0, 0, 0.052}}},
                                          .drive = {.tension = TimeTable({{1, 0}, {1.001, 20}})}});
    REQUIRE(world.advance(0.9).ok());
    REQUIRE(world.asleep(cube));
    REQUIRE(world.advance(0.2).ok());
    CHECK(world.pose(cube).position.z() > 0.06);  // the table has woken it
    cables.set_drive(cable, {.tension = 0});
    REQUIRE(world.advance(1.5).ok());
    REQUIRE(world.asleep(cube));
    cables.set_drive(cable, {.length = 0.8});
    CHECK_FALSE(world.asleep(cube));
}

TEST_CASE("a moving collider wakes a body that hangs on it by a cable", "[scene][cables]") {
    Settings settings;
    settings.sleep_time = 0.05;
    World world(settings);
    const auto at = [](Real time, Real height) { return MotionKey{time, {0, 0, height}, Vec3::Zero()}; };
    const ColliderHandle box = world.add_collider(
        Box{Vec3::Constant(0.1)}, {.position = {0, 0, 1}, .motion = {.keys = {at(0, 1), at(1, 1), at(2, 1.5)}}});
    const BodyHandle cube = add_cube(world, {0, 0, 0});
    const CableHandle cable =
        Cables(world).add({.points = {{.collider = box, .point = {0, 0, 1}}, {.body = cube, .point = {0, 0, 0.05}}},
                           .drive = {.length = 0.95}});
    REQUIRE(world.advance(0.9).ok());
    REQUIRE(world.asleep(cube));
    REQUIRE(world.advance(1.1).ok());
    CHECK(world.pose(cube).position.z() == Approx(0.5).epsilon(0.01));
    CHECK(Cables(world).state(cable).length == Approx(0.95).epsilon(1e-3));
}

TEST_CASE("a cable between held points lengthens at its rate", "[scene][cables]") {
    World world(with_step(1e-3));
    const BodyHandle cube = add_cube(world, {0, 0, 0});
    world.attach(cube, nodes_where(mesh::box(Vec3::Constant(0.1), {1, 1, 1}), [](const Vec3&) { return true; }));
    const CableHandle cable = Cables(world).add(
        {.points = {{.point = {0, 0, 1}}, {.body = cube, .point = {0, 0, 0}}}, .drive = {.rate = 0.2}});
    REQUIRE(world.advance(0.5).ok());
    CHECK(Cables(world).state(cable).released == Approx(1.1).epsilon(1e-12));
}

TEST_CASE("a segment without length passes its tension on", "[scene][cables]") {
    constexpr Real tension = 3;
    for (const bool first : {true, false})
        for (const CableDrive& drive : {CableDrive{.tension = tension}, CableDrive{.length = 0.8}}) {
            World world(with_step(1e-3));
            const BodyHandle cube = add_cube(world, {0, 0, 0}, 0.25);
            const Vec3 corner = Vec3::Constant(0.125), near(0.125, 0.125, 1), far(1, 0.125, 1);
            std::vector<Anchor> points{{.point = near}, {.body = cube, .point = corner}, {.point = far}};
            if (!first) std::swap(points[0], points[2]);
            const CableHandle cable = Cables(world).add({.points = points, .drive = drive, .friction = 0.2});
            world.set_pose(cube, {.position = near - corner});
            REQUIRE(world.advance(1e-9).steps == 1);  // afterwards the segment has a length
            CHECK(world.report().unconverged == 0);
            const std::vector<Real> now = Cables(world).state(cable).tension;
            CHECK(now[0] > 0);
            CHECK(now[0] == Approx(now[1]).epsilon(1e-9));
            CHECK(world.velocity(cube).velocity.x() > 0);
        }
}

TEST_CASE("a saved cable that pushes, or a point of two objects, is refused", "[scene][cables]") {
    const auto message = [](auto&& change) {
        World world(with_step(1e-3));
        const BodyHandle cube = add_cube(world, {0, 0, 0});
        world.add_collider(Plane{}, {.position = {0, 0, -5}});
        Cables(world).add(
            {.points = {{.point = {0, 0, 1}}, {.body = cube, .point = {0, 0, 0}}}, .drive = {.tension = 1}});
        change(WorldAccess::state_of(world).model.cables);
        const TemporaryFolder folder;
        world.save(folder.path() / "world.skerry");
        return message_of([&] { World::load(folder.path() / "world.skerry"); });
    };
    using Catch::Contains;
    CHECK(message([](CableTable&) {}).empty());
    CHECK_THAT(message([](CableTable& table) { table.key[0].value = -1; }), Contains("cables: key") && Contains("-1"));
    CHECK_THAT(message([](CableTable& table) { table.tension[0] = -1; }), Contains("cables: tension"));
    CHECK_THAT(message([](CableTable& table) { table.anchor.collider[1] = 0; }), Contains("cables: collider"));
}

TEST_CASE("errors of cables name the field, the value found and the values expected", "[scene][cables]") {
    World world(with_step(1e-3));
    const BodyHandle cube = add_cube(world, {0, 0, 0});
    const Anchor on_cube{.body = cube, .point = {0, 0, 0}}, above{.point = {0, 0, 1}};
    const auto message = [&](const CableSettings& cable) { return message_of([&] { Cables(world).add(cable); }); };
    using Catch::Contains;
    CHECK_THAT(message({.points = {on_cube}, .drive = {.tension = 1}}), Contains("points") && Contains("at least 2"));
    CHECK_THAT(message({.points = {above, above}, .drive = {.tension = 1}}), Contains("points[1]"));
    CHECK_THAT(message({.points = {{.point = {1, 0, 0}}, above}, .drive = {.tension = 1}}),
               Contains("at least one point on a body"));
    CHECK_THAT(message({.points = {above, on_cube}, .drive = {}}), Contains("exactly one of tension, length and rate"));
    CHECK_THAT(message({.points = {above, on_cube}, .drive = {.tension = 1, .length = 1}}), Contains("more than one"));
    CHECK_THAT(message({.points = {above, on_cube}, .drive = {.tension = -1}}), Contains("does not push"));
    CHECK_THAT(message({.points = {above, on_cube}, .drive = {.length = 0}}), Contains("a length > 0"));
    CHECK_THAT(message({.points = {above, on_cube}, .drive = {.tension = 1}, .friction = -1}), Contains("friction"));
    CHECK(Cables(world).all().empty());
}

}  // namespace skerry::test::cables_test
