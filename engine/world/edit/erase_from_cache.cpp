#include <utility>

#include "components/any_table.h"
#include "engine/world/edit/erase_gone.h"
#include "systems/collision/inputs/contact_key.h"

namespace skerry {

namespace {

class CacheRows {
public:
    CacheRows(const RowMoves& moves, PairTable& pairs) : moves_(moves), pairs_(pairs) {}

    bool is_gone(std::size_t p) const { return body_now(pairs_.first[p]) == no_index || second_now(p) == no_index; }

    void renumber(std::size_t p) const {
        const auto &first = shift(pairs_.first[p]),
                   &second = pairs_.kind[p] == PairKind::collider ? first : shift(pairs_.second[p]);
        const Index second_row = second_now(p);
        if (first != Shift{} || second != Shift{} || second_row != pairs_.second[p])
            for (Candidate& candidate : pairs_.candidates[p]) renumber(candidate, pairs_.kind[p], first, second);
        if (pairs_.kind[p] == PairKind::collider)
            for (Candidate& candidate : pairs_.candidates[p]) candidate.second = second_row;
        pairs_.first[p] = body_now(pairs_.first[p]);
        pairs_.second[p] = second_row;
    }

private:
    using Shift = OfBodyTables<Index>;

    const Shift& shift(Index body) const { return moves_.shift_to_start[static_cast<std::size_t>(body)]; }
    Index body_now(Index body) const { return moves_.body_now[static_cast<std::size_t>(body)]; }
    Index second_now(std::size_t p) const {
        const Index second = pairs_.second[p];
        return pairs_.kind[p] == PairKind::collider ? moves_.collider_now[static_cast<std::size_t>(second)]
                                                    : body_now(second);
    }

    static void renumber(Candidate& candidate, PairKind kind, const Shift& first, const Shift& second) {
        const bool of_collider = kind == PairKind::collider;
        if (is_edge_edge(candidate.feature)) {
            candidate.first -= first.edges;
            if (!of_collider) candidate.second -= second.edges;
        } else if (of_collider) {
            candidate.first -= is_face_collider(candidate.feature) ? first.triangles : first.vertices;
        } else {
            const bool turned = is_point_of_second(candidate.feature);
            candidate.first -= turned ? second.vertices : first.vertices;
            candidate.second -= turned ? first.triangles : second.triangles;
        }
    }

    const RowMoves& moves_;
    PairTable& pairs_;
};

/// Returns the ranges of the rows for which is_gone(row) is true, and calls renumber(row) for all other rows.
std::vector<Range> take_rows(std::size_t count, auto&& is_gone, auto&& renumber) {
    std::vector<Range> removed;
    for (std::size_t row = 0; row < count; ++row) {
        const auto index = static_cast<Index>(row);
        if (is_gone(row))
            append_gone(Range{index, index + 1}, removed);
        else
            renumber(row);
    }
    return removed;
}

/// Moves the candidate lists of the remaining pairs to the pairs' new rows. The lists of removed pairs move to the end,
/// so that later pairs can reuse their memory.
void move_lists(std::span<const Range> removed, std::size_t count, PairTable& pairs) {
    if (removed.empty()) return;
    std::size_t to = static_cast<std::size_t>(removed.front().begin);
    for (std::size_t i = 0; i < removed.size(); ++i) {
        const std::size_t stop = i + 1 < removed.size() ? static_cast<std::size_t>(removed[i + 1].begin) : count;
        for (auto from = static_cast<std::size_t>(removed[i].end); from < stop; ++from, ++to) {
            pairs.candidates[from].swap(pairs.candidates[to]);
            pairs.asleep_until[from].swap(pairs.asleep_until[to]);
            std::swap(pairs.leaf_pairs[from], pairs.leaf_pairs[to]);
        }
    }
}

}  // namespace

void erase_gone(const RowMoves& moves, std::span<const Index> body_of_node, ContactCache& cache) {
    cache.resting.step.erase(erase_gone(moves, body_of_node, cache.resting.contact));
    PairTable& pairs = cache.pairs;
    SearchState& search = cache.search;
    const std::size_t count = pairs.size();
    const CacheRows rows(moves, pairs);
    const std::vector<Range> removed = take_rows(
        count,
        [&](std::size_t p) {
            const bool goes = rows.is_gone(p);
            if (goes) search.candidate_count -= pairs.candidates[p].size();
            return goes;
        },
        [&](std::size_t p) { rows.renumber(p); });
    move_lists(removed, count, pairs);
    AnyTable(pairs).erase(removed);
    pairs.self.origin.erase(moves.removed.nodes);
    search.body_valid_until.erase(moves.removed.bodies);
    search.memory.rebase.erase(moves.removed.bodies);
    search.collider_valid_until.erase(moves.removed_colliders);
    search.memory.collider_extent.erase(moves.removed_colliders);
}

std::vector<Range> erase_gone(const RowMoves& moves, std::span<const Index> body_of_node, ContactTable& contacts) {
    const auto now = [](std::span<const Index> row_now, Index row) {
        return row == no_index ? no_index : row_now[static_cast<std::size_t>(row)];
    };
    const auto is_gone = [&](std::span<const Index> row_now, Index row) {
        return row != no_index && now(row_now, row) == no_index;
    };
    const std::vector<Range> removed = take_rows(
        contacts.size(),
        [&](std::size_t c) {
            return is_gone(moves.body_now, contacts.first_body[c]) ||
                   is_gone(moves.body_now, contacts.second_body[c]) ||
                   is_gone(moves.collider_now, contacts.collider[c]);
        },
        [&](std::size_t c) {
            for (Index& node : contacts.stencil[c].node) {
                const Index body = body_of_node[static_cast<std::size_t>(node)];
                node -= moves.shift_to_start[static_cast<std::size_t>(body)].nodes;
            }
            contacts.first_body[c] = now(moves.body_now, contacts.first_body[c]);
            contacts.second_body[c] = now(moves.body_now, contacts.second_body[c]);
            contacts.collider[c] = now(moves.collider_now, contacts.collider[c]);
        });
    AnyTable(contacts).erase(removed);
    return removed;
}

}  // namespace skerry
