#include "systems/dynamics/elements/build_elements.h"

#include <catch2/catch.hpp>

#include "components/check.h"
#include "tests/support/elastic_body.h"

using namespace skerry;
using test::ElasticBody;
using test::jittered_box;

namespace {

MaterialConstants rubber() {
    return material_constants(MaterialModel::stable_neo_hookean, 1e5, 0.4, 1000);
}

}  // namespace

TEST_CASE("a body's elements are undeformed where it is put, turned or not", "[unit]") {
    const Mat3 turn = Eigen::AngleAxis<Real>(2.0, Vec3(1, 2, 3).normalized()).toRotationMatrix();
    const ElasticBody body(jittered_box({2, 3, 2}, 0.1, 0.2, 1), rubber(), turn);
    for (std::size_t e = 0; e < 72; ++e) CHECK((body.deformation(e) - Mat3::Identity()).norm() <= 1e-13);
}

TEST_CASE("volumes and masses add up to those of the box", "[unit]") {
    const ElasticBody body(jittered_box({3, 2, 4}, 0.1, 0, 1), rubber());
    Real volume = 0, mass = 0;
    for (const ElementLane& lanes : body.elements.volume)
        for (Real v : lanes.lane) volume += v;
    for (Real m : body.mass) mass += m;
    CHECK(volume == Approx(24e-3).epsilon(1e-13));
    CHECK(mass == Approx(24).epsilon(1e-13));
}

TEST_CASE("lanes that are left over have no volume, no gradient and a node of the body", "[unit]") {
    const test::TetMesh mesh = jittered_box({1, 1, 1}, 0.1, 0, 1);  // six tetrahedra
    ElementBlockTable elements;
    const Range first = append_elements(mesh.tetrahedra, mesh.nodes, 0, 0, 0, Mat3::Identity(), elements);
    const Range second = append_elements(mesh.tetrahedra, mesh.nodes, 8, 1, 2, Mat3::Identity(), elements);
    CHECK(first == Range{0, 1});
    CHECK(second == Range{1, 2});
    CHECK(elements.body[1] == 1);
    CHECK(elements.material[1] == 2);
    for (std::size_t l = 6; l < 8; ++l) {
        CHECK(elements.volume[1][l] == 0);
        for (std::size_t a = 0; a < 4; ++a) CHECK(elements.node[1][a][l] == 8);
        for (std::size_t i = 0; i < 9; ++i) CHECK(elements.inverse_rest[1][i][l] == 0);
        CHECK(elements.rotation[1][0][l] == 1);
        CHECK(elements.rotation_next[1][0][l] == 1);
    }
    CHECK(elements.node[1][0][0] == 8 + mesh.tetrahedra[0][0]);
}

TEST_CASE("no tetrahedra make no blocks", "[unit]") {
    ElementBlockTable elements;
    CHECK(append_elements({}, {}, 0, 0, 0, Mat3::Identity(), elements) == Range{0, 0});
    Ragged<Index> corners;
    build_corners(elements.node, elements.volume, 3, corners);
    CHECK(corners.size() == 3);
    CHECK(corners[1].empty());
}

TEST_CASE("a mirrored tetrahedron is refused", "[unit]") {
    test::TetMesh mesh = jittered_box({1, 1, 1}, 0.1, 0, 1);
    std::swap(mesh.tetrahedra[0][1], mesh.tetrahedra[0][2]);
    ElementBlockTable elements;
    CHECK_THROWS_AS(append_elements(mesh.tetrahedra, mesh.nodes, 0, 0, 0, Mat3::Identity(), elements), CheckFailed);
}

TEST_CASE("corners list every use of a node once, in element order", "[unit]") {
    const ElasticBody body(jittered_box({2, 2, 3}, 0.1, 0, 1), rubber());
    std::size_t total = 0;
    for (std::size_t n = 0; n < body.position.size(); ++n) {
        const std::span<const Index> corners = body.corners[n];
        total += corners.size();
        CHECK(std::is_sorted(corners.begin(), corners.end()));
        for (Index c : corners) {
            const std::size_t e = static_cast<std::size_t>(c) / 4;
            CHECK(body.elements.node[e / 8][static_cast<std::size_t>(c) % 4][e % 8] == static_cast<Index>(n));
        }
    }
    CHECK(total == 4 * 72);
}
