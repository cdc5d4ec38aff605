// Stress suite: bodies deformed as strongly as users do it have to recover, at little more than the usual cost (items
// 29 to 31 of docs/stress.md).
#include <catch2/catch.hpp>

#include "tests/support/dense_algebra.h"
#include "tests/support/stress.h"
#include "tests/support/worlds.h"

namespace skerry::test::crushed_test {

using namespace skerry::test::stress;

namespace {

/// A world without gravity with one rubber body, which comes to rest when nothing touches it.
struct OneBody {
    World world;
    MaterialHandle rubber;
    BodyHandle body;
    std::vector<Vec3> rest;

    OneBody(const Mesh& mesh, const BodySettings& settings, Real young_modulus, Real damping)
        : world([] {
              Settings weightless;
              weightless.gravity = Vec3::Zero();
              weightless.sleep = false;  // a sleeping body would cost nothing
              return weightless;
          }()),
          rubber(world.add_material(
              {.young_modulus = young_modulus, .poisson_ratio = 0.4, .friction = 0.1, .damping = damping})),
          rest(mesh.nodes) {
        BodySettings own = settings;
        own.material = rubber;
        body = world.add_body(mesh, own);
    }

    Vec3 middle() const {
        Vec3 sum = Vec3::Zero();
        for (const Vec3& x : world.positions(body)) sum += x;
        return sum / static_cast<Real>(rest.size());
    }

    /// Removes the spin that the body flies off with, since spin stretches it. Then waits for half a second.
    void stop() {
        world.set_velocities(body, std::vector<Vec3>(rest.size(), Vec3::Zero()));
        REQUIRE(world.advance(0.5).ok());
    }

    /// Largest distance of a node from its rest position, after the best rigid alignment [m]
    Real out_of_shape() const {
        const auto x = world.positions(body);
        Vec3 rest_middle = Vec3::Zero();
        for (const Vec3& X : rest) rest_middle += X / static_cast<Real>(rest.size());
        Mat3 product = Mat3::Zero();
        for (std::size_t n = 0; n < rest.size(); ++n)
            product += (x[n] - middle()) * (rest[n] - rest_middle).transpose();
        const Mat3 rotation = orthogonal_factor(product);
        Real most = 0;
        for (std::size_t n = 0; n < rest.size(); ++n)
            most = std::max(most, (x[n] - middle() - rotation * (rest[n] - rest_middle)).norm());
        return most;
    }
};

/// Number of steps plus abandoned tries of steps.
int tries(const Course& course) {
    return course.steps + course.shortened + course.retried;
}

/// Checks that the body has recovered after a disturbance, and compares the cost with an undisturbed run.
void judge_return(int item, const std::string& scene, OneBody& tested, const Course& course, const Course& undisturbed,
                  Real edge, Real times) {
    judge({item, scene, "every step taken, finite", course.ok ? "all steps" : course.message,
           course.ok && course.finite});
    at_most(item, scene, "penetration / edge", course.max_penetration / edge, 1e-3);
    at_most(item, scene, "regions not converged", static_cast<Real>(course.unconverged), 0);
    at_most(item, scene, "steps and tries, times those without",
            static_cast<Real>(tries(course)) / static_cast<Real>(tries(undisturbed)), times);
    tested.stop();
    at_most(item, scene, "inverted elements at the end", inverted_share(tested.world, tested.body), 0);
    at_most(item, scene, "out of shape at the end / edge", tested.out_of_shape() / edge, 0.01);
}

/// A torus: a plate with a round hole and a round rim. Only part of it is needed.
SurfaceMesh ring(Real hole, Real tube, Index around, Index across) {
    SurfaceMesh mesh;
    const Real turn = 2 * std::numbers::pi;
    const auto row = [&](Index i, Index j) { return i % around * across + j % across; };
    for (Index i = 0; i < around; ++i)
        for (Index j = 0; j < across; ++j) {
            const Real a = turn * i / around, b = turn * j / across;
            const Real r = hole + tube + tube * std::cos(b);
            mesh.nodes.emplace_back(r * std::cos(a), r * std::sin(a), tube * std::sin(b));
            mesh.triangles.push_back({row(i, j), row(i + 1, j), row(i + 1, j + 1)});
            mesh.triangles.push_back({row(i, j), row(i + 1, j + 1), row(i, j + 1)});
        }
    return mesh;
}

}  // namespace

TEST_CASE("a cube crushed to a fifth of its height comes back", "[scene][stress][slow]") {
    constexpr Real size = 0.2, edge = 0.03;
    const auto run = [&](OneBody& cube, bool crushed) {
        Motion plate;
        plate.keys = {{0, {0, 0, size + 1e-3}, Vec3::Zero()}};
        if (crushed) {
            plate.keys.push_back({0.25, {0, 0, size / 5}, Vec3::Zero()});
            plate.keys.push_back({0.3, {0, 0, size / 5}, Vec3::Zero()});
            plate.keys.push_back({0.35, {0, 0, 2 * size}, Vec3::Zero()});
        }
        cube.world.add_collider(Plane{});
        cube.world.add_collider(Plane{.normal = {0, 0, -1}}, {.motion = plate});
        return follow(cube.world, 1.2, 60);
    };
    const auto cube = [&] {
        return OneBody(mesh::box({size, size, size}, {8, 8, 8}), {.position = {0, 0, size / 2 + 5e-4}}, 1e5, 20);
    };
    OneBody still = cube(), pressed = cube();
    const Course undisturbed = run(still, false), crushed = run(pressed, true);
    judge_return(29, "cube of 3,072 crushed by a plate, 0.9 s after it", pressed, crushed, undisturbed, edge, 5);
}

TEST_CASE("a ball shot at a wall at 30 m/s comes back", "[scene][stress][slow]") {
    constexpr Real radius = 0.1, edge = 0.03;
    const auto ball = [&] {
        return OneBody(mesh::ball(radius, 8), {.position = {0, 0, 0.15}, .velocity = {0, 0, -30}}, 1e6, 20);
    };
    OneBody flying = ball(), shot = ball();
    shot.world.add_collider(Plane{});
    const Course undisturbed = follow(flying.world, 0.6, 60), stopped = follow(shot.world, 0.6, 60);
    const std::string scene = "ball shot at a wall, 0.6 s";
    judge_return(30, scene, shot, stopped, undisturbed, edge, 5);
    at_least(30, scene, "height at the end", shot.middle().z(), radius);
}

TEST_CASE("a ball pressed through a hole half its size comes back", "[scene][stress][slow]") {
    constexpr Real radius = 0.1, edge = 0.03;
    const auto run = [](OneBody& ball, bool pressed) {
        Motion rod;
        rod.keys = {{0, {0, 0, 0.42}, Vec3::Zero()}};
        if (pressed) {
            rod.keys.push_back({0.8, {0, 0, -0.1}, Vec3::Zero()});
            rod.keys.push_back({1, {0, 0, 0.6}, Vec3::Zero()});
        }
        ball.world.add_collider(ring(radius / 2, 0.06, 48, 24), {.friction = 0.1});
        ball.world.add_collider(Box{.size = {0.05, 0.05, 0.3}}, {.motion = rod, .friction = 0.1});
        return follow(ball.world, 2, 60);
    };
    const auto ball = [&] { return OneBody(mesh::ball(radius, 8), {.position = {0, 0, 0.145}}, 5e4, 10); };
    OneBody still = ball(), through = ball();
    const Course undisturbed = run(still, false), pressed = run(through, true);
    const std::string scene = "ball pressed through a hole half as wide, 1 s after it";
    judge_return(31, scene, through, pressed, undisturbed, edge, 5);
    at_most(31, scene, "height at the end", through.middle().z(), -radius);
}

}  // namespace skerry::test::crushed_test
