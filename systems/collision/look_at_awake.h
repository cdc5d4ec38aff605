// Tests of the awake candidates of many pairs of bodies side by side: their distances, and which of them may be
// contacts of this step.
#pragma once

#include <array>
#include <cstdint>
#include <limits>
#include <span>

#include "components/contact_table.h"
#include "components/pair_table.h"
#include "components/range.h"
#include "systems/collision/inputs/collision_inputs.h"
#include "systems/collision/inputs/contact_reach.h"
#include "systems/collision/narrow/candidate_lanes.h"

namespace skerry {

/// Does the work of look_at_candidates for several ranges of candidates at once, pass by pass. Most pairs have few
/// awake candidates, and memory that one pass prefetches is there for the next.
class AwakeCandidates {
public:
    AwakeCandidates(const CollisionInputs& inputs, const CollisionSettings& settings, Real h, PairTable& pairs,
                    Column<ContactRow>& found, Column<NearCandidate>& near)
        : inputs_(inputs), settings_(settings), h_(h), pairs_(pairs), found_(found), near_(near) {}

    /// Adds a range of candidates of two bodies, neither of them a cylinder. The awake ones are tested with those of
    /// other pairs.
    void add(Index p, Range range);
    /// Tests the candidates that were added.
    void look();

    /// Least distance of all candidates tested [m].
    Real least_distance() const { return least_distance_; }

private:
    static constexpr std::size_t most_candidates = 256;  // so that their data stays in the first-level cache

    template <class T>
    using ByPlace = std::array<T, most_candidates>;

    /// Indices of candidates of one kind in the ByPlace arrays, ascending.
    struct Places {
        explicit Places(FeaturePair of_kind) : kind(of_kind) {}

        const FeaturePair kind;
        std::size_t count = 0;
        ByPlace<std::uint16_t> place;

        void push_back_if(bool holds, std::size_t at) {
            place[count] = static_cast<std::uint16_t>(at);
            count += holds;
        }
    };

    /// The awake candidates of one pair in the order of its list: points and triangles, then edges.
    struct AwakePair {
        Index pair;
        std::size_t begin, edges_begin, end;  // indices in the ByPlace arrays
        std::size_t close_points_end, close_edges_end;
    };

    void list_kinds();
    void list_nodes(const Places& places);
    void measure_distances(const Places& places);
    void measure_speeds(const Places& places);
    CandidateNodeLanes nodes_of_lanes(const Places& places, std::size_t first) const;
    void put_to_sleep(AwakePair& awake);
    void put_to_sleep(const AwakePair& awake, std::size_t begin, std::size_t end, Real zone, const PairScale& scale,
                      Places& close);
    void wake(const AwakePair& awake, std::size_t& next_point, std::size_t& next_edge);
    PairScale scale_of(Index p) const;

    const CollisionInputs& inputs_;
    const CollisionSettings& settings_;
    const Real h_;
    PairTable& pairs_;
    Column<ContactRow>& found_;
    Column<NearCandidate>& near_;
    Real least_distance_ = std::numeric_limits<Real>::infinity();

    std::size_t count_ = 0, pair_count_ = 0;
    ByPlace<AwakePair> pair_;       // each pair has at least one candidate
    ByPlace<Index> row_;            // row in the list of the pair
    ByPlace<Candidate> candidate_;  // copies
    ByPlace<CandidateNodes> node_;
    ByPlace<Real> distance_;  // [m]
    ByPlace<Real> speed_;     // of the close candidates [m/s]
    Places points_{FeaturePair::point_triangle}, edges_{FeaturePair::edge_edge};
    // candidates that are near enough to meet at the greatest speeds of their pair
    Places close_points_{FeaturePair::point_triangle}, close_edges_{FeaturePair::edge_edge};
};

}  // namespace skerry
