// Free rotation of rigid bodies (docs/methods/rigid_bodies.md 2).
#include <catch2/catch.hpp>
#include <cmath>
#include <numbers>

#include "systems/dynamics/rigid/rigid_motion.h"
#include "systems/geometry/rotation.h"

namespace skerry::test::rigid_motion_test {

namespace {

const Vec3 moments(1, 2, 3);  // [kg m^2]

Mat3 turned_for(Mat3 rotation, const Vec3& angular_momentum, Real seconds, int steps) {
    for (int k = 0; k < steps; ++k)
        rotation = without_strain(turned_freely(rotation, moments, angular_momentum, seconds / steps));
    return rotation;
}

Real energy(const Mat3& rotation, const Vec3& angular_momentum) {
    return angular_momentum.dot(spin_of(rotation, moments, angular_momentum)) / 2;
}

}  // namespace

TEST_CASE("a free top keeps its energy to second order, for ever", "[dynamics][rigid]") {
    const Vec3 angular_momentum = moments.cwiseProduct(Vec3(0.3, 5, 0.2));  // near the middle axis: the body tumbles
    const auto worst = [&](Real h) {
        Mat3 rotation = Mat3::Identity();
        const Real start = energy(rotation, angular_momentum);
        Real most = 0;
        for (int k = 0; k < static_cast<int>(100 / h); ++k) {
            rotation = without_strain(turned_freely(rotation, moments, angular_momentum, h));
            most = std::max(most, std::abs(energy(rotation, angular_momentum) / start - 1));
        }
        return most;
    };
    const Real coarse = worst(1.0 / 60), fine = worst(1.0 / 120);
    CHECK(coarse < 1e-3);
    CHECK(coarse / fine == Approx(4).epsilon(0.1));
}

TEST_CASE("attitudes of a free top are of second order", "[dynamics][rigid]") {
    const Vec3 angular_momentum = moments.cwiseProduct(Vec3(0.3, 5, 0.2));
    const Mat3 start = rotation_matrix({0.4, -0.2, 0.1});
    const Mat3 reference = turned_for(start, angular_momentum, 2, 200000);
    const Real coarse = (turned_for(start, angular_momentum, 2, 240) - reference).norm(),
               fine = (turned_for(start, angular_momentum, 2, 480) - reference).norm();
    CHECK(std::log2(coarse / fine) == Approx(2).margin(0.05));
}

TEST_CASE("a top turned forth and back is where it was", "[dynamics][rigid]") {
    const Vec3 angular_momentum(1, 12, -3);
    const Mat3 start = rotation_matrix({0.4, -0.2, 0.1});
    const Mat3 there = turned_freely(start, moments, angular_momentum, 0.2);
    CHECK((there - start).norm() > 0.5);
    CHECK((turned_freely(there, moments, angular_momentum, -0.2) - start).norm() < 1e-14);
}

TEST_CASE("a wing nut turns over in the time that elliptic functions give", "[dynamics][rigid]") {
    // Landau and Lifshitz, Mechanics, 37: for L^2 > 2 E I2 the period is 4 K(k) / p
    const Vec3 spin(0.01, 5, 0.01), angular_momentum = moments.cwiseProduct(spin);
    const Real squared = angular_momentum.squaredNorm(), twice = spin.dot(angular_momentum);
    const Vec3 ordered = squared > twice * moments[1] ? moments : Vec3(moments.reverse());
    const Real p = std::sqrt((ordered[2] - ordered[1]) * (squared - twice * ordered[0]) / ordered.prod());
    const Real k = std::sqrt((ordered[1] - ordered[0]) * (twice * ordered[2] - squared) /
                             ((ordered[2] - ordered[1]) * (squared - twice * ordered[0])));
    const Real period = 4 * std::comp_ellint_1(k) / std::abs(p);
    Mat3 rotation = Mat3::Identity();
    const Real h = 1e-3;
    std::vector<Real> turns;  // times when the momentum changes its side of the middle axis [s]
    Real before = (rotation.transpose() * angular_momentum)[1];
    for (int step = 1; step * h < 3 * period; ++step) {
        rotation = turned_freely(rotation, moments, angular_momentum, h);
        const Real now = (rotation.transpose() * angular_momentum)[1];
        if (before * now < 0) turns.push_back((step - now / (now - before)) * h);
        before = now;
    }
    REQUIRE(turns.size() >= 5);
    CHECK(turns[4] - turns[0] == Approx(2 * period).epsilon(1e-3));
}

TEST_CASE("a rotation strained by rounding becomes a rotation again", "[dynamics][rigid]") {
    const Mat3 rotation = rotation_matrix({0.4, -0.2, 0.1});
    const Mat3 strained = rotation * (Mat3::Identity() + 1e-7 * Mat3::Ones());
    const Mat3 again = without_strain(strained);
    CHECK((again.transpose() * again - Mat3::Identity()).norm() < 1e-12);
    CHECK((again - rotation).norm() < 1e-6);
}

}  // namespace skerry::test::rigid_motion_test
