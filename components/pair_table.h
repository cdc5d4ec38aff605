// Close pairs: two bodies, a body and a collider, or a body and itself, with the features of theirs that could touch
// soon.
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

/// Two features that were close when the pair was last searched. Rows of VertexTable, TriangleTable or EdgeTable, by
/// kind.
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

/// Whether the surfaces of a pair are known not to go through each other.
enum class PairState : std::uint8_t { unknown, apart, overlapping };
template <>
inline constexpr std::uint64_t value_count<PairState> = 3;

/// Place in the concatenated candidate lists.
struct CandidatePlace {
    Index pair;
    Index candidate;
};

/// Features that find_contacts looked at and that are near enough to meet within the step.
struct NearCandidate {
    Index pair;       // row of PairTable
    Index candidate;  // place in its list
    Real distance;    // m, at the start of the step
};

/// One row per pair whose bounding boxes were close at the last broad search, in the order of ContactKey::pair. The
/// candidate lists are columns of their own, so that one pair is searched again without moving the others; lists beyond
/// size() are memory for later.
struct PairTable {
    Column<std::uint64_t> key;  // ContactKey::pair
    Column<PairKind> kind;
    Column<Index> first;        // row of BodyTable; never a kinematic body
    Column<Index> second;       // row of BodyTable, or of ColliderTable
    Column<std::uint8_t> idle;  // neither partner moves in this step: no contacts are looked for, last ones are kept
    Column<Index> looked_at;    // candidates that are not idle
    Column<Vec3> frame_apart;   // m, difference of the positions of both frames, two bodies
    Column<Real> frame_path;    // m, the length of the way of one frame as the other sees it
    Column<Real> travel;  // m: sum of both travels and of that way; of a body's whole way to a collider. In every step
    Column<Real> travel_bound;  // m: with what this step may add to the closing
    // m: what this step may close by the greatest speeds, which are state; frames are not, and decide no contact
    Column<Real> closing;
    // m: how far a try of this step moved it, further than its list was good for; below 0 where the list was made for
    // that
    Column<Real> longer_motion;
    Column<Real> valid_until;    // m: the list holds while travel_bound is below this
    Column<std::uint8_t> fresh;  // searched for this step: what its nodes drifted before takes nothing from the list
    Column<PairState> state;     // as last searched; apart stays apart, find_crossings sees to it
    std::vector<Column<Candidate>> candidates;  // by pair, sorted by feature
    std::vector<Column<Real>>
        asleep_until;                 // m, by pair and candidate: it cannot touch while travel_bound is below this
    Column<std::int64_t> work;        // by some pairs, what looking at them costs; then at those before
    Column<CandidatePlace> block;     // where the blocks of find_contacts start, and one past the last
    Column<std::size_t> block_first;  // row of ContactTable where the contacts of a block start
    std::vector<Column<ContactRow>> found;    // this step's contacts, by block, in candidate order
    std::vector<Column<NearCandidate>> near;  // of two bodies, by block, in candidate order: for find_crossings
    // m: no features that were looked at in this block are nearer to each other
    Column<Real> block_nearest;

    /// Of the columns with one row per pair. State is which pairs overlap: a search finds again what is apart. The
    /// lists are memory, too.
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

/// What a search found of two features: the candidate and until when it may sleep.
struct FoundCandidate {
    Candidate candidate;
    Real asleep_until;  // m
};

/// A pair that the broad search found.
struct FoundPair {
    std::uint64_t key;
    PairKind kind;
    Index first;
    Index second;
    Real valid_until;  // m
    PairState state;
    Vec3 frame_apart;  // m
    Real frame_path;   // m
};

/// Features that would have gone through each other in a try of this step. The step is tried again with them as
/// contacts.
struct CrossingTable {
    Column<ContactRow> row;                 // in key order; empty once a step is taken
    std::vector<Column<ContactRow>> found;  // of the last try, by block of find_contacts
    Column<ContactRow> merged;              // working memory
    bool extends_lists = true;              // off: a pair that moves further than its list stands against the step
    bool beyond_lists = false;              // of the last try: some pair moved further than its list is good for
    bool last_try = false;                  // what crosses now is let through, and its pair counts as overlapping
    std::uint64_t tested = 0;               // features, since the world was made
    std::uint64_t hits = 0;                 // of these, crossings that were stopped
    std::uint64_t let_through = 0;          // of these, crossings that no try could stop
};

/// No point of a body's surface is further than `radius` from `centre`.
struct BoundingSphere {
    Vec3 centre;  // m
    Real radius;  // m
};

/// Working memory of the searches, kept between steps so that a steady state allocates nothing.
struct SearchMemory {
    // by row, when a step begins: nothing is known of its distances
    Column<std::uint8_t> body_forgotten, collider_forgotten;
    // By body, while any is: forgotten in some try of this step. BodyTable::max_speed and frame_speed, which a try that
    // is given up leaves as they were, know nothing of it until the step is taken.
    Column<std::uint8_t> body_unmeasured;
    bool any_unmeasured = false;
    Column<Real> body_travel_bound;  // m: travel, path of the frame and what this step may close, by body
    // m: what this step may close, by body: in its frame, and with the motion of the frame
    Column<Real> body_frame_reach, body_reach;
    Column<Real> collider_travel_bound;  // m, the same by collider
    // m: no point of it near a body is further from its origin, until the next broad search
    Column<Real> collider_extent;
    Column<Real> collider_margin;  // m: how far a box may be and still make a pair with the collider
    Column<Aabb> box;              // m, grown by what may happen until the next broad search: bodies, then colliders
    // by body, as of the last broad search or refit: for round bodies nearer the truth than a box
    Column<BoundingSphere> sphere;
    BoxGrid grid;                                // of them
    Column<std::uint8_t> has_box;                // by row of `box`: it is in the grid
    Column<Index> entry;                         // rows of `box` in the grid
    Column<Index> planes;                        // rows of ColliderTable
    std::vector<Column<FoundPair>> found_pairs;  // by block of the broad search, in no order
    Column<FoundPair> pairs;                     // all of them, in key order
    Column<Index> group_begin, group_end;        // in `pairs`, by kind and slot of the first body
    Column<Index> old_row;            // by pair: in PairTable before, no_index for one that is new or forgotten
    Column<Index> old_list;           // by list: which one it was
    Column<std::uint8_t> given_away;  // by old list
    std::vector<Column<Candidate>> candidates;  // on their way to the new order of pairs
    std::vector<Column<Real>> asleep_until;
    Column<Index> expired;             // rows of PairTable
    Column<Index> near, far;           // of them: those that are searched, and those that are seen to be far apart
    Column<std::uint8_t> needs_refit;  // by body
    Column<std::uint8_t> rebase;  // by body: its displacement costs a pair much; measure_displacement sets it to zero
    Column<Index> refit;          // rows of BodyTable
    std::vector<Column<FoundCandidate>> found;  // by block of the search
};

/// When the broad search has to run again, and what the searches did. What was moved by hand is forgotten, and all
/// pairs of it are found and searched afresh; others keep theirs. New rows, for which the columns are too short, are
/// searched as forgotten ones; rows that go are erased here, too.
struct SearchState {
    static constexpr Real forgotten = -std::numeric_limits<Real>::infinity();

    Column<Real> body_valid_until;  // m, by body: the list of pairs holds while every body's travel_bound is below this
    Column<Real> collider_valid_until;  // m, by collider
    std::uint64_t broad_searches = 0;
    std::uint64_t pair_searches = 0;
    std::uint64_t candidate_count = 0;  // in all lists, now
    SearchMemory memory;

    void forget_body(std::size_t row) {
        if (row < body_valid_until.size()) body_valid_until[row] = forgotten;
    }
    /// Speeds are known of all bodies where the step was taken; else nothing is known again of those that it began with
    /// forgotten.
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
