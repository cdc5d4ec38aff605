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
    const ElementList list = elements_of({mesh.tetrahedra, mesh.nodes}, ElementKind::linear, 2);
    TetrahedronBlockTable tetrahedra;
    ElementBlockTable elements;
    ElementNodeTable nodes;
    CHECK(append_tetrahedra(mesh.tetrahedra, mesh.nodes, 0, tetrahedra) == Range{0, 1});
    CHECK(append_tetrahedra(mesh.tetrahedra, mesh.nodes, 8, tetrahedra) == Range{1, 2});
    CHECK(append_elements(list, {}, 0, 0, elements, nodes).blocks == Range{0, 1});
    const AppendedElements second = append_elements(list, {}, 8, 1, elements, nodes);
    CHECK(second.blocks == Range{1, 2});
    CHECK(second.nodes == Range{4, 8});
    CHECK(elements.body[1] == 1);
    CHECK(elements.material[1] == 2);
    for (std::size_t l = 6; l < 8; ++l) {
        CHECK(second.element[l] == no_index);
        CHECK(elements.volume[1][l] == 0);
        CHECK(tetrahedra.volume[1][l] == 0);
        for (std::size_t a = 0; a < 4; ++a) {
            CHECK(tetrahedra.node[1][a][l] == 8);
            CHECK(nodes.node[4 + a][l] == 8);
            for (std::size_t i = 0; i < 3; ++i) CHECK(nodes.gradient[4 + a][i][l] == 0);
        }
        CHECK(elements.rotation[1][0][l] == 1);
        CHECK(elements.rotation_next[1][0][l] == 1);
    }
    CHECK(nodes.node[4][0] == 8 + mesh.tetrahedra[0][0]);
    CHECK(tetrahedra.node[1][0][0] == 8 + mesh.tetrahedra[0][0]);
}

TEST_CASE("no tetrahedra make no blocks", "[unit]") {
    TetrahedronBlockTable tetrahedra;
    ElementBlockTable elements;
    ElementNodeTable nodes;
    CHECK(append_tetrahedra({}, {}, 0, tetrahedra) == Range{0, 0});
    CHECK(append_elements({}, {}, 0, 0, elements, nodes).blocks == Range{0, 0});
    Ragged<Index> corners;
    build_corners(elements, nodes, 3, corners);
    CHECK(corners.size() == 3);
    CHECK(corners[1].empty());
}

TEST_CASE("a mirrored tetrahedron is refused", "[unit]") {
    test::TetMesh mesh = jittered_box({1, 1, 1}, 0.1, 0, 1);
    std::swap(mesh.tetrahedra[0][1], mesh.tetrahedra[0][2]);
    for (const ElementKind kind : {ElementKind::linear, ElementKind::edge_smoothed})
        CHECK_THROWS_AS(elements_of({mesh.tetrahedra, mesh.nodes}, kind), CheckFailed);
}

TEST_CASE("corners list every use of a node once, in element order", "[unit]") {
    const ElasticBody body(jittered_box({2, 2, 3}, 0.1, 0, 1), rubber());
    std::size_t total = 0;
    for (std::size_t n = 0; n < body.position.size(); ++n) {
        const std::span<const Index> corners = body.corners[n];
        total += corners.size();
        const auto element_of = [&](Index c) {
            const auto row = static_cast<std::size_t>(c) / 8;
            return row / 4 * 8 + static_cast<std::size_t>(c) % 8;
        };
        CHECK(std::is_sorted(corners.begin(), corners.end(),
                             [&](Index a, Index b) { return element_of(a) < element_of(b); }));
        for (Index c : corners)
            CHECK(body.element_nodes.node[static_cast<std::size_t>(c) / 8][static_cast<std::size_t>(c) % 8] ==
                  static_cast<Index>(n));
    }
    CHECK(total == 4 * 72);
}
