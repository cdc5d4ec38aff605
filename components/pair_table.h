// Pairs of close objects, called the partners of the pair: two bodies, a body and a collider, or a body and itself.
// Each pair has a list of candidates: pairs of features (points, edges, triangles) that could touch soon.
#pragma once

#include <cstdint>
#include <vector>

#include "components/box_grid.h"
#include "components/bvh_table.h"
#include "components/column.h"
#include "components/column_role.h"
#include "components/contact_table.h"
#include "components/row_type.h"
#include "components/types.h"

namespace skerry {

/// Two features that were close when their pair was last searched. `first` and `second` are rows of VertexTable,
/// TriangleTable, EdgeTable or ColliderTable, depending on the kind of the pair and of the features.
struct Candidate {
    std::uint64_t feature;  // ContactKey::feature
    // row of the vertex, or of the edge of the first body; for a triangle that touches a collider, row of the triangle
    Index first;
    Index second;  // row of the triangle, of the edge of the second body, or of the collider
};
template <>
struct MembersOf<Candidate> {
    static std::span<const Member> list();
};

enum class PairKind : std::uint8_t { bodies, collider, self };
template <>
inline constexpr std::uint64_t value_count<PairKind> = 3;

/// Tells whether the surfaces of a pair intersect (`overlapping`) or not (`apart`). `unknown`: no search has tested it
/// yet.
enum class PairState : std::uint8_t { unknown, apart, overlapping };
template <>
inline constexpr std::uint64_t value_count<PairState> = 3;

/// One candidate of PairTable: row of its pair, and index in the candidate list of this pair.
struct CandidateIndex {
    Index pair;
    Index candidate;
};

/// A pair of features that could meet within the step, as found by find_contacts.
struct NearCandidate {
    Index pair;       // row of PairTable
    Index candidate;  // index in the candidate list of the pair
    Real distance;    // distance of the features at the start of the step [m]
};

/// Two leaves in the tree of one body, or a leaf paired with itself. `first` and `second` are rows of BvhTable minus
/// the row of the root of this tree.
struct LeafPair {
    Index first;
    Index second;
    // Lower bound of the distance by which two features of these leaves must approach each other before they can touch,
    // if the candidate list does not contain them [m].
    Real spare;
};
template <>
struct MembersOf<LeafPair> {
    static std::span<const Member> list();
};

/// Pairs of close leaves in the tree of a body that is paired with itself.
struct LeafPairTable {
    // The first row is the pair of the root with itself. It represents all pairs of leaves that are not listed. The
    // other rows are sorted by `first` and `second`. The column is saved with the role `memory`.
    Column<LeafPair> listed;
    Column<LeafPair> before;  // working memory: the list `listed` before it is made anew
    // Pairs of leaves whose features the last search compared. Their LeafPair::spare is the margin of this search [m]:
    // it found all features of these leaves that are nearer to each other than the contact zone plus the margin.
    Column<LeafPair> searched;
};

/// Working memory of the searches of bodies for contacts with themselves (self_motion.h). All columns are empty while
/// no body is paired with itself.
struct SelfSearch {
    // For each node: position at the last update of LeafPair::spare [m]. The column is saved with the role `memory`.
    Column<Vec3> origin;
    // For each node: displacement from `origin` to the present position, without the common rotation of the body [m].
    // The check at the end of a step uses the position at the end of the step instead of the present one.
    Column<Vec3> moved;
    // Boxes by row of BvhTable. A box of `moved_box` contains the vectors `moved` of all mesh nodes below this node of
    // the tree [m], a box of `speed_box` their velocities [m/s].
    Column<Aabb> moved_box, speed_box;
    // For each row of VertexTable, EdgeTable and TriangleTable: row of BvhTable of the leaf that owns the feature.
    Column<Index> leaf_of_vertex, leaf_of_edge, leaf_of_triangle;
    Column<std::uint8_t> is_searched;  // by row of BvhTable: 1 for a leaf in LeafPairTable::searched
};

/// Pairs of objects whose bounding boxes were close at the last broad search, one row per pair, in the order of
/// ContactKey::pair. The candidate list of each pair is a column of its own, so that one pair can be searched again
/// without moving other lists. Lists with an index of size() or more are spare memory.
struct PairTable {
    Column<std::uint64_t> key;  // ContactKey::pair
    Column<PairKind> kind;
    Column<Index> first;   // row of BodyTable; never a kinematic body
    Column<Index> second;  // row of BodyTable, or of ColliderTable
    // 1: neither partner moves in this step. No contacts are searched for the pair, and its last contacts remain valid.
    Column<std::uint8_t> idle;
    Column<Index> test_count;  // number of candidates to test; 0 for an idle pair
    Column<Vec3> frame_apart;  // MovingFrame::position of the first body minus that of the second body [m]
    // length of the path of the first body's frame relative to the second body's frame since the pair was found [m]
    Column<Real> frame_path;
    // Counter that bounds the relative motion of the partners from above; computed in every step [m]:
    // - two bodies: BodyTable::travel of both bodies plus frame_path
    // - body and collider: `travel` of the body and of the collider, plus the path length of the body's frame
    Column<Real> travel;
    Column<Real> travel_bound;  // `travel` plus the distance by which the partners may approach in this step [m]
    // Distance by which the partners may approach in this step at their greatest speeds in the world [m]. Speeds in the
    // moving frames of the bodies must not be used: contacts depend on this distance, but no result may depend on the
    // frames, which have the role `memory`.
    Column<Real> closing;
    // Relative motion for which the candidate list must be valid, because the partners moved further than it allows in
    // an earlier attempt at this step; 0: no request [m]. Once the list has been rebuilt, the value is made negative,
    // so that a list for the same motion is not requested again.
    Column<Real> longer_motion;
    Column<Real> valid_until;  // the candidate list is complete while travel_bound is below this value [m]
    // 1: the candidate list was made from the positions at the start of this step. valid_until allows for displacements
    // of nodes in the moving frames before this step. Such a list contains these displacements already, so it stays
    // valid longer (is_beyond_list).
    Column<std::uint8_t> rebuilt;
    // State of the surfaces at the last search; not used for a body and an analytic collider. Surfaces that are apart
    // are not tested again, because find_crossings prevents them from crossing.
    Column<PairState> state;
    std::vector<Column<Candidate>> candidates;  // by pair: candidate list, sorted by `feature`
    // A candidate is asleep, which means that it is not tested, while travel_bound is below this value, because its
    // features cannot touch until then [m]. By pair and candidate.
    std::vector<Column<Real>> asleep_until;
    std::vector<LeafPairTable> leaf_pairs;  // by pair; empty for two bodies, and for a body and a collider
    // For each group of consecutive pairs: cost of testing their candidates. cut_blocks then replaces it by the sum of
    // the costs of all groups before this one.
    Column<std::int64_t> work;
    // Start of each block, and the end of the last one. A block is a part of the concatenated candidate lists that one
    // task of find_contacts tests.
    Column<CandidateIndex> block;
    Column<std::size_t> block_first;  // by block: row of ContactTable for its first contact
    // For each block of find_contacts: contacts found in this step, in candidate order.
    std::vector<Column<ContactRow>> found;
    // For each block of find_contacts: candidates that find_crossings must test, in candidate order; only of pairs of
    // bodies, not of a body and a collider.
    std::vector<Column<NearCandidate>> near;
    // For each block of find_contacts: lower bound of the distances of the candidates that it has tested; skipped
    // candidates do not count [m].
    Column<Real> block_nearest;
    SelfSearch self;

    /// Visits the columns with one row per pair. The overlapping pairs are part of the state of the world; all other
    /// pairs are not, because a broad search finds them again. The candidate lists have the role `memory`; this
    /// function does not visit them.
    void for_each_row_column(auto&& visit) {
        visit("key", key, ColumnRole::state);
        visit("kind", kind, ColumnRole::state);
        visit("first", first, ColumnRole::link);
        visit("second", second, ColumnRole::link);
        visit("state", state, ColumnRole::state);
        visit("valid_until", valid_until, ColumnRole::memory);
        visit("frame_apart", frame_apart, ColumnRole::memory);
        visit("frame_path", frame_path, ColumnRole::memory);
        visit("idle", idle, ColumnRole::scratch);
        visit("test_count", test_count, ColumnRole::scratch);
        visit("travel", travel, ColumnRole::scratch);
        visit("travel_bound", travel_bound, ColumnRole::scratch);
        visit("closing", closing, ColumnRole::scratch);
        visit("longer_motion", longer_motion, ColumnRole::scratch);
        visit("rebuilt", rebuilt, ColumnRole::scratch);
    }
    std::size_t size() const { return key.size(); }
};

/// A candidate that a search found, and the value of PairTable::travel_bound below which its features cannot touch.
struct FoundCandidate {
    Candidate candidate;
    Real asleep_until;  // [m]
};

/// A pair that the broad search found.
struct FoundPair {
    std::uint64_t key;
    PairKind kind;
    Index first;
    Index second;
    Real valid_until;  // [m]
    PairState state;
    Vec3 frame_apart;  // [m]
    Real frame_path;   // [m]
};

/// Pairs of features that would pass through each other, found in an earlier attempt at this step. The step is
/// attempted again with contacts between these features.
struct CrossingTable {
    Column<ContactRow> row;  // contacts of the features that crossed, in key order; empty once the step is committed
    std::vector<Column<ContactRow>> found;  // by block of find_contacts: crossings found in the last attempt
    std::size_t found_count = 0;            // number of rows of `found`
    Column<ContactRow> merged;              // working memory
    // Reaction to a pair that moves further than its candidate list is valid for. True: the list is extended. False:
    // the attempt is rejected.
    bool extends_lists = true;
    // true: find_crossings tested no features in the last attempt, because candidate lists must first be extended
    bool beyond_lists = false;
    // True: crossings in this attempt are permitted, and their pairs are marked as overlapping.
    bool last_attempt = false;
    std::uint64_t tested = 0;       // number of feature pairs tested since the world was made
    std::uint64_t hits = 0;         // number of crossings that were prevented
    std::uint64_t let_through = 0;  // number of crossings that were permitted because no attempt could prevent them
};

/// A sphere that contains the surface of a body.
struct BoundingSphere {
    Vec3 centre;  // [m]
    Real radius;  // [m]
};

/// Working memory of the searches. Later steps reuse it, so that they need not allocate memory.
struct SearchMemory {
    // For each body and each collider: 1 if the object was added, or moved by the user, since the last search. Its
    // distances to other objects are then unknown. The flags tell the state at the start of the step.
    Column<std::uint8_t> body_forgotten, collider_forgotten;
    // For each body: 1 if BodyTable::max_speed and frame_speed are out of date, because the user has added or moved the
    // body and no step has been committed since. Rejected attempts do not update the two columns. Valid while
    // any_unmeasured is set.
    Column<std::uint8_t> body_unmeasured;
    bool any_unmeasured = false;
    // For each body: sum of its travel, the path length of its frame, and the greatest distance that it may move in
    // this step [m].
    Column<Real> body_travel_bound;
    // For each body: greatest distance that a node may move in this step, relative to the frame of the body
    // (body_frame_reach) or to the world (body_reach) [m].
    Column<Real> body_frame_reach, body_reach;
    // For each collider: sum of its travel and the distance it may move in this step [m].
    Column<Real> collider_travel_bound;
    // For each collider: radius of a sphere around its origin. All points of the collider that are near a body stay
    // inside this sphere until the next broad search [m].
    Column<Real> collider_extent;
    // For each collider: largest distance from the collider to the box of a body at which the two are listed as a pair
    // [m].
    Column<Real> collider_margin;
    // Boxes of all bodies, followed by the boxes of all colliders. Each box is enlarged by the motion that is allowed
    // until the next broad search [m].
    Column<Aabb> box;
    // Bounding sphere of each body at the last broad search, or at the last update of the boxes of its tree. A sphere
    // encloses round bodies more tightly than a box.
    Column<BoundingSphere> sphere;
    BoxGrid grid;                                // grid of the boxes in `box`
    Column<std::uint8_t> has_box;                // by row of `box`: 1 if the box is in the grid
    Column<Index> entry;                         // rows of `box` that are in the grid
    Column<Index> planes;                        // rows of planes in ColliderTable; planes have no box in the grid
    std::vector<Column<FoundPair>> found_pairs;  // by block of the broad search: found pairs in no particular order
    Column<FoundPair> pairs;                     // all found pairs, in key order
    // Begin and end of each range of `pairs` with the same slot of the first body and the same key type (two bodies, or
    // body and collider). They serve to sort `pairs`.
    Column<Index> group_begin, group_end;
    // For each pair: row of the pair in the previous PairTable. It is no_index for a new pair, and for a pair of an
    // object that the user has moved.
    Column<Index> old_row;
    Column<Index> old_list;  // by index of a candidate list: index of the old list whose memory it takes over
    // For each previous candidate list: 1 if its pair still exists and keeps the list; 0 if a new pair may reuse its
    // memory.
    Column<std::uint8_t> list_is_kept;
    // The next three columns are temporary storage used while the lists of PairTable are reordered.
    std::vector<Column<Candidate>> candidates;
    std::vector<Column<Real>> asleep_until;
    std::vector<LeafPairTable> leaf_pairs;
    Column<Index> expired;    // rows of PairTable whose candidate list is no longer valid
    Column<Index> near, far;  // expired pairs that must be searched, and expired pairs that are known to be far apart
    Column<std::uint8_t> needs_refit;  // by body: 1 if the boxes of its tree must be recomputed
    // Flag by body: 1 if the displacement of the body uses up much of the margin of a pair. measure_displacement then
    // resets the displacement to zero.
    Column<std::uint8_t> rebase;
    Column<Index> refit;                        // rows of BodyTable whose trees are recomputed
    std::vector<Column<FoundCandidate>> found;  // by block of the search: found candidates
};

/// Limits that decide when the broad search, which finds the pairs, runs again; and counts of searches. The rows of
/// removed objects are erased from the columns.
struct SearchState {
    // Limit of an object that the user has added or moved: all its pairs are found and searched again, while other
    // pairs keep their candidate lists. New rows of objects, for which the columns are too short, count as forgotten.
    static constexpr Real forgotten = -infinity;

    // For each body: upper limit of body_travel_bound [m]. The set of pairs is complete while every body and every
    // collider is below its limit.
    Column<Real> body_valid_until;
    // For each collider: upper limit of collider_travel_bound [m].
    Column<Real> collider_valid_until;
    std::uint64_t broad_searches = 0;
    std::uint64_t pair_searches = 0;
    std::uint64_t candidate_count = 0;  // current number of candidates in all lists
    SearchMemory memory;

    void forget_body(std::size_t row) {
        if (row < body_valid_until.size()) body_valid_until[row] = forgotten;
    }
    /// Ends an attempt at a step. After a rejected attempt, bodies that were forgotten at its start are marked as
    /// forgotten again, because their speeds are still unknown. A `committed` step has measured the speeds of all
    /// bodies.
    void end_step(bool committed) {
        if (!memory.any_unmeasured) return;
        for (std::size_t row = 0; row < memory.body_unmeasured.size(); ++row)
            if (!committed && memory.body_unmeasured[row]) forget_body(row);
        memory.any_unmeasured = false;
    }
    void forget_collider(std::size_t row) {
        if (row < collider_valid_until.size()) collider_valid_until[row] = forgotten;
    }
};

}  // namespace skerry
