#include <catch2/catch.hpp>
#include <cstring>
#include <limits>

#include "jobs/executor.h"
#include "tests/support/elastic_body.h"
#include "tests/support/material_models.h"

namespace skerry::test::element_kernels_test {

using test::ElasticBody;
using test::jittered_box;

namespace {

MaterialConstants rubber(MaterialModel model) {
    return material_constants(model, 1e5, 0.4, 1000);
}

void deform(ElasticBody& body, Real size, std::uint64_t seed) {
    std::mt19937_64 random(seed);
    for (Vec3& x : body.position) x += size * test::random_vector(random);
}

template <class T>
bool same_bits(std::span<const T> a, std::span<const T> b) {
    return a.size() == b.size() && std::memcmp(a.data(), b.data(), a.size_bytes()) == 0;
}

}  // namespace

TEST_CASE("forces are those of the textbook, summed element by element", "[unit]") {
    const auto executor = make_executor(Backend::serial, 1);
    const ElementKind kind = GENERATE(ElementKind::linear, ElementKind::edge_smoothed, ElementKind::edge_node_smoothed);
    for (MaterialModel model : test::material_models) {
        for (Real size : {0.01, 0.08}) {  // the second size inverts some elements
            ElasticBody body(jittered_box({4, 4, 4}, 0.1, 0.2, 1), rubber(model), Mat3::Identity(), kind);
            deform(body, size, 2);
            body.compute_elements(*executor);
            body.gather();
            std::vector<Vec3> force(body.position.size(), Vec3::Zero());
            std::vector<Real> rounding(force.size(), 0);
            for (std::size_t e = 0; e < element_lanes * body.elements.first.size(); ++e) {
                if (body.volume(e) == 0) continue;
                const Mat3 F = body.deformation(e);
                const MaterialConstants material = part_of(body.constants[0], body.elements.part[e / element_lanes]);
                const Mat3 P = stress(material, F);
                // A frame that is about to jump can give any force.
                const bool jumps = model == MaterialModel::corotational && stiffness_bound(body.constants[0], F) > 1e8;
                const Real scale = jumps ? std::numeric_limits<Real>::infinity() : 1e3 * std::pow(1 + F.norm(), 5);
                for (std::size_t k = 0; k < body.node_count(e); ++k) {
                    force[body.node(e, k)] -= body.volume(e) * P * body.gradient(e, k);
                    rounding[body.node(e, k)] += 1e-12 * scale;
                }
            }
            INFO("model " << name_of(model) << ", size " << size);
            int compared = 0;
            for (std::size_t n = 0; n < force.size(); ++n) {
                CHECK((body.force[n] - force[n]).norm() <= rounding[n]);
                compared += std::isfinite(rounding[n]);
            }
            CHECK(compared > 20);
        }
    }
}

TEST_CASE("a single tetrahedron has as many nodes as a register lanes", "[unit]") {
    const auto executor = make_executor(Backend::serial, 1);
    const test::TetMesh one{{Vec3(0, 0, 0), Vec3(0.1, 0, 0), Vec3(0, 0.1, 0), Vec3(0, 0, 0.1)}, {{0, 1, 2, 3}}};
    ElasticBody body(one, rubber(MaterialModel::linear));
    // Exact allocation: an address sanitizer sees a read past the last node by a force or energy kernel.
    body.position.shrink_to_fit();
    body.position[3].z() = 0.11;  // e_zz = 0.1
    body.compute_forces(*executor);
    const MaterialConstants m = body.constants[0];
    const Real area = 0.005 / 3;  // area of the face, a third for each corner [m^2]
    CHECK(body.force[3].z() == Approx(-area * 0.1 * (2 * m.shear_modulus + m.lame_lambda)));
    CHECK(body.force[1].x() == Approx(-area * 0.1 * m.lame_lambda));
    CHECK(body.force[0].y() == Approx(area * 0.1 * m.lame_lambda));
}

TEST_CASE("only corotational elements touch the frames", "[unit]") {
    const auto executor = make_executor(Backend::serial, 1);
    for (MaterialModel model : test::material_models) {
        ElasticBody body(jittered_box({1, 1, 1}, 0.1, 0, 1), rubber(model));
        const Eigen::AngleAxis<Real> turn(0.5, Vec3::UnitX());
        for (Vec3& x : body.position) x = turn * x;
        body.compute_elements(*executor);
        const Real half = body.elements.rotation_next[0][1][2];
        CHECK(half == Approx(model == MaterialModel::corotational ? std::sin(0.25) : 0.0).margin(1e-14));
        CHECK(body.elements.rotation[0][0][0] == 1);
    }
}

TEST_CASE("a position that is not a number reaches the nodes of its elements only", "[unit]") {
    const auto executor = make_executor(Backend::serial, 1);
    for (MaterialModel model : test::material_models) {
        ElasticBody body(jittered_box({4, 1, 1}, 0.1, 0, 1), rubber(model));
        body.position[0].x() = std::numeric_limits<Real>::quiet_NaN();
        body.compute_forces(*executor);
        CHECK(!body.force[0].allFinite());
        CHECK(body.force[3].allFinite());  // three cells away from the bad node
    }
}

TEST_CASE("element and node forces have the same bits on any number of workers", "[unit][determinism]") {
    for (MaterialModel model : test::material_models) {
        std::vector<Vec3> reference;
        for (int workers : {1, 2, 3, 4, 8}) {
            const auto executor = make_executor(available_backends().front(), workers);
            ElasticBody body(jittered_box({12, 10, 9}, 0.1, 0.2, 6), rubber(model));
            deform(body, 0.03, 7);
            for (int step = 0; step < 3; ++step) {
                body.compute_forces(*executor);
                for (std::size_t n = 0; n < body.position.size(); ++n) body.position[n] += 1e-6 * body.force[n];
            }
            if (workers == 1)
                reference = body.force;
            else
                CHECK(same_bits<Vec3>(body.force, reference));
        }
    }
}

}  // namespace skerry::test::element_kernels_test
