// Close pairs: two bodies, a body and a collider, or a body and itself, with the features of theirs that could touch soon.
#pragma once

#include <cstdint>

#include "components/column.h"
#include "components/contact_table.h"
#include "components/types.h"

namespace skerry {

/// Two features that were close when the pair was last searched. Rows of VertexTable, TriangleTable or EdgeTable, by kind.
struct Candidate {
    std::uint64_t feature;  // ContactKey::feature
    Index first;            // vertex, or edge of the first body
    Index second;           // triangle, edge, or collider
};

enum class PairKind : std::uint8_t { bodies, collider, self };

/// One row per pair whose bounding boxes were close at the last broad search, in the order of ContactKey::pair. The candidate lists
/// are columns of their own, so that one pair is searched again without moving the others; erased rows keep their memory for later.
struct PairTable {
    Column<std::uint64_t> key;  // ContactKey::pair
    Column<PairKind> kind;
    Column<Index> first;                        // row of BodyTable
    Column<Index> second;                       // row of BodyTable, or of ColliderTable
    Column<Real> valid_until;                   // m: the list holds while the sum of both travels is below this
    std::vector<Column<Candidate>> candidates;  // sorted by feature
    std::vector<Column<Real>> asleep_until;     // m, by candidate: it cannot touch while the sum of travels is below this
    std::vector<Column<ContactRow>> found;      // this step's contacts of the pair, in candidate order

    std::size_t size() const { return key.size(); }
};

/// When the broad search has to run again, and what the searches did.
struct SearchState {
    Column<Real> body_valid_until;      // m, by body: the list of pairs holds while no body's travel exceeds this
    Column<Real> collider_valid_until;  // m, by collider
    std::uint64_t broad_searches = 0;
    std::uint64_t pair_searches = 0;
    std::uint64_t candidate_count = 0;
};

}  // namespace skerry
