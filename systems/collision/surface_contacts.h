// Contacts of this step between the surfaces of two bodies, or between parts of the surface of one body.
#pragma once

#include <array>
#include <cstdint>

#include "components/contact_table.h"
#include "components/pair_table.h"
#include "components/range.h"
#include "systems/collision/inputs/collision_inputs.h"
#include "systems/collision/narrow/candidate_lanes.h"

namespace skerry {

/// Tests the candidates of pairs of surfaces. Most pairs have few candidates, so the candidates of several pairs are
/// collected, and their distances are computed eight at a time. The tests write, in list order:
/// - `found`: contacts, for candidates whose gap (distance minus contact distance) may close within the step of length
///   h;
/// - `near`: candidates whose features could meet within the step, for find_crossings;
/// - asleep_until: for each tested candidate, the value of PairTable::travel_bound below which it needs no further test
///   (contact_reach.h).
class SurfaceContacts {
public:
    SurfaceContacts(const CollisionInputs& inputs, const CollisionSettings& settings, Real h, PairTable& pairs,
                    Column<ContactRow>& found, Column<NearCandidate>& near)
        : inputs_(inputs), settings_(settings), h_(h), pairs_(pairs), found_(found), near_(near) {}

    /// Collects those candidates in a range of the list of pair p whose features may touch in this step. Without
    /// use_budgets, all candidates in the range are collected. Neither partner may be a cylinder.
    void add(Index p, Range range);
    /// Tests the collected candidates.
    void test();

    /// Least distance between the surfaces of all tested candidates [m].
    Real least_distance() const { return smallest_distance_; }

private:
    // Capacity of the collection. It is so small that the data of all collected candidates fit into the first-level
    // cache.
    static constexpr std::size_t max_candidates = 256;

    template <class T>
    using PerSlot = std::array<T, max_candidates>;

    /// Indices of the collected candidates of one kind (FeaturePair), ascending.
    struct Slots {
        std::size_t count = 0;
        PerSlot<std::uint16_t> slot;
    };
    /// The collected candidates of one pair, in the order of its list.
    struct CollectedPair {
        Index pair;
        std::size_t begin, end;  // range of indices of these candidates among all collected candidates
    };

    void list_nodes();
    void measure_distances(FeaturePair kind);
    void test_pair(const CollectedPair& awake);

    const CollisionInputs& inputs_;
    const CollisionSettings& settings_;
    const Real h_;
    PairTable& pairs_;
    Column<ContactRow>& found_;
    Column<NearCandidate>& near_;
    Real smallest_distance_ = infinity;

    std::size_t count_ = 0, pair_count_ = 0;
    PerSlot<CollectedPair> pair_;   // pairs with at least one collected candidate
    PerSlot<Index> row_;            // index of the collected candidate in the list of its pair
    PerSlot<Candidate> candidate_;  // copy of the collected candidate
    PerSlot<CandidateNodes> node_;
    PerSlot<Real> distance_;      // [m]
    std::array<Slots, 2> slots_;  // by FeaturePair
};

}  // namespace skerry
