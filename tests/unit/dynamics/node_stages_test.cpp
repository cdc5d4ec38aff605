#include <catch2/catch.hpp>
#include <limits>
#include <vector>

#include "systems/dynamics/advance_positions.h"
#include "systems/dynamics/predict_velocity.h"

using namespace skerry;

TEST_CASE("a kick adds h force over mass, and nothing to a pinned node", "[unit]") {
    const auto executor = make_executor(Backend::serial, 1);
    const Real nan = std::numeric_limits<Real>::quiet_NaN();
    const std::vector<Vec3> force{Vec3(1, 2, 3), Vec3(1, 2, 3), Vec3(nan, 0, 0)}, velocity{Vec3(1, 0, 0), Vec3(0, 1, 0), Vec3(0, 0, 1)};
    const std::vector<Real> inverse_mass{0.5, 0, 0};
    std::vector<Vec3> next(3);
    predict_velocity(*executor, force, inverse_mass, velocity, 0.25, {}, next);
    CHECK(next[0] == Vec3(1.125, 0.25, 0.375));
    CHECK(next[1] == Vec3(0, 1, 0));
    CHECK(next[2] == Vec3(0, 0, 1));  // a pinned node stays put even under a force that is no number
    predict_velocity(*executor, {}, {}, {}, 0.25, {}, {});
}

TEST_CASE("a drift commits velocity and push-out, and uses the push-out up", "[unit]") {
    const auto executor = make_executor(Backend::serial, 1);
    const std::vector<Vec3> next{Vec3(1, 2, 3), Vec3(0, 0, 0)};
    std::vector<Vec3> push{Vec3(1, 0, 0), Vec3(0, 0, 2)}, position{Vec3(10, 0, 0), Vec3(0, 0, 0)}, velocity(2, Vec3::Zero());
    advance_positions(*executor, next, 0.5, Integrator::symplectic_euler, {}, push, position, velocity);
    CHECK(position[0] == Vec3(11, 1, 1.5));
    CHECK(position[1] == Vec3(0, 0, 1));
    CHECK(velocity[0] == next[0]);
    CHECK(velocity[1] == Vec3(0, 0, 0));  // the push-out moves positions only
    CHECK(push[0] == Vec3::Zero());
    CHECK(push[1] == Vec3::Zero());
    advance_positions(*executor, {}, 0.5, Integrator::symplectic_euler, {}, {}, {}, {});
}

TEST_CASE("free fall follows its discrete law", "[unit]") {
    // methods.md 8.1: v_n = -g n h, x_n = -g h^2 n (n + 1) / 2.
    const auto executor = make_executor(Backend::serial, 1);
    const Real g = 9.81, h = 1e-3, mass = 0.3;
    std::vector<Vec3> position(1, Vec3::Zero()), velocity(1, Vec3::Zero()), next(1, Vec3::Zero()), push(1, Vec3::Zero());
    const std::vector<Vec3> force{Vec3(0, 0, -g * mass)};
    const std::vector<Real> inverse_mass{1 / mass};
    constexpr int steps = 1000;
    for (int n = 0; n < steps; ++n) {
        predict_velocity(*executor, force, inverse_mass, velocity, h, {}, next);
        advance_positions(*executor, next, h, Integrator::symplectic_euler, {}, push, position, velocity);
    }
    CHECK(velocity[0].z() == Approx(-g * steps * h).epsilon(1e-12));
    CHECK(position[0].z() == Approx(-g * h * h * steps * (steps + 1) / 2).epsilon(1e-12));
}
