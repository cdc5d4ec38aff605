// Pairs of close objects: two bodies, a body and a collider, or a body and itself. Each pair lists the features that
// could touch soon.
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

/// Two features that were close when their pair was last searched. They are rows of VertexTable, TriangleTable,
/// EdgeTable or ColliderTable, depending on the kind of the pair and features.
struct Candidate {
    std::uint64_t feature;  // ContactKey::feature
    Index first;            // row of the vertex, or of the edge of the first body
    Index second;           // row of the triangle, edge or collider
};
template <>
struct MembersOf<Candidate> {
    static std::span<const Member> list();
};

enum class PairKind : std::uint8_t { bodies, collider, self };
template <>
inline constexpr std::uint64_t value_count<PairKind> = 3;

/// Whether the surfaces of a pair intersect; unknown until a search tests them.
enum class PairState : std::uint8_t { unknown, apart, overlapping };
template <>
inline constexpr std::uint64_t value_count<PairState> = 3;

/// Position in the concatenated candidate lists: a pair, and an index in the list of the pair.
struct CandidatePlace {
    Index pair;
    Index candidate;
};

/// A pair of features that find_contacts tested and that could meet within the step.
struct NearCandidate {
    Index pair;       // row of PairTable
    Index candidate;  // index in the candidate list of the pair
    Real distance;    // distance of the features at the start of the step [m]
};

/// One row per pair whose bounding boxes were close at the last broad search, in the order of ContactKey::pair. The
/// candidate list of each pair is a separate column, so that one pair can be searched again without moving the lists of
/// other pairs. Lists beyond size() are spare memory.
struct PairTable {
    Column<std::uint64_t> key;  // ContactKey::pair
    Column<PairKind> kind;
    Column<Index> first;   // row of BodyTable; never a kinematic body
    Column<Index> second;  // row of BodyTable, or of ColliderTable
    // 1: neither partner moves in this step. No contacts are searched, and the last ones are kept.
    Column<std::uint8_t> idle;
    Column<Index> looked_at;   // number of candidates to test; 0 for an idle pair
    Column<Vec3> frame_apart;  // difference of the frame positions of two bodies [m]
    Column<Real> frame_path;   // path length of one frame relative to the other frame [m]
    // Bound on the relative motion so far [m], computed in every step. Two bodies: travel of both plus frame_path. Body
    // and collider: travel of both plus the path of the body's frame.
    Column<Real> travel;
    Column<Real> travel_bound;  // `travel` plus the distance that this step may close [m]
    // Distance that this step may close at the greatest speeds of the partners [m]. It is computed from speeds, which
    // are state, and not from frames, which are not state and must not decide about a contact.
    Column<Real> closing;
    // Relative motion in an attempted step that exceeded the validity of the list; negative once the list was rebuilt
    // for this motion [m].
    Column<Real> longer_motion;
    Column<Real> valid_until;  // the candidate list is complete while travel_bound is below this [m]
    // 1: the list was searched for this step, so earlier drift does not shorten its validity.
    Column<std::uint8_t> fresh;
    // Result of the last search. A pair that is apart stays apart, because find_crossings stops crossings.
    Column<PairState> state;
    std::vector<Column<Candidate>> candidates;  // by pair: candidate list, sorted by feature
    // Value of travel_bound below which no contact is possible, by pair and candidate [m].
    std::vector<Column<Real>> asleep_until;
    // Cost of testing the candidates, by group of pairs; later the sum of the costs of all earlier groups.
    Column<std::int64_t> work;
    Column<CandidatePlace> block;           // start of each block of find_contacts, and the end of the last block
    Column<std::size_t> block_first;        // row of ContactTable at which the contacts of a block start
    std::vector<Column<ContactRow>> found;  // by block, in candidate order: contacts of this step
    // Candidates of pairs of two bodies, for find_crossings; by block, in candidate order.
    std::vector<Column<NearCandidate>> near;
    // Lower bound of the distances of the features tested in each block [m].
    Column<Real> block_nearest;

    /// Visits the columns with one row per pair. The set of overlapping pairs is state, because a search finds only the
    /// other pairs again. The candidate lists, which are not visited here, have the role `memory`.
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
        visit("looked_at", looked_at, ColumnRole::scratch);
        visit("travel", travel, ColumnRole::scratch);
        visit("travel_bound", travel_bound, ColumnRole::scratch);
        visit("closing", closing, ColumnRole::scratch);
        visit("longer_motion", longer_motion, ColumnRole::scratch);
        visit("fresh", fresh, ColumnRole::scratch);
    }
    std::size_t size() const { return key.size(); }
};

/// Result of a search for two features: a candidate, and the travel_bound below which it cannot touch.
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

/// Features that would have crossed in an attempt at this step. The step is repeated with these features as contacts.
struct CrossingTable {
    Column<ContactRow> row;                 // crossings in key order; empty once a step is committed
    std::vector<Column<ContactRow>> found;  // by block of find_contacts: crossings of the last attempt
    Column<ContactRow> merged;              // working memory
    // True: if a pair moves further than its candidate list allows, the list is extended. false: the step is rejected.
    bool extends_lists = true;
    bool beyond_lists = false;  // true: the last attempt was stopped to extend candidate lists
    // True: crossings of this attempt are let through, and their pairs marked as overlapping.
    bool last_try = false;
    std::uint64_t tested = 0;       // number of feature pairs tested since the world was made
    std::uint64_t hits = 0;         // number of crossings that were stopped
    std::uint64_t let_through = 0;  // number of crossings that no attempt could stop
};

/// A sphere that contains the surface of a body.
struct BoundingSphere {
    Vec3 centre;  // [m]
    Real radius;  // [m]
};

/// Working memory of the searches. It is reused in later steps, so that a steady state allocates nothing.
struct SearchMemory {
    // Flags by body and by collider, at the start of a step: 1 if nothing is known about its distances.
    Column<std::uint8_t> body_forgotten, collider_forgotten;
    // Flag by body, valid while any_unmeasured is set: 1 if the body was marked as forgotten in some attempt at this
    // step. Until the step is committed, BodyTable::max_speed and frame_speed do not include its speed, because a
    // rejected attempt leaves these columns unchanged.
    Column<std::uint8_t> body_unmeasured;
    bool any_unmeasured = false;
    Column<Real> body_travel_bound;  // by body: sum of travel, path of the frame, and closing distance of this step [m]
    // Distance that a body may close in this step, relative to its frame, and including the motion of the frame [m].
    Column<Real> body_frame_reach, body_reach;
    Column<Real> collider_travel_bound;  // by collider: sum of travel and closing distance of this step [m]
    // Distance from the origin of a collider within which all its points near a body lie until the next broad search
    // [m].
    Column<Real> collider_extent;
    // Largest distance between a collider and the box of a body with which it forms a pair [m].
    Column<Real> collider_margin;
    // Boxes of bodies, then of colliders; grown by the motion allowed until the next broad search [m].
    Column<Aabb> box;
    // Bounding sphere of each body at the last broad search or refit. It fits round bodies more closely than a box.
    Column<BoundingSphere> sphere;
    BoxGrid grid;                                // of the boxes
    Column<std::uint8_t> has_box;                // by row of `box`: 1 if it is in the grid
    Column<Index> entry;                         // rows of `box` that are in the grid
    Column<Index> planes;                        // rows of ColliderTable
    std::vector<Column<FoundPair>> found_pairs;  // by block of the broad search: found pairs, unordered
    Column<FoundPair> pairs;                     // all found pairs, in key order
    Column<Index> group_begin, group_end;        // ranges in `pairs`, by kind and slot of the first body
    Column<Index> old_row;            // by pair: its previous row in PairTable; no_index for a new or forgotten pair
    Column<Index> old_list;           // by candidate list: its previous index
    Column<std::uint8_t> given_away;  // by previous list: 1 if a pair that stays has taken it over
    std::vector<Column<Candidate>> candidates;  // temporary storage while the lists are reordered
    std::vector<Column<Real>> asleep_until;
    Column<Index> expired;             // rows of PairTable
    Column<Index> near, far;           // expired pairs: those to be searched, and those known to be far apart
    Column<std::uint8_t> needs_refit;  // by body
    // Flag by body: 1 if its displacement costs a pair much of its margin; measure_displacement then resets it to zero.
    Column<std::uint8_t> rebase;
    Column<Index> refit;                        // rows of BodyTable
    std::vector<Column<FoundCandidate>> found;  // by block of the search: candidates found
};

/// Decides when the broad search runs again, and counts the searches. Bodies and colliders that a user has moved are
/// marked as forgotten: all their pairs are found and searched afresh, while other pairs keep their lists. New rows,
/// for which the columns are too short, count as forgotten. Rows of removed bodies and colliders are erased from the
/// columns.
struct SearchState {
    static constexpr Real forgotten = -infinity;

    // The set of pairs is complete while body_travel_bound of every body is below this [m].
    Column<Real> body_valid_until;
    Column<Real> collider_valid_until;  // by collider [m]
    std::uint64_t broad_searches = 0;
    std::uint64_t pair_searches = 0;
    std::uint64_t candidate_count = 0;  // current number of candidates in all lists
    SearchMemory memory;

    void forget_body(std::size_t row) {
        if (row < body_valid_until.size()) body_valid_until[row] = forgotten;
    }
    /// Ends a step. If the step was committed, the speeds of all bodies are known. Otherwise the bodies that were
    /// marked as forgotten at its start are marked again.
    void end_step(bool taken) {
        if (!memory.any_unmeasured) return;
        for (std::size_t row = 0; row < memory.body_unmeasured.size(); ++row)
            if (!taken && memory.body_unmeasured[row]) forget_body(row);
        memory.any_unmeasured = false;
    }
    void forget_collider(std::size_t row) {
        if (row < collider_valid_until.size()) collider_valid_until[row] = forgotten;
    }
};

}  // namespace skerry
