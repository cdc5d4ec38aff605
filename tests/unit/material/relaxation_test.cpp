#include "systems/material/relaxation.h"

#include <Eigen/Geometry>
#include <catch2/catch.hpp>
#include <complex>
#include <numbers>

#include "systems/material/material_law.h"
#include "tests/support/jittered_box.h"

namespace skerry::test::relaxation_test {

namespace {

ViscousModuli some_moduli() {
    MaterialConstants material = material_constants(MaterialModel::stable_neo_hookean, 1e5, 0.4, 1000);
    material.bulk_viscosity = 0.06;
    return viscous_moduli(material, 0.2);
}

Mat3 random_matrix(std::mt19937_64& random) {
    Mat3 m;
    m << test::random_vector(random), test::random_vector(random), test::random_vector(random);
    return m;
}

/// Springs before any relaxation.
MaxwellSprings<Real> springs_of(const Mat3& F) {
    const LaneSymmetric<Real> strain = twice_green_strain(from_matrix(F));
    MaxwellSprings<Real> springs{{}, strain.trace()};
    springs.strain.fill(strain);
    return springs;
}

Mat3 first_stress(const ViscousModuli& moduli, const Mat3& F) {
    return to_matrix(multiply(from_matrix(F), stress(moduli, springs_of(F).sum())));
}

}  // namespace

TEST_CASE("the stress of relaxing springs is the derivative of their energy", "[unit]") {
    std::mt19937_64 random(1);
    const ViscousModuli moduli = some_moduli();
    for (int trial = 0; trial < 50; ++trial) {
        const Mat3 F = Mat3::Identity() + 0.5 * random_matrix(random);
        const Mat3 P = first_stress(moduli, F);
        constexpr Real step = 1e-5;
        for (int i = 0; i < 9; ++i) {
            Mat3 up = F, down = F;
            up.data()[i] += step;
            down.data()[i] -= step;
            const Real slope =
                (energy_density(moduli, springs_of(up)) - energy_density(moduli, springs_of(down))) / (2 * step);
            CHECK(P.data()[i] == Approx(slope).margin(1e-6 * moduli.mu));
        }
    }
}

TEST_CASE("relaxing springs are independent of rotations, and give no torque", "[unit]") {
    std::mt19937_64 random(2);
    const ViscousModuli moduli = some_moduli();
    for (int trial = 0; trial < 20; ++trial) {
        const Mat3 F = Mat3::Identity() + 0.5 * random_matrix(random);
        const Mat3 R = Eigen::AngleAxis<Real>(trial, test::random_vector(random).normalized()).toRotationMatrix();
        CHECK((first_stress(moduli, R * F) - R * first_stress(moduli, F)).norm() <= 1e-10 * moduli.mu);
        const Mat3 kirchhoff = first_stress(moduli, F) * F.transpose();
        CHECK((kirchhoff - kirchhoff.transpose()).norm() <= 1e-10 * moduli.mu);
    }
}

TEST_CASE("rates spread over a band give the loss factor", "[unit]") {
    for (const Real loss_factor : {0.01, 0.05, 0.2, 0.3})
        for (const Real over_lowest : {10.0, 30.0, 100.0, 300.0, 800.0}) {  // highest over lowest frequency of a body
            const Real span = std::max(rates_below * over_lowest, Real{100}), share = relaxing_share(loss_factor, span);
            const auto loss_at = [&](Real omega) {  // omega in units of the lower end of the band
                Real in_phase = 1, behind = 0;
                for (const Real rate : relaxation_rates(span, span)) {
                    const Real x = omega / rate;
                    in_phase += share * x * x / (1 + x * x);
                    behind += share * x / (1 + x * x);
                }
                return behind / in_phase;
            };
            INFO("loss factor " << loss_factor << ", highest frequency over lowest " << over_lowest);
            CHECK(share > 0);
            const std::complex<Real> z = rates_below * std::complex<Real>(-loss_factor / 2, 1);
            std::complex<Real> stiffness = 1;
            for (const Real rate : relaxation_rates(span, span)) stiffness += share * z / (z + rate);
            CHECK(std::arg(stiffness) == Approx(std::arg(-z * z)).epsilon(1e-12));
            // A held end makes the lowest frequency of a beam six times lower. Above the lowest frequency the stiffness
            // grows, as losses require, and the loss factor is smaller by that growth.
            for (const Real times : {1.0 / 6, 0.5, 2.0, 5.0}) {
                const Real growth = 1 + 2 / std::numbers::pi * loss_factor * std::log(times);
                CHECK(loss_at(times * rates_below) == Approx(loss_factor / growth).epsilon(0.3));
            }
        }
}

}  // namespace skerry::test::relaxation_test
