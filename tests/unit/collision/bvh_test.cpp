#include "systems/collision/tree/bvh.h"

#include <algorithm>
#include <catch2/catch.hpp>
#include <limits>
#include <set>

#include "systems/collision/tree/leaf_boxes.h"
#include "tests/support/collision_world.h"

namespace skerry::test::bvh_test {

namespace {

bool contains(const Aabb& box, const Vec3& p) {
    return (box.lower.array() <= p.array()).all() && (box.upper.array() >= p.array()).all();
}

void refit(test::CollisionWorld& world, Index body) {
    refit_bvh(world.body.bvh_nodes[body], world.bvh.node, world.bvh_leaves.nodes, world.nodes.position, world.bvh.box);
}

}  // namespace

TEST_CASE("a tree holds each triangle of its body in one lane of one leaf", "[unit]") {
    test::CollisionWorld world;
    world.add_solid(test::ball_mesh(1, 3), world.at(Vec3::Zero()), 0);
    const Index b = world.add_solid(test::ball_mesh(1, 4), world.at({3, 0, 0}), 0);
    const Range nodes = world.body.bvh_nodes[b], leaves = world.body.bvh_leaves[b], triangles = world.body.triangles[b];
    std::set<Index> seen;
    for (Index row = nodes.begin; row < nodes.end; ++row) {
        const BvhNode& node = world.bvh.node[row];
        CHECK(node.count <= leaf_lanes);
        CHECK(node.skip <= nodes.end);
        if (node.count == 0) {
            CHECK(world.bvh.node[row + 1].skip == node.right);
            CHECK(world.bvh.node[node.right].skip == node.skip);
            CHECK(node.leaf == no_index);
            continue;
        }
        CHECK(node.skip == row + 1);
        CHECK(node.leaf >= leaves.begin);
        CHECK(node.leaf < leaves.end);
        for (Index l = 0; l < leaf_lanes; ++l) {
            const Index t = world.bvh_leaves.triangle[node.leaf][static_cast<std::size_t>(l)];
            CHECK((t == no_index) == (l >= node.count));
            if (t == no_index) continue;
            CHECK(t >= triangles.begin);
            CHECK(t < triangles.end);
            CHECK(seen.insert(t).second);
        }
    }
    CHECK(static_cast<Index>(seen.size()) == triangles.size());
    CHECK(world.bvh.node[nodes.begin].skip == nodes.end);
}

namespace {

/// Surfaces and trees of bodies with one mesh, appended one after the other.
struct Outlines {
    SurfaceTables surface;
    BvhTable bvh;
    BvhLeafTable leaves;
    std::vector<Vec3> position;

    /// All row numbers that columns, tree nodes, leaves and features refer to, in one list.
    std::vector<Index> rows() {
        std::vector<Index> all;
        const auto add = [&](const auto& rows) { all.insert(all.end(), rows.begin(), rows.end()); };
        surface.for_each_column([&](const char*, auto& column, ColumnRole) {
            for (const auto& row : column) {
                if constexpr (requires { row.begin(); })
                    add(row);
                else
                    all.push_back(row);
            }
        });
        for (const BvhNode& node : bvh.node) add(std::array{node.skip, node.right, node.leaf, node.count});
        for (const LeafTriangles& triangles : leaves.triangle) add(triangles);
        for (const LeafNodes& nodes : leaves.nodes) {
            for (const auto& corner : nodes.corner) add(corner);
            add(std::span(nodes.node).first(static_cast<std::size_t>(nodes.count)));
        }
        for (const LeafFeatures& features : leaves.features) {
            add(std::array{features.edge_count, features.point_count});
            for (std::size_t i = 0; i < static_cast<std::size_t>(features.edge_count); ++i)
                add(std::array{features.edge[i].row, features.edge[i].node[0], features.edge[i].node[1]});
            for (std::size_t i = 0; i < static_cast<std::size_t>(features.point_count); ++i)
                add(std::array{features.point[i].row, features.point[i].node});
        }
        return all;
    }
};

}  // namespace

TEST_CASE("a body whose mesh is known has the rows that it would have by itself", "[unit]") {
    for (const test::SolidMesh& mesh : {test::ball_mesh(1, 4), test::box_mesh({1, 1, 1}, {1, 2, 3})}) {
        const auto count = static_cast<Index>(mesh.nodes.size());
        Outlines found, copied;
        for (Outlines* of : {&found, &copied}) {
            SurfaceRanges first;
            BvhRanges first_tree;
            for (Index body = 0; body < 3; ++body) {
                of->position.insert(of->position.end(), mesh.nodes.begin(), mesh.nodes.end());
                if (of == &copied && body > 0) {
                    RowOffsets offset{count * body, 8 * body};
                    append_surface_copy(first, offset, of->surface);
                    append_bvh_copy(first_tree, offset, of->position, of->bvh, of->leaves);
                    continue;
                }
                first = append_surface(boundary_triangles(mesh.tetrahedra), count * body, 8 * body, of->surface);
                first_tree = append_bvh(first.triangles, of->surface.triangles.node, of->position, of->bvh, of->leaves);
                append_leaf_features(first_tree.leaves, of->surface.triangles, of->leaves);
            }
        }
        CHECK(found.rows() == copied.rows());
        REQUIRE(found.bvh.box.size() == copied.bvh.box.size());
        for (std::size_t row = 0; row < found.bvh.box.size(); ++row) {
            CHECK(found.bvh.box[row].lower == copied.bvh.box[row].lower);
            CHECK(found.bvh.box[row].upper == copied.bvh.box[row].upper);
        }
    }
}

TEST_CASE("the leaves of a tree own each edge and each point of their body once", "[unit]") {
    test::CollisionWorld world;
    world.add_solid(test::ball_mesh(1, 3), world.at(Vec3::Zero()), 0);
    const Index b = world.add_solid(test::ball_mesh(1, 4), world.at({3, 0, 0}), 0);
    const SurfaceTables& surface = world.surface;
    std::set<Index> edges, points;
    const Range leaves = world.body.bvh_leaves[b];
    for (Index leaf = leaves.begin; leaf < leaves.end; ++leaf) {
        const LeafFeatures& features = world.bvh_leaves.features[leaf];
        for (std::size_t i = 0; i < static_cast<std::size_t>(features.edge_count); ++i) {
            const LeafFeatures::Edge& edge = features.edge[i];
            CHECK(edges.insert(edge.row).second);
            const auto& ends = surface.edges.node[edge.row];
            CHECK(std::is_permutation(ends.begin(), ends.end(), edge.node.begin()));
        }
        for (std::size_t i = 0; i < static_cast<std::size_t>(features.point_count); ++i) {
            const LeafFeatures::Point& point = features.point[i];
            CHECK(points.insert(point.row).second);
            CHECK(surface.vertices.node[point.row] == point.node);
        }
    }
    CHECK(static_cast<Index>(edges.size()) == world.body.edges[b].size());
    CHECK(*edges.begin() == world.body.edges[b].begin);
    CHECK(static_cast<Index>(points.size()) == world.body.vertices[b].size());
    CHECK(*points.begin() == world.body.vertices[b].begin);
}

TEST_CASE("a leaf lists the nodes of its triangles, by corner and each once", "[unit]") {
    test::CollisionWorld world;
    world.add_solid(test::ball_mesh(1, 3), world.at(Vec3::Zero()), 0);
    world.add_solid(test::ball_mesh(1, 4), world.at({3, 0, 0}), 0);
    int shorter = 0;
    for (std::size_t leaf = 0; leaf < world.bvh_leaves.triangle.size(); ++leaf) {
        const LeafTriangles& triangle = world.bvh_leaves.triangle[leaf];
        const LeafNodes& nodes = world.bvh_leaves.nodes[leaf];
        std::set<Index> expected;
        for (std::size_t l = 0; l < leaf_lanes; ++l) {
            const auto& of_triangle = world.surface.triangles.node[triangle[triangle[l] == no_index ? 0 : l]];
            for (std::size_t k = 0; k < 3; ++k) CHECK(nodes.corner[k][l] == of_triangle[k]);
            expected.insert(of_triangle.begin(), of_triangle.end());
            shorter += triangle[l] == no_index;
        }
        CHECK(std::vector<Index>(nodes.node.begin(), nodes.node.begin() + nodes.count) ==
              std::vector<Index>(expected.begin(), expected.end()));
    }
    CHECK(shorter > 0);
}

TEST_CASE("after a refit every box holds all triangles below it, and no more than that", "[unit]") {
    test::CollisionWorld world;
    const Index b = world.add_solid(test::ball_mesh(1, 4), world.at(Vec3::Zero()), 0);
    test::Random random(5);
    for (Vec3& x : world.nodes.position) x = 2 * x + 0.3 * random.vector();
    refit(world, b);
    const Range nodes = world.body.bvh_nodes[b];
    for (Index row = nodes.begin; row < nodes.end; ++row) {
        Aabb tight{Vec3::Constant(1e300), Vec3::Constant(-1e300)};
        for (Index below = row; below < world.bvh.node[row].skip; ++below)
            for (Index l = 0; l < world.bvh.node[below].count; ++l) {
                const auto lane = static_cast<std::size_t>(l);
                const Index leaf = world.bvh.node[below].leaf;
                for (Index n : world.surface.triangles.node[world.bvh_leaves.triangle[leaf][lane]]) {
                    CHECK(contains(world.bvh.box[row], world.nodes.position[n]));
                    tight.lower = tight.lower.cwiseMin(world.nodes.position[n]);
                    tight.upper = tight.upper.cwiseMax(world.nodes.position[n]);
                }
            }
        CHECK(tight.lower == world.bvh.box[row].lower);
        CHECK(tight.upper == world.bvh.box[row].upper);
    }
}

TEST_CASE("a point that is not a number stays out of the boxes", "[unit]") {
    test::CollisionWorld world;
    const Index b = world.add_solid(test::box_mesh({2, 2, 2}, {1, 1, 1}), world.at(Vec3::Zero()), 0);
    world.nodes.position[0][1] = std::numeric_limits<Real>::quiet_NaN();
    refit(world, b);
    CHECK(world.bvh.box[world.body.bvh_nodes[b].begin].upper.allFinite());
}

TEST_CASE("a body without triangles has no tree", "[unit]") {
    BvhTable bvh;
    BvhLeafTable leaves;
    CHECK(append_bvh({0, 0}, {}, {}, bvh, leaves).nodes.size() == 0);
    CHECK(bvh.node.empty());
    CHECK(leaves.triangle.empty());
}

}  // namespace skerry::test::bvh_test
