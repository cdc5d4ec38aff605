#include "systems/material/orthotropic.h"

#include <Eigen/Geometry>
#include <catch2/catch.hpp>
#include <random>

#include "systems/material/material_law.h"
#include "tests/support/dense_algebra.h"
#include "tests/support/jittered_box.h"
#include "tests/support/stress_slope.h"

namespace skerry::test::orthotropic_test {

namespace {

/// Douglas fir at a moisture of 12 % (Wood Handbook, FPL 2010, tables 5-1 to 5-3), with the axes along the grain,
/// across the rings and along the rings.
OrthotropicModuli fir() {
    constexpr Real E = 1.43e10;
    return {.young_modulus = {E, 0.068 * E, 0.050 * E},
            .poisson_ratio = {0.292, 0.390, 0.449},
            .shear_modulus = {0.064 * E, 0.007 * E, 0.078 * E}};
}

MaterialConstants constants_of(const OrthotropicModuli& moduli) {
    MaterialConstants material = material_constants(MaterialModel::orthotropic, 1e5, 0.3, 500);
    set_orthotropic(moduli, material);
    return material;
}

Mat3 axes_of(const Vec3& turn) {
    return Eigen::AngleAxis<Real>(turn.norm(), turn.normalized()).toRotationMatrix();
}

OrthotropicModuli turned(OrthotropicModuli moduli, const Mat3& axes) {
    moduli.first_axis = 3 * axes.col(0);                   // of any length
    moduli.second_axis = axes.col(1) + 0.4 * axes.col(0);  // not orthogonal
    return moduli;
}

Vector9 entries_of(const Mat3& m) {
    return Eigen::Map<const Vector9>(m.data());
}

/// Map of the tangent as a matrix. The tangent of this law has no part in principal axes.
Matrix9 matrix_of_tangent(const Tangent& tangent) {
    Matrix9 H = Matrix9::Zero();
    for (const Mat3& dyad : tangent.dyads) H += entries_of(dyad) * entries_of(dyad).transpose();
    for (Index i = 0; i < 9; ++i) {
        Mat3 X = Mat3::Zero();
        X.data()[i] = 1;
        H.col(i) += entries_of(X * tangent.second_stress);
    }
    return H;
}

/// Collects the terms of add_stiffness as a matrix.
struct StiffnessMatrix {
    Matrix9 sum = Matrix9::Zero();

    void add_identity(const Real8& s) { sum += s[0] * Matrix9::Identity(); }
    void add_dyad(const Real8& s, const LaneMat3<Real8>& X) {
        const Vector9 v = entries_of(lane_of(X, 0));
        sum += s[0] * v * v.transpose();
    }
};

LaneMat3<Real8> all_lanes(const Mat3& F) {
    const auto column = [&](Index c) {
        return LaneVec3<Real8>{Real8{} + F(0, c), Real8{} + F(1, c), Real8{} + F(2, c)};
    };
    return {column(0), column(1), column(2)};
}

Real largest_eigenvalue(const Matrix9& H) {
    return symmetric_eigenvalues(0.5 * (H + H.transpose()))[8];
}

const Mat3 rotated = axes_of({0.3, -1.1, 0.7});

}  // namespace

TEST_CASE("orthotropic: pulls along three axes and shear have the given constants, whatever the axes", "[unit]") {
    for (const Mat3& axes : {Mat3(Mat3::Identity()), rotated}) {
        const OrthotropicModuli moduli = turned(fir(), axes);
        const MaterialConstants material = constants_of(moduli);
        const Vec3 &E = moduli.young_modulus, &nu = moduli.poisson_ratio, &G = moduli.shear_modulus;
        Mat3 ratio;  // ratio(i, j) = nu_ij
        ratio << 0, nu[0], nu[2], nu[0] * E[1] / E[0], 0, nu[1], nu[2] * E[2] / E[0], nu[1] * E[2] / E[1], 0;
        constexpr Real small = 1e-6;
        // Stress in the axes of the material under a small strain. Rotations change nothing.
        const auto stress_at = [&](const Mat3& strain) {
            const Mat3 F = rotated * (Mat3::Identity() + axes * strain * axes.transpose());
            return Mat3(axes.transpose() * rotated.transpose() * stress(material, F) * axes);
        };
        for (Index i = 0; i < 3; ++i) {
            Mat3 strain = Mat3::Zero();
            for (Index j = 0; j < 3; ++j) strain(j, j) = i == j ? small : -ratio(i, j) * small;
            Mat3 expected = Mat3::Zero();
            expected(i, i) = E[i] * small;
            // Green's strain and the nominal stress differ from the linear ones by the square of the strain.
            CHECK((stress_at(strain) - stress_at(-strain) - 2 * expected).norm() < 1e-9 * 2 * E[0] * small);
        }
        for (Index k = 0; k < 3; ++k) {
            const Index i = k == 1 ? 1 : 0, j = k == 0 ? 1 : 2;
            Mat3 strain = Mat3::Zero();
            strain(i, j) = strain(j, i) = small / 2;
            const Mat3 difference = stress_at(strain) - stress_at(-strain);
            CHECK(difference(i, j) == Approx(2 * G[k] * small).epsilon(1e-8));
            CHECK(difference(j, i) == Approx(2 * G[k] * small).epsilon(1e-8));
        }
    }
}

TEST_CASE("orthotropic: constants of an isotropic material give its stress", "[unit]") {
    constexpr Real E = 1e5, nu = 0.35;
    const MaterialConstants ortho = constants_of({.young_modulus = Vec3::Constant(E),
                                                  .poisson_ratio = Vec3::Constant(nu),
                                                  .shear_modulus = Vec3::Constant(E / (2 * (1 + nu)))}),
                            plain = material_constants(MaterialModel::orthotropic, E, nu, 500);
    std::mt19937_64 random(1);
    for (int trial = 0; trial < 20; ++trial) {
        Mat3 F = Mat3::Identity();
        for (Index c = 0; c < 3; ++c) F.col(c) += 0.3 * random_vector(random);
        CHECK((stress(ortho, F) - stress(plain, F)).norm() < 1e-12 * E);
        CHECK(energy_density(ortho, F) == Approx(energy_density(plain, F)).epsilon(1e-12).margin(1e-12 * E));
    }
}

TEST_CASE("orthotropic: stress and tangent are derivatives, the bounds hold, and rotations turn the stress", "[unit]") {
    const MaterialConstants material = constants_of(turned(fir(), rotated));
    const Real scale = fir().young_modulus[0];
    std::mt19937_64 random(2);
    for (int trial = 0; trial < 60; ++trial) {
        Mat3 F = Mat3::Identity();
        for (Index c = 0; c < 3; ++c)
            F.col(c) += (trial % 3 == 0 ? 0.02 : trial % 3 == 1 ? 0.3 : 1.0) * random_vector(random);
        const Mat3 P = stress(material, F);
        const Real size = scale * std::pow(F.norm(), 3);
        for (Index i = 0; i < 9; ++i) {
            constexpr Real step = 1e-5;
            Mat3 up = F, down = F;
            up.data()[i] += step;
            down.data()[i] -= step;
            const Real slope = (energy_density(material, up) - energy_density(material, down)) / (2 * step);
            CHECK(std::abs(slope - P.data()[i]) < 1e-8 * size);
        }
        const Matrix9 H = slope_of_stress(material, F);
        const Tangent tangent = skerry::tangent(material, F);
        // The tangent leaves out the compressive part of the stress, which lowers the stiffness.
        const Matrix9 left_out = matrix_of_tangent(tangent) - H;
        CHECK(symmetric_eigenvalues(0.5 * (left_out + left_out.transpose()))[0] > -1e-7 * size);
        if (trial == 0) {
            const Mat3 stretched = 1.2 * rotated;
            CHECK((matrix_of_tangent(skerry::tangent(material, stretched)) - slope_of_stress(material, stretched))
                      .norm() < 1e-7 * scale);
        }
        StiffnessMatrix bound;
        Orthotropic::add_stiffness(material, all_lanes(F), bound);
        const Matrix9 rest = bound.sum - H;
        CHECK(symmetric_eigenvalues(0.5 * (rest + rest.transpose()))[0] > -1e-7 * size);
        CHECK(largest_eigenvalue(H) <= stiffness_bound(material, F) * (1 + 1e-7));
        CHECK((stress(material, rotated * F) - rotated * P).norm() < 1e-14 * size);
    }
    StiffnessMatrix at_rest;
    Orthotropic::add_stiffness(material, all_lanes(Mat3::Identity()), at_rest);
    CHECK((at_rest.sum - slope_of_stress(material, Mat3::Identity())).norm() < 1e-8 * scale);
    CHECK(stress(material, rotated).norm() < 1e-14 * scale);
}

TEST_CASE("orthotropic: the isotropic part is nowhere stiffer than the material, and turned axes turn the stress",
          "[unit]") {
    const MaterialConstants material = constants_of(fir());
    MaterialConstants isotropic = material_constants(MaterialModel::orthotropic, 1, 0.3, 500);
    isotropic.shear_modulus = material.shear_modulus;
    isotropic.lame_lambda = material.lame_lambda;
    CHECK(material.shear_modulus > 0);
    CHECK(material.lame_lambda > 0);
    std::mt19937_64 random(3);
    for (int trial = 0; trial < 200; ++trial) {
        Mat3 strain;
        for (Index c = 0; c < 3; ++c) strain.col(c) = random_vector(random);
        strain = (strain + strain.transpose()).eval();
        CHECK(Orthotropic::energy_of_strain(isotropic, strain) <= Orthotropic::energy_of_strain(material, strain));
    }
    MaterialConstants by_hand = material;
    turn_axes(rotated, by_hand);
    const MaterialConstants given = constants_of(turned(fir(), rotated));
    const Mat3 F = Mat3::Identity() + 0.1 * rotated;
    CHECK((stress(by_hand, F) - stress(given, F)).norm() < 1e-12 * fir().young_modulus[0]);
}

}  // namespace skerry::test::orthotropic_test
