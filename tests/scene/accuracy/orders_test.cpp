// Convergence of errors with the step and with the tolerance of the solver (docs/accuracy.md, item 31).
#include <catch2/catch.hpp>

#include "skerry/problem.h"
#include "tests/support/accuracy.h"
#include "tests/support/worlds.h"

namespace skerry::test::orders_test {

using accuracy::Tolerance;

namespace {

using Positions = std::vector<Vec3>;

/// Root mean square distance [m]
Real distance(const Positions& a, const Positions& b) {
    Real sum = 0;
    for (std::size_t n = 0; n < a.size(); ++n) sum += (a[n] - b[n]).squaredNorm();
    return std::sqrt(sum / static_cast<Real>(a.size()));
}

/// A block that hangs by its top and is let go. `early`: velocities start half a force interval (kick) early
/// (leapfrog).
Positions hang(Real h, bool early) {
    Settings settings;
    settings.step_size = h;
    World world(settings);
    const auto material = world.add_material(test::lossless({.young_modulus = 2e4, .poisson_ratio = 0.3}));
    const Mesh mesh = mesh::box({0.1, 0.1, 0.2}, {2, 2, 4});
    const auto body = world.add_body(mesh, {.material = material});
    std::vector<Index> top;
    Positions velocity;
    for (std::size_t n = 0; n < mesh.nodes.size(); ++n) {
        const bool held = mesh.nodes[n].z() > 0.1 - 1e-9;
        if (held) top.push_back(static_cast<Index>(n));
        // The block has no stress, so the first kick is that of gravity alone.
        velocity.push_back(early && !held ? Vec3(0, 0, 0.5 * h * standard_gravity) : Vec3::Zero());
    }
    world.attach(body, top);
    world.set_velocities(body, velocity);
    REQUIRE(world.advance(0.128).ok());
    return {world.positions(body).begin(), world.positions(body).end()};
}

/// A ball that hits a plane and has left it again.
Positions bounce(Real h) {
    Settings settings;
    settings.step_size = h;
    settings.gravity = Vec3::Zero();
    settings.tolerance = 1e-10;
    settings.max_iterations = 20000;
    World world(settings);
    const auto material =
        world.add_material(test::lossless({.young_modulus = 2e4, .poisson_ratio = 0.3, .friction = 0.3}));
    world.add_collider(Plane{});
    const auto body = world.add_body(
        mesh::ball(0.05, 4),
        {.material = material, .position = {0, 0, 0.0537}, .velocity = {0.1, 0, -0.4}, .contact_distance = 0.004});
    REQUIRE(world.advance(0.128).ok());
    REQUIRE(world.contacts().empty());
    return {world.positions(body).begin(), world.positions(body).end()};
}

/// A block that lands flat, is compressed and leaves again, by leapfrog.
Positions land_flat(Real h, Real friction = 0, const Vec3& velocity = {0, 0, -0.7}) {
    Settings settings = accurate({0, 0, -standard_gravity}, 1e-10);
    settings.integrator = Integrator::leapfrog;
    settings.step_size = h;
    World world(settings);
    const auto material = world.add_material(
        test::lossless({.young_modulus = 1e5, .poisson_ratio = 0.3, .density = 1000, .friction = friction}));
    world.add_collider(Plane{});
    const auto body = world.add_body(
        mesh::box({0.1, 0.1, 0.1}, {2, 2, 2}),
        {.material = material, .position = {0, 0, 0.09}, .velocity = velocity, .contact_distance = 0.001});
    REQUIRE(world.advance(0.1).ok());
    REQUIRE(world.report().max_contacts == 9);
    REQUIRE(world.contacts().empty());
    return {world.positions(body).begin(), world.positions(body).end()};
}

/// A block that lands flat and slides so fast that no node reverses.
Positions land_slide(Real h) {
    return land_flat(h, 0.3, {3, 1, -0.7});
}

/// Slope of log(error) over log(h) for h, h/2, h/4, h/8.
template <class Run>
Real order(Real h, const Positions& reference, Run run) {
    Real slope = 0;
    const std::array<Real, 4> place{-1.5, -0.5, 0.5, 1.5};
    for (std::size_t k = 0; k < 4; ++k) slope -= place[k] * std::log2(distance(run(h / std::exp2(k)), reference)) / 5;
    return slope;
}

}  // namespace

TEST_CASE("errors fall with the step as they must", "[scene][accuracy]") {
    const Real h = 1e-3;
    const Positions limit = hang(h / 256, true);
    accuracy::check({.item = 31,
                     .name = "hanging block let go, order of the positions in h, velocities start with the positions",
                     .formula = "1",
                     .expected = 1,
                     .found = order(h, limit, [](Real step) { return hang(step, false); }),
                     .tolerance = 0.1,
                     .kind = Tolerance::absolute});
    accuracy::check({.item = 31,
                     .name = "hanging block let go, order of the positions in h, leapfrog start",
                     .formula = "2",
                     .expected = 2,
                     .found = order(h, limit, [](Real step) { return hang(step, true); }),
                     .tolerance = 0.1,
                     .kind = Tolerance::absolute});
    const Positions after = bounce(h / 256);
    accuracy::check({.item = 31,
                     .name = "ball after a bounce, order of the positions in h",
                     .formula = "1, about",
                     .expected = 1,
                     .found = order(h, after, [](Real step) { return bounce(step); }),
                     .tolerance = 0.4,
                     .kind = Tolerance::absolute,
                     .note = "After a bounce with friction: where the slip of a node turns back within a step friction "
                             "has one sign for "
                             "all of it, which is an error of the order of h."});
    accuracy::check({.item = 31,
                     .name = "block that lands flat and slides, leapfrog, order of the positions in h",
                     .formula = "2",
                     .expected = 2,
                     .found = order(4e-4, land_slide(4e-4 / 256), [](Real step) { return land_slide(step); }),
                     .tolerance = 0.1,
                     .kind = Tolerance::absolute,
                     .note = "Friction has the direction of the slip in the middle of the step's kick."});
    accuracy::check({.item = 31,
                     .name = "block that lands flat and leaves, no friction, leapfrog, order of the positions in h",
                     .formula = "2",
                     .expected = 2,
                     .found = order(4e-4, land_flat(4e-4 / 256), [](Real step) { return land_flat(step); }),
                     .tolerance = 0.1,
                     .kind = Tolerance::absolute,
                     .note = "A gap that closes takes its impulse in two steps, in the proportion of the time before "
                             "and after the touch: "
                             "the middle of both is the touch itself."});
}

TEST_CASE("the Coulomb gap of every step is within the tolerance of the solver", "[scene][accuracy]") {
    constexpr Real tolerance = 1e-6;
    Settings settings;
    settings.tolerance = tolerance;
    settings.max_iterations = 20000;
    World world(settings);
    const auto material = world.add_material(test::lossless({.young_modulus = 3e4, .friction = 0.5, .damping = 4}));
    world.add_collider(Plane{});
    for (int i = 0; i < 6; ++i)
        world.add_body(
            mesh::ball(0.05, 5),
            {.material = material, .position = {0.05 * (i % 2), 0.02 * i, 0.06 + 0.09 * i}, .velocity = {0, 0, -1}});
    Real worst = 0;
    int problems = 0;
    world.watch_contact_problems([&](const StepProblem& step) {
        const ContactProblem& p = step.problem;
        Real scale = 0;  // twice the energy that the contacts have to stop [J]
        for (Index i = 0; i < p.contacts(); ++i) {
            const std::size_t row = static_cast<std::size_t>(i);
            for (Index k = p.row_offset[row]; k < p.row_offset[row + 1]; ++k)
                if (p.column[static_cast<std::size_t>(k)] == i)
                    scale += p.q[row].squaredNorm() / (p.block[static_cast<std::size_t>(k)].trace() / 3);
        }
        // Contacts without energy to stop are skipped: here the gap is relative to that energy itself, without the
        // floor that the error measure has for regions at rest.
        if (scale > 0) worst = std::max(worst, std::abs(problem_error(p, step.impulse).energy_gap) / scale);
        ++problems;
    });
    REQUIRE(world.advance(0.4).ok());
    REQUIRE(problems > 200);
    REQUIRE(world.report().unconverged == 0);
    accuracy::check({.item = 31,
                     .name = "six balls, Coulomb gap over the energy of the contacts, worst step",
                     .formula = "0, tolerance that of the solver",
                     .found = worst,
                     .tolerance = tolerance,
                     .kind = Tolerance::absolute});
}

}  // namespace skerry::test::orders_test
