#include "systems/material/material_law.h"

#include <Eigen/Geometry>
#include <Eigen/LU>
#include <catch2/catch.hpp>
#include <cstring>

#include "components/check.h"
#include "systems/material/extract_rotation.h"
#include "systems/material/with_law.h"
#include "tests/support/dense_algebra.h"
#include "tests/support/jittered_box.h"
#include "tests/support/material_models.h"

namespace skerry::test::material_law_test {

namespace {

MaterialConstants rubber(MaterialModel model) {
    return material_constants(model, 1e5, 0.4, 1000);
}

/// Random F: mild (kind 0), strong (1) or mirrored (2).
Mat3 random_gradient(std::mt19937_64& random, int kind) {
    Mat3 noise;
    noise << test::random_vector(random), test::random_vector(random), test::random_vector(random);
    Mat3 F = Mat3::Identity() + (kind == 0 ? 0.2 : 1.0) * noise;
    if (kind == 2) F.col(0) *= -1;
    return F;
}

LaneMat3<Real8> side_by_side(const std::array<Mat3, element_lanes>& F) {
    LaneMat3<Real8> out;
    for (int l = 0; l < element_lanes; ++l) {
        const Mat3& f = F[static_cast<std::size_t>(l)];
        out.c0.x[l] = f(0, 0), out.c0.y[l] = f(1, 0), out.c0.z[l] = f(2, 0);
        out.c1.x[l] = f(0, 1), out.c1.y[l] = f(1, 1), out.c1.z[l] = f(2, 1);
        out.c2.x[l] = f(0, 2), out.c2.y[l] = f(1, 2), out.c2.z[l] = f(2, 2);
    }
    return out;
}

LaneMat3<Real8> lane_frame(const LaneMat3<Real8>& F) {
    const Real8 one = Real8{} + 1.0;
    LaneQuaternion<Real8> q{one, {}, {}, {}};
    extract_rotation(F, one, q);
    return rotation_of(q);
}

LaneMat3<Real8> lane_stress(const MaterialConstants& material, const LaneMat3<Real8>& F) {
    return with_law(material.model, [&](auto law) {
        if constexpr (law.has_frame)
            return whole(law.stress(material, F, lane_frame(F)), F);
        else
            return whole(law.stress(material, F), F);
    });
}

Real8 lane_energy(const MaterialConstants& material, const LaneMat3<Real8>& F) {
    return with_law(material.model, [&](auto law) {
        if constexpr (law.has_frame)
            return law.energy_density(material, F, lane_frame(F));
        else
            return law.energy_density(material, F);
    });
}

}  // namespace

TEST_CASE("every model is free of stress and energy at rest", "[unit]") {
    for (MaterialModel model : test::material_models) {
        const MaterialConstants material = rubber(model);
        CHECK(stress(material, Mat3::Identity()).norm() <= 1e-15 * material.lame_lambda * 10);
        CHECK(std::abs(energy_density(material, Mat3::Identity())) <= 1e-15 * material.lame_lambda);
    }
}

TEST_CASE("stress and energy by lanes agree with the plain twin", "[unit]") {
    std::mt19937_64 random(1);
    for (MaterialModel model : test::material_models) {
        const MaterialConstants material = rubber(model);
        for (int trial = 0; trial < 300; ++trial) {
            std::array<Mat3, element_lanes> F;
            for (Mat3& f : F) f = random_gradient(random, trial % 3);
            const LaneMat3<Real8> lanes = side_by_side(F), P = lane_stress(material, lanes);
            const Real8 energy = lane_energy(material, lanes);
            for (int l = 0; l < element_lanes; ++l) {
                const Mat3& f = F[static_cast<std::size_t>(l)];
                // Only rounding differs, but the axes of a nearly degenerate F magnify it by 1 / (s_i + s_j).
                const Real scale = material.lame_lambda * (1 + f.squaredNorm() * f.norm());
                const bool has_axes = model == MaterialModel::corotational || model == MaterialModel::ogden ||
                                      model == MaterialModel::hencky;
                const Real magnify = has_axes ? stiffness_bound(material, f) / material.shear_modulus : 1;
                // Logarithms of small stretches have the rounding error of the logarithm, not that of the stretch.
                const Real digits = model == MaterialModel::hencky ? 3e-14 : 1e-14;
                INFO("model " << name_of(model) << " trial " << trial << " lane " << l);
                CHECK((lane_of(P, l) - stress(material, f)).norm() <= digits * scale * magnify);
                CHECK(std::abs(energy[l] - energy_density(material, f)) <= 1e-14 * scale * magnify * (1 + f.norm()));
            }
        }
    }
}

TEST_CASE("a lane has the bits that its element gives alone", "[unit]") {
    std::mt19937_64 random(2);
    std::array<Mat3, element_lanes> F;
    for (Mat3& f : F) f = random_gradient(random, 1);
    const LaneMat3<Real8> lanes = side_by_side(F);
    for (MaterialModel model : test::material_models) {
        if (has_frame(model)) continue;  // its frame iterates until all lanes are done
        const MaterialConstants material = rubber(model);
        const LaneMat3<Real8> P = lane_stress(material, lanes);
        for (int l = 0; l < element_lanes; ++l) {
            const LaneMat3<Real> f = from_matrix(F[static_cast<std::size_t>(l)]);
            const LaneMat3<Real> alone = with_law(model, [&](auto law) {
                if constexpr (law.has_frame)
                    return f;
                else
                    return whole(law.stress(material, f), f);
            });
            CHECK(lane_of(P, l) == to_matrix(alone));
        }
    }
}

TEST_CASE("no eigenvalue of dP/dF is above the bound", "[unit]") {
    std::mt19937_64 random(3);
    for (MaterialModel model : test::material_models) {
        const MaterialConstants material = rubber(model);
        for (int trial = 0; trial < 200; ++trial) {
            const Mat3 F = random_gradient(random, trial % 3);
            const Real bound = stiffness_bound(material, F);
            // The frame is about to jump: differences across the jump have no meaning.
            if (bound > 1e3 * material.lame_lambda) continue;
            // Power iteration on dP/dF by central differences, with a shift that makes the largest eigenvalue the
            // largest in magnitude.
            const Real step = 1e-5;
            Mat3 d = random_gradient(random, 1);
            Real top = 0;
            for (int i = 0; i < 200; ++i) {
                d.normalize();
                const Mat3 Hd = (stress(material, F + step * d) - stress(material, F - step * d)) / (2 * step);
                top = (d.cwiseProduct(Hd)).sum();
                d = Hd + bound * d;
            }
            INFO("model " << name_of(model) << " trial " << trial);
            CHECK(top <= bound * (1 + 1e-5));  // 1e-5: error of the differences
            if (model != MaterialModel::linear && F.determinant() > 0.5)
                CHECK(bound <= 4 * std::max(top, 2 * material.shear_modulus));
        }
    }
}

TEST_CASE("at rest the bound is the stiffest small-strain modulus", "[unit]") {
    for (MaterialModel model : {MaterialModel::linear, MaterialModel::corotational}) {
        const MaterialConstants material = rubber(model);
        CHECK(stiffness_bound(material, Mat3::Identity()) ==
              Approx(2 * material.shear_modulus + 3 * material.lame_lambda));
    }
}

TEST_CASE("stable neo-Hookean: at rest no stress, and Hooke's law for small strains, for every Poisson ratio",
          "[unit]") {
    std::mt19937_64 random(4);
    for (Real nu : {-0.999, -0.9, -0.5, -0.1, 0.0, 0.25, 0.4, 0.49, 0.4999}) {
        const MaterialConstants material = material_constants(MaterialModel::stable_neo_hookean, 1, nu, 1);
        const Real mu = material.shear_modulus, la = material.lame_lambda;
        INFO("nu " << nu);
        CHECK(stress(material, Mat3::Identity()).norm() <= 1e-15 * mu);
        CHECK(energy_density(material, Mat3::Identity()) == 0);
        for (int trial = 0; trial < 20; ++trial) {
            const Mat3 d = random_gradient(random, 1);
            constexpr Real step = 1e-5;
            const Mat3 slope =
                (stress(material, Mat3::Identity() + step * d) - stress(material, Mat3::Identity() - step * d)) /
                (2 * step);
            const Mat3 expected = la * d.trace() * Mat3::Identity() + mu * (d + d.transpose());
            // error of the differences: step^2 times the third derivative
            CHECK((slope - expected).norm() <= 1e-8 * (mu + std::abs(la)));
        }
    }
}

TEST_CASE("stable neo-Hookean: energy and stress turn with the body, whatever the shape", "[unit]") {
    std::mt19937_64 random(5);
    const MaterialConstants material = rubber(MaterialModel::stable_neo_hookean);
    for (int trial = 0; trial < 100; ++trial) {
        const Mat3 F = random_gradient(random, trial % 3);
        const Mat3 Q = Eigen::AngleAxis<Real>(0.1 * trial, test::random_vector(random).normalized()).toRotationMatrix();
        const Real scale = 1e-14 * material.lame_lambda * std::pow(1 + F.norm(), 6);
        CHECK(std::abs(energy_density(material, Q * F) - energy_density(material, F)) <= scale);
        CHECK((stress(material, Q * F) - Q * stress(material, F)).norm() <= scale);
        CHECK((stress(material, F * Q) - stress(material, F) * Q).norm() <= scale);  // isotropic, too
    }
}

TEST_CASE("stable neo-Hookean: a compressed element is pushed apart", "[unit]") {
    // Without the logarithm F = 0 is a minimum. Below nu = -0.85, where a material resists shear much more than
    // pressure, the law as published has a second minimum at a half of the length.
    for (Real nu : {-0.84, -0.5, 0.0, 0.3, 0.4, 0.49, 0.4999}) {
        const MaterialConstants material = material_constants(MaterialModel::stable_neo_hookean, 1, nu, 1);
        Real energy = energy_density(material, Mat3::Zero());
        for (Real s = 1e-3; s < 0.999; s += 1e-3) {
            INFO("nu " << nu << " s " << s);
            REQUIRE(stress(material, s * Mat3::Identity()).trace() < 0);
            const Real next = energy_density(material, s * Mat3::Identity());
            REQUIRE(next < energy);
            energy = next;
        }
        CHECK(stress(material, Mat3::Zero()) == Mat3::Zero());
        // Compressed to a line of any length: the two nearly vanishing sides are pushed apart.
        for (Real length : {0.01, 0.3, 1.0, 3.0, 100.0}) {
            const Mat3 P = stress(material, Vec3(length, 1e-6, 1e-6).asDiagonal());
            CHECK(P(1, 1) < 0);
            CHECK(P(2, 2) < 0);
        }
        // Compressed flat: pushed apart, from either side towards the right one.
        for (Real thickness : {0.01, 0.0, -0.01, -0.5, -1.0})
            CHECK(stress(material, Vec3(1, 1, thickness).asDiagonal())(2, 2) < 0);
    }
}

TEST_CASE("stable neo-Hookean: no eigenvalue of the dense Hessian is above the bound", "[unit]") {
    std::mt19937_64 random(6);
    const std::array<Vec3, 10> stretches{
        Vec3(1, 1, 1), Vec3(3, 3, 3),    Vec3(5, 0.5, 0.5),    Vec3(0.5, 0.5, 0.5), Vec3(0.1, 0.1, 0.1),
        Vec3(0, 0, 0), Vec3(1, 1, 0.05), Vec3(1.3, 0.9, -0.6), Vec3(-1, -1, -1),    Vec3(2, -0.1, 0.1)};
    for (Real nu : {-0.9, -0.5, 0.0, 0.3, 0.49}) {
        const MaterialConstants material = material_constants(MaterialModel::stable_neo_hookean, 1, nu, 1);
        for (const Vec3& stretch : stretches)
            for (int trial = 0; trial < 10; ++trial) {
                const Mat3 F =
                    Mat3(stretch.asDiagonal()) + 0.05 * trial * (random_gradient(random, 1) - Mat3::Identity());
                Eigen::Matrix<Real, 9, 9> H;
                constexpr Real step = 1e-5;
                for (int i = 0; i < 9; ++i) {
                    Mat3 up = F, down = F;
                    up.data()[i] += step;
                    down.data()[i] -= step;
                    const Mat3 column = (stress(material, up) - stress(material, down)) / (2 * step);
                    H.col(i) = Eigen::Map<const Eigen::Matrix<Real, 9, 1>>(column.data());
                }
                const Real bound = stiffness_bound(material, F);
                INFO("nu " << nu << " stretch " << stretch.transpose() << " trial " << trial);
                CHECK((H - H.transpose()).norm() <= 1e-7 * bound);  // a stress with an energy has a symmetric Hessian
                const Real top = symmetric_eigenvalues(0.5 * (H + H.transpose()))[8];
                CHECK(top <= bound * (1 + 1e-7));
                const Real rough = StableNeoHookean::rough_stiffness_bound(material, F.squaredNorm(), F.determinant());
                CHECK(rough >= bound * (1 - 1e-12));
                if (trial == 0 && stretch == Vec3::Ones()) CHECK(rough == Approx(bound).epsilon(1e-12));
                CHECK(bound > 0);  // mass shares use it as a weight: positive, however soft the element is
            }
    }
}

TEST_CASE("stable neo-Hookean stress is finite for flat and mirrored elements", "[unit]") {
    const MaterialConstants material = rubber(MaterialModel::stable_neo_hookean);
    for (const Vec3& stretch : {Vec3(0, 0, 0), Vec3(1, 1, 0), Vec3(1, 1, -1), Vec3(1, 0, 0)}) {
        const Mat3 F = stretch.asDiagonal();
        CHECK(stress(material, F).allFinite());
        CHECK(energy_density(material, F) >= 0);
    }
}

TEST_CASE("constants are refused for values that mean nothing", "[unit]") {
    CHECK_THROWS_AS(material_constants(MaterialModel::linear, -1, 0.3, 1000), CheckFailed);
    CHECK_THROWS_AS(material_constants(MaterialModel::linear, 1e5, 0.5, 1000), CheckFailed);
    CHECK_THROWS_AS(material_constants(MaterialModel::linear, 1e5, 0.3, 0), CheckFailed);
}

TEST_CASE("a neo-Hookean body at rest has the energy of its strains, not of the rounding of the formula", "[unit]") {
    // A strain of 1e-12 has an energy of 1e-24 of the modulus. First-order terms that cancel only to rounding would
    // leave 1e-16.
    for (const Real nu : {-0.5, 0.0, 0.3, 0.49}) {
        const MaterialConstants material = material_constants(MaterialModel::stable_neo_hookean, 1e5, nu, 1000);
        Mat3 e;
        e << 1, 2, -3, 4, -5, 6, -7, 8, 9;
        const Mat3 F = Mat3::Identity() + 1e-12 * e;
        const Mat3 rounded = (F - Mat3::Identity()) / 1e-12, strain = (rounded + rounded.transpose()) / 2;
        const Real expected = 1e-24 * (material.shear_modulus * strain.squaredNorm() +
                                       material.lame_lambda / 2 * strain.trace() * strain.trace());
        CHECK(StableNeoHookean::energy_density(material, F) == Approx(expected).epsilon(1e-3));
    }
}

}  // namespace skerry::test::material_law_test
