#include "systems/material/relaxation.h"

#include <Eigen/Geometry>
#include <catch2/catch.hpp>

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

/// Viscous stretch before any relaxation.
ViscousStretch<Real> stretch_of(const Mat3& F) {
    const LaneSymmetric<Real> strain = twice_green_strain(from_matrix(F));
    return {strain, strain.trace()};
}

Mat3 first_stress(const ViscousModuli& moduli, const Mat3& F) {
    return to_matrix(multiply(from_matrix(F), stress(moduli, stretch_of(F))));
}

}  // namespace

TEST_CASE("the stress of what relaxes is the derivative of its energy", "[unit]") {
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
                (energy_density(moduli, stretch_of(up)) - energy_density(moduli, stretch_of(down))) / (2 * step);
            CHECK(P.data()[i] == Approx(slope).margin(1e-6 * moduli.mu));
        }
    }
}

TEST_CASE("what relaxes does not see rotations, and gives no torque", "[unit]") {
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

TEST_CASE("rates spread over a span lose what the loss factor says", "[unit]") {
    constexpr int parts = 4000;
    for (Real loss_factor : {0.01, 0.05, 0.2}) {
        constexpr Real span = 1e4;
        const Real share = relaxing_share(loss_factor, span);
        const auto loss_at = [&](Real omega) {  // omega in units of the lowest rate
            Real in_phase = 1, behind = 0;
            for (int i = 0; i < parts; ++i) {
                const Real x = omega / std::pow(span, (i + 0.5) / parts);
                in_phase += share / parts * x * x / (1 + x * x);
                behind += share / parts * x / (1 + x * x);
            }
            return behind / in_phase;
        };
        CHECK(loss_at(rates_below) == Approx(loss_factor).epsilon(0.05));
        // Above this frequency the stiffness grows, as losses require, and the loss factor is smaller by that growth.
        const Real growth = 1 + 2 / std::numbers::pi * loss_factor * std::log(10);
        CHECK(loss_at(10 * rates_below) == Approx(loss_factor / growth).epsilon(0.05));
    }
}

}  // namespace skerry::test::relaxation_test
