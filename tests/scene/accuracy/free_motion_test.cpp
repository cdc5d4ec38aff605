// Motion of bodies without contact: free fall, momentum, spin (docs/accuracy.md, items 1 to 3 and 20).
#include <Eigen/Geometry>
#include <catch2/catch.hpp>

#include "tests/support/accuracy.h"
#include "tests/support/worlds.h"

namespace skerry::test::free_motion_test {

using accuracy::Tolerance;

namespace {

/// Errors of the worst node of a falling cube against x0 + v0 t - g t^2 / 2 + `lag` t and v0 + `early` - g t.
struct Fall {
    Real position_error = 0;  // m
    Real velocity_error = 0;  // relative to the speed
};

constexpr Real fall_time = 0.5;  // s

/// Adds `early` to the start velocity and `lag` to the mean velocity of the law.
Fall fall(MaterialModel model, Real h, const Vec3& early, const Vec3& lag) {
    Settings settings;
    settings.step_size = h;
    World world(settings);
    const auto material = world.add_material({.young_modulus = 1e4, .model = model});
    const Vec3 start(0.3, -0.2, 5), v0(0.5, 0.25, 1);
    const Mesh cube = mesh::box({0.1, 0.1, 0.1}, {2, 2, 2});
    const auto body = world.add_body(cube, {.material = material, .position = start, .velocity = v0 + early});
    REQUIRE(world.advance(fall_time).steps == static_cast<int>(std::round(fall_time / h)));
    const Vec3 g(0, 0, -standard_gravity);
    const Vec3 shift = start + (v0 + lag) * fall_time + 0.5 * fall_time * fall_time * g;
    const Vec3 velocity = v0 + early + fall_time * g;
    Fall errors;
    for (std::size_t n = 0; n < cube.nodes.size(); ++n) {
        errors.position_error =
            std::max(errors.position_error, (world.positions(body)[n] - cube.nodes[n] - shift).norm());
        errors.velocity_error =
            std::max(errors.velocity_error, (world.velocities(body)[n] - velocity).norm() / velocity.norm());
    }
    return errors;
}

}  // namespace

TEST_CASE("free fall follows the discrete law to rounding, and the exact law in first order", "[scene][accuracy]") {
    const Real h = std::ldexp(1.0, -10);
    const Vec3 g(0, 0, -standard_gravity);
    Fall discrete, leapfrog;
    for (const auto model : {MaterialModel::linear, MaterialModel::corotational, MaterialModel::stable_neo_hookean}) {
        // x_n = x0 + n h v0 - g h^2 n (n + 1) / 2: the mean velocity is ahead by g h / 2.
        const Fall symplectic = fall(model, h, Vec3::Zero(), 0.5 * h * g);
        discrete.position_error = std::max(discrete.position_error, symplectic.position_error);
        discrete.velocity_error = std::max(discrete.velocity_error, symplectic.velocity_error);
        // Leapfrog: start velocities half a force interval (kick) early are those of the middle of each step.
        leapfrog.position_error =
            std::max(leapfrog.position_error, fall(model, h, -0.5 * h * g, Vec3::Zero()).position_error);
    }
    accuracy::check({.item = 1,
                     .name = "free fall, velocity after 0.5 s, worst node error over speed",
                     .formula = "v_n = v0 - g n h",
                     .found = discrete.velocity_error,
                     .tolerance = 1e-12,
                     .kind = Tolerance::absolute});
    accuracy::check({.item = 1,
                     .name = "free fall, position after 0.5 s, worst node error (m)",
                     .formula = "x_n = x0 + n h v0 - g h^2 n (n + 1) / 2",
                     .found = discrete.position_error,
                     .tolerance = 1e-12,
                     .kind = Tolerance::absolute});
    accuracy::check({.item = 1,
                     .name = "free fall, leapfrog start, worst node error (m)",
                     .formula = "x = x0 + v0 t - g t^2 / 2",
                     .found = leapfrog.position_error,
                     .tolerance = 1e-12,
                     .kind = Tolerance::absolute,
                     .note = "A leapfrog start is an initial velocity half a kick early; velocities are then those of "
                             "the middle of the step."});
    const Real coarse = fall(MaterialModel::linear, h, Vec3::Zero(), Vec3::Zero()).position_error;
    const Real fine = fall(MaterialModel::linear, h / 2, Vec3::Zero(), Vec3::Zero()).position_error;
    accuracy::check({.item = 1,
                     .name = "free fall, order in h against the exact law",
                     .formula = "log2(error(h) / error(h/2)) = 1",
                     .expected = 1,
                     .found = std::log2(coarse / fine),
                     .tolerance = 1e-6});
}

}  // namespace skerry::test::free_motion_test
