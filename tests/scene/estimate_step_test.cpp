// Estimated errors of steps and contacts, compared with the true ones (docs/methods/error_estimates.md).
#include <catch2/catch.hpp>
#include <cmath>
#include <optional>
#include <string>
#include <tuple>

#include "engine/estimate/contact_area.h"
#include "engine/estimate/contact_error.h"
#include "engine/estimate/step_error.h"
#include "skerry/problem.h"
#include "skerry/surface.h"
#include "tests/support/mapped_box.h"
#include "tests/support/worlds.h"

namespace skerry::test::estimate_step_test {

namespace {

/// A world with one body, sampled at the ends of calls of advance.
struct Case {
    std::string name;
    Real step;            // [s]
    Real frame, seconds;  // time between samples, and duration of the run [s]
    BodySettings body{};  // without material
    Mesh mesh{};          // empty: a rigid sphere
    MaterialSettings material{};
    bool held = false;  // true: the end with the smallest x is held
    Real slope = 0;     // [degree]
    bool floor = false;
    Settings settings{};
    Real restitution = 0;         // of the pair of the body and the floor
    std::optional<Vec3> other{};  // centre of a sphere in the way of the body [m]
    int order = 1;                // order of the error in the length of the steps
    Real within = 1.25;           // largest ratio of estimated and true error
};

struct Run {
    std::vector<std::vector<Vec3>> places;  // node positions at the samples [m]
    ErrorEstimate estimate;
};

Run run(const Case& test_case, Real factor) {
    Settings settings = test_case.settings;
    settings.gravity = tilted_gravity(test_case.slope);
    settings.step_size = test_case.step * factor;
    settings.sleep = false;
    World world(settings);
    BodySettings settings_of_body = test_case.body;
    settings_of_body.material = world.add_material(test_case.material);
    const BodyHandle body = test_case.mesh.nodes.empty() ? world.add_body(Sphere{.radius = 0.05}, settings_of_body)
                                                         : world.add_body(test_case.mesh, settings_of_body);
    if (test_case.other)
        world.add_body(
            Sphere{.radius = 0.05},
            {.material = settings_of_body.material, .position = *test_case.other, .dynamics = BodyDynamics::rigid});
    if (test_case.held) {
        Real lowest_x = infinity;
        for (const Vec3& x : test_case.mesh.nodes) lowest_x = std::min(lowest_x, x.x());
        world.attach(body, nodes_where(test_case.mesh, [&](const Vec3& x) { return x.x() < lowest_x + 1e-9; }));
    }
    if (test_case.floor) {
        const ColliderHandle floor = world.add_collider(Plane{});
        SurfacePairs pairs(world);
        pairs.set_material(floor, settings_of_body.material);
        if (test_case.restitution > 0)
            pairs.set(settings_of_body.material, settings_of_body.material, {.restitution = test_case.restitution});
    }
    StepError error;
    Run found;
    const auto sample = [&] {
        error.sample(world);
        found.places.emplace_back(world.positions(body).begin(), world.positions(body).end());
    };
    sample();
    while (world.time() < test_case.seconds - test_case.frame / 2) {
        REQUIRE(world.advance(test_case.frame).ok());
        sample();
    }
    std::vector<ErrorEstimate> bodies{{.body = body, .name = {}}};
    error.add_to(bodies);
    found.estimate = bodies.front();
    return found;
}

/// Root mean square distance of the nodes.
Real distance(const std::vector<Vec3>& a, const std::vector<Vec3>& b) {
    Real sum = 0;
    for (std::size_t n = 0; n < a.size(); ++n) sum += (a[n] - b[n]).squaredNorm();
    return std::sqrt(sum / static_cast<Real>(a.size()));
}

/// The true error of a run, from a run with steps a quarter as long.
Real true_error(const Run& run, const Run& finer, int order) {
    Real error = 0, moved = 0;
    for (std::size_t s = 0; s < run.places.size(); ++s) {
        error = std::max(error, distance(run.places[s], finer.places[s]));
        moved = std::max(moved, distance(run.places[s], run.places.front()));
    }
    return error / (1 - std::pow(0.25, order)) / moved;
}

std::vector<Case> cases() {
    const Mesh bar = mesh::box({0.2, 0.02, 0.02}, {10, 1, 1}), block = mesh::box({0.1, 0.1, 0.05}, {2, 2, 1});
    const MaterialSettings rubber = lossless({.young_modulus = 1e6, .poisson_ratio = 0.3}),
                           stiff = lossless({.young_modulus = 1e8, .poisson_ratio = 0.3}),
                           soft{.young_modulus = 1e6, .friction = 0.3};
    const BodySettings rigid{.position = {0, 0, 0.0255}, .dynamics = BodyDynamics::rigid},
        elastic{.position = {0, 0, 0.0255}, .dynamics = BodyDynamics::explicit_elastic},
        implicit{.dynamics = BodyDynamics::implicit_elastic};
    BodySettings thrown = rigid, pushed = elastic, dropped = rigid;
    dropped.position.z() = 0.2;
    BodySettings tumbling = rigid;
    tumbling.angular_velocity = {0.05, 6, 0};
    thrown.velocity = pushed.velocity = {1, 0, 0};
    BodySettings colliding = rigid;
    colliding.position = {-0.4, 0, 0.3};
    colliding.velocity = {2, 0, 0};
    Settings vibrating;
    vibrating.theta = 0.55;
    Settings undamped;
    undamped.theta = 0.5;
    Settings leapfrog;
    leapfrog.integrator = Integrator::leapfrog;
    return {
        {.name = "thrown", .step = 2e-3, .frame = 0.01, .seconds = 0.2, .body = thrown, .mesh = block},
        {.name = "tumbles freely",
         .step = 4e-3,
         .frame = 0.02,
         .seconds = 2,
         .body = tumbling,
         .mesh = mesh::box({0.3, 0.2, 0.1}, {1, 1, 1}),
         .settings = leapfrog,
         .order = 2,
         .within = 4},
        {.name = "stopped by friction",
         .step = 2e-3,
         .frame = 0.01,
         .seconds = 0.5,
         .body = thrown,
         .mesh = block,
         .floor = true},
        {.name = "bouncing sphere",
         .step = 2e-3,
         .frame = 0.01,
         .seconds = 0.7,
         .body = dropped,
         .material = {.restitution = 0.8},
         .floor = true,
         .within = 3},
        {.name = "bouncing sphere, by a pair of materials",
         .step = 2e-3,
         .frame = 0.01,
         .seconds = 0.7,
         .body = dropped,
         .floor = true,
         .restitution = 0.8,
         .within = 3},
        {.name = "bouncing sphere, leapfrog",
         .step = 2e-3,
         .frame = 0.01,
         .seconds = 0.7,
         .body = dropped,
         .material = {.restitution = 0.8},
         .floor = true,
         .settings = leapfrog,
         .within = 3},
        {.name = "sphere that collides with another one",
         .step = 4e-3,
         .frame = 0.01,
         .seconds = 0.35,
         .body = colliding,
         .floor = true,
         .other = Vec3(0, 0, 0.05),
         .within = 3},
        {.name = "elastic, stopped by friction",
         .step = 2e-4,
         .frame = 0.01,
         .seconds = 0.1,
         .body = pushed,
         .mesh = block,
         .material = soft,
         .floor = true},
        {.name = "slides down",
         .step = 2e-3,
         .frame = 0.01,
         .seconds = 0.3,
         .body = rigid,
         .mesh = block,
         .material = soft,
         .slope = 30,
         .floor = true},
        {.name = "cantilever",
         .step = 2e-4,
         .frame = 0.01,
         .seconds = 0.2,
         .body = elastic,
         .mesh = bar,
         .material = rubber,
         .held = true},
        {.name = "wave in a bar",
         .step = 2e-4,
         .frame = 0.002,
         .seconds = 0.06,
         .body = elastic,
         .mesh = bar,
         .material = rubber,
         .held = true,
         .slope = 90},
        {.name = "implicit cantilever",
         .step = 2e-3,
         .frame = 0.01,
         .seconds = 0.2,
         .body = implicit,
         .mesh = bar,
         .material = rubber,
         .held = true},
        {.name = "implicit cantilever, long steps",
         .step = 1.0 / 120,
         .frame = 1.0 / 60,
         .seconds = 0.5,
         .body = implicit,
         .mesh = bar,
         .material = rubber,
         .held = true},
        {.name = "stiff implicit cantilever",
         .step = 1.0 / 120,
         .frame = 1.0 / 60,
         .seconds = 0.3,
         .body = implicit,
         .mesh = bar,
         .material = stiff,
         .held = true,
         .within = 2},
        {.name = "implicit cantilever, theta 0.5",
         .step = 1.0 / 120,
         .frame = 1.0 / 60,
         .seconds = 1.5,
         .body = implicit,
         .mesh = bar,
         .material = rubber,
         .held = true,
         .settings = undamped,
         .order = 2},
        {.name = "implicit cantilever, theta 0.55",
         .step = 2e-3,
         .frame = 0.01,
         .seconds = 0.2,
         .body = implicit,
         .mesh = bar,
         .material = rubber,
         .held = true,
         .settings = vibrating},
    };
}

}  // namespace

TEST_CASE("the estimated error of the steps is near the true error", "[scene][long]") {
    for (const Case& test_case : cases()) {
        CAPTURE(test_case.name);
        const Run coarse = run(test_case, 1);
        const Real truth = true_error(coarse, run(test_case, 0.25), test_case.order);
        CHECK(coarse.estimate.step < test_case.within * truth);
        CHECK(coarse.estimate.step > truth / test_case.within);
    }
}

TEST_CASE("a slow load on an implicit body leaves an error below the share of the energy that its steps dissipate",
          "[scene]") {
    constexpr int ramp = 25;  // steps in which the load grows
    Settings settings;
    settings.gravity = Vec3::Zero();
    settings.step_size = 0.01;
    World world(settings);
    const Mesh bar = mesh::box({0.2, 0.02, 0.02}, {10, 1, 1});
    const BodyHandle body =
        world.add_body(bar, {.material = world.add_material(lossless({.young_modulus = 1e9, .poisson_ratio = 0.3})),
                             .dynamics = BodyDynamics::implicit_elastic});
    world.attach(body, nodes_where(bar, [](const Vec3& x) { return x.x() < -0.099; }));
    StepError error;
    error.sample(world);
    for (int step = 1; step <= 2 * ramp; ++step) {
        const Real share = std::min(1.0, static_cast<Real>(step) / ramp);
        world.set_loads(body, std::vector<Vec3>(bar.nodes.size(), Vec3(0, 0, share)));
        REQUIRE(world.advance(*settings.step_size).ok());
        if (step % ramp == 0) error.sample(world);
    }
    std::vector<ErrorEstimate> bodies{{.body = body, .name = {}}};
    error.add_to(bodies);
    // Each step dissipates about 1/ramp^2 of the elastic energy.
    CHECK(bodies.front().step < 1.25 * std::sqrt(1.0 / ramp));
}

TEST_CASE("a body that falls freely with leapfrog has no error of the steps", "[scene]") {
    Case test_case{
        .name = {}, .step = 2e-3, .frame = 0.02, .seconds = 0.2, .mesh = mesh::box({0.1, 0.1, 0.05}, {1, 1, 1})};
    test_case.body.dynamics = BodyDynamics::rigid;
    test_case.settings.integrator = Integrator::leapfrog;
    CHECK(run(test_case, 1).estimate.step == 0);
}

namespace {

/// Rigid boxes on top of each other, on a floor, with a tolerance of the solver. Adds the estimates of three times.
struct Stack {
    World world;
    std::vector<BodyHandle> boxes;
    ContactError error;

    explicit Stack(Real tolerance, int iterations) : world(settings_of(tolerance, iterations)) {
        world.add_collider(Plane{});
        const Mesh box = mesh::box({0.1, 0.1, 0.1}, {1, 1, 1});
        for (int k = 0; k < 4; ++k)
            boxes.push_back(world.add_body(box, {.material = world.add_material({.density = 1000}),
                                                 .position = {0.01 * k, 0, 0.05 + 0.1 * k},
                                                 .dynamics = BodyDynamics::rigid}));
    }
    static Settings settings_of(Real tolerance, int iterations) {
        Settings settings;
        settings.tolerance = tolerance;
        settings.max_iterations = iterations;
        settings.step_size = 2e-3;
        settings.sleep = false;
        return settings;
    }
    ErrorEstimate estimate(BodyHandle body) const {
        std::vector<ErrorEstimate> bodies{{.body = body, .name = {}}};
        error.add_to(bodies);
        return bodies.front();
    }
};

}  // namespace

TEST_CASE("the estimated error of contacts is within a factor of 4 of the error of the force in a step",
          "[scene][long]") {
    for (const auto& [tolerance, iterations] : {std::pair{1e-3, 200}, {1e-2, 200}, {1e-6, 2}}) {
        CAPTURE(tolerance, iterations);
        Stack stack(tolerance, iterations);
        Real squares = 0;
        int steps = 0;
        stack.world.watch_contact_problems([&](const StepProblem& step) {
            const ProblemSolution exact = solve_problem(step.problem, {.tolerance = 1e-8});
            Real change = 0, total = 0;  // of the normal impulses
            for (std::size_t c = 0; c < step.impulse.size(); ++c) {
                change += step.impulse[c].x() - exact.reaction[c].x();
                total += exact.reaction[c].x();
            }
            if (step.step <= 10) return;
            squares += change * change / (total * total);
            ++steps;
        });
        for (int k = 0; k < 25; ++k) {
            REQUIRE(stack.world.advance(2e-3).ok());
            stack.error.sample(stack.world);
        }
        const Real truth = std::sqrt(squares / steps), found = stack.estimate(stack.boxes.front()).contact;
        CHECK(found < 4 * truth);
        CHECK(found > truth / 4);
    }
}

TEST_CASE("errors of contacts can be sampled after the removal of a body and after a load, before the next step",
          "[scene]") {
    Stack stack(1e-6, 200);
    REQUIRE(stack.world.advance(0.02).ok());
    stack.world.remove(stack.boxes.back());
    stack.error.sample(stack.world);
    const World loaded = World::from_bytes(stack.world.to_bytes());
    stack.error.sample(loaded);
    CHECK(std::isnan(stack.estimate(stack.boxes.front()).contact));
    REQUIRE(stack.world.advance(0.02).ok());
    stack.error.sample(stack.world);
    CHECK(stack.estimate(stack.boxes.front()).contact >= 0);
}

TEST_CASE("the gap of a box at rest on a floor is the height at which it rests", "[scene]") {
    constexpr Real size = 0.1;
    World world;
    world.add_collider(Plane{});
    const BodyHandle box = world.add_body(mesh::box({size, size, size}, {2, 2, 2}),
                                          {.material = world.add_material({.young_modulus = 1e7}),
                                           .position = {0, 0, size / 2},
                                           .dynamics = BodyDynamics::explicit_elastic});
    ErrorEstimator errors(world);
    REQUIRE(world.advance(0.1).ok());
    errors.finish(world);
    Real lowest = infinity;
    for (const Vec3& x : world.positions(box)) lowest = std::min(lowest, x.z());
    REQUIRE(lowest > 0);
    // Contacts have the distance before the last step.
    CHECK(errors.bodies().front().gap == Approx(lowest).epsilon(0.01));
}

TEST_CASE("the coarsest ball has a contact area", "[scene]") {
    World world;
    world.add_collider(Plane{});
    const BodyHandle body = world.add_body(
        mesh::ball(0.05, 2),
        {.material = world.add_material({.young_modulus = 1e5}), .position = {0, 0, 0.05}, .velocity = {0, 0, -0.2}});
    REQUIRE(world.advance(0.01).ok());
    ContactArea area;
    area.sample(world);
    std::vector<ErrorEstimate> bodies{{.body = body, .name = {}}};
    area.add_to(bodies);
    CHECK(bodies.front().contact_radius > 0);
}

TEST_CASE("the contact area of a ball on a floor is that of Hertz, and a cube has none", "[scene]") {
    const Real radius = 0.05, young_modulus = 1e5, poisson_ratio = 0.3;  // [m], [Pa]
    World world;
    world.add_collider(Plane{});
    const auto material = world.add_material({.young_modulus = young_modulus, .poisson_ratio = poisson_ratio});
    std::vector<ErrorEstimate> bodies;
    for (const Mesh& mesh : {mesh::ball(radius, 6), mesh::box({0.1, 0.1, 0.1}, {2, 2, 2})})
        bodies.push_back({.body = world.add_body(mesh, {.material = material,
                                                        .position = {static_cast<Real>(bodies.size()), 0, radius},
                                                        .velocity = {0, 0, -0.2}}),
                          .name = {}});
    REQUIRE(world.advance(0.01).ok());
    Real force = 0;  // [N]
    for (const Contact& contact : world.contacts())
        if (contact.first == bodies[0].body) force += contact.force().norm();
    REQUIRE(force > 0);
    ContactArea area;
    area.sample(world);
    area.add_to(bodies);
    const Real expected = std::cbrt(0.75 * force * radius * (1 - poisson_ratio * poisson_ratio) / young_modulus);
    CHECK(bodies[0].contact_radius == Approx(expected).epsilon(0.01));
    CHECK(bodies[0].contact_edge == Approx(0.35 * radius).epsilon(0.3));
    CHECK(std::isnan(bodies[1].contact_radius));
}

TEST_CASE("the contact area of two balls follows from the radii and the stiffness of both", "[scene]") {
    constexpr Real poisson_ratio = 0.3;
    Settings settings;
    settings.gravity = Vec3::Zero();
    World world(settings);
    Real curvature = 0, compliance = 0;  // [1/m], [1/Pa]
    std::vector<ErrorEstimate> bodies;
    for (const auto& [radius, young_modulus, side] : {std::tuple{0.05, 1e5, 1.0}, std::tuple{0.1, 3e5, -1.0}}) {
        const auto material = world.add_material({.young_modulus = young_modulus, .poisson_ratio = poisson_ratio});
        bodies.push_back({.body = world.add_body(mesh::ball(radius, 6), {.material = material,
                                                                         .position = {0, 0, side * radius},
                                                                         .velocity = {0, 0, -0.1 * side}}),
                          .name = {}});
        curvature += 1 / radius;
        compliance += (1 - poisson_ratio * poisson_ratio) / young_modulus;
    }
    REQUIRE(world.advance(0.01).ok());
    Real force = 0;  // [N]
    for (const Contact& contact : world.contacts()) force += contact.force().norm();
    REQUIRE(force > 0);
    ContactArea area;
    area.sample(world);
    area.add_to(bodies);
    const Real expected = std::cbrt(0.75 * force / curvature * compliance);
    for (const ErrorEstimate& estimate : bodies) CHECK(estimate.contact_radius == Approx(expected).epsilon(0.02));
}

}  // namespace skerry::test::estimate_step_test
