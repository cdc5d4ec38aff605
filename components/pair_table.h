// Close pairs: two bodies, a body and a collider, or a body and itself, each with the features that could touch soon.
#pragma once

#include <cstdint>
#include <limits>
#include <vector>

#include "components/box_grid.h"
#include "components/bvh_table.h"
#include "components/column.h"
#include "components/column_role.h"
#include "components/contact_table.h"
#include "components/row_type.h"
#include "components/types.h"

namespace skerry {

/// Two features that were close when the pair was last searched: rows of VertexTable, TriangleTable or EdgeTable,
/// depending on the kind.
struct Candidate {
    std::uint64_t feature;  // ContactKey::feature
    Index first;            // vertex, or edge of the first body
    Index second;           // triangle, edge, or collider
};
template <>
struct MembersOf<Candidate> {
    static std::span<const Member> list();
};

enum class PairKind : std::uint8_t { bodies, collider, self };
template <>
inline constexpr std::uint64_t value_count<PairKind> = 3;

/// Whether the surfaces of a pair intersect, as far as known.
enum class PairState : std::uint8_t { unknown, apart, overlapping };
template <>
inline constexpr std::uint64_t value_count<PairState> = 3;

/// Place in the concatenated candidate lists.
struct CandidatePlace {
    Index pair;
    Index candidate;
};

/// A pair of features that find_contacts tested and that could meet within the step.
struct NearCandidate {
    Index pair;       // row of PairTable
    Index candidate;  // place in its list
    Real distance;    // at the start of the step [m]
};

/// One row per pair whose bounding boxes were close at the last broad search, in the order of ContactKey::pair. Each
/// candidate list is a column of its own, so that one pair can be searched again without moving the others. Lists
/// beyond size() are spare memory.
struct PairTable {
    Column<std::uint64_t> key;  // ContactKey::pair
    Column<PairKind> kind;
    Column<Index> first;        // row of BodyTable; never a kinematic body
    Column<Index> second;       // row of BodyTable, or of ColliderTable
    Column<std::uint8_t> idle;  // neither partner moves in this step: no contacts are searched, the last ones are kept
    Column<Index> looked_at;    // number of candidates to test; 0 for an idle pair
    Column<Vec3> frame_apart;   // difference of the positions of both frames, for two bodies [m]
    Column<Real> frame_path;    // path length of one frame as seen from the other [m]
    Column<Real> travel;  // both travels plus frame_path; for a collider plus the body's frame path. In every step [m]
    Column<Real> travel_bound;  // travel plus the closing distance possible in this step [m]
    // Distance that this step may close at the greatest speeds [m]. Uses speeds, which are state, and not frames, which
    // are not and must not decide a contact.
    Column<Real> closing;
    // Relative motion in a try that exceeded the list; negative if the list was rebuilt for that motion [m].
    Column<Real> longer_motion;
    Column<Real> valid_until;                   // the list is complete while travel_bound is below this [m]
    Column<std::uint8_t> fresh;                 // searched for this step: earlier drift does not shorten its list
    Column<PairState> state;                    // as last searched; find_crossings keeps pairs apart that are apart
    std::vector<Column<Candidate>> candidates;  // by pair, sorted by feature
    std::vector<Column<Real>> asleep_until;  // by pair and candidate: no contact while travel_bound is below this [m]
    Column<std::int64_t> work;        // by group of pairs: cost of testing them, then the sum over the groups before
    Column<CandidatePlace> block;     // start of each block of find_contacts, and one past the last
    Column<std::size_t> block_first;  // row of ContactTable at which the contacts of a block start
    std::vector<Column<ContactRow>> found;    // this step's contacts, by block, in candidate order
    std::vector<Column<NearCandidate>> near;  // pairs of two bodies, by block, in candidate order: for find_crossings
    // Lower bound of the distances of the features tested in this block [m].
    Column<Real> block_nearest;

    /// Visits the columns with one row per pair. Which pairs overlap is state; a search finds again the pairs that are
    /// apart. The candidate lists are memory, too.
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

/// Result of a search for two features: the candidate, and how long it may sleep.
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

/// Features that would have crossed in a try of this step. The step is tried again with them as contacts.
struct CrossingTable {
    Column<ContactRow> row;                 // in key order; empty once a step is taken
    std::vector<Column<ContactRow>> found;  // of the last try, by block of find_contacts
    Column<ContactRow> merged;              // working memory
    bool extends_lists = true;      // false: a step in which a pair moves further than its list allows is rejected
    bool beyond_lists = false;      // in the last try some pair moved further than its list allows
    bool last_try = false;          // crossings of this try are let through, and their pairs count as overlapping
    std::uint64_t tested = 0;       // features tested since the world was made
    std::uint64_t hits = 0;         // of these, crossings that were stopped
    std::uint64_t let_through = 0;  // of these, crossings that no try could stop
};

/// A sphere that contains the surface of a body.
struct BoundingSphere {
    Vec3 centre;  // [m]
    Real radius;  // [m]
};

/// Working memory of the searches, kept between steps so that a steady state allocates nothing.
struct SearchMemory {
    // Per row, at the start of a step: 1 if nothing is known about the distances of the body or collider.
    Column<std::uint8_t> body_forgotten, collider_forgotten;
    // Per body, valid while any_unmeasured: 1 if it was forgotten in some try of this step. BodyTable::max_speed and
    // frame_speed do not include it until the step is taken, because a rejected try leaves them unchanged.
    Column<std::uint8_t> body_unmeasured;
    bool any_unmeasured = false;
    Column<Real> body_travel_bound;  // travel, path of the frame and closing distance of this step, by body [m]
    // Closing distance of this step, by body: in its frame, and including the motion of the frame [m].
    Column<Real> body_frame_reach, body_reach;
    Column<Real> collider_travel_bound;  // travel and closing distance of this step, by collider [m]
    // Distance from the collider's origin within which all its points near a body lie, until the next broad search [m].
    Column<Real> collider_extent;
    Column<Real> collider_margin;  // largest distance at which a box makes a pair with the collider [m]
    Column<Aabb> box;  // bodies, then colliders; grown by the motion allowed until the next broad search [m]
    // Per body, as of the last broad search or refit; fits round bodies more closely than a box.
    Column<BoundingSphere> sphere;
    BoxGrid grid;                                // of the boxes
    Column<std::uint8_t> has_box;                // by row of `box`: whether it is in the grid
    Column<Index> entry;                         // rows of `box` in the grid
    Column<Index> planes;                        // rows of ColliderTable
    std::vector<Column<FoundPair>> found_pairs;  // by block of the broad search, unordered
    Column<FoundPair> pairs;                     // all found pairs, in key order
    Column<Index> group_begin, group_end;        // in `pairs`, by kind and slot of the first body
    Column<Index> old_row;            // by pair: previous row in PairTable, no_index for a new or forgotten one
    Column<Index> old_list;           // by list: its previous index
    Column<std::uint8_t> given_away;  // by old list: whether a pair has taken it over
    std::vector<Column<Candidate>> candidates;  // temporary, while the lists are reordered
    std::vector<Column<Real>> asleep_until;
    Column<Index> expired;             // rows of PairTable
    Column<Index> near, far;           // expired pairs that are searched, and those known to be far apart
    Column<std::uint8_t> needs_refit;  // by body
    Column<std::uint8_t> rebase;       // by body: its displacement costs a pair much; measure_displacement resets it
    Column<Index> refit;               // rows of BodyTable
    std::vector<Column<FoundCandidate>> found;  // by block of the search
};

/// Decides when the broad search runs again, and counts the searches. Bodies and colliders that a user moved are
/// forgotten: all their pairs are found and searched afresh, and other pairs keep theirs. New rows, for which the
/// columns are too short, count as forgotten. Removed rows are erased here, too.
struct SearchState {
    static constexpr Real forgotten = -std::numeric_limits<Real>::infinity();

    Column<Real> body_valid_until;      // by body: the list of pairs holds while every travel_bound is below this [m]
    Column<Real> collider_valid_until;  // by collider [m]
    std::uint64_t broad_searches = 0;
    std::uint64_t pair_searches = 0;
    std::uint64_t candidate_count = 0;  // current total of all lists
    SearchMemory memory;

    void forget_body(std::size_t row) {
        if (row < body_valid_until.size()) body_valid_until[row] = forgotten;
    }
    /// Ends a step. If it was taken, the speeds of all bodies are known; otherwise the bodies that were forgotten at
    /// its start are forgotten again.
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
