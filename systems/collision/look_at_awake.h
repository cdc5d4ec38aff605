// Candidates of many pairs of bodies looked at side by side, whatever pair they are of: how far apart they are, and
// which of them may be contacts of this step.
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

/// Does for ranges of candidates that are added one after the other what look_at_candidates does for each, step by step
/// for all of them: most pairs have few that are awake, and what is asked for early is there when it is needed.
class AwakeCandidates {
public:
    AwakeCandidates(const CollisionInputs& inputs, const CollisionSettings& settings, Real h, PairTable& pairs,
                    Column<ContactRow>& found, Column<NearCandidate>& near)
        : inputs_(inputs), settings_(settings), h_(h), pairs_(pairs), found_(found), near_(near) {}

    /// Of a pair of bodies, none of them a cylinder. Those that are awake are looked at with those of other pairs.
    void add(Index p, Range range);
    /// Looks at what was added.
    void look();

    /// m, of all that were looked at.
    Real least_distance() const { return least_distance_; }

private:
    static constexpr std::size_t most_candidates = 256;  // what is known of them stays in the nearest cache

    template <class T>
    using ByPlace = std::array<T, most_candidates>;

    /// Places of candidates of one kind, in order.
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

    /// Some candidates of one pair, in the order of its list: points and triangles, then edges.
    struct AwakePair {
        Index pair;
        std::size_t begin, edges_begin, end;  // places
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
    ByPlace<AwakePair> pair_;       // each has a place at least
    ByPlace<Index> row_;            // in the list of the pair
    ByPlace<Candidate> candidate_;  // copies
    ByPlace<CandidateNodes> node_;
    ByPlace<Real> distance_;  // m
    ByPlace<Real> speed_;     // m/s, of those that are close
    Places points_{FeaturePair::point_triangle}, edges_{FeaturePair::edge_edge};
    // of these, what is near enough for the greatest speeds of its pair
    Places close_points_{FeaturePair::point_triangle}, close_edges_{FeaturePair::edge_edge};
};

}  // namespace skerry
