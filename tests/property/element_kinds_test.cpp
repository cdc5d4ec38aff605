// Properties that every kind of element must have, and those that smoothed elements add (docs/methods/elasticity.md 7).
#include <Eigen/Geometry>
#include <catch2/catch.hpp>

#include "jobs/executor.h"
#include "systems/dynamics/checks/volume_ratios.h"
#include "systems/dynamics/elements/element_energy.h"
#include "tests/support/dense_algebra.h"
#include "tests/support/elastic_body.h"
#include "tests/support/element_kinds.h"
#include "tests/support/exact_frequency.h"
#include "tests/support/material_models.h"

namespace skerry::test::element_kinds_test {

using test::ElasticBody;
using test::jittered_box;

namespace {

constexpr Real cell = 0.1;  // [m]

ElasticBody body_of(const test::TetMesh& mesh, ElementKind kind,
                    MaterialModel model = MaterialModel::stable_neo_hookean, Real nu = 0.4) {
    return {mesh, material_constants(model, 1e5, nu, 1000), Mat3::Identity(), kind};
}

void scatter(ElasticBody& body, Real size, unsigned seed) {
    std::mt19937_64 random(seed);
    for (Vec3& x : body.position) x += size * test::random_vector(random);
}

Real largest(std::span<const Vec3> vectors) {
    Real most = 0;
    for (const Vec3& v : vectors) most = std::max(most, v.norm());
    return most;
}

Real energy(const ElasticBody& body) {
    return elastic_energy(body.inputs(), body.blocks, body.position);
}

/// u^T K u at rest for a linear material: twice the energy [J].
Real quadratic_form(ElasticBody& body, const std::vector<Vec3>& rest, const std::vector<Vec3>& u) {
    for (std::size_t n = 0; n < u.size(); ++n) body.position[n] = rest[n] + u[n];
    const Real twice = 2 * energy(body);
    body.position = rest;
    return twice;
}

test::TetMesh one_tetrahedron() {
    return {{Vec3(0, 0, 0), Vec3(cell, 0, 0), Vec3(0.2 * cell, cell, 0), Vec3(0.1 * cell, 0.3 * cell, cell)},
            {{0, 1, 2, 3}}};
}

}  // namespace

TEST_CASE("elements of every kind fill the body once and have gradients without a sum", "[property]") {
    for (const ElementKind kind : test::element_kinds) {
        const ElasticBody body = body_of(jittered_box({3, 3, 2}, cell, 0.25, 1), kind);
        Real whole = 0, shear = 0, volume = 0;
        for (const ElementLane& lanes : body.tetrahedra.volume)
            for (const Real v : lanes.lane) whole += v;
        for (std::size_t b = 0; b < body.elements.volume.size(); ++b)
            for (std::size_t l = 0; l < element_lanes; ++l) {
                const Real v = body.elements.volume[b][l];
                if (body.elements.part[b] != ElementPart::volume) shear += v;
                if (body.elements.part[b] != ElementPart::shear) volume += v;
                Vec3 sum = Vec3::Zero();
                for (std::size_t k = 0; k < body.node_count(8 * b + l); ++k) sum += body.gradient(8 * b + l, k);
                CHECK(sum.norm() <= 1e-14 / cell * 10);
            }
        INFO(name_of(kind));
        CHECK(shear == Approx(whole).epsilon(1e-13));
        CHECK(volume == Approx(whole).epsilon(1e-13));
    }
}

TEST_CASE("patch test of every kind of element", "[property]") {
    const auto executor = make_executor(Backend::serial, 1);
    Mat3 A;
    A << 1.1, 0.05, 0, 0.02, 0.95, 0.03, -0.04, 0, 1.2;
    for (const ElementKind kind : test::element_kinds)
        for (const MaterialModel model : test::material_models) {
            ElasticBody body = body_of(jittered_box({4, 4, 4}, cell, 0.25, 7), kind, model);
            std::vector<bool> inside;
            for (std::size_t n = 0; n < body.position.size(); ++n) {
                const auto at = [&](Index stride) { return static_cast<Index>(n) / stride % 5 % 4 != 0; };
                inside.push_back(at(1) && at(5) && at(25));
                body.position[n] = A * body.position[n] + Vec3(1, 2, 3);
            }
            body.compute_forces(*executor);
            Real force = 0;
            for (std::size_t n = 0; n < body.position.size(); ++n)
                if (inside[n]) force = std::max(force, body.force[n].norm());
            INFO(name_of(kind) << ", " << name_of(model));
            CHECK(force <= 1e-12 * largest(body.force));
            for (std::size_t e = 0; e < 8 * body.elements.first.size(); ++e)
                if (body.volume(e) > 0) CHECK((body.deformation(e) - A).norm() <= 2e-14 * 30);  // coordinates reach 4 m
        }
}

TEST_CASE("forces of every kind of element are minus the derivative of its energy", "[property]") {
    const auto executor = make_executor(Backend::serial, 1);
    for (const ElementKind kind : test::element_kinds)
        for (const MaterialModel model : test::material_models) {
            ElasticBody body = body_of(jittered_box({2, 2, 2}, cell, 0.25, 3), kind, model);
            scatter(body, 0.015, 4);
            body.compute_forces(*executor);
            constexpr Real step = 1e-6;  // [m]
            INFO(name_of(kind) << ", " << name_of(model));
            std::mt19937_64 random(5);
            for (int trial = 0; trial < 20; ++trial) {
                std::vector<Vec3> way, start = body.position;
                Real slope = 0, size = 0;
                for (const Vec3& f : body.force) {
                    way.push_back(test::random_vector(random));
                    slope -= f.dot(way.back());
                    size += f.norm();
                }
                const auto at = [&](Real by) {
                    for (std::size_t n = 0; n < way.size(); ++n) body.position[n] = start[n] + by * way[n];
                    return energy(body);
                };
                CHECK(std::abs((at(step) - at(-step)) / (2 * step) - slope) <= 1e-8 * size);
                body.position = start;
            }
        }
}

TEST_CASE("no kind of element has forces with a sum or a torque, or feels a turn", "[property]") {
    const auto executor = make_executor(Backend::serial, 1);
    const Mat3 Q = Eigen::AngleAxis<Real>(2.1, Vec3(1, -2, 3).normalized()).toRotationMatrix();
    for (const ElementKind kind : test::element_kinds)
        for (const MaterialModel model : {MaterialModel::corotational, MaterialModel::stable_neo_hookean}) {
            ElasticBody body = body_of(jittered_box({3, 3, 3}, cell, 0.25, 5), kind, model);
            scatter(body, 0.02, 6);
            body.compute_forces(*executor);
            const std::vector<Vec3> force = body.force;
            const Real before = energy(body);
            Vec3 sum = Vec3::Zero(), torque = Vec3::Zero();
            Real size = 0, arm = 0;
            for (std::size_t n = 0; n < force.size(); ++n) {
                sum += force[n];
                torque += body.position[n].cross(force[n]);
                size += force[n].norm();
                arm += body.position[n].norm() * force[n].norm();
            }
            INFO(name_of(kind) << ", " << name_of(model));
            CHECK(sum.norm() <= 1e-14 * size);
            CHECK(torque.norm() <= 1e-13 * arm);
            for (Vec3& x : body.position) x = Q * x + Vec3(0.5, 0.2, -0.1);
            body.compute_forces(*executor);
            Real worst = 0;
            for (std::size_t n = 0; n < force.size(); ++n)
                worst = std::max(worst, (body.force[n] - Q * force[n]).norm());
            CHECK(worst <= 1e-11 * largest(force));
            CHECK(energy(body) == Approx(before).epsilon(1e-12));
        }
}

TEST_CASE("where strain is the same everywhere all kinds give the same forces", "[property]") {
    const auto executor = make_executor(Backend::serial, 1);
    Mat3 A;
    A << 1.3, 0.1, 0, 0.05, 0.9, 0.1, -0.1, 0, 1.1;
    for (const MaterialModel model : test::material_models)
        for (const test::TetMesh& mesh : {one_tetrahedron(), jittered_box({2, 2, 2}, cell, 0.2, 8)}) {
            std::vector<Vec3> of_linear;
            for (const ElementKind kind : test::element_kinds) {
                ElasticBody body = body_of(mesh, kind, model);
                for (Vec3& x : body.position) x = A * x;
                body.compute_forces(*executor);
                if (of_linear.empty()) of_linear = body.force;
                Real worst = 0;
                for (std::size_t n = 0; n < body.force.size(); ++n)
                    worst = std::max(worst, (body.force[n] - of_linear[n]).norm());
                INFO(name_of(kind) << ", " << name_of(model));
                CHECK(worst <= 1e-13 * largest(of_linear));
            }
        }
}

TEST_CASE("rigid motion alone costs nothing, however thin the mesh", "[property]") {
    const auto executor = make_executor(Backend::serial, 1);
    for (const ElementKind kind : test::element_kinds)
        for (const test::TetMesh& mesh : {one_tetrahedron(), jittered_box({1, 1, 1}, cell, 0, 1),
                                          jittered_box({4, 4, 1}, cell, 0, 1), jittered_box({6, 1, 1}, cell, 0, 1)}) {
            ElasticBody body = body_of(mesh, kind, MaterialModel::linear, 0.3);
            const auto size = static_cast<Eigen::Index>(3 * body.position.size());
            Eigen::MatrixXd K(size, size);
            const std::vector<Vec3> rest = body.position;
            for (Eigen::Index j = 0; j < size; ++j) {  // linear model: forces are -K u
                body.position[static_cast<std::size_t>(j / 3)][j % 3] += 1;
                body.compute_forces(*executor);
                body.position = rest;
                K.col(j) = -Eigen::Map<const Eigen::VectorXd>(body.force[0].data(), size);
            }
            const Eigen::VectorXd values = symmetric_eigenvalues(0.5 * (K + K.transpose()));
            INFO(name_of(kind) << ", " << mesh.tetrahedra.size() << " tetrahedra");
            const auto zero = (values.array() < 1e-10 * values[size - 1]).count();
            CHECK(zero == 6);
        }
}

TEST_CASE("means are never stiffer than the averaged elements", "[property]") {
    for (const Real nu : {0.3, 0.49}) {
        const test::TetMesh mesh = jittered_box({3, 3, 3}, cell, 0.25, 9);
        ElasticBody linear = body_of(mesh, ElementKind::linear, MaterialModel::linear, nu);
        const std::vector<Vec3> rest = linear.position;
        for (const ElementKind kind : {ElementKind::edge_smoothed, ElementKind::edge_node_smoothed}) {
            ElasticBody smoothed = body_of(mesh, kind, MaterialModel::linear, nu);
            std::mt19937_64 random(10);
            std::vector<Vec3> u(rest.size());
            int softer = 0;
            for (int trial = 0; trial < 500; ++trial) {
                for (Vec3& x : u) x = 0.01 * test::random_vector(random);
                const Real of_linear = quadratic_form(linear, rest, u);
                softer += quadratic_form(smoothed, rest, u) <= of_linear * (1 + 1e-13);
            }
            CHECK(softer == 500);
        }
    }
}

TEST_CASE("the stable step of every kind is below the limit, and shares of mass make it longer", "[property]") {
    for (const ElementKind kind : test::element_kinds)
        for (const MaterialModel model : {MaterialModel::linear, MaterialModel::stable_neo_hookean})
            for (const Real jitter : {0.0, 0.25})
                for (const Real nu : {0.3, 0.49}) {
                    ElasticBody body = body_of(jittered_box({4, 3, 3}, cell, jitter, 11, 0.02), kind, model, nu);
                    const Real limit = test::exact_limit(body), before = test::stable_step_of(body);
                    std::vector<Real> sums(body.position.size());
                    find_mass_shares(body.inputs(), body.blocks, body.position, body.mass, sums,
                                     body.elements.mass_share.span());
                    const Real after = test::stable_step_of(body);
                    INFO(name_of(kind) << ", " << name_of(model) << ", jitter " << jitter << ", nu " << nu << ": "
                                       << before / limit << ", shared " << after / limit);
                    CHECK(before <= 0.9 * limit * (1 + 1e-6));  // 1e-6: error of the differences
                    CHECK(after <= 0.9 * limit * (1 + 1e-6));
                    CHECK(after >= 0.6 * 0.9 * limit);
                    CHECK(after >= 0.99 * before);
                    scatter(body, 0.02, 12);  // mass shares of the rest shape are rigorous for other shapes, too
                    CHECK(test::stable_step_of(body) <= 0.9 * test::exact_limit(body) * (1 + 1e-5));
                }
}

TEST_CASE("smoothed forces have the same bits on any number of workers", "[property][determinism]") {
    const test::TetMesh mesh = jittered_box({12, 10, 10}, cell, 0.2, 13);
    for (const ElementKind kind : {ElementKind::edge_smoothed, ElementKind::edge_node_smoothed}) {
        std::vector<Vec3> expected;
        for (const int workers : {1, 2, 5, 8}) {
            const auto executor = make_executor(workers == 1 ? Backend::serial : available_backends().front(), workers);
            ElasticBody body = body_of(mesh, kind);
            scatter(body, 0.01, 14);
            body.compute_forces(*executor);
            if (expected.empty()) expected = body.force;
            CHECK(body.force == expected);
        }
    }
}

}  // namespace skerry::test::element_kinds_test
