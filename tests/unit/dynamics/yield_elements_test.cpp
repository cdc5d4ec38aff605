#include "systems/dynamics/elements/yield_elements.h"

#include <Eigen/Geometry>
#include <Eigen/LU>
#include <catch2/catch.hpp>

#include "tests/support/dense_algebra.h"
#include "tests/support/elastic_body.h"

namespace skerry::test::yield_elements_test {

namespace {

MaterialConstants clay() {
    MaterialConstants material = material_constants(MaterialModel::hencky, 1e6, 0.3, 1000);
    material.yield_stress = 1e4;
    material.hardening = 2e4;
    return material;
}

struct Sample {
    ElasticBody body;
    Column<Real> parts;
    std::unique_ptr<Executor> executor = make_executor(Backend::serial, 1);

    explicit Sample(const MaterialConstants& material = clay(), const Mat3& rotation = Mat3::Identity(),
                    ElementKind kind = ElementKind::linear)
        : body(jittered_box({2, 2, 2}, 0.1, 0.1, 1), material, rotation, kind) {
        parts.resize(body.elements.first.size());
    }
    PlasticState state() { return PlasticState::of(body.elements, body.element_nodes); }
    void deform(const Mat3& F) {
        for (std::size_t n = 0; n < body.position.size(); ++n) body.position[n] = F * body.mesh.nodes[n];
    }
    Real yield() { return yield_elements(*executor, body.inputs(), body.blocks, body.position, state(), parts); }
    /// Sum over the nodes of X (x) g, with the rest positions X: the inverse of the plastic deformation.
    Mat3 inverse_flow(std::size_t element) const {
        Mat3 sum = Mat3::Zero();
        for (std::size_t k = 0; k < body.node_count(element); ++k)
            sum += body.mesh.nodes[body.node(element, k)] * body.gradient(element, k).transpose();
        return sum;
    }
};

Mat3 stretched_along(const Vec3& axis, Real by) {
    const Mat3 turn = rotation_between(Vec3::UnitX(), axis);
    return turn * Vec3(by, 1 / std::sqrt(by), 1 / std::sqrt(by)).asDiagonal() * turn.transpose();
}

}  // namespace

TEST_CASE("plastic flow keeps the rest volume to rounding over 1e5 returns", "[unit][long]") {
    MaterialConstants perfect = clay();
    perfect.hardening = 0;
    Sample sample(perfect);
    for (int k = 0; k < 100000; ++k) {
        const Real a = 0.7 * k;
        sample.deform(stretched_along({std::cos(a), std::sin(a), std::sin(3 * a)}, 1.03));
        REQUIRE(sample.yield() > 0);
    }
    const Real error = sample.inverse_flow(0).determinant() - 1;
    CHECK(std::abs(error) * 1e10 < 1);  // about four rounding errors in each return
    CHECK(sample.body.elements.plastic_strain[0][0] > 100);
}

TEST_CASE("plastic work is the area below the yield stress, and a second return changes nothing", "[unit]") {
    for (const ElementKind kind : {ElementKind::linear, ElementKind::edge_smoothed, ElementKind::edge_node_smoothed}) {
        const MaterialConstants material = clay();
        Sample sample(material, Mat3::Identity(), kind);
        Real dissipated = 0;
        for (const Real stretch : {1.1, 1.4, 0.8}) {
            sample.deform(stretched_along({1, 2, stretch}, stretch));
            dissipated += sample.yield();
            CHECK(sample.yield() == 0);
        }
        Real expected = 0;
        for (std::size_t b = 0; b < sample.body.elements.volume.size(); ++b)
            for (std::size_t l = 0; l < element_lanes; ++l) {
                const Real strain = sample.body.elements.plastic_strain[b][l];
                expected += sample.body.elements.volume[b][l] *
                            (material.yield_stress + material.hardening * strain / 2) * strain;
            }
        CHECK(dissipated == Approx(expected).epsilon(1e-12));
    }
}

TEST_CASE("an element keeps its mass when it flows, and forgets its flow", "[unit]") {
    const Mat3 rotation = Eigen::AngleAxis<Real>(0.8, Vec3(1, -2, 3).normalized()).toRotationMatrix();
    Sample sample(clay(), rotation);
    for (ElementForm& form : sample.body.elements.mass_form)
        for (std::size_t i = 0; i < 6; ++i)
            for (std::size_t l = 0; l < element_lanes; ++l)
                form[i][l] = i < 3 ? 2 + static_cast<Real>(i) : 0.1 * static_cast<Real>(l);
    const auto masses = [&](std::size_t element) {
        const ElementForm& q = sample.body.elements.mass_form[element / element_lanes];
        const std::size_t l = element % element_lanes;
        Mat3 form;
        form << q[0][l], q[3][l], q[5][l], q[3][l], q[1][l], q[4][l], q[5][l], q[4][l], q[2][l];
        Eigen::Matrix<Real, 4, 3> G;
        for (Index k = 0; k < 4; ++k) G.row(k) = sample.body.gradient(element, static_cast<std::size_t>(k)).transpose();
        return Eigen::Matrix4d(G * form.inverse() * G.transpose());
    };
    const Eigen::Matrix4d mass = masses(3);
    const Mat3 rest = sample.inverse_flow(3);
    sample.deform(stretched_along({1, 2, 3}, 1.4));
    sample.yield();
    CHECK((sample.inverse_flow(3) - rest).norm() > 0.1);
    CHECK((masses(3) - mass).norm() < 1e-12 * mass.norm());
    forget_flow(sample.body.inputs(), sample.body.blocks, sample.body.mesh.nodes, rotation, sample.state());
    CHECK((sample.inverse_flow(3) - rest).norm() < 1e-13);
    CHECK((masses(3) - mass).norm() < 1e-12 * mass.norm());
    CHECK(sample.body.elements.plastic_strain[0][3] == 0);
}

TEST_CASE("a crushed or inverted element does not flow", "[unit]") {
    for (const Vec3& s : {Vec3(1, 1, 0.04), Vec3(1, 1, -0.5), Vec3(0.4, 0.4, 0.9), Vec3(1, 1, 0)}) {
        Sample sample;
        sample.deform(s.asDiagonal());
        CHECK(sample.yield() == 0);
    }
}

}  // namespace skerry::test::yield_elements_test
