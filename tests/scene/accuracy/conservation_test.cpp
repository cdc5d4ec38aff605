// Conservation of momentum, angular momentum and energy in every step (docs/accuracy.md, items 2, 3 and 32).
#include <Eigen/Geometry>
#include <catch2/catch.hpp>
#include <cstdio>

#include "tests/support/accuracy.h"
#include "tests/support/elastic_body.h"
#include "tests/support/worlds.h"

namespace skerry::test::conservation_test {

using accuracy::Tolerance;

namespace {

/// Two balls with friction that hit each other off centre, in a world without a floor.
struct TwoBalls {
    World world;
    Mesh ball = mesh::ball(0.05, 5);
    std::array<BodyHandle, 2> body;
    std::vector<Real> mass;  // nodal masses, equal for both balls

    explicit TwoBalls(const Settings& settings, Real damping = 0) : world(settings) {
        const auto rubber =
            world.add_material(test::lossless({.young_modulus = 5e4, .friction = 0.6, .damping = damping}));
        body[0] = world.add_body(
            ball,
            {.material = rubber, .position = {-0.06, 0, 0}, .velocity = {1, 0, 0}, .angular_velocity = {3, -4, 5}});
        body[1] = world.add_body(ball, {.material = rubber, .position = {0.06, 0.03, 0.01}, .velocity = {-1, 0.5, 0}});
        mass = node_masses(world, body[0], ball, 1000);
    }
    Vec3 momentum() const {
        return world.mass(body[0]) * (mean_velocity(world, body[0], mass) + mean_velocity(world, body[1], mass));
    }
    Vec3 angular_momentum() const {
        Vec3 sum = Vec3::Zero();
        for (BodyHandle b : body)
            for (std::size_t n = 0; n < mass.size(); ++n)
                sum += mass[n] * world.positions(b)[n].cross(world.velocities(b)[n]);
        return sum;
    }
    Real sum_of_momenta() const {  // sum of m |v|
        Real sum = 0;
        for (BodyHandle b : body)
            for (std::size_t n = 0; n < mass.size(); ++n) sum += mass[n] * world.velocities(b)[n].norm();
        return sum;
    }
};

Settings in_short_steps(const Vec3& gravity) {
    Settings settings = accurate(gravity, 1e-10);
    settings.step_size = 2.5e-4;  // a third of the stable step of the balls
    return settings;
}

}  // namespace

TEST_CASE("two balls that collide under gravity keep their momentum but for the weight, in every step",
          "[scene][accuracy]") {
    for (Friction friction : {Friction::cone, Friction::pyramid}) {
        const Vec3 gravity(0.3, 0.1, -standard_gravity);
        Settings settings = in_short_steps(gravity);
        settings.friction = friction;
        TwoBalls scene(settings);
        Real worst = 0;
        for (int step = 0; step < 800; ++step) {
            const Vec3 before = scene.momentum();
            const StepReport report = scene.world.advance(2.5e-4);
            REQUIRE(report.ok());
            REQUIRE(report.steps == 1);
            const Vec3 weight = 2 * scene.world.mass(scene.body[0]) * report.step_size * gravity;
            worst = std::max(worst, (scene.momentum() - before - weight).norm() / scene.sum_of_momenta());
        }
        REQUIRE(scene.world.report().max_contacts > 3);
        accuracy::check({.item = 2,
                         .name = "two balls, change of momentum less the weight, worst step, over sum m |v|, " +
                                 std::string(name_of(friction)),
                         .formula = "M g h",
                         .found = worst,
                         .tolerance = 1e-13,
                         .kind = Tolerance::absolute});
    }
}

TEST_CASE("a free spinning body keeps its angular momentum in every step", "[scene][accuracy]") {
    for (const auto model : {MaterialModel::corotational, MaterialModel::stable_neo_hookean})
        for (const Real damping : {0.0, 5.0}) {
            World world(in_short_steps(Vec3::Zero()));
            const auto material =
                world.add_material(test::lossless({.young_modulus = 1e5, .damping = damping, .model = model}));
            world.add_body(mesh::box({0.2, 0.1, 0.05}, {4, 3, 2}),
                           {.material = material, .velocity = {1, 2, 3}, .angular_velocity = {3, -4, 5}});
            Real worst = 0;
            Vec3 before = world.report().angular_momentum;
            for (int step = 0; step < 1000; ++step) {
                REQUIRE(world.advance(2.5e-4).ok());
                const Vec3 now = world.report().angular_momentum;
                worst = std::max(worst, (now - before).norm() / now.norm());
                before = now;
            }
            accuracy::check({.item = 3,
                             .name = "spinning block, change of angular momentum, worst step, relative, " +
                                     std::string(name_of(model)) + (damping > 0 ? ", damped" : ""),
                             .formula = "0",
                             .found = worst,
                             .tolerance = 1e-12,
                             .kind = Tolerance::absolute});
        }
}

TEST_CASE("a free spinning bar of smoothed elements keeps energy and angular momentum for 10,000 steps",
          "[scene][accuracy]") {
    for (const auto model : {MaterialModel::corotational, MaterialModel::stable_neo_hookean}) {
        Settings settings;
        settings.gravity = Vec3::Zero();
        settings.integrator = Integrator::leapfrog;
        World world(settings);
        const auto material =
            world.add_material(test::lossless({.young_modulus = 1e6, .poisson_ratio = 0.3, .model = model}));
        world.add_body(mesh::box({1, 0.1, 0.1}, {20, 2, 2}), {.material = material, .angular_velocity = {0.5, 3, 1}});
        const Real h = 0.55 * world.stable_step();  // half of the stable step; the error is of second order
        const WorldReport start = world.report();
        const auto energy = [&] {
            const Energy now = world.energy();
            return now.kinetic + now.elastic;
        };
        Real worst = 0;
        std::array<Real, 2> mean{};  // over the first and the last tenth
        const Real before = energy();
        constexpr int steps = 10000;
        for (int step = 0; step < steps; ++step) {
            REQUIRE(world.advance(h).steps == 1);
            const Real error = energy() / before - 1;
            worst = std::max(worst, std::abs(error));
            if (step < steps / 10) mean[0] += error / (steps / 10);
            if (step >= steps - steps / 10) mean[1] += error / (steps / 10);
        }
        const std::string bar = "free spinning bar, 10,000 leapfrog steps, " + std::string(name_of(model));
        accuracy::check({.item = 40,
                         .name = bar + ", largest change of energy, relative",
                         .formula = "0",
                         .found = worst,
                         .tolerance = 2e-6,
                         .kind = Tolerance::absolute});
        accuracy::check({.item = 40,
                         .name = bar + ", mean energy of the last tenth less that of the first, relative",
                         .formula = "0",
                         .found = mean[1] - mean[0],
                         .tolerance = 1e-7,
                         .kind = Tolerance::absolute});
        accuracy::check(
            {.item = 40,
             .name = bar + ", change of angular momentum, relative",
             .formula = "0",
             .found = (world.report().angular_momentum - start.angular_momentum).norm() / start.angular_momentum.norm(),
             .tolerance = 1e-13,
             .kind = Tolerance::absolute});
    }
}

TEST_CASE("friction across a gap turns a pair of bodies by the known torque and no more", "[scene][accuracy]") {
    TwoBalls scene(in_short_steps(Vec3::Zero()));
    const Real scale = scene.angular_momentum().norm();
    Real worst = 0, largest = 0;
    for (int step = 0; step < 800; ++step) {
        const Vec3 before = scene.angular_momentum();
        std::array<std::vector<Vec3>, 2> start;
        for (std::size_t b : {0, 1})
            start[b].assign(scene.world.positions(scene.body[b]).begin(), scene.world.positions(scene.body[b]).end());
        const Real h = scene.world.advance(2.5e-4).step_size;
        // The two points where a contact pulls are `distance` apart along the normal.
        Vec3 torque = Vec3::Zero(), moved = Vec3::Zero();
        for (const Contact& c : scene.world.contacts()) torque += c.distance * c.normal.cross(c.impulse);
        // Pushing overlapping shells apart changes positions only.
        for (std::size_t b : {0, 1})
            for (std::size_t n = 0; n < scene.mass.size(); ++n) {
                const Vec3 v = scene.world.velocities(scene.body[b])[n];
                moved += scene.mass[n] * (scene.world.positions(scene.body[b])[n] - start[b][n] - h * v).cross(v);
            }
        largest = std::max(largest, torque.norm() / scale);
        worst = std::max(worst, (scene.angular_momentum() - before - torque - moved).norm() / scale);
    }
    REQUIRE(largest > 1e-6);  // the two sides are not both zero
    accuracy::check(
        {.item = 3,
         .name =
             "two balls with friction, change of angular momentum less the torque of the gaps, worst step, relative",
         .formula = "sum d n x r",
         .found = worst,
         .tolerance = 1e-12,
         .kind = Tolerance::absolute,
         .note = "Friction acts on two points that are the distance d apart, so that it leaves the torque d n x r: of "
                 "the order of the "
                 "contact distance, and the only source of angular momentum but for the push that takes overlapping "
                 "shells apart. "
                 "That push moves positions without touching velocities; its share sum m dx x v is taken off, too."});
}

TEST_CASE("a bar that bounces without friction never gains discrete energy", "[scene][accuracy]") {
    // docs/methods/time_stepping.md 2.1: E_n = v_n+1 M v_n+1 / 2 + x_n K x_n+1 / 2 + weight at the middle of the step.
    // The shell is thick enough to find every contact that closes in a step. A contact that closes by elastic forces
    // alone is found within a twentieth of the shell (contact_reach.h). Found later it would be inside the shell, where
    // the theorem does not apply.
    constexpr Real density = 1000, shell = 0.04;
    for (Real fraction : {0.5, 0.9, 1.0}) {
        Settings settings = in_short_steps({0, 0, -standard_gravity});
        settings.tolerance = 1e-14;
        settings.step_size.reset();
        World world(settings);
        const auto material = world.add_material(test::lossless(
            {.young_modulus = 1e5, .poisson_ratio = 0.3, .friction = 0, .model = MaterialModel::linear}));
        world.add_collider(Plane{});
        const Mesh mesh = mesh::box({0.1, 0.1, 1}, {1, 1, 10});
        const auto bar = world.add_body(
            mesh, {.material = material, .position = {0, 0, 0.55}, .velocity = {0, 0, -1}, .contact_distance = shell});
        // A second body computes the elastic forces K (x - rest) of the position before the step.
        ElasticBody twin({mesh.nodes, mesh.tetrahedra}, material_constants(MaterialModel::linear, 1e5, 0.3, density),
                         Mat3::Identity(), resolved(ElementKind::smoothed, 0.3));
        const auto executor = make_executor(Backend::serial, 1);
        std::vector<Vec3> rest(world.positions(bar).begin(), world.positions(bar).end());
        const Real h = fraction * world.stable_step();
        Real last = 0, scale = 0, worst = -1, lowest_gap = 0;
        int touching = 0, flying = 0;
        for (int step = 0; step < 5000; ++step) {
            std::copy(world.positions(bar).begin(), world.positions(bar).end(), twin.position.begin());
            twin.compute_forces(*executor);
            const StepReport report = world.advance(h);
            REQUIRE(report.ok());
            REQUIRE(report.steps == 1);
            bool touches = false;
            for (const Contact& c : world.contacts()) {
                touches |= c.impulse.z() > 0;
                lowest_gap = std::min(lowest_gap, c.gap);
            }
            touching += touches;
            flying += !touches && touching > 0;
            Real energy = 0;
            for (std::size_t n = 0; n < rest.size(); ++n) {
                const Vec3 v = world.velocities(bar)[n], x = world.positions(bar)[n];
                energy += 0.5 * twin.mass[n] * v.squaredNorm() - 0.5 * twin.force[n].dot(x - rest[n]) +
                          twin.mass[n] * standard_gravity * (x.z() - 0.5 * report.step_size * v.z());
            }
            scale = std::max(scale, std::abs(energy));
            if (step > 0) worst = std::max(worst, (energy - last) / scale);
            last = energy;
        }
        REQUIRE(touching > 100);
        REQUIRE(flying > 100);
        REQUIRE(lowest_gap > -1e-12);  // rounding of positions of about a metre
        char name[100];
        std::snprintf(name, sizeof name,
                      "bouncing bar, largest gain of energy in a step over energy, %.0f %% of the stable step",
                      100 * fraction);
        accuracy::check({.item = 32,
                         .name = name,
                         .formula = "<= 0",
                         .found = std::max(worst, Real(0)),
                         .tolerance = 1e-14,
                         .kind = Tolerance::absolute,
                         .note = "The theorem asks that no gap is negative, which is asserted, too. A contact that an "
                                 "elastic force closes within a "
                                 "step is noticed while it is within a twentieth of the contact distance; the shell of "
                                 "this test is as thick as that "
                                 "needs. With a thin one a node can enter the shell, and leave it with a gain."});
    }
}

}  // namespace skerry::test::conservation_test
