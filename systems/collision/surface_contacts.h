// Contacts of this step between the surfaces of two bodies, or of a body with itself.
#pragma once

#include <array>
#include <cstdint>

#include "components/contact_table.h"
#include "components/pair_table.h"
#include "components/range.h"
#include "systems/collision/inputs/collision_inputs.h"
#include "systems/collision/narrow/candidate_lanes.h"

namespace skerry {

/// Tests the awake candidates of several pairs together, eight at a time, because most pairs have few candidates.
/// Candidates whose gap may close within the step of length h are appended to `found`, in order. Candidates that could
/// meet within the step are appended to `near`. Each tested candidate stores the travel until which it may sleep.
class SurfaceContacts {
public:
    SurfaceContacts(const CollisionInputs& inputs, const CollisionSettings& settings, Real h, PairTable& pairs,
                    Column<ContactRow>& found, Column<NearCandidate>& near)
        : inputs_(inputs), settings_(settings), h_(h), pairs_(pairs), found_(found), near_(near) {}

    /// Collects the awake candidates in a range of the list of pair p. Without use_budgets, it collects all candidates.
    /// Neither partner may be a cylinder.
    void add(Index p, Range range);
    /// Tests the candidates that were collected.
    void test();

    /// Least distance of all candidates tested [m].
    Real least_distance() const { return least_distance_; }

private:
    static constexpr std::size_t most_candidates = 256;  // small enough for their data to stay in the first-level cache

    template <class T>
    using ByPlace = std::array<T, most_candidates>;

    /// Indices of the candidates of one kind (FeaturePair), ascending.
    struct Places {
        std::size_t count = 0;
        ByPlace<std::uint16_t> place;
    };
    /// The awake candidates of one pair, in the order of its list: points against triangles, then edges against edges.
    struct AwakePair {
        Index pair;
        std::size_t begin, end;  // range of indices of the collected candidates
    };

    void list_nodes();
    void measure_distances(FeaturePair kind);
    void test_pair(const AwakePair& awake);

    const CollisionInputs& inputs_;
    const CollisionSettings& settings_;
    const Real h_;
    PairTable& pairs_;
    Column<ContactRow>& found_;
    Column<NearCandidate>& near_;
    Real least_distance_ = infinity;

    std::size_t count_ = 0, pair_count_ = 0;
    ByPlace<AwakePair> pair_;       // each pair has at least one collected candidate
    ByPlace<Index> row_;            // index in the candidate list of the pair
    ByPlace<Candidate> candidate_;  // copies
    ByPlace<CandidateNodes> node_;
    ByPlace<Real> distance_;        // [m]
    std::array<Places, 2> places_;  // by FeaturePair
};

}  // namespace skerry
