// Derivatives against finite differences, and properties of the stress for simple deformations.
#include <Eigen/Geometry>
#include <catch2/catch.hpp>

#include "jobs/executor.h"
#include "systems/dynamics/elements/element_energy.h"
#include "tests/support/accuracy.h"
#include "tests/support/dense_algebra.h"
#include "tests/support/elastic_body.h"
#include "tests/support/material_models.h"

namespace skerry::test::elastic_gradient_test {

using test::ElasticBody;
using test::jittered_box;
namespace accuracy = test::accuracy;
using accuracy::Tolerance;

namespace {

Mat3 random_matrix(std::mt19937_64& random) {
    Mat3 m;
    m << test::random_vector(random), test::random_vector(random), test::random_vector(random);
    return m;
}

}  // namespace

TEST_CASE("stress is the derivative of the energy density", "[property]") {
    std::mt19937_64 random(1);
    for (MaterialModel model : test::material_models) {
        const MaterialConstants material = material_constants(model, 1, 0.4, 1);
        for (int trial = 0; trial < 300; ++trial) {
            Mat3 F = Mat3::Identity() + (trial % 2 ? 1.0 : 0.2) * random_matrix(random);
            if (trial % 3 == 0) F.col(1) *= -1;
            if (stiffness_bound(material, F) > 100) continue;  // corotational model just before its frame jumps
            const Mat3 P = stress(material, F);
            constexpr Real step = 1e-5;  // error step^2 times the third derivative plus 1e-16 / step
            for (int i = 0; i < 9; ++i) {
                Mat3 up = F, down = F;
                up.data()[i] += step;
                down.data()[i] -= step;
                const Real slope = (energy_density(material, up) - energy_density(material, down)) / (2 * step);
                INFO("model " << name_of(model) << " trial " << trial);
                CHECK(std::abs(P.data()[i] - slope) <= 1e-6 * (1 + P.norm()));
            }
        }
    }
}

TEST_CASE("a tangent is the derivative of stress without its negative part", "[property]") {
    std::mt19937_64 random(3);
    using Matrix9 = Eigen::Matrix<Real, 9, 9>;
    for (MaterialModel model : test::material_models) {
        // The tangent of this law has further parts, and leaves out the negative part of the stress alone. It is tested
        // in orthotropic_test.cpp.
        if (model == MaterialModel::orthotropic) continue;
        int softened = 0;
        for (int trial = 0; trial < 200; ++trial) {
            const MaterialConstants material = material_constants(model, 1, trial % 4 == 0 ? -0.3 : 0.4, 1);
            Mat3 F = Mat3::Identity() + (trial % 2 ? 0.7 : 0.2) * random_matrix(random);
            if (trial % 5 == 0) F.col(1) *= -1;
            if (stiffness_bound(material, F) > 30) continue;  // corotational model just before its frame jumps
            Matrix9 slope, found;
            const Tangent tangent = skerry::tangent(material, F);
            for (int i = 0; i < 9; ++i) {
                constexpr Real step = 1e-5;
                Mat3 unit = Mat3::Zero();
                unit.data()[i] = 1;
                const Mat3 by_differences =
                    (stress(material, F + step * unit) - stress(material, F - step * unit)) / (2 * step);
                const Mat3 turned = tangent.left.transpose() * unit * tangent.right;
                Mat3 pull = Mat3::Zero();
                for (int k = 0; k < 3; ++k) {
                    const int a = (k + 1) % 3, b = (k + 2) % 3;
                    pull(k, k) = tangent.normal.row(k).dot(turned.diagonal());
                    const Real even = (tangent.flip[k] + tangent.twist[k]) / 2,
                               crossed = (tangent.flip[k] - tangent.twist[k]) / 2;
                    pull(a, b) = even * turned(a, b) + crossed * turned(b, a);
                    pull(b, a) = even * turned(b, a) + crossed * turned(a, b);
                }
                const Mat3 back = tangent.left * pull * tangent.right.transpose();
                slope.col(i) = Eigen::Map<const Eigen::Matrix<Real, 9, 1>>(by_differences.data());
                found.col(i) = Eigen::Map<const Eigen::Matrix<Real, 9, 1>>(back.data());
            }
            const SymmetricModes modes = symmetric_modes((slope + slope.transpose()) / 2);
            const Matrix9 kept =
                modes.eigenvectors * modes.eigenvalues.cwiseMax(0).asDiagonal() * modes.eigenvectors.transpose();
            softened += modes.eigenvalues.minCoeff() < -1e-3;
            INFO("model " << name_of(model) << " trial " << trial);
            CHECK((found - kept).norm() <= 1e-6 * (1 + slope.norm()));
        }
        CHECK((model == MaterialModel::linear ? softened == 0 : softened > 20));
    }
}

TEST_CASE("small strains meet the Lame moduli", "[property][accuracy]") {
    // docs/accuracy.md, item 19: dP/dF at rest is lambda I:dF + 2 mu sym(dF). The tolerance 1e-6 is for the
    // differences.
    std::mt19937_64 random(2);
    for (MaterialModel model : test::material_models) {
        const MaterialConstants material = material_constants(model, 1e5, 0.4, 1000);
        Real worst = 0;
        for (int trial = 0; trial < 20; ++trial) {
            const Mat3 d = random_matrix(random);
            constexpr Real step = 1e-5;
            const Mat3 slope =
                (stress(material, Mat3::Identity() + step * d) - stress(material, Mat3::Identity() - step * d)) /
                (2 * step);
            const Mat3 expected =
                material.lame_lambda * d.trace() * Mat3::Identity() + material.shear_modulus * (d + d.transpose());
            worst = std::max(worst, (slope - expected).norm() / expected.norm());
        }
        accuracy::check({.item = 19,
                         .name = "slope of the stress at rest, relative error, worst of 20 directions, " +
                                 std::string(name_of(model)),
                         .formula = "lambda tr(dF) I + mu (dF + dF^T)",
                         .found = worst,
                         .tolerance = 1e-6,
                         .kind = Tolerance::absolute});
    }
}

TEST_CASE("nodal forces are minus the derivative of the elastic energy", "[property]") {
    const auto executor = make_executor(Backend::serial, 1);
    for (MaterialModel model : test::material_models) {
        ElasticBody body(jittered_box({2, 2, 2}, 0.1, 0.25, 3), material_constants(model, 1e5, 0.4, 1000));
        std::mt19937_64 random(4);
        for (Vec3& x : body.position) x += 0.015 * test::random_vector(random);
        body.compute_forces(*executor);
        Real scale = 0;
        for (const Vec3& f : body.force) scale = std::max(scale, f.norm());
        constexpr Real step = 1e-6;  // [m]; cells are 0.1 m
        for (std::size_t n = 0; n < body.position.size(); ++n)
            for (int i = 0; i < 3; ++i) {
                const Real before = body.position[n][i];
                body.position[n][i] = before + step;
                const Real up = elastic_energy(body.inputs(), body.blocks, body.position);
                body.position[n][i] = before - step;
                const Real down = elastic_energy(body.inputs(), body.blocks, body.position);
                body.position[n][i] = before;
                CHECK(std::abs(body.force[n][i] + (up - down) / (2 * step)) <= 1e-6 * scale);
            }
    }
}

TEST_CASE("internal forces have no sum and, rotation-invariant models, no torque", "[property]") {
    const auto executor = make_executor(Backend::serial, 1);
    for (MaterialModel model : test::material_models) {
        ElasticBody body(jittered_box({3, 3, 3}, 0.1, 0.25, 5), material_constants(model, 1e5, 0.4, 1000));
        std::mt19937_64 random(6);
        for (Vec3& x : body.position) x = Vec3(1, 2, 3) + x + 0.03 * test::random_vector(random);
        body.compute_forces(*executor);
        Vec3 sum = Vec3::Zero(), torque = Vec3::Zero();
        Real size = 0, arm = 0;
        for (std::size_t n = 0; n < body.position.size(); ++n) {
            sum += body.force[n];
            torque += body.position[n].cross(body.force[n]);
            size += body.force[n].norm();
            arm += body.position[n].norm() * body.force[n].norm();
        }
        INFO(name_of(model));
        CHECK(sum.norm() <= 1e-13 * size);
        if (model == MaterialModel::linear)
            CHECK(torque.norm() > 1e-6 * arm);  // known defect of linear elasticity: no balance of torque
        else
            CHECK(torque.norm() <= 1e-13 * arm);
    }
}

TEST_CASE("patch test: a homogeneous deformation leaves no force inside and one stress everywhere",
          "[property][accuracy]") {
    // docs/accuracy.md, item 17: interior forces <= 1e-12 E h^2.
    const auto executor = make_executor(Backend::serial, 1);
    Mat3 A;
    A << 1.1, 0.05, 0, 0.02, 0.95, 0.03, -0.04, 0, 1.2;
    for (MaterialModel model : test::material_models) {
        ElasticBody body(jittered_box({4, 4, 4}, 0.1, 0.25, 7), material_constants(model, 1e5, 0.4, 1000));
        std::vector<bool> inside;
        for (std::size_t n = 0; n < body.position.size(); ++n) {
            const Index i = static_cast<Index>(n) % 5, j = static_cast<Index>(n) / 5 % 5,
                        k = static_cast<Index>(n) / 25;
            inside.push_back(i % 4 != 0 && j % 4 != 0 && k % 4 != 0);
            body.position[n] = A * body.position[n] + Vec3(1, 2, 3);
        }
        body.compute_forces(*executor);
        Real force = 0, spread = 0;
        for (std::size_t n = 0; n < body.position.size(); ++n)
            if (inside[n]) force = std::max(force, body.force[n].norm());
        std::vector<Mat3> stress(384);
        cauchy_stress(body.inputs(), body.blocks, body.position, stress);
        for (const Mat3& s : stress) spread = std::max(spread, std::abs(von_mises(s) / von_mises(stress[0]) - 1));
        const std::string which = std::string(name_of(model));
        accuracy::check({.item = 17,
                         .name = "patch test, largest force inside over E h^2, " + which,
                         .formula = "0",
                         .found = force / (1e5 * 0.01),
                         .tolerance = 1e-12,
                         .kind = Tolerance::absolute});
        accuracy::check({.item = 17,
                         .name = "patch test, spread of the stress over the stress, " + which,
                         .formula = "0",
                         .found = spread,
                         .tolerance = 1e-11,
                         .kind = Tolerance::absolute});
    }
}

TEST_CASE("a turned body feels nothing, but for linear elasticity, which swells by the known amount",
          "[property][accuracy]") {
    // docs/accuracy.md, item 18.
    const auto executor = make_executor(Backend::serial, 1);
    std::mt19937_64 random(8);
    for (MaterialModel model : test::material_models) {
        const MaterialConstants material = material_constants(model, 1e5, 0.4, 1000);
        ElasticBody body(jittered_box({3, 3, 3}, 0.1, 0.2, 9), material);
        const std::vector<Vec3> rest = body.position;
        Real volume = 0;
        for (std::size_t e = 0; e < 162; ++e) volume += body.volume(e);
        Real worst = 0;
        for (int trial = 0; trial < 20; ++trial) {
            const Eigen::AngleAxis<Real> turn(M_PI * (trial + 1) / 20, test::random_vector(random).normalized());
            for (std::size_t n = 0; n < rest.size(); ++n) body.position[n] = turn * rest[n];
            body.compute_forces(*executor);
            if (model != MaterialModel::linear) {
                for (const Vec3& f : body.force) worst = std::max(worst, f.norm() / (material.shear_modulus * 0.01));
            } else {
                const Mat3 R = turn.toRotationMatrix();
                const Mat3 strain = 0.5 * (R + R.transpose()) - Mat3::Identity();
                const Real density = material.shear_modulus * strain.squaredNorm() +
                                     0.5 * material.lame_lambda * strain.trace() * strain.trace();
                worst = std::max(
                    worst,
                    std::abs(elastic_energy(body.inputs(), body.blocks, body.position) / (volume * density) - 1));
            }
        }
        if (model == MaterialModel::linear)
            accuracy::check({.item = 18,
                             .name = "turned body of linear material: energy over the known one - 1, worst of 20 turns",
                             .formula = "V (mu |e|^2 + lambda tr(e)^2 / 2), e = (R + R^T) / 2 - I",
                             .found = worst,
                             .tolerance = 1e-10,
                             .kind = Tolerance::absolute,
                             .note = "Linear elasticity is not invariant; it fails by the amount that theory gives."});
        else
            accuracy::check(
                {.item = 18,
                 .name = "turned body, largest force over mu h^2, worst of 20 turns, " + std::string(name_of(model)),
                 .formula = "0",
                 .found = worst,
                 .tolerance = 1e-12,
                 .kind = Tolerance::absolute});
    }
}

TEST_CASE("forces turn with the body", "[property]") {
    const auto executor = make_executor(Backend::serial, 1);
    std::mt19937_64 random(10);
    for (MaterialModel model : {MaterialModel::corotational, MaterialModel::stable_neo_hookean, MaterialModel::ogden,
                                MaterialModel::hencky, MaterialModel::orthotropic}) {
        ElasticBody body(jittered_box({3, 2, 2}, 0.1, 0.2, 11), material_constants(model, 1e5, 0.4, 1000));
        for (Vec3& x : body.position) x += 0.02 * test::random_vector(random);
        body.compute_forces(*executor);
        const std::vector<Vec3> before = body.force;
        const Eigen::AngleAxis<Real> turn(2.2, Vec3(3, -1, 2).normalized());
        for (Vec3& x : body.position) x = turn * x;
        body.compute_forces(*executor);
        for (std::size_t n = 0; n < before.size(); ++n)
            CHECK((body.force[n] - turn * before[n]).norm() <= 1e-11 * 1e5 * 0.01);
    }
}

}  // namespace skerry::test::elastic_gradient_test
