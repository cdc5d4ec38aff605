#include "systems/collision/search_pair.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include "components/check.h"
#include "systems/collision/collider_distance.h"
#include "systems/collision/contact_key.h"
#include "systems/collision/leaf_boxes.h"
#include "systems/geometry/closest_points.h"

namespace skerry {

namespace {

constexpr Real infinite = std::numeric_limits<Real>::infinity();

// Two trees over at most 2^31 triangles are at most 2 * 32 levels deep together, and a level leaves at most two waiting pairs.
constexpr std::size_t max_waiting = 192;

template <std::size_t Size>
bool share_node(const std::array<Index, Size>& a, Index node) {
    return std::find(a.begin(), a.end(), node) != a.end();
}

class BodySearch {
public:
    BodySearch(const CollisionInputs& inputs, const PairToSearch& pair, const BvhBoxes& boxes, Column<FoundCandidate>& found)
        : inputs_(inputs),
          triangle_(inputs.surface.triangles),
          pair_(pair),
          boxes_(boxes),
          found_(found),
          radius_(pair.scale.zone + pair.margin),
          radius_squared_(radius_ * radius_),
          edge_radius_squared_((pair.scale.edge_depth + pair.margin) * (pair.scale.edge_depth + pair.margin)),
          self_(pair.kind == PairKind::self) {}

    void run() {
        push(inputs_.body.bvh_nodes[pair_.first].begin, inputs_.body.bvh_nodes[pair_.second].begin);
        while (waiting_count_ > 0) {
            const auto [a, b] = waiting_[--waiting_count_];
            if (self_ && a == b)
                split_with_itself(a);
            else
                split(a, b);
        }
    }

private:
    const BvhNode& node(Index row) const { return inputs_.bvh_node[row]; }
    const Vec3& position(Index n) const { return inputs_.position[n]; }

    void push(Index a, Index b) {
        SKERRY_CHECK(waiting_count_ < max_waiting);
        waiting_[waiting_count_++] = {a, b};
    }

    void push_if_near(Index a, Index b) {
        if (distance_squared(boxes_.node[a], boxes_.node[b]) < radius_squared_) push(a, b);
    }

    void split_with_itself(Index a) {
        if (node(a).count > 0) {
            compare_within(a);
            return;
        }
        push(a + 1, a + 1);
        push(node(a).right, node(a).right);
        push_if_near(a + 1, node(a).right);
    }

    /// Opens the tree with more below it.
    void split(Index a, Index b) {
        const bool leaf_a = node(a).count > 0, leaf_b = node(b).count > 0;
        if (leaf_a && leaf_b) {
            compare_leaves(a, b);
        } else if (leaf_b || (!leaf_a && node(a).skip - a >= node(b).skip - b)) {
            push_if_near(a + 1, b);
            push_if_near(node(a).right, b);
        } else {
            push_if_near(a, b + 1);
            push_if_near(a, node(b).right);
        }
    }

    const LeafBoxes& leaf_box(Index a) const { return boxes_.leaf[node(a).leaf]; }
    const LeafTriangles& leaf_triangle(Index a) const { return inputs_.leaf_triangle[node(a).leaf]; }

    /// The lanes of a leaf that are near a box.
    unsigned lanes_near(Index leaf, const Aabb& box, Real radius_squared) const {
        return lanes_below(distance_squared(leaf_box(leaf), box), radius_squared);
    }

    void compare_leaves(Index a, Index b) {
        const unsigned of_a = lanes_near(a, boxes_.node[b], radius_squared_);
        if (of_a == 0) return;
        compare_points(a, of_a, b, false);
        compare_points(b, lanes_near(b, boxes_.node[a], radius_squared_), a, true);
        for_each_lane(of_a, [&](std::size_t i) {
            const Aabb box = lane_of(leaf_box(a), i);
            for_each_lane(lanes_near(b, box, edge_radius_squared_), [&](std::size_t j) {
                compare_edges({leaf_triangle(a)[i], box}, {leaf_triangle(b)[j], lane_of(leaf_box(b), j)});
            });
        });
    }

    /// A leaf with itself: points against all triangles, and every pair of triangles once.
    void compare_within(Index a) {
        const unsigned all = (1U << node(a).count) - 1;
        compare_points(a, all, a, false);
        for_each_lane(all, [&](std::size_t i) {
            const Aabb box = lane_of(leaf_box(a), i);
            const unsigned later = lanes_near(a, box, edge_radius_squared_) & (~0U << (i + 1));
            for_each_lane(later, [&](std::size_t j) {
                compare_edges({leaf_triangle(a)[i], box}, {leaf_triangle(a)[j], lane_of(leaf_box(a), j)});
            });
        });
    }

    /// The points that the triangles in `lanes` own, with the triangles of the other leaf.
    void compare_points(Index owner, unsigned lanes, Index other, bool of_second) {
        for_each_lane(lanes, [&](std::size_t lane) {
            const Index row = leaf_triangle(owner)[lane];
            for (std::size_t k = 0; k < 3; ++k) {
                if (!(triangle_.owned_vertices[row] >> k & 1)) continue;
                const Index n = triangle_.node[row][k];
                const Aabb point{position(n), position(n)};
                for_each_lane(lanes_near(other, point, radius_squared_),
                              [&](std::size_t j) { compare_point(n, triangle_.vertex[row][k], leaf_triangle(other)[j], of_second); });
            }
        });
    }

    void compare_point(Index n, Index vertex, Index triangle, bool of_second) {
        const auto& corner = triangle_.node[triangle];
        const Real squared =
            closest_point_on_triangle(position(n), position(corner[0]), position(corner[1]), position(corner[2])).distance_squared;
        if (!(squared < radius_squared_) || (self_ && excluded_at_rest(n, corner))) return;
        add({point_triangle_feature(of_second && !self_, vertex - vertices(of_second).begin, triangle - triangles(of_second).begin), vertex,
             triangle},
            squared, pair_.scale.zone);
    }

    struct Triangle {
        Index row;  // of TriangleTable
        Aabb box;
    };

    struct NearEdges {
        std::array<Index, 3> edge;  // place in the triangle
        std::array<Aabb, 3> box;
        std::size_t count = 0;
    };

    /// The edges that a triangle owns and that are near a box.
    NearEdges edges_near(const Triangle& owner, const Aabb& other) const {
        NearEdges near;
        const std::uint8_t owned = triangle_.owned_edges[owner.row];
        const auto& node = triangle_.node[owner.row];
        for (Index i = 0; i < 3; ++i) {
            if (!(owned >> i & 1)) continue;
            const Aabb box = edge_box({node[static_cast<std::size_t>(i)], node[static_cast<std::size_t>((i + 1) % 3)]});
            if (!(distance_squared(box, other) < edge_radius_squared_)) continue;
            near.edge[near.count] = i;
            near.box[near.count++] = box;
        }
        return near;
    }

    void compare_edges(const Triangle& a, const Triangle& b) {
        const NearEdges of_a = edges_near(a, b.box);
        if (of_a.count == 0) return;
        const NearEdges of_b = edges_near(b, a.box);
        for (std::size_t i = 0; i < of_a.count; ++i)
            for (std::size_t j = 0; j < of_b.count; ++j)
                if (distance_squared(of_a.box[i], of_b.box[j]) < edge_radius_squared_)
                    compare_edge(a.row, static_cast<std::size_t>(of_a.edge[i]), b.row, static_cast<std::size_t>(of_b.edge[j]));
    }

    void compare_edge(Index a, std::size_t i, Index b, std::size_t j) {
        const auto &na = triangle_.node[a], &nb = triangle_.node[b];
        const std::array<Index, 2> ea{na[i], na[(i + 1) % 3]}, eb{nb[j], nb[(j + 1) % 3]};
        const Real squared =
            closest_points_of_segments(position(ea[0]), position(ea[1]), position(eb[0]), position(eb[1])).distance_squared;
        if (!(squared < edge_radius_squared_) || (self_ && excluded_at_rest(ea, eb))) return;
        add_edges(triangle_.edge[a][i], triangle_.edge[b][j], squared);
    }

    void add_edges(Index a, Index b, Real squared) {
        if (self_ && a > b) std::swap(a, b);
        const Index first = a - inputs_.body.edges[pair_.first].begin, second = b - inputs_.body.edges[pair_.second].begin;
        add({edge_edge_feature(first, second), a, b}, squared, pair_.scale.edge_depth);
    }

    Aabb edge_box(const std::array<Index, 2>& edge) const {
        const Vec3 &a = position(edge[0]), &b = position(edge[1]);
        return {a.cwiseMin(b), a.cwiseMax(b)};
    }

    Range vertices(bool of_second) const { return inputs_.body.vertices[of_second ? pair_.second : pair_.first]; }
    Range triangles(bool of_first) const { return inputs_.body.triangles[of_first ? pair_.first : pair_.second]; }

    bool excluded_at_rest(Index point, const std::array<Index, 3>& corner) const {
        if (share_node(corner, point)) return true;
        if (inputs_.rest_position.empty()) return false;
        const auto& rest = inputs_.rest_position;
        const Real squared = closest_point_on_triangle(rest[point], rest[corner[0]], rest[corner[1]], rest[corner[2]]).distance_squared;
        return squared < pair_.scale.contact_distance * pair_.scale.contact_distance;
    }

    bool excluded_at_rest(const std::array<Index, 2>& a, const std::array<Index, 2>& b) const {
        if (share_node(b, a[0]) || share_node(b, a[1])) return true;
        if (inputs_.rest_position.empty()) return false;
        const auto& rest = inputs_.rest_position;
        const Real squared = closest_points_of_segments(rest[a[0]], rest[a[1]], rest[b[0]], rest[b[1]]).distance_squared;
        return squared < pair_.scale.contact_distance * pair_.scale.contact_distance;
    }

    /// It sleeps until it may have come within the zone in which it is looked at closely.
    void add(const Candidate& candidate, Real squared, Real zone) {
        found_.push_back({candidate, pair_.datum + std::sqrt(squared) - zone});
    }

    const CollisionInputs& inputs_;
    const TriangleTable& triangle_;
    const PairToSearch& pair_;
    const BvhBoxes& boxes_;
    Column<FoundCandidate>& found_;
    const Real radius_;
    const Real radius_squared_;
    const Real edge_radius_squared_;  // edges are looked at less deep
    const bool self_;
    std::array<std::array<Index, 2>, max_waiting> waiting_;
    std::size_t waiting_count_ = 0;
};

Real search_bodies(const CollisionInputs& inputs, const PairToSearch& pair, const BvhBoxes& boxes, Column<FoundCandidate>& found) {
    const Range first = inputs.body.bvh_nodes[pair.first], second = inputs.body.bvh_nodes[pair.second];
    if (first.size() == 0 || second.size() == 0) return infinite;
    const Real apart =
        std::max(pair.apart, std::sqrt(distance_squared(boxes.node[first.begin], boxes.node[second.begin]))) - pair.scale.zone;
    if (apart >= pair.margin) return pair.datum + apart;
    BodySearch(inputs, pair, boxes, found).run();
    std::sort(found.begin(), found.end(),
              [](const FoundCandidate& a, const FoundCandidate& b) { return a.candidate.feature < b.candidate.feature; });
    return pair.datum + pair.margin;
}

Real search_collider(const CollisionInputs& inputs, const PairToSearch& pair, Column<FoundCandidate>& found) {
    const ColliderGeometry& geometry = inputs.collider.geometry[pair.second];
    const RigidMotion& motion = inputs.collider.motion[pair.second];
    const Index parts = collider_part_count(geometry.shape);
    const Range vertices = inputs.body.vertices[pair.first];
    const Real radius = pair.scale.zone + pair.margin;
    Real nearest = infinite;
    for (Index v = vertices.begin; v < vertices.end; ++v) {
        const Vec3& point = inputs.position[inputs.surface.vertices.node[v]];
        for (Index part = 0; part < parts; ++part) {
            const Real distance = distance_to_collider_part(geometry, motion, part, point).distance;
            nearest = distance < nearest ? distance : nearest;
            if (!(distance < radius)) continue;
            found.push_back({{point_collider_feature(v - vertices.begin, part), v, pair.second}, pair.datum + distance - pair.scale.zone});
        }
    }
    return pair.datum + std::max(pair.margin, nearest - pair.scale.zone);
}

}  // namespace

Real search_pair(const CollisionInputs& inputs, const PairToSearch& pair, const BvhBoxes& boxes, Column<FoundCandidate>& found) {
    found.clear();
    if (pair.kind == PairKind::collider) return search_collider(inputs, pair, found);
    return search_bodies(inputs, pair, boxes, found);
}

}  // namespace skerry
