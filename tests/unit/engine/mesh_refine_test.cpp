// Uniform subdivision of meshes, and the parts that it carries over.
#include <Eigen/Geometry>
#include <algorithm>
#include <catch2/catch.hpp>

#include "skerry/error.h"
#include "skerry/refine.h"
#include "systems/collision/build_surface.h"
#include "tests/support/jittered_box.h"
#include "tests/support/message_of.h"

namespace skerry::test::mesh_refine_test {

using Catch::Matchers::Contains;
using Faces = std::vector<std::array<Index, 3>>;

namespace {

Faces boundary_of(const Mesh& mesh) {
    Faces faces;
    for (const BoundaryTriangle& triangle : boundary_triangles(mesh.tetrahedra)) faces.push_back(triangle.node);
    return faces;
}

/// Sum of the area vectors of faces, which the orientation of each face affects [m^2].
Vec3 area_vector(const Faces& faces, const Mesh& mesh) {
    const auto at = [&](Index n) -> const Vec3& { return mesh.nodes[static_cast<std::size_t>(n)]; };
    Vec3 area = Vec3::Zero();
    for (const auto& [a, b, c] : faces) area += (at(b) - at(a)).cross(at(c) - at(a)) / 2;
    return area;
}

Real volume_of_set(const std::string& name, const Mesh& mesh) {
    Mesh part{.nodes = mesh.nodes, .tetrahedra = {}};
    for (const Index t : mesh::tetrahedra_of(mesh.sets.at(name), mesh.tetrahedra))
        part.tetrahedra.push_back(mesh.tetrahedra[static_cast<std::size_t>(t)]);
    return inspect(part).volume;
}

Mesh irregular_box() {
    TetMesh box = jittered_box({3, 3, 3}, 0.5, 0.25, 7);
    return {.nodes = std::move(box.nodes), .tetrahedra = std::move(box.tetrahedra)};
}

}  // namespace

TEST_CASE("refined meshes keep volume, boundary, labels and vectors, and the numbers of their nodes", "[unit]") {
    Mesh mesh = irregular_box();
    for (std::size_t t = 0; t < mesh.tetrahedra.size(); ++t) {
        mesh.label.push_back(static_cast<int>(t));
        mesh.vectors["fibre"].emplace_back(t, 0, 1);
    }
    for (std::size_t n = 0; n < mesh.nodes.size(); ++n) mesh.file_number.push_back(static_cast<Index>(2 * n));
    const Mesh fine = mesh::refine(mesh);
    const MeshReport before = inspect(mesh), after = inspect(fine);
    CHECK(after.tetrahedra == 8 * before.tetrahedra);
    CHECK(after.boundary_triangles == 4 * before.boundary_triangles);
    CHECK(after.closed_manifold);
    CHECK(after.inverted + after.flat == 0);
    CHECK(after.volume == Approx(before.volume).epsilon(1e-13));
    CHECK(std::equal(mesh.nodes.begin(), mesh.nodes.end(), fine.nodes.begin()));
    CHECK(fine.file_number.size() == fine.nodes.size());
    CHECK(std::ranges::is_sorted(fine.file_number));
    for (std::size_t part = 0; part < fine.tetrahedra.size(); ++part) {
        CHECK(fine.label[part] == static_cast<int>(part / 8));
        CHECK(fine.vectors.at("fibre")[part] == Vec3(static_cast<Real>(part / 8), 0, 1));
    }
}

TEST_CASE("repeated refinement keeps the quality of the first one", "[unit]") {
    // The shapes of the parts repeat after two levels: S. Zhang, Successive subdivisions of tetrahedra, 1995.
    Mesh mesh = irregular_box();
    std::vector<Real> quality{inspect(mesh).min_quality};
    for (int level = 1; level <= 3; ++level) {
        mesh = mesh::refine(std::move(mesh));
        quality.push_back(inspect(mesh).min_quality);
    }
    // The worst of 3,000 random tetrahedra kept 0.758 of its quality.
    CHECK(quality[1] > 0.75 * quality[0]);
    CHECK(quality[2] > 0.999 * std::min(quality[0], quality[1]));
    CHECK(quality[3] > 0.999 * quality[1]);
}

TEST_CASE("sets of a refined mesh are the same parts of the body", "[unit]") {
    Mesh mesh = mesh::box({1, 2, 3}, {2, 2, 4});
    const auto in = [&](auto condition) {
        std::vector<Index> nodes;
        for (std::size_t n = 0; n < mesh.nodes.size(); ++n)
            if (condition(mesh.nodes[n])) nodes.push_back(static_cast<Index>(n));
        return nodes;
    };
    mesh.sets["end"].nodes = in([](const Vec3& x) { return x.z() > 1.49; });
    mesh.sets["half"].nodes = in([](const Vec3& x) { return x.z() > -0.01; });
    mesh.sets["edge"].nodes = in([](const Vec3& x) { return x.z() > 1.49 && x.x() > 0.49; });
    mesh.sets["corner"].nodes = in([](const Vec3& x) { return x.z() > 1.49 && x.x() > 0.49 && x.y() > 0.99; });
    mesh.sets["faces"].faces = mesh::faces_of(mesh.sets["end"], mesh.tetrahedra, boundary_of(mesh));
    mesh.sets["tetrahedra"].tetrahedra = mesh::tetrahedra_of(mesh.sets["half"], mesh.tetrahedra);
    const Mesh fine = mesh::refine(mesh::refine(mesh));
    for (const char* const name : {"end", "faces"}) {
        const Faces faces = mesh::faces_of(fine.sets.at(name), fine.tetrahedra, boundary_of(fine));
        CHECK(faces.size() == 16u * 8);
        CHECK((area_vector(faces, fine) - Vec3(0, 0, 2)).norm() < 1e-14);
    }
    for (const char* const name : {"half", "tetrahedra"}) CHECK(volume_of_set(name, fine) == Approx(3).epsilon(1e-13));
    CHECK(fine.sets.at("edge").nodes.size() == 9);
    CHECK(fine.sets.at("corner").nodes.size() == 1);
    for (const auto& [name, set] : fine.sets) CHECK(std::ranges::is_sorted(set.nodes));
}

TEST_CASE("an edge between two faces of a set does not join the set", "[unit]") {
    // The faces 0 1 2 and 4 5 6 belong to the set. The edge 0 4 connects them outside of all faces of the set.
    Mesh mesh{.nodes = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0.3, 0.3, 1}, {0, 0, 3}, {1, 0, 3}, {0, 1, 3}, {0.3, 0.3, 2}},
              .tetrahedra = {{0, 1, 2, 3}, {4, 6, 5, 7}, {0, 3, 7, 4}}};
    mesh.sets["ends"].nodes = {0, 1, 2, 4, 5, 6};
    const Mesh fine = mesh::refine(mesh);
    CHECK(fine.sets.at("ends").nodes.size() == 12);
    for (const Index n : fine.sets.at("ends").nodes) {
        const Real z = fine.nodes[static_cast<std::size_t>(n)].z();
        CHECK((z == 0 || z == 3));
    }
}

TEST_CASE("a surface without tetrahedra is refined with its sets", "[unit]") {
    Mesh mesh{.nodes = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1}}, .tetrahedra = {}};
    mesh.triangles = {{0, 2, 1}, {0, 1, 3}, {1, 2, 3}, {0, 3, 2}};
    mesh.sets["floor"].faces = {{0, 2, 1}};
    mesh.sets["nodes"].nodes = {0, 1, 2};
    const Mesh fine = mesh::refine(mesh);
    CHECK(fine.triangles.size() == 16);
    CHECK(fine.nodes.size() == 10);
    CHECK((area_vector(fine.sets.at("floor").faces, fine) - Vec3(0, 0, -0.5)).norm() < 1e-15);
    CHECK(fine.sets.at("nodes").nodes.size() == 6);
}

TEST_CASE("refine refuses invalid meshes", "[unit]") {
    Mesh mesh = mesh::box({1, 1, 1}, {1, 1, 1});
    const auto refused = [](Mesh faulty) { return message_of([&] { mesh::refine(std::move(faulty)); }); };
    mesh.label = {1, 2};
    CHECK_THAT(refused(mesh), Contains("label: found 2 values, expected 6 values, one for each tetrahedron"));
    mesh.label.clear();
    mesh.sets["far"].nodes = {99};
    CHECK_THAT(refused(mesh), Contains("sets[\"far\"]: found node 99, expected numbers from 0 to 7"));
    mesh.sets.clear();
    mesh.tetrahedra[0][1] = 50;
    CHECK_THAT(refused(mesh), Contains("tetrahedron 0: node: found 50"));
    CHECK_THAT(refused({.nodes = {{0, 0, 0}}, .tetrahedra = {}, .triangles = {{0, 1, 2}}}),
               Contains("triangles: found node 1"));
}

}  // namespace skerry::test::mesh_refine_test
