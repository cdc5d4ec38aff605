// Bodies and colliders as the collision stages see them, without an engine.
#pragma once

#include <memory>
#include <vector>

#include "components/node_table.h"
#include "components/pair_table.h"
#include "jobs/executor.h"
#include "systems/collision/build_surface.h"
#include "systems/collision/find_candidates.h"
#include "systems/collision/find_contacts.h"
#include "systems/collision/tree/bvh.h"
#include "tests/support/meshes.h"
#include "tests/support/random.h"

namespace skerry::test {

struct CollisionWorld {
    NodeTable nodes;
    BodyTable body;
    ColliderTable collider;
    SurfaceTables surface;
    BvhTable bvh;
    BvhLeafTable bvh_leaves;
    Column<SurfaceProperties> material;
    SearchState search;
    PairTable pairs;
    CrossingTable crossings;
    ContactTable contacts;
    CollisionSettings settings;
    std::unique_ptr<Executor> executor = make_executor(Backend::serial, 1);
    std::uint32_t next_slot = 0;

    CollisionWorld() { settings.gravity = 9.81; }

    CollisionInputs inputs() const {
        return {body,
                collider,
                surface,
                nodes.inverse_mass,
                material,
                bvh.node,
                bvh_leaves.triangle,
                bvh_leaves.nodes,
                bvh_leaves.features,
                nodes.position,
                nodes.velocity,
                nodes.rest_position};
    }

    static RigidMotion at(const Vec3& position, const Mat3& rotation = Mat3::Identity()) {
        return {position, rotation, Vec3::Zero(), Vec3::Zero()};
    }

    Index add_collider(ColliderShape shape, const Vec3& size, const RigidMotion& motion) {
        const std::size_t row = collider.slot.size();
        collider.for_each_row_column([row](const char*, auto& column, ColumnRole) { column.resize(row + 1); });
        collider.slot[row] = next_slot++;
        collider.geometry[row] = {shape, size};
        collider.motion[row] = collider.initial[row] = motion;
        collider.surface[row] = {-1, -1, -1};  // negative: the values of the body are used
        collider.body[row] = collider.material[row] = no_index;
        return static_cast<Index>(row);
    }

    /// Adds a surface whose nodes the test moves: the body part of a mesh collider.
    Index add_kinematic(const std::vector<Vec3>& points, const std::vector<BoundaryTriangle>& triangles,
                        Real contact_distance) {
        const Index c = add_collider(ColliderShape::mesh, Vec3::Zero(), at(Vec3::Zero()));
        const Index b = add(points, triangles, contact_distance, BodyKind::kinematic);
        body.slot[b] = collider.slot[c];
        body.collider[b] = c;
        collider.body[c] = b;
        return b;
    }

    Index add_solid(const SolidMesh& mesh, const RigidMotion& pose, Real contact_distance,
                    const SurfaceProperties& properties = {0.5, 0.4, 0}) {
        std::vector<Vec3> points = mesh.nodes;
        for (Vec3& x : points) x = pose.position + pose.rotation * x;
        const Index b = add(points, boundary_triangles(mesh.tetrahedra), contact_distance, BodyKind::deformable);
        body.slot[b] = next_slot++;
        body.material[b] = static_cast<Index>(material.size());
        material.push_back(properties);
        return b;
    }

    /// Runs both stages as in a step.
    void find(Real h) {
        find_candidates(*executor, inputs(), settings, h, bvh.box, search, pairs);
        find_contacts(*executor, inputs(), settings, h, pairs, crossings, contacts);
    }

    /// Moves every node by h velocity and updates frames and travelled distances like the engine.
    void drift(Real h) {
        for (std::size_t n = 0; n < nodes.position.size(); ++n) nodes.position[n] += h * nodes.velocity[n];
        for (std::size_t b = 0; b < body.slot.size(); ++b) {
            MovingFrame& frame = body.frame[b];
            frame.position += h * frame.velocity;
            frame.path += h * frame.velocity.norm();
            body.travel[b] += h * body.frame_speed[b];
        }
        for (std::size_t c = 0; c < collider.slot.size(); ++c) {
            RigidMotion& motion = collider.motion[c];
            motion.position += h * motion.velocity;
            collider.travel[c] += h * motion.velocity.norm();
        }
    }

    void measure_speed() {
        for (std::size_t b = 0; b < body.slot.size(); ++b) {
            body.max_speed[b] = body.frame_speed[b] = 0;
            for (Index n = body.nodes[b].begin; n < body.nodes[b].end; ++n) {
                body.max_speed[b] = std::max(body.max_speed[b], nodes.velocity[n].norm());
                body.frame_speed[b] =
                    std::max(body.frame_speed[b], (nodes.velocity[n] - body.frame[b].velocity).norm());
            }
        }
    }

    /// From now on every frame moves with the mean velocity of its body.
    void follow_bodies() {
        for (std::size_t b = 0; b < body.slot.size(); ++b) {
            Vec3 sum = Vec3::Zero();
            for (Index n = body.nodes[b].begin; n < body.nodes[b].end; ++n) sum += nodes.velocity[n];
            body.frame[b].velocity = sum / body.nodes[b].size();
        }
    }

    const Vec3& node(Index b, Index local) const { return nodes.position[body.nodes[b].begin + local]; }

private:
    Index add(const std::vector<Vec3>& points, const std::vector<BoundaryTriangle>& triangles, Real contact_distance,
              BodyKind kind) {
        const Index first = static_cast<Index>(nodes.position.size());
        const std::size_t row = body.slot.size();
        body.for_each_column([row](const char*, auto& column, ColumnRole) { column.resize(row + 1); });
        for (const Vec3& x : points) {
            nodes.position.push_back(x);
            nodes.rest_position.push_back(x);
            nodes.velocity.push_back(Vec3::Zero());
            nodes.inverse_mass.push_back(kind == BodyKind::deformable ? 1 : 0);
        }
        body.kind[row] = kind;
        body.collider[row] = body.material[row] = no_index;
        body.nodes[row] = {first, static_cast<Index>(nodes.position.size())};
        const SurfaceRanges ranges = append_surface(triangles, first, no_index, surface);
        body.triangles[row] = ranges.triangles;
        body.edges[row] = ranges.edges;
        body.vertices[row] = ranges.vertices;
        const BvhRanges tree = append_bvh(ranges.triangles, surface.triangles.node, nodes.position, bvh, bvh_leaves);
        append_leaf_features(tree.leaves, surface.triangles, bvh_leaves);
        body.bvh_nodes[row] = tree.nodes;
        body.bvh_leaves[row] = tree.leaves;
        body.contact_distance[row] = contact_distance;
        for (Index e = ranges.edges.begin; e < ranges.edges.end; ++e) {
            const auto& ends = surface.edges.node[e];
            body.mean_edge[row] += (nodes.position[ends[0]] - nodes.position[ends[1]]).norm() / ranges.edges.size();
        }
        return static_cast<Index>(row);
    }
};

}  // namespace skerry::test
