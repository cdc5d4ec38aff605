#include <catch2/catch.hpp>
#include <cstring>
#include <limits>

#include "jobs/executor.h"
#include "tests/support/elastic_body.h"
#include "tests/support/material_models.h"

using namespace skerry;
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

TEST_CASE("element forces are those of the textbook, element by element", "[unit]") {
    const auto executor = make_executor(Backend::serial, 1);
    for (MaterialModel model : test::material_models) {
        for (Real size : {0.01, 0.08}) {  // the second inverts some
            ElasticBody body(jittered_box({3, 3, 3}, 0.1, 0.2, 1), rubber(model));
            deform(body, size, 2);
            body.compute_elements(*executor);
            for (std::size_t e = 0; e < 162; ++e) {
                const Mat3 F = body.deformation(e);
                // about to jump
                if (model == MaterialModel::corotational && stiffness_bound(body.constants[0], F) > 1e8) continue;
                const Mat3 P = stress(body.constants[0], F);
                const Real scale = 1e5 * 1e-2 * std::pow(1 + F.norm(), 5);
                INFO("model " << name_of(model) << " element " << e);
                for (std::size_t k = 0; k < body.node_count(e); ++k)
                    CHECK((body.element_force(e, k) + body.volume(e) * P * body.gradient(e, k)).norm() <=
                          1e-12 * scale);
            }
        }
    }
}

TEST_CASE("the element that touches the last node is not read past its end", "[unit]") {
    // Exactly as many nodes as a vector holds: an address sanitizer would see a read past it.
    const auto executor = make_executor(Backend::serial, 1);
    const test::TetMesh one{{Vec3(0, 0, 0), Vec3(0.1, 0, 0), Vec3(0, 0.1, 0), Vec3(0, 0, 0.1)}, {{0, 1, 2, 3}}};
    ElasticBody body(one, rubber(MaterialModel::linear));
    body.position.shrink_to_fit();
    body.position[3].z() = 0.11;  // e_zz = 0.1
    body.compute_elements(*executor);
    const MaterialConstants m = body.constants[0];
    const Real area = 0.005 / 3;  // m^2, of the face, a third for each corner
    CHECK(body.element_force(0, 3).z() == Approx(-area * 0.1 * (2 * m.shear_modulus + m.lame_lambda)));
    CHECK(body.element_force(0, 1).x() == Approx(-area * 0.1 * m.lame_lambda));
    CHECK(body.element_force(0, 0).y() == Approx(area * 0.1 * m.lame_lambda));
}

TEST_CASE("lanes that are left over give no force", "[unit]") {
    const auto executor = make_executor(Backend::serial, 1);
    for (MaterialModel model : test::material_models) {
        ElasticBody body(jittered_box({1, 1, 1}, 0.1, 0, 1), rubber(model));
        deform(body, 0.02, 3);
        body.compute_elements(*executor);
        for (std::size_t l = 6; l < 8; ++l)
            for (std::size_t a = 0; a < 4; ++a) CHECK(body.element_force(l, a) == Vec3::Zero());
    }
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

TEST_CASE("a node sums its corners, its weight and its load", "[unit]") {
    const auto executor = make_executor(Backend::serial, 1);
    ElasticBody body(jittered_box({2, 2, 2}, 0.1, 0.2, 4), rubber(MaterialModel::stable_neo_hookean));
    deform(body, 0.02, 5);
    body.load[7] = {1, 2, 3};
    const Vec3 gravity(0, 0, -10);
    body.compute_elements(*executor);
    body.gather(gravity);
    for (std::size_t n = 0; n < body.position.size(); ++n) {
        Vec3 sum = Vec3::Zero();
        for (std::size_t e = 0; e < 48; ++e)
            for (std::size_t a = 0; a < 4; ++a)
                if (body.node(e, a) == n) sum += body.element_force(e, a);
        CHECK(body.force[n] == sum + body.mass[n] * gravity + body.load[n]);
    }
}

TEST_CASE("a position that is not a number reaches the nodes of its elements only", "[unit]") {
    const auto executor = make_executor(Backend::serial, 1);
    for (MaterialModel model : test::material_models) {
        ElasticBody body(jittered_box({4, 1, 1}, 0.1, 0, 1), rubber(model));
        body.position[0].x() = std::numeric_limits<Real>::quiet_NaN();
        body.compute_forces(*executor);
        CHECK(!body.force[0].allFinite());
        CHECK(body.force[3].allFinite());  // three cells away
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
