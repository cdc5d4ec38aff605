// Stress suite: long rest, restitution in stacks, bodies that come and go (items 14, 20 and 28 of docs/stress.md).
#include <catch2/catch.hpp>

#include "engine/world/tuning.h"
#include "tests/support/stress.h"
#include "tests/support/worlds.h"

namespace skerry::test::rest_test {

using namespace skerry::test::stress;

namespace {

std::vector<Vec3> all_positions(const World& world) {
    std::vector<Vec3> all;
    for (const BodyHandle body : world.bodies())
        all.insert(all.end(), world.positions(body).begin(), world.positions(body).end());
    return all;
}

Real largest_distance(const std::vector<Vec3>& a, const std::vector<Vec3>& b) {
    Real largest = 0;
    for (std::size_t n = 0; n < a.size(); ++n) largest = std::max(largest, (a[n] - b[n]).norm());
    return largest;
}

/// Lets a settled world rest for `chunks` times `steps` steps. Records the drift of nodes and the largest rise of the
/// energy.
struct Rest {
    Course course;
    Real drift = 0;  // largest distance of a node from its start [m]
    Real rise = 0;   // largest rise above an earlier minimum, sampled after each chunk [J]
    Rest(World& world, int chunks, int steps) {
        const std::vector<Vec3> start = all_positions(world);
        Real lowest = mechanical_energy(world);
        for (int chunk = 0; chunk < chunks && (chunk == 0 || course.ok); ++chunk) {
            const int before = course.steps;
            const Course part = follow(world, steps * world.stable_step() * (1 - 1e-12), 1);
            course.ok = part.ok;
            course.message = part.message;
            course.finite &= part.finite;
            course.steps = before + part.steps;
            drift = std::max(drift, largest_distance(all_positions(world), start));
            const Real energy = mechanical_energy(world);
            rise = std::max(rise, energy - lowest);
            lowest = std::min(lowest, energy);
        }
    }
};

void judge_rest(int item, const std::string& scene, const Rest& rest, int steps, Real edge, Real weight_energy,
                Real most_rise = 1e-9) {
    judge({item, scene, "every step taken, finite",
           rest.course.ok ? text(rest.course.steps) + " steps" : rest.course.message,
           rest.course.ok && rest.course.finite && rest.course.steps >= steps});
    at_most(item, scene, "drift / edge", rest.drift / edge, 1e-3);
    at_most(item, scene, "rise of the energy / (weight times edge)", rest.rise / weight_energy, most_rise);
}

/// Three boxes of one cell; the third lies across the other two.
World small_heap(Real tolerance, Real modulus, Real damping, Real sleep_speed = 0) {
    Settings settings;
    settings.tolerance = tolerance;
    settings.max_iterations = 10000;
    World world = tuned_world(settings, {.sleep_speed = sleep_speed});
    world.add_collider(Plane{});
    const auto material =
        world.add_material({.young_modulus = modulus, .poisson_ratio = 0.3, .friction = 0.6, .damping = damping});
    const Mesh mesh = mesh::box({0.1, 0.1, 0.1}, {1, 1, 1});
    for (const Vec3& place : {Vec3(-0.06, 0, 0.051), Vec3(0.06, 0.01, 0.051), Vec3(0.004, 0.007, 0.154)})
        world.add_body(mesh, {.material = material, .position = place, .contact_distance = 2e-3});
    return world;
}

void rest_small_heap(int chunks) {
    World world = small_heap(1e-8, 2e6, 300);
    REQUIRE(world.advance(3).ok());
    Real weight = 0;
    for (const BodyHandle body : world.bodies()) weight += world.mass(body) * standard_gravity;
    const int steps = 10000;
    const Rest rest(world, chunks, steps);
    judge_rest(20, "heap of 3 boxes, tolerance 1e-8, " + text(chunks * steps) + " steps", rest, chunks * steps, 0.1,
               weight * 0.1);
    CHECK(world.contacts().size() >= 6);
}

}  // namespace

TEST_CASE("a heap at rest stays for a hundred thousand steps", "[scene][stress]") {
    rest_small_heap(10);
}

TEST_CASE("a heap at rest stays for a million steps", "[scene][stress][slow]") {
    rest_small_heap(100);
}

TEST_CASE("a tower of soft blocks only loses energy while its sway dies away", "[scene][stress]") {
    // Wide faces on wide faces, whose inner edges bend to and fro: the contact forces must not shake the tower.
    Settings settings;
    settings.tolerance = 1e-6;
    settings.max_iterations = 2000;
    World world(settings);
    world.add_collider(Plane{});
    const auto rubber = world.add_material({.young_modulus = 5e4, .density = 500, .friction = 0.5, .damping = 20});
    const Mesh mesh = mesh::box({0.2, 0.2, 0.1}, {3, 3, 2});
    Real weight = 0;
    for (int i = 0; i < 3; ++i) {
        const auto block = world.add_body(
            mesh,
            {.material = rubber, .position = {0.01 * i, 0.007 * i, 0.051 + 0.1025 * i}, .contact_distance = 2e-3});
        weight += world.mass(block) * standard_gravity;
    }
    REQUIRE(world.advance(4).ok());
    const auto swing = [&world] {  // largest motion within a second
        Real most = 0;
        for (int look = 0; look < 20; ++look) {
            REQUIRE(world.advance(0.05).ok());
            most = std::max(most, world.energy().kinetic);
        }
        return most;
    };
    const Real early = swing(), weight_energy = weight * 0.1;
    // The energy of a symplectic method oscillates by a thousandth of the kinetic energy, which is 2e-4 of this scale.
    const Rest rest(world, 200, 20);
    const std::string scene = "tower of 3 soft blocks";
    at_most(20, scene + ", 4000 steps", "rise of the energy / (weight times height)", rest.rise / weight_energy, 1e-6);
    at_most(20, scene + ", 4000 steps later", "kinetic energy of the sway / that before", swing() / early, 0.75);
}

TEST_CASE("a heap solved to the default tolerance creeps no faster than that allows", "[scene][stress]") {
    World world = small_heap(Settings{}.tolerance, 2e4, 300);
    REQUIRE(world.advance(3).ok());
    const Rest rest(world, 10, 1000);
    const Real h = world.stable_step(), seconds = 10000 * h;
    const std::string scene = "heap of 3 soft boxes, default tolerance 1e-3, 1e4 steps of " + text(1000 * h) + " ms";
    judge({20, scene, "every step taken, finite", rest.course.ok ? "all steps" : rest.course.message,
           rest.course.ok && rest.course.finite});
    // A contact has to stop a velocity of g h in each step, and is solved to the tolerance relative to that.
    at_most(20, scene, "speed of creep / (tolerance g h)",
            rest.drift / seconds / (Settings{}.tolerance * standard_gravity * h), 1);
}

TEST_CASE("a heap falls asleep, and then nothing moves", "[scene][stress]") {
    World world = small_heap(Settings{}.tolerance, 2e4, 300, 5e-3);
    REQUIRE(world.advance(3).ok());
    const std::string scene = "heap of 3 soft boxes, default tolerance 1e-3, sleep_speed 5 mm/s";
    at_least(20, scene + ", 3 s", "bodies asleep", static_cast<Real>(world.report().asleep), 3);
    const Rest rest(world, 10, 10000);
    at_most(20, scene + ", 1e5 steps later", "drift, m", rest.drift, 0);
}

TEST_CASE("balls in a bucket rest for a hundred thousand steps", "[scene][stress][slow]") {
    Settings settings;
    settings.tolerance = 1e-8;
    settings.max_iterations = 10000;
    World world(settings);
    world.add_collider(Bucket{.radius = 0.12, .height = 0.3, .thickness = 0.02});
    const auto material =
        world.add_material({.young_modulus = 2e4, .poisson_ratio = 0.3, .friction = 0.5, .damping = 300});
    const Mesh mesh = mesh::ball(0.05, 2);
    for (int k = 0; k < 4; ++k)
        world.add_body(mesh, {.material = material,
                              .position = {0.055 * std::cos(2.1 * k), 0.055 * std::sin(2.1 * k), 0.06 + 0.04 * k}});
    REQUIRE(world.advance(10).ok());
    Real weight = 0;
    for (const BodyHandle body : world.bodies()) weight += world.mass(body) * standard_gravity;
    const Rest rest(world, 10, 10000);
    // The balls can roll up as well as down. A contact has to stop a velocity of g h in each step, and is solved to the
    // tolerance relative to that.
    const Real h = world.stable_step(), creep = settings.tolerance * standard_gravity * h * 100000 * h;  // m
    judge_rest(0, "resting for long: 4 balls in a bucket, tolerance 1e-8, 1e5 steps", rest, 100000,
               world.mean_edge(world.bodies()[0]), weight * 0.05, creep / 0.05);
}

namespace {

/// Five boxes above each other, each shifted a little.
World stack_of_five(Real restitution, Real apart) {
    World world;
    world.add_collider(Plane{});
    const auto material = world.add_material(
        {.young_modulus = 1e6, .poisson_ratio = 0.3, .friction = 0.5, .restitution = restitution, .damping = 400});
    const Real edge = 0.1, shell = 2e-3;
    for (int k = 0; k < 5; ++k)
        world.add_body(mesh::box({edge, edge, edge}, {2, 2, 2}),
                       {.material = material,
                        .position = {0.002 * k, 0, shell / 2 + apart + edge / 2 + k * (edge + shell + apart)},
                        .contact_distance = shell});
    return world;
}

Real largest_speed(const World& world) {
    Real speed = 0;
    for (const BodyHandle body : world.bodies())
        for (const Vec3& v : world.velocities(body)) speed = std::max(speed, v.norm());
    return speed;
}

}  // namespace

TEST_CASE("boxes that fall onto each other gain no energy and end quiet, whatever the restitution", "[scene][stress]") {
    for (const Real restitution : {0.0, 0.5, 1.0}) {
        World world = stack_of_five(restitution, 0.008);
        const Course course = follow(world, 3, 100);
        const std::string scene = "5 boxes fall onto each other, restitution " + text(restitution) + ", 3 s";
        judge({14, scene, "every step taken, finite", course.ok ? "all steps" : course.message,
               course.ok && course.finite});
        // Kinetic and elastic energy are half a step apart (docs/methods/time_stepping.md 2.2). Their sum therefore
        // oscillates by a small part of the vibration energy.
        at_most(14, scene, "energy gained / in play", course.gain(), 1e-2);
        at_most(14, scene, "penetration / edge", course.max_penetration / 0.1, 1e-2);
        Real speed = 0;
        for (int step = 0; step < 100; ++step) {
            REQUIRE(world.advance(world.stable_step() * (1 - 1e-12)).ok());
            speed = std::max(speed, largest_speed(world));
        }
        // The stack still sways. Nodes that bounce for ever had a speed of 0.08 m/s.
        at_most(14, scene + ", then 100 steps", "largest speed, m/s", speed, 0.05);
    }
}

TEST_CASE("a stack at rest does not notice its restitution", "[scene][stress]") {
    std::vector<Vec3> without;
    for (const Real restitution : {0.0, 0.5, 1.0}) {
        World world = stack_of_five(restitution, 0);
        const Vec3 gravity = world.settings().gravity;
        for (int i = 1; i <= 100; ++i) {  // gravity is turned on slowly
            world.set_gravity(gravity * (i / 100.0));
            REQUIRE(world.advance(0.005).ok());
        }
        REQUIRE(world.advance(0.5).ok());
        const std::string scene = "5 boxes laid on each other, restitution " + text(restitution) + ", 1 s";
        at_most(14, scene, "largest speed / (g h)", largest_speed(world) / (standard_gravity * world.stable_step()), 1);
        if (restitution == 0) without = all_positions(world);
        at_most(14, scene, "positions apart from those without restitution, m",
                largest_distance(all_positions(world), without), 0);
    }
}

TEST_CASE("adding and removing bodies changes no bit of bodies without contact with them", "[scene][stress]") {
    const auto run = [](bool change) {
        Settings settings;
        settings.step_size = 1e-4;  // equal steps in both runs, whatever bodies there are
        World world(settings);
        world.add_collider(Plane{});
        const auto material = world.add_material({.young_modulus = 5e4, .friction = 0.4, .damping = 10});
        const Mesh ball = mesh::ball(0.05, 4);
        const auto add = [&](const Vec3& place) {
            return world.add_body(ball, {.material = material, .position = place});
        };
        const auto lower = add({0, 0, 0.06}), upper = add({0.01, 0, 0.17});
        const auto other = add({1, 0, 0.06}), above = add({1.01, 0.01, 0.17});
        REQUIRE(world.stable_step() > 1e-4);
        REQUIRE(world.advance(0.25).ok());
        if (change) world.remove(lower);  // its rows are the first, so all others move
        REQUIRE(world.advance(0.1).ok());
        if (change) add({-0.2, 0, 0.2});
        REQUIRE(world.advance(0.25).ok());
        if (change) world.remove(upper);
        const StepReport report = world.advance(0.1);
        REQUIRE(report.ok());
        std::vector<Vec3> all(world.positions(other).begin(), world.positions(other).end());
        all.insert(all.end(), world.positions(above).begin(), world.positions(above).end());
        all.insert(all.end(), world.velocities(above).begin(), world.velocities(above).end());
        return all;
    };
    const bool same = run(true) == run(false);
    judge({28, "two pairs of balls; of one pair bodies are removed and added, 0.7 s",
           "positions and velocities of the other pair the same bits", same ? "yes" : "no", same});
}

}  // namespace skerry::test::rest_test
