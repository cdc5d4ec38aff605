#include "systems/collision/search/search_pair.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "components/node_block_table.h"
#include "components/prefetch_lines.h"
#include "systems/collision/inputs/contact_key.h"
#include "systems/collision/narrow/candidate_lanes.h"
#include "systems/collision/narrow/rest_distance.h"
#include "systems/collision/search/leaf_features.h"
#include "systems/collision/search/sort_found.h"
#include "systems/collision/tree/box.h"
#include "systems/collision/tree/leaf_boxes.h"
#include "systems/collision/tree/leaf_pairs.h"

namespace skerry {

namespace {

// Number of leaves whose data is cached, for two bodies and for a body that is paired with itself. Two bodies that lie
// on each other touch with about ten leaves. In a body paired with itself, the second leaf changes with each pair; the
// data of 128 leaves fit into the second-level cache of a processor.
constexpr std::size_t cached_leaves = 16, cached_leaves_of_self = 128;
template <class Features, std::size_t Count>
using CachedLeaves = std::array<Features, Count>;

/// Cached features of the leaves of one tree. Leaf row r is cached at index r % Count.
template <std::size_t Count>
struct CachedFeatures {
    CachedLeaves<LeafPoints, Count> points;
    CachedLeaves<LeafEdges, Count> edges;
    CachedLeaves<LeafTriangleBoxes, Count> boxes;
};

// Number of pairs of leaves that are collected before their features are compared.
constexpr std::size_t max_near_leaves = 32;

constexpr unsigned all_lanes = (1U << leaf_lanes) - 1;

template <std::size_t Size>
bool has_node(const std::array<Index, Size>& a, Index node) {
    return std::find(a.begin(), a.end(), node) != a.end();
}

/// Finds close features of two bodies, or of one body that is paired with itself (`Self`).
template <bool Self>
class BodySearch {
public:
    BodySearch(const CollisionInputs& inputs, const PairToSearch& pair, std::span<const Aabb> box,
               Column<FoundCandidate>& found)
        : inputs_(inputs),
          triangle_(inputs.surface.triangles),
          pair_(pair),
          box_(box),
          found_(found),
          first_is_point_(is_point(inputs.body.core_nodes[pair.first])),
          second_is_point_(is_point(inputs.body.core_nodes[pair.second])) {
        set_margin(pair.margin);
    }

    void run() {
        const Index root = inputs_.body.bvh_nodes[pair_.first].begin;
        for (const LeafPair& leaves : pair_.leaf_pairs)
            add_near_leaves({root + leaves.first, root + leaves.second, leaves.spare});
        if (!Self) find_near_leaves();
        compare_near_leaves();
        flush_queue(FeaturePair::point_triangle);
        flush_queue(FeaturePair::edge_edge);
    }

private:
    /// Two leaves (rows of BvhTable) whose features are to be compared. Features are listed if their distance is below
    /// the zone (PairScale) plus `margin` [m].
    struct NearLeaves {
        Index first, second;
        Real margin;
    };

    void find_near_leaves() {
        any_leaf_pair(
            inputs_.bvh_node, inputs_.body.bvh_nodes[pair_.first].begin, inputs_.body.bvh_nodes[pair_.second].begin,
            false, [&](Index a, Index b) { return distance_squared(box_[a], box_[b]) < radius_squared_; },
            [&](Index a, Index b) {
                add_near_leaves({a, b, margin_});
                return false;
            });
    }

    static bool is_point(Index core_nodes) { return core_nodes == 1 || core_nodes == cylinder_core_nodes; }

    void set_margin(Real margin) {
        margin_ = margin;
        radius_squared_ = (pair_.scale.zone + margin) * (pair_.scale.zone + margin);
        edge_radius_squared_ = (pair_.scale.edge_depth + margin) * (pair_.scale.edge_depth + margin);
    }

    const BvhNode& node(Index row) const { return inputs_.bvh_node[row]; }
    const Vec3& position(Index n) const { return inputs_.position[n]; }

    /// Prefetches the data of a leaf. Leaves are scattered in memory, so their data are rarely in the cache. They are
    /// prefetched when they are found, and compared after several pairs of leaves have been found.
    void prefetch_leaf(Index a) const {
        // Average numbers of edges and points that eight triangles own.
        constexpr std::size_t owned_edges = 12, owned_points = 4;
        const LeafFeatures& features = inputs_.leaf_features[node(a).leaf];
        const LeafNodes& nodes = inputs_.leaf_nodes[node(a).leaf];
        prefetch_lines(features.edge.data(), owned_edges);
        prefetch_lines(features.point.data(), owned_points);
        prefetch_lines(nodes.corner.data(), nodes.corner.size());
    }

    const LeafTriangles& leaf_triangle(Index a) const { return inputs_.leaf_triangle[node(a).leaf]; }

    void add_near_leaves(const NearLeaves& leaves) {
        if (near_count_ == max_near_leaves) compare_near_leaves();
        near_leaves_[near_count_++] = leaves;
        prefetch_leaf(leaves.first);
        prefetch_leaf(leaves.second);
    }

    void compare_near_leaves() {
        for (std::size_t i = 0; i < near_count_; ++i) {
            const auto [a, b, margin] = near_leaves_[i];
            if (Self) set_margin(margin);
            if (a == b)
                compare_within(a);
            else
                compare_leaves(a, b);
        }
        near_count_ = 0;
    }

    void compare_leaves(Index a, Index b) {
        // The core of a sphere or cylinder is a point in this search. It is compared with the faces and axes of the
        // other body, but not with its nodes. No contact is lost:
        // - If a node is nearest to the core, the test of a face at the node finds it.
        // - A node inside a flat surface does not obstruct the sphere.
        // For two spheres, only the core of the first is compared with the second.
        if (!second_is_point_ || first_is_point_) compare_points(a, b, false);
        if (!first_is_point_) compare_points(b, a, true);
        const LeafEdges &own = features_of(a, first_.edges), &other = features_of(b, second_.edges);
        std::array<unsigned, 3> near;
        if (!find_near_edges(other, box_[a], near)) return;
        for (std::size_t group = 0; group < own.groups(); ++group)
            for_each_lane(
                own.used(group) & lanes_below(distance_squared(own.box[group], box_[b]), edge_radius_squared_),
                [&](std::size_t lane) { compare_edge(own, leaf_lanes * group + lane, other, near); });
    }

    /// Compares the features of a leaf with each other: all points with all triangles, and each pair of edges once.
    void compare_within(Index a) {
        compare_points(a, a, false);
        const LeafEdges& own = features_of(a, first_.edges);
        for (std::size_t i = 0; i < own.count(); ++i) {
            std::array<unsigned, 3> later;
            for (unsigned group = 0; group < later.size(); ++group) {
                const unsigned first = leaf_lanes * group;
                later[group] = i < first ? all_lanes : (all_lanes << (i - first)) << 1;
                if (group < own.groups()) later[group] &= own.used(group);
            }
            compare_edge(own, i, own, later);
        }
    }

    template <class Features, std::size_t Count>
    const Features& features_of(Index a, CachedLeaves<Features, Count>& cache) const {
        const Index leaf = node(a).leaf;
        Features& features = cache[static_cast<std::size_t>(leaf) % Count];
        if (features.leaf != leaf) features.fill(inputs_, leaf);
        return features;
    }

    /// Sets `near`: for each group of eight edges, the bits of the edges close to a box. Returns true if any edge is
    /// close.
    bool find_near_edges(const LeafEdges& edges, const Aabb& box, std::array<unsigned, 3>& near) const {
        unsigned any = 0;
        for (std::size_t group = 0; group < edges.groups(); ++group)
            any |= near[group] =
                edges.used(group) & lanes_below(distance_squared(edges.box[group], box), edge_radius_squared_);
        return any != 0;
    }

    /// Compares the points of the leaf `owner` with the triangles of the leaf `other`. `points_on_second`: true if the
    /// points belong to the second body.
    void compare_points(Index owner, Index other, bool points_on_second) {
        const LeafPoints& points =
            points_on_second ? features_of(owner, second_.points) : features_of(owner, first_.points);
        for (std::size_t group = 0; group < points.groups(); ++group)
            for_each_lane(
                points.used(group) & lanes_below(distance_squared(points.at[group], box_[other]), radius_squared_),
                [&](std::size_t lane) {
                    const LeafFeatures::Point& point = points.list->point[leaf_lanes * group + lane];
                    compare_point(point.node, point.row, other, points_on_second);
                });
    }

    /// Puts the pairs of a point and the near triangles of a leaf into the queue, in which their distances are
    /// computed.
    void compare_point(Index n, Index vertex, Index other, bool points_on_second) {
        const LeafBoxes& boxes =
            points_on_second ? features_of(other, first_.boxes).box : features_of(other, second_.boxes).box;
        const Vec3& at = position(n);
        const unsigned near =
            used_lanes(node(other).count, 0) & lanes_below(distance_squared(boxes, {at, at}), radius_squared_);
        for_each_lane(near, [&](std::size_t lane) {
            const Index triangle = leaf_triangle(other)[lane];
            const auto& corner = triangle_.node[triangle];
            if (Self && has_node(corner, n)) return;
            enqueue({point_triangle_feature(points_on_second && !Self, vertex - vertices(points_on_second).begin,
                                            triangle - triangles(points_on_second).begin),
                     vertex, triangle},
                    {n, corner[0], corner[1], corner[2]});
        });
    }

    /// Compares edge i of one leaf with those edges of another leaf whose bits are set in `selected`.
    void compare_edge(const LeafEdges& a, std::size_t i, const LeafEdges& b, const std::array<unsigned, 3>& selected) {
        const Aabb box = lane_of(a.box[i / leaf_lanes], i % leaf_lanes);
        const auto& own = a.node(i);
        for (std::size_t group = 0; group < b.groups(); ++group) {
            if (selected[group] == 0) continue;
            const unsigned lanes =
                selected[group] & lanes_below(distance_squared(b.box[group], box), edge_radius_squared_);
            for_each_lane(lanes, [&](std::size_t lane) {
                const std::size_t j = leaf_lanes * group + lane;
                const auto& other = b.node(j);
                if (Self && (has_node(other, own[0]) || has_node(other, own[1]))) return;
                enqueue(edges_candidate(a.row(i), b.row(j)), {own[0], own[1], other[0], other[1]});
            });
        }
    }

    Candidate edges_candidate(Index a, Index b) const {
        if (Self && a > b) std::swap(a, b);
        const Index first = a - inputs_.body.edges[pair_.first].begin,
                    second = b - inputs_.body.edges[pair_.second].begin;
        return {edge_edge_feature(first, second), a, b};
    }

    /// Puts two features whose boxes are close into the queue of their kind. The distances of eight pairs of features
    /// are computed at once.
    void enqueue(const Candidate& candidate, const CandidateNodes& nodes) {
        const FeaturePair kind = skerry::features_of(candidate);
        Queue& queue = queue_[static_cast<std::size_t>(kind)];
        queue.candidate[queue.count] = candidate;
        queue.radius[queue.count] = zone_of(kind) + margin_;
        set_lane(queue.node, queue.count, nodes);
        if (++queue.count == candidate_lanes) flush_queue(kind);
    }

    /// Adds the close candidates of the queue to found_, except features of one body whose distance in the rest shape
    /// is below the contact distance. A candidate sleeps (needs no test) while its features are farther apart than the
    /// zone (PairScale).
    void flush_queue(FeaturePair kind) {
        Queue& queue = queue_[static_cast<std::size_t>(kind)];
        if (queue.count == 0) return;
        for (auto& node : queue.node)
            std::fill(node.begin() + static_cast<std::ptrdiff_t>(queue.count), node.end(), node[0]);
        const auto distance = distances(kind, inputs_.position, queue.node);
        for (std::size_t lane = 0; lane < queue.count; ++lane) {
            if (!(distance[lane] < queue.radius[lane])) continue;
            const auto node = [&](std::size_t i) { return queue.node[i][lane]; };
            const bool excluded =
                Self && (kind == FeaturePair::edge_edge
                             ? touched_at_rest(std::array{node(0), node(1)}, std::array{node(2), node(3)})
                             : touched_at_rest(node(0), std::array{node(1), node(2), node(3)}));
            if (!excluded)
                found_.push_back({queue.candidate[lane], pair_.travel_base + distance[lane] - zone_of(kind)});
        }
        queue.count = 0;
    }

    Real zone_of(FeaturePair kind) const {
        return kind == FeaturePair::edge_edge ? pair_.scale.edge_depth : pair_.scale.zone;
    }

    Range vertices(bool of_second_body) const {
        return inputs_.body.vertices[of_second_body ? pair_.second : pair_.first];
    }
    Range triangles(bool of_first_body) const {
        return inputs_.body.triangles[of_first_body ? pair_.first : pair_.second];
    }

    bool touched_at_rest(const auto& first, const auto& second) const {
        return !inputs_.rest_position.empty() && rest_distance_squared(inputs_, first, second) <
                                                     pair_.scale.contact_distance * pair_.scale.contact_distance;
    }

    /// Pairs of features of one kind whose distances are still to be computed.
    struct Queue {
        std::size_t count = 0;
        std::array<Candidate, candidate_lanes> candidate;
        std::array<Real, candidate_lanes> radius;  // distance below which the candidate is added [m]
        CandidateNodeLanes node;
    };

    const CollisionInputs& inputs_;
    const TriangleTable& triangle_;
    const PairToSearch& pair_;
    std::span<const Aabb> box_;
    Column<FoundCandidate>& found_;
    // Squared distances below which features are listed [m^2]. radius_squared_: of a point and a triangle.
    // edge_radius_squared_: of two edges; it is never larger than radius_squared_.
    Real radius_squared_, edge_radius_squared_;
    Real margin_;  // margin of the list for the present pair of leaves [m]
    // True for a sphere or a cylinder, whose core is a point in this search.
    const bool first_is_point_, second_is_point_;
    // Cached data of leaves that were recently read, for the first and the second tree. Each leaf is compared with
    // several leaves of the other tree.
    CachedFeatures<cached_leaves> first_;
    CachedFeatures<Self ? cached_leaves_of_self : cached_leaves> second_;
    // Collected pairs of leaves whose features are not compared yet.
    std::array<NearLeaves, max_near_leaves> near_leaves_;
    std::size_t near_count_ = 0;
    std::array<Queue, 2> queue_;  // by FeaturePair
};

Real search_bodies(const CollisionInputs& inputs, const PairToSearch& pair, std::span<const Aabb> box,
                   Column<FoundCandidate>& found) {
    const Range first = inputs.body.bvh_nodes[pair.first], second = inputs.body.bvh_nodes[pair.second];
    if (first.size() == 0 || second.size() == 0) return infinity;
    const Real distance =
        std::max(pair.min_distance, std::sqrt(distance_squared(box[first.begin], box[second.begin]))) - pair.scale.zone;
    if (distance >= pair.margin) return pair.travel_base + distance;
    if (pair.kind == PairKind::self)
        BodySearch<true>(inputs, pair, box, found).run();
    else
        BodySearch<false>(inputs, pair, box, found).run();
    sort_by_feature(found);
    return pair.travel_base + pair.margin;
}

}  // namespace

Real search_pair(const CollisionInputs& inputs, const PairToSearch& pair, std::span<const Aabb> box,
                 Column<FoundCandidate>& found) {
    found.clear();
    if (pair.kind == PairKind::collider) return search_collider(inputs, pair, found);
    return search_bodies(inputs, pair, box, found);
}

}  // namespace skerry
