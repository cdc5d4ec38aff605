#include "systems/dynamics/stability/frame_masses.h"

#include <Eigen/Geometry>
#include <catch2/catch.hpp>
#include <cmath>
#include <limits>

#include "systems/dynamics/stability/mass_forms.h"
#include "systems/dynamics/stability/stable_step.h"
#include "tests/support/dense_algebra.h"
#include "tests/support/elastic_body.h"
#include "tests/support/element_kinds.h"
#include "tests/support/exact_frequency.h"
#include "tests/support/material_models.h"

namespace skerry::test::frame_masses_test {

using test::ElasticBody;
using test::jittered_box;

namespace {

void find_masses(ElasticBody& body, Real most_products = products_of_frame) {
    find_frame_masses(body.inputs(), body.blocks, body.position, body.mass, most_products,
                      body.elements.frame_mass.span(), body.elements.frame_bound.span());
}
void find_forms(ElasticBody& body) {
    find_mass_forms(body.inputs(), body.blocks, body.position, body.mass, products_of_group,
                    body.elements.mass_form.span());
}

Real q_of(const ElasticBody& body, std::size_t element) {
    return body.elements.frame_mass[element / element_lanes][0][element % element_lanes];
}
Real b_of(const ElasticBody& body, std::size_t element) {
    return body.elements.frame_mass[element / element_lanes][1][element % element_lanes];
}

/// Largest eigenvalue of M^-1/2 S M^-1/2, where S sums the masses taken by all elements of a body turned by R.
Real part_of_mass_taken(const ElasticBody& body, const Mat3& R) {
    const auto size = 3 * static_cast<Eigen::Index>(body.position.size());
    Eigen::MatrixXd sum = Eigen::MatrixXd::Zero(size, size);
    for (std::size_t e = 0; e < body.elements.volume.size() * element_lanes; ++e) {
        if (!(body.volume(e) > 0)) continue;
        for (std::size_t j = 0; j < body.node_count(e); ++j)
            for (std::size_t k = 0; k < body.node_count(e); ++k) {
                const Vec3 gj = body.gradient(e, j), gk = body.gradient(e, k);
                const Mat3 block =
                    (gj.dot(gk) / q_of(body, e)) * Mat3::Identity() + b_of(body, e) * (R * gj) * (R * gk).transpose();
                sum.block<3, 3>(3 * static_cast<Eigen::Index>(body.node(e, j)),
                                3 * static_cast<Eigen::Index>(body.node(e, k))) +=
                    block / std::sqrt(body.mass[body.node(e, j)] * body.mass[body.node(e, k)]);
            }
    }
    return symmetric_eigenvalues(sum)[size - 1];
}

/// Bound of omega^2 of the body from the frame masses alone, in a frame turned by R [1/s^2].
Real bound_in_frame(const ElasticBody& body, const Mat3& R) {
    Real highest = 0;
    for (auto b = static_cast<std::size_t>(body.blocks.begin); b < static_cast<std::size_t>(body.blocks.end); ++b) {
        LaneQuaternion<Real8> q{Real8{} + 1.0, {}, {}, {}};
        const Real8 bound =
            frequency_squared_in_frame(body.inputs(), b, deformation_of(body.inputs(), b, body.position), R, q);
        for (std::size_t l = 0; l < element_lanes; ++l) highest = std::max<Real>(highest, bound[l]);
    }
    return highest;
}

Mat3 turned(Real angle, const Vec3& axis) {
    return Eigen::AngleAxis<Real>(angle, axis.normalized()).toRotationMatrix();
}

/// Turns each cross-section of a box by an angle proportional to x, so that elements turn against each other.
void twist(ElasticBody& body, Real radians_per_metre) {
    for (Vec3& x : body.position) x = turned(radians_per_metre * x.x(), {1, 0, 0}) * x;
}

}  // namespace

TEST_CASE("in its frame elements take no more mass than there is, and nearly all", "[unit]") {
    for (const ElementKind kind : test::element_kinds)
        for (const Real jitter : {0.0, 0.3}) {
            ElasticBody body(jittered_box({4, 3, 3}, 0.1, jitter, 21, 0.02),
                             material_constants(MaterialModel::stable_neo_hookean, 1e5, 0.4, 1000), Mat3::Identity(),
                             kind);
            find_masses(body);
            for (const Mat3& R : {Mat3(Mat3::Identity()), turned(2.1, {1, -2, 0.5})}) {
                const Real taken = part_of_mass_taken(body, R);
                INFO(name_of(kind) << ", jitter " << jitter << ": " << taken);
                CHECK(taken <= 1 + 1e-9);
                CHECK(taken >= 0.97);
            }
        }
}

TEST_CASE("the step in the frame of a body is below the limit and within an eighth of it at rest", "[unit][long]") {
    for (const ElementKind kind : test::element_kinds)
        for (const MaterialModel model : test::material_models)
            for (const Real jitter : {0.0, 0.3})
                for (const Real nu : {0.0, 0.3, 0.45}) {
                    if (kind == ElementKind::edge_node_smoothed && nu == 0) continue;  // nodes would have no stiffness
                    ElasticBody body(jittered_box({4, 3, 3}, 0.1, jitter, 11, 0.02),
                                     material_constants(model, 1e5, nu, 1000), Mat3::Identity(), kind);
                    find_masses(body);
                    const Real limit = test::exact_limit(body), step = test::stable_step_of(body);
                    INFO(name_of(kind) << ", " << name_of(model) << ", jitter " << jitter << ", nu " << nu << ": "
                                       << step / limit);
                    CHECK(step <= 0.9 * limit * (1 + 1e-6));  // 1e-6: error of the differences
                    CHECK(step >= 0.87 * 0.9 * limit);
                    if (model == MaterialModel::linear) continue;
                    const Mat3 turn = turned(2.5, {1, -2, 0.5});
                    for (Vec3& x : body.position) x = turn * x + Vec3(1, 2, 3);
                    CHECK(test::stable_step_of(body) == Approx(step).epsilon(0.003));  // tolerance of the bisection
                }
}

TEST_CASE("masses in a frame hold for every shape and in every frame", "[unit][long]") {
    for (const ElementKind kind : test::element_kinds)
        for (const MaterialModel model : test::material_models)
            for (const Vec3& stretch :
                 {Vec3(1, 1, 1), Vec3(1.6, 1.6, 1.6), Vec3(2.5, 0.7, 0.7), Vec3(0.5, 0.5, 0.5), Vec3(1.3, 1, -0.5)}) {
                if (model == MaterialModel::orthotropic && stretch == Vec3(0.5, 0.5, 0.5))
                    continue;  // no stiffness left
                ElasticBody body(jittered_box({3, 3, 2}, 0.1, 0.2, 12), material_constants(model, 1e5, 0.4, 1000),
                                 Mat3::Identity(), kind);
                find_masses(body);
                find_forms(body);
                std::mt19937_64 random(13);
                for (Vec3& x : body.position) x = stretch.cwiseProduct(x) + 0.004 * test::random_vector(random);
                twist(body, 3);
                const Real squared = test::exact_frequency_squared(body);
                INFO(name_of(kind) << ", " << name_of(model) << ", " << stretch.transpose());
                for (const Mat3& R : {Mat3(Mat3::Identity()), turned(0.4, {1, 0, 0}), turned(2, {0, 1, 1})})
                    CHECK(bound_in_frame(body, R) >= squared * (1 - 2e-5));
                CHECK(test::stable_step_of(body) <= 0.9 * 2 / std::sqrt(squared) * (1 + 1e-5));
            }
}

TEST_CASE("the bound in a frame is the highest eigenvalue of stiffness over mass", "[unit]") {
    ElasticBody body(jittered_box({2, 2, 2}, 0.1, 0.2, 4), material_constants(MaterialModel::linear, 1e5, 0.35, 1000));
    find_masses(body);
    const MaterialConstants& material = body.constants[0];
    Eigen::Matrix<double, 9, 9> H = Eigen::Matrix<double, 9, 9>::Zero();
    for (int i = 0; i < 3; ++i)
        for (int j = 0; j < 3; ++j) {  // by entries of X: index 3 column + row
            H(3 * j + i, 3 * j + i) += material.shear_modulus;
            H(3 * j + i, 3 * i + j) += material.shear_modulus;
            H(4 * i, 4 * j) += material.lame_lambda;
        }
    for (const Real angle : {0.0, 0.3, 1.5}) {
        const Mat3 R = turned(angle, {1, 2, -1});
        const Eigen::Map<const Eigen::Matrix<double, 9, 1>> r(R.data());
        for (std::size_t b = 0; b < body.elements.volume.size(); ++b) {
            LaneQuaternion<Real8> q{Real8{} + 1.0, {}, {}, {}};
            const Real8 bound =
                frequency_squared_in_frame(body.inputs(), b, deformation_of(body.inputs(), b, body.position), R, q);
            for (std::size_t l = 0; l < element_lanes; ++l) {
                const std::size_t e = b * element_lanes + l;
                if (!(body.volume(e) > 0)) continue;
                const Eigen::Matrix<double, 9, 9> M =
                    Eigen::Matrix<double, 9, 9>::Identity() / q_of(body, e) + b_of(body, e) * r * r.transpose();
                const Real exact = symmetric_eigenvalues(body.volume(e) * H, M)[8];
                INFO(angle << ": " << bound[l] / exact);
                CHECK(bound[l] >= exact * (1 - 1e-9));
                CHECK(bound[l] <= exact * 1.004);  // tolerance of the bisection
            }
        }
    }
}

TEST_CASE("a body of elements that rotate against each other uses mass forms", "[unit]") {
    ElasticBody body(jittered_box({12, 2, 2}, 0.1, 0.1, 3),
                     material_constants(MaterialModel::stable_neo_hookean, 1e5, 0.4, 1000));
    find_forms(body);
    const Real forms_at_rest = test::stable_step_of(body);
    find_masses(body);
    const Real at_rest = test::stable_step_of(body);
    CHECK(at_rest > 1.2 * forms_at_rest);
    twist(body, 2.5);  // the ends turn by three radians against each other
    const Real twisted = test::stable_step_of(body);
    CHECK(0.9 * 2 / std::sqrt(bound_in_frame(body, Mat3::Identity())) < 0.8 * twisted);
    std::ranges::fill(body.elements.frame_bound, Real(0));
    CHECK(twisted == test::stable_step_of(body));
}

TEST_CASE("relaxing springs shorten the step in a frame", "[unit]") {
    MaterialConstants material = material_constants(MaterialModel::stable_neo_hookean, 1e5, 0.4, 1000);
    material.loss_factor = 0.1;
    for (const ElementKind kind : test::element_kinds) {
        ElasticBody body(jittered_box({4, 3, 3}, 0.1, 0.1, 5), material, Mat3::Identity(), kind);
        for (Real& share : body.elements.relaxing_share) share = 0.5;  // relaxation rate 0: the springs act in full
        find_masses(body);
        const Real limit = test::exact_limit(body), step = test::stable_step_of(body);
        INFO(name_of(kind) << ": " << step / limit);
        CHECK(step <= 0.9 * limit * (1 + 1e-6));
        CHECK(step >= 0.87 * 0.9 * limit);
    }
}

TEST_CASE("nothing is found for a body without elements or of too many, nor a step for one that is not finite",
          "[unit]") {
    find_frame_masses({}, {0, 0}, {}, {}, products_of_frame, {}, {});
    ElasticBody body(jittered_box({3, 3, 3}, 0.1, 0, 1), material_constants(MaterialModel::linear, 1e5, 0.3, 1000));
    find_masses(body, 1e5);
    CHECK(std::ranges::all_of(body.elements.frame_bound, [](Real bound) { return bound == 0; }));
    find_masses(body);
    CHECK(std::ranges::all_of(body.elements.frame_bound, [](Real bound) { return bound > 0; }));
    body.position[0].x() = std::numeric_limits<Real>::quiet_NaN();
    CHECK(test::stable_step_of(body) == 0);
}

}  // namespace skerry::test::frame_masses_test
