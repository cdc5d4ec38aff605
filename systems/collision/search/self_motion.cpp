#include "systems/collision/search/self_motion.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "systems/collision/inputs/contact_key.h"
#include "systems/collision/narrow/candidate_lanes.h"
#include "systems/collision/tree/bvh.h"
#include "systems/geometry/rotation.h"

namespace skerry {

namespace {

/// Computes, for each tree node of a body, the box of the vectors node_vector[n] of the mesh nodes n below it. The
/// vectors are for example displacements.
void fit(const CollisionInputs& inputs, Index body, std::span<const Vec3> node_vector, Column<Aabb>& box) {
    refit_bvh(inputs.body.bvh_nodes[body], inputs.bvh_node, inputs.leaf_nodes, node_vector, box);
}

/// Calls visit(n) for each node n on the surface of a body.
void for_each_node(const CollisionInputs& inputs, Index body, auto&& visit) {
    const Range vertices = inputs.body.vertices[body];
    for (Index v = vertices.begin; v < vertices.end; ++v) visit(inputs.surface.vertices.node[v]);
}

/// The rigid motion of a body since the last update: a point X moves to now + rotation (X - before).
struct RigidDisplacement {
    Vec3 before = Vec3::Zero(), now = Vec3::Zero();  // centres [m]
    Mat3 rotation = Mat3::Identity();
};

/// Fits a rigid motion to the displacements of the surface nodes. With the position r and the displacement u of a node
/// relative to the centres, the rotation vector w is a least squares fit of cross(w, r) to u. For large rotations the
/// fit is poor, but the bounds of self_motion.h hold for any rotation.
RigidDisplacement rigid_displacement(const CollisionInputs& inputs, Index body, const SelfSearch& self,
                                     auto&& position) {
    RigidDisplacement rigid;
    for_each_node(inputs, body, [&](Index n) {
        rigid.before += self.origin[n];
        rigid.now += position(n);
    });
    const Real count = inputs.body.vertices[body].size();
    rigid.before /= count;
    rigid.now /= count;
    Mat3 inertia = Mat3::Zero();
    Vec3 moment = Vec3::Zero();
    for_each_node(inputs, body, [&](Index n) {
        const Vec3 r = self.origin[n] - rigid.before;
        inertia.diagonal().array() += r.squaredNorm();
        inertia -= r * r.transpose();
        moment += r.cross(position(n) - rigid.now);
    });
    const Vec3 turn = inertia.inverse() * moment;
    if (turn.allFinite()) rigid.rotation = rotation_matrix(turn);
    return rigid;
}

/// Computes the displacements of the surface nodes since the last update without the rigid motion of the body
/// (self.moved), and their boxes. position(n): position of node n [m].
void fit_motion(const CollisionInputs& inputs, Index body, SelfSearch& self, auto&& position) {
    const RigidDisplacement rigid = rigid_displacement(inputs, body, self, position);
    for_each_node(inputs, body, [&](Index n) {
        self.moved[n] = position(n) - rigid.now - rigid.rotation * (self.origin[n] - rigid.before);
    });
    fit(inputs, body, self.moved, self.moved_box);
}

void store_origin(const SelfMotion& motion, SelfSearch& self) {
    for_each_node(motion.inputs, motion.body, [&](Index n) { self.origin[n] = motion.inputs.position[n]; });
}

void store_speeds(const SelfMotion& motion, SelfSearch& self) {
    fit(motion.inputs, motion.body, motion.inputs.velocity, self.speed_box);
}

/// Upper bound U(root, root) of the relative displacement of two nodes of the body since the last update [m].
Real greatest_motion(const SelfMotion& motion, const SelfSearch& self) {
    return farthest(self.moved_box[motion.root()], self.moved_box[motion.root()]);
}

constexpr auto leaves_before = [](const LeafPair& a, const LeafPair& b) {
    return a.first != b.first ? a.first < b.first : a.second < b.second;
};

/// Lists the pairs of leaves that are close to each other, sorted by first and second leaf. The spare distance M of a
/// pair (self_motion.h) follows from its boxes; a pair that was listed before keeps its previous spare distance if that
/// is larger.
void list_close_pairs(const SelfMotion& motion, std::span<const Aabb> box, const SelfSearch& self,
                      LeafPairTable& pairs) {
    const Index root = motion.root(), end = motion.inputs.body.bvh_nodes[motion.body].end;
    const Real margin = std::max(listed_edges * motion.scale.edge, motion.margin_of(self, root, root)),
               distance = motion.scale.zone + margin;
    pairs.before.swap(pairs.listed);
    pairs.listed.clear();
    pairs.listed.push_back({0, 0, margin});
    std::size_t old = 1;
    for (Index a = root; a < end; ++a) {
        if (motion.inputs.bvh_node[a].count == 0) continue;
        // Tree nodes are in depth-first order, so this search finds the second leaves in ascending order.
        for (Index b = a; b < end;) {
            const BvhNode& other = motion.inputs.bvh_node[b];
            const Real squared = distance_squared(box[a], box[b]);
            if (squared > distance * distance) {
                b = other.skip;
                continue;
            }
            if (other.count > 0) {
                LeafPair pair{a - root, b - root, std::sqrt(squared) - motion.scale.zone};
                while (old < pairs.before.size() && leaves_before(pairs.before[old], pair)) ++old;
                if (old < pairs.before.size() && !leaves_before(pair, pairs.before[old]))
                    pair.spare = std::max(pair.spare, pairs.before[old].spare);
                pairs.listed.push_back(pair);
            }
            ++b;
        }
    }
}

/// Finds the leaf that owns each feature of a body.
void find_leaves(const CollisionInputs& inputs, Index body, SelfSearch& self) {
    const Range tree = inputs.body.bvh_nodes[body];
    for (Index row = tree.begin; row < tree.end; ++row) {
        const BvhNode& node = inputs.bvh_node[row];
        if (node.count == 0) continue;
        const LeafFeatures& features = inputs.leaf_features[node.leaf];
        for (std::size_t i = 0; i < static_cast<std::size_t>(features.edge_count); ++i)
            self.leaf_of_edge[features.edge[i].row] = row;
        for (std::size_t i = 0; i < static_cast<std::size_t>(features.point_count); ++i)
            self.leaf_of_vertex[features.point[i].row] = row;
        for (std::size_t i = 0; i < static_cast<std::size_t>(node.count); ++i)
            self.leaf_of_triangle[inputs.leaf_triangle[node.leaf][i]] = row;
    }
}

/// Tests whether a sorted list contains a pair of leaves. Many consecutive calls have the same first leaf, because they
/// follow the order of the candidates. So the class stores for recent first leaves where in the list their pairs begin.
class SortedLeafPairs {
public:
    explicit SortedLeafPairs(std::span<const LeafPair> pairs) : pairs_(pairs) {}

    bool contains(Index first, Index second) {
        LeafRun& run = recent_[static_cast<std::size_t>(first) % recent_.size()];
        if (run.first != first) run = run_of(first);
        for (std::size_t i = run.begin; i < pairs_.size() && pairs_[i].first == first; ++i)
            if (pairs_[i].second >= second) return pairs_[i].second == second;
        return false;
    }

private:
    /// Index `begin` in the list of the first pair whose first leaf is `first`.
    struct LeafRun {
        Index first = no_index;
        std::size_t begin = 0;
    };

    LeafRun run_of(Index first) const {
        const auto at = std::lower_bound(pairs_.begin(), pairs_.end(), LeafPair{first, 0, 0}, leaves_before);
        return {first, static_cast<std::size_t>(at - pairs_.begin())};
    }

    std::span<const LeafPair> pairs_;
    std::array<LeafRun, 64> recent_;
};

/// Removes the candidates of pair p whose leaves satisfy is_removed(a, b).
void remove_candidates(const SelfSearch& self, Index p, PairTable& pairs, auto&& is_removed) {
    Column<Candidate>& candidates = pairs.candidates[p];
    Column<Real>& asleep_until = pairs.asleep_until[p];
    std::size_t count = 0;
    for (std::size_t c = 0; c < candidates.size(); ++c) {
        const Candidate& candidate = candidates[c];
        const bool edges = is_edge_edge(candidate.feature);
        const Index a = edges ? self.leaf_of_edge[candidate.first] : self.leaf_of_vertex[candidate.first],
                    b = edges ? self.leaf_of_edge[candidate.second] : self.leaf_of_triangle[candidate.second];
        if (is_removed(std::min(a, b), std::max(a, b))) continue;
        candidates[count] = candidate;
        asleep_until[count++] = asleep_until[c];
    }
    candidates.resize(count);
    asleep_until.resize(count);
}

}  // namespace

void resize(const CollisionInputs& inputs, SelfSearch& self) {
    // Rows of nodes inside bodies are unused, but they are saved too, so they need defined values.
    for (Column<Vec3>* column : {&self.origin, &self.moved}) column->resize(inputs.position.size(), Vec3::Zero());
    for (Column<Aabb>* box : {&self.moved_box, &self.speed_box}) box->resize(inputs.bvh_node.size());
    self.leaf_of_vertex.resize(inputs.surface.vertices.node.size());
    self.leaf_of_edge.resize(inputs.surface.edges.node.size());
    self.leaf_of_triangle.resize(inputs.surface.triangles.node.size());
    self.is_searched.resize(inputs.bvh_node.size());
}

Real update_spare(const SelfMotion& motion, std::span<LeafPair> pairs, SelfSearch& self) {
    const CollisionInputs& inputs = motion.inputs;
    fit_motion(inputs, motion.body, self, [&](Index n) -> const Vec3& { return inputs.position[n]; });
    store_speeds(motion, self);
    const Real remaining = smallest_spare(pairs) - greatest_motion(motion, self);
    if (remaining > motion.reach_of(self, motion.root(), motion.root())) return remaining;
    store_origin(motion, self);
    bool complete = true;
    for (LeafPair& pair : pairs) {
        const Index a = motion.root() + pair.first, b = motion.root() + pair.second;
        pair.spare -= farthest(self.moved_box[a], self.moved_box[b]);
        complete &= pair.spare > motion.reach_of(self, a, b);
    }
    return complete ? smallest_spare(pairs) : 0;
}

void renew_leaf_pairs(const SelfMotion& motion, std::span<const Aabb> box, bool compare_all, Index p,
                      PairTable& pairs) {
    const Index root = motion.root();
    SelfSearch& self = pairs.self;
    LeafPairTable& leaves = pairs.leaf_pairs[p];
    if (compare_all) {
        store_origin(motion, self);
        store_speeds(motion, self);
        leaves.listed.clear();
        pairs.candidates[p].clear();
        pairs.asleep_until[p].clear();
    }
    const bool relist = leaves.listed.empty() || !(leaves.listed[0].spare > motion.reach_of(self, root, root));
    if (relist) list_close_pairs(motion, box, self, leaves);
    leaves.searched.clear();
    const Real greatest_reach = motion.reach_of(self, root, root);
    for (std::size_t i = 1; i < leaves.listed.size(); ++i) {
        LeafPair& pair = leaves.listed[i];
        const Index a = root + pair.first, b = root + pair.second;
        if (!compare_all && pair.spare > std::max(greatest_reach, renewal_fraction * motion.skin)) continue;
        const Real margin = motion.margin_of(self, a, b);
        if (pair.spare > (compare_all ? margin : std::max(motion.reach_of(self, a, b), renewal_fraction * motion.skin)))
            continue;
        pair.spare = margin;
        leaves.searched.push_back(pair);
        self.is_searched[a] = self.is_searched[b] = 1;
    }
    const Real listed = motion.scale.zone + leaves.listed[0].spare;
    SortedLeafPairs searched(leaves.searched.span());
    const auto is_removed = [&](Index a, Index b) {
        if (relist && distance_squared(box[a], box[b]) > listed * listed) return true;
        return self.is_searched[a] && self.is_searched[b] && searched.contains(a - root, b - root);
    };
    find_leaves(motion.inputs, motion.body, self);
    remove_candidates(self, p, pairs, is_removed);
    for (const LeafPair& pair : leaves.searched)
        self.is_searched[root + pair.first] = self.is_searched[root + pair.second] = 0;
}

Real smallest_spare(std::span<const LeafPair> pairs) {
    Real least = infinity;
    for (const LeafPair& pair : pairs) least = std::min(least, pair.spare);
    return least;
}

bool moves_as_expected(const SelfMotion& motion, const StepMotion& step) {
    const CollisionInputs& inputs = motion.inputs;
    Real change_squared = 0;  // greatest difference from the motion at the present velocities [m^2]
    for_each_node(inputs, motion.body, [&](Index n) {
        change_squared = std::max(change_squared, (step.displacement(n) - step.h * inputs.velocity[n]).squaredNorm());
    });
    const Real allowed = reach(step.h, Real(0), motion.gravity, motion.scale.contact_distance) / 2;
    return change_squared < allowed * allowed;
}

bool holds_for_motion(const SelfMotion& motion, const StepMotion& step, std::span<const LeafPair> pairs,
                      SelfSearch& self) {
    const CollisionInputs& inputs = motion.inputs;
    fit_motion(inputs, motion.body, self, [&](Index n) { return Vec3(inputs.position[n] + step.displacement(n)); });
    if (greatest_motion(motion, self) < smallest_spare(pairs)) return true;
    return std::ranges::all_of(pairs, [&](const LeafPair& pair) {
        return farthest(self.moved_box[motion.root() + pair.first], self.moved_box[motion.root() + pair.second]) <
               pair.spare;
    });
}

}  // namespace skerry
