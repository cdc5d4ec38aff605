// Candidates of many pairs that are evaluated together, against each pair alone.
#include "systems/collision/surface_contacts.h"

#include <algorithm>
#include <catch2/catch.hpp>
#include <cmath>
#include <cstddef>
#include <limits>

#include "systems/collision/inputs/contact_reach.h"
#include "systems/collision/pair_contacts.h"
#include "systems/geometry/closest_points.h"
#include "tests/support/collision_world.h"
#include "tests/support/random.h"

namespace skerry::test::surface_contacts_test {

using test::CollisionWorld;

namespace {

constexpr Real h = 1e-4, contact_distance = 2e-3;

Real distance_of(const CollisionInputs& inputs, const Candidate& candidate) {
    const CandidateNodes node = nodes_of(inputs.surface, candidate);
    const auto at = [&](std::size_t k) -> const Vec3& { return inputs.position[node[k]]; };
    return std::sqrt(features_of(candidate) == FeaturePair::edge_edge
                         ? closest_points_of_segments(at(0), at(1), at(2), at(3)).distance_squared
                         : closest_point_on_triangle(at(0), at(1), at(2), at(3)).distance_squared);
}

/// A row of balls that just touch, rotated at random, with randomly moving nodes: all candidates are awake.
struct Row : CollisionWorld {
    explicit Row(test::Random& random) {
        constexpr Real radius = 0.1;
        for (int ball = 0; ball < 4; ++ball)
            add_solid(test::ball_mesh(radius, 4), at({ball * (2 * radius - 2e-3), 0, 0}, random.rotation()),
                      contact_distance);
        for (std::size_t n = 0; n < nodes.velocity.size(); ++n) nodes.velocity[n] = 5 * random.vector();
        measure_speed();
        find(h);
        for (std::size_t p = 0; p < pairs.size(); ++p)
            std::ranges::fill(pairs.asleep_until[p], -std::numeric_limits<Real>::infinity());
    }
};

}  // namespace

TEST_CASE("candidates of many pairs tested together become the contacts of each candidate tested alone", "[unit]") {
    test::Random random(17);
    std::size_t edges = 0, points = 0, far_edges = 0, far_points = 0, contacts = 0;
    for (int trial = 0; trial < 4; ++trial) {
        Row row(random);
        const CollisionInputs inputs = row.inputs();
        PairTable twin = row.pairs;
        CollisionSettings thorough = row.settings;
        thorough.use_budgets = false;
        Column<ContactRow> together, alone;
        Column<NearCandidate> near, near_alone;
        SurfaceContacts of_all(inputs, row.settings, h, row.pairs, together, near);
        for (Index p = 0; p < static_cast<Index>(row.pairs.size()); ++p) {
            const Range all{0, static_cast<Index>(row.pairs.candidates[p].size())};
            of_all.add(p, all);
            for (Index c = 0; c < all.end; ++c) {  // without any filter by distance or speed
                SurfaceContacts of_one(inputs, thorough, h, twin, alone, near_alone);
                of_one.add(p, {c, c + 1});
                of_one.test();
            }
        }
        of_all.test();

        REQUIRE(together.size() == alone.size());
        contacts += together.size();
        for (std::size_t i = 0; i < together.size(); ++i) {
            CHECK(together[i].key == alone[i].key);
            CHECK(together[i].gap == alone[i].gap);
        }
        for (const NearCandidate& found : near) {
            const Candidate& candidate = row.pairs.candidates[found.pair][found.candidate];
            CHECK(found.distance == Approx(distance_of(inputs, candidate)).margin(1e-13));
            ++(features_of(candidate) == FeaturePair::edge_edge ? edges : points);
        }
        for (Index p = 0; p < static_cast<Index>(row.pairs.size()); ++p) {
            const PairScale scale =
                pair_scale_as_known(row.settings, row.pairs.state[p],
                                    pair_scale(inputs, row.pairs.kind[p], row.pairs.first[p], row.pairs.second[p]));
            const Real base = pair_travel_base(inputs, row.pairs, p),
                       close = std::max(near_distance(scale, row.pairs.closing[p]), scale.zone);
            for (std::size_t c = 0; c < row.pairs.candidates[p].size(); ++c) {
                const Candidate& candidate = row.pairs.candidates[p][c];
                const Real distance = distance_of(inputs, candidate);
                if (distance <= close + 1e-12) continue;
                const bool is_edge = features_of(candidate) == FeaturePair::edge_edge;
                CHECK(row.pairs.asleep_until[p][c] ==
                      Approx(base + distance - (is_edge ? scale.edge_depth : scale.zone)).margin(1e-12));
                ++(is_edge ? far_edges : far_points);
            }
        }
    }
    // Each kind occurred often enough.
    CHECK(contacts > 10);
    CHECK(edges > 100);
    CHECK(points > 50);
    CHECK(far_edges > 100);
    CHECK(far_points > 100);
}

}  // namespace skerry::test::surface_contacts_test
