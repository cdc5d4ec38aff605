#include "systems/dynamics/stability/mass_forms.h"

#include <Eigen/Geometry>
#include <catch2/catch.hpp>
#include <cmath>
#include <limits>

#include "systems/dynamics/stability/stable_step.h"
#include "tests/support/dense_algebra.h"
#include "tests/support/elastic_body.h"
#include "tests/support/element_kinds.h"
#include "tests/support/exact_frequency.h"
#include "tests/support/material_models.h"

namespace skerry::test::mass_forms_test {

using test::ElasticBody;
using test::jittered_box;

namespace {

void find_forms(ElasticBody& body, Real most_products = products_of_group) {
    find_mass_forms(body.inputs(), body.blocks, body.position, body.mass, most_products,
                    body.elements.mass_form.span());
}

/// Largest eigenvalue of M^-1/2 sum_e G Q^-1 G^T M^-1/2.
Real part_of_mass_taken(const ElasticBody& body) {
    const auto size = static_cast<Eigen::Index>(body.position.size());
    Eigen::MatrixXd sum = Eigen::MatrixXd::Zero(size, size);
    for (std::size_t e = 0; e < body.elements.volume.size() * element_lanes; ++e) {
        if (!(body.volume(e) > 0)) continue;
        const ElementForm& form = body.elements.mass_form[e / element_lanes];
        const auto q = [&](std::size_t i) { return form[i][e % element_lanes]; };
        Mat3 Q;
        Q << q(0), q(3), q(5), q(3), q(1), q(4), q(5), q(4), q(2);
        const Mat3 inverse = Q.inverse();
        for (std::size_t j = 0; j < body.node_count(e); ++j)
            for (std::size_t k = 0; k < body.node_count(e); ++k)
                sum(static_cast<Eigen::Index>(body.node(e, j)), static_cast<Eigen::Index>(body.node(e, k))) +=
                    body.gradient(e, j).dot(inverse * body.gradient(e, k)) /
                    std::sqrt(body.mass[body.node(e, j)] * body.mass[body.node(e, k)]);
    }
    return symmetric_eigenvalues(sum)[size - 1];
}

}  // namespace

TEST_CASE("elements take no more mass than there is, and nearly all", "[unit]") {
    for (const ElementKind kind : test::element_kinds)
        for (const Real jitter : {0.0, 0.3}) {
            ElasticBody body(jittered_box({6, 4, 4}, 0.1, jitter, 21, 0.02),
                             material_constants(MaterialModel::stable_neo_hookean, 1e5, 0.4, 1000), Mat3::Identity(),
                             kind);
            find_forms(body);
            const Real whole = part_of_mass_taken(body);
            INFO(name_of(kind) << ", jitter " << jitter << ": " << whole);
            CHECK(whole <= 1 + 1e-9);
            CHECK(whole >= 0.97);
            find_forms(body, 2e4);  // in groups, each with a part of the masses of shared nodes
            const Real in_groups = part_of_mass_taken(body);
            INFO("in groups: " << in_groups);
            CHECK(in_groups <= 1 + 1e-9);
            CHECK(in_groups >= 0.3);
            CHECK(in_groups < whole);
        }
}

TEST_CASE("the step by mass forms is below the limit and near it", "[unit][long]") {
    // docs/methods/stable_step.md 2.3: linear elements reach 0.7 to 0.9 of the limit at rest, smoothed ones at least
    // 0.8.
    for (const ElementKind kind : test::element_kinds)
        for (const MaterialModel model : test::material_models)
            for (const Real jitter : {0.0, 0.3})
                for (const Real nu : {0.0, 0.3, 0.45}) {
                    if (kind == ElementKind::edge_node_smoothed && nu == 0) continue;  // nodes would have no stiffness
                    ElasticBody body(jittered_box({4, 3, 3}, 0.1, jitter, 11, 0.02),
                                     material_constants(model, 1e5, nu, 1000), Mat3::Identity(), kind);
                    find_forms(body);
                    const Real limit = test::exact_limit(body), step = test::stable_step_of(body);
                    INFO(name_of(kind) << ", " << name_of(model) << ", jitter " << jitter << ", nu " << nu << ": "
                                       << step / limit);
                    CHECK(step <= 0.9 * limit * (1 + 1e-6));  // 1e-6: error of the differences
                    CHECK(step >= (kind == ElementKind::linear ? 0.6 : 0.75) * 0.9 * limit);
                }
}

TEST_CASE("mass forms hold for every shape", "[unit][long]") {
    for (const ElementKind kind : test::element_kinds)
        for (const MaterialModel model : test::material_models)
            for (const Vec3& stretch :
                 {Vec3(1, 1, 1), Vec3(1.6, 1.6, 1.6), Vec3(2.5, 0.7, 0.7), Vec3(0.5, 0.5, 0.5), Vec3(1.3, 1, -0.5)}) {
                if (model == MaterialModel::orthotropic && stretch == Vec3(0.5, 0.5, 0.5))
                    continue;  // no stiffness left
                ElasticBody body(jittered_box({3, 3, 2}, 0.1, 0.2, 12), material_constants(model, 1e5, 0.4, 1000),
                                 Mat3::Identity(), kind);
                find_forms(body);
                std::mt19937_64 random(13);
                const Eigen::AngleAxis<Real> turn(2.5, Vec3(1, -2, 0.5).normalized());
                for (Vec3& x : body.position)
                    x = turn * (stretch.cwiseProduct(x) + 0.004 * test::random_vector(random));
                const Real limit = test::exact_limit(body), step = test::stable_step_of(body);
                INFO(name_of(kind) << ", " << name_of(model) << ", " << stretch.transpose() << ": " << step / limit);
                CHECK(step <= 0.9 * limit * (1 + 1e-5));
                CHECK(step >= 0.25 * limit);
            }
}

TEST_CASE("mass forms turn with nothing and make the step of smoothed elements a quarter longer", "[unit]") {
    ElasticBody body(jittered_box({5, 5, 5}, 0.1, 0, 1),
                     material_constants(MaterialModel::stable_neo_hookean, 1e5, 0.4, 1000), Mat3::Identity(),
                     ElementKind::edge_node_smoothed);
    std::vector<Real> sums(body.position.size());
    find_mass_shares(body.inputs(), body.blocks, body.position, body.mass, sums, body.elements.mass_share.span());
    const Real by_shares = test::stable_step_of(body);
    find_forms(body);
    const Real by_forms = test::stable_step_of(body);
    CHECK(by_forms > 1.25 * by_shares);
    const Eigen::AngleAxis<Real> turn(1.1, Vec3(3, 1, -2).normalized());
    for (Vec3& x : body.position) x = turn * x;
    CHECK(test::stable_step_of(body) == Approx(by_forms).epsilon(0.003));  // tolerance of the bisection
}

TEST_CASE("relaxing springs shorten the step by mass forms", "[unit]") {
    MaterialConstants material = material_constants(MaterialModel::stable_neo_hookean, 1e5, 0.4, 1000);
    material.loss_factor = 0.1;
    ElasticBody body(jittered_box({4, 3, 3}, 0.1, 0.1, 5), material, Mat3::Identity(), ElementKind::edge_node_smoothed);
    for (Real& share : body.elements.relaxing_share) share = 0.5;  // relaxation rate 0: the springs act in full
    find_forms(body);
    const Real limit = test::exact_limit(body), step = test::stable_step_of(body);
    CHECK(step <= 0.9 * limit * (1 + 1e-6));
    CHECK(step >= 0.75 * 0.9 * limit);
}

// Springs count by 2 / (2 + h r). Most elements are only compared with the step that others allow. No element that is
// unstable at that step may pass.
TEST_CASE("all elements are stable at the found step, in which their springs relax", "[unit][long]") {
    MaterialConstants material = material_constants(MaterialModel::stable_neo_hookean, 1e5, 0.4, 1000);
    material.loss_factor = 0.1;
    for (const ElementKind kind : test::element_kinds)
        for (const bool by_forms : {true, false}) {
            ElasticBody body(jittered_box({5, 4, 4}, 0.1, 0.1, 5), material, Mat3::Identity(), kind);
            const Real elastic = test::stable_step_of(body);
            for (std::size_t b = 0; b < body.elements.relaxing_share.size(); ++b) {
                body.elements.relaxing_share[b] = b % 2 == 0 ? 0.5 : 0.1;
                for (Real& rate : body.elements.relaxation_rate[b])
                    rate = 0.1 * std::pow(10, static_cast<Real>(b % 4)) / elastic;
            }
            if (by_forms) find_forms(body);
            const Real step = test::stable_step_of(body);
            INFO(name_of(kind) << (by_forms ? ", forms" : ", shares"));

            // each element evaluated by itself, with equal sharpness
            std::vector<Real> sums(body.position.size());
            Real shortest = std::numeric_limits<Real>::infinity();
            std::vector<ElementLane> steps(body.elements.volume.size());
            element_steps(body.inputs(), body.blocks, body.position, body.mass, sums, steps);
            for (std::size_t b = 0; b < steps.size(); ++b) {
                LaneQuaternion<Real8> q{Real8{} + 1.0, {}, {}, {}};
                const Real8 squared =
                    frequency_squared_by_form(body.inputs(), b, deformation_of(body.inputs(), b, body.position), q, 0);
                for (std::size_t l = 0; l < element_lanes; ++l)
                    if (body.elements.volume[b][l] > 0)
                        shortest =
                            std::min(shortest, by_forms ? step_times_frequency / std::sqrt(squared[l]) : steps[b][l]);
            }
            CHECK(step >= shortest * (1 - 0.003));  // tolerance of the bisection
            // Springs count at the step that is found, not at the shorter step of full springs. The bound by the trace
            // is at most 7 % too short, that of forms 0.3 %.
            CHECK(step <= shortest * (by_forms ? 1.01 : 1.08));
            INFO("of the shortest: " << step / shortest);

            // the whole body, with the part of the springs that counts in a step of this length
            for (std::size_t b = 0; b < body.elements.relaxing_share.size(); ++b)
                body.elements.relaxing_share[b] *= 2 / (2 + step * body.elements.relaxation_rate[b][0]);
            const Real limit = test::exact_limit(body);
            INFO("of the limit: " << step / limit);
            CHECK(step <= 0.9 * limit * (1 + 1e-6));
            CHECK(step >= (by_forms ? 0.65 : 0.3) * 0.9 * limit);
        }
}

TEST_CASE("a body without elements has no mass forms, one that is not finite has no step by them", "[unit]") {
    find_mass_forms({}, {0, 0}, {}, {}, products_of_group, {});
    ElasticBody body(jittered_box({2, 2, 2}, 0.1, 0, 1), material_constants(MaterialModel::linear, 1e5, 0.3, 1000));
    find_forms(body);
    body.position[0].x() = std::numeric_limits<Real>::quiet_NaN();
    CHECK(test::stable_step_of(body) == 0);
}

TEST_CASE("mass forms turn with the elements that they are of", "[unit]") {
    const Mat3 rotation = Eigen::AngleAxis<Real>(2, Vec3(3, 1, -2).normalized()).toRotationMatrix();
    for (const ElementKind kind : test::element_kinds)
        for (const MaterialModel model : test::material_models) {
            const test::TetMesh mesh = jittered_box({4, 3, 3}, 0.1, 0.3, 11, 0.02);
            const MaterialConstants material = material_constants(model, 1e5, 0.3, 1000);
            ElasticBody body(mesh, material, Mat3::Identity(), kind);
            find_forms(body);
            const Real step = test::stable_step_of(body), taken = part_of_mass_taken(body);
            turn_elements(rotation, body.blocks, body.elements, body.element_nodes);
            for (Vec3& x : body.position) x = rotation * x;
            INFO(name_of(kind) << ", " << name_of(model));
            CHECK(test::stable_step_of(body) == Approx(step).epsilon(1e-9));
            CHECK(part_of_mass_taken(body) == Approx(taken).epsilon(1e-9));
            for (std::size_t e = 0; e < body.elements.volume.size() * element_lanes; ++e)
                if (body.volume(e) > 0) CHECK((body.deformation(e) - Mat3::Identity()).norm() < 1e-12);
        }
}

}  // namespace skerry::test::mass_forms_test
