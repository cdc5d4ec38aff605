// Contacts of one body with itself, for which the bounds of self_motion.h must not change results.
#include <Eigen/Geometry>
#include <algorithm>
#include <catch2/catch.hpp>
#include <cmath>
#include <set>
#include <utility>

#include "systems/collision/find_crossings.h"
#include "systems/collision/inputs/contact_key.h"
#include "systems/collision/narrow/candidate_lanes.h"
#include "systems/collision/narrow/rest_distance.h"
#include "systems/collision/search/search_pair.h"
#include "tests/support/collision_world.h"
#include "tests/support/surfaces_cross.h"

namespace skerry::test::self_contact_test {

using test::CollisionWorld;

namespace {

constexpr Real h = 2e-3;
constexpr Real length = 8, shell = 0.1;  // length and contact distance of the strip [m]

/// A strip that bends into a ring whose ends nearly meet, and straightens again, while it turns and trembles.
struct RollingStrip {
    CollisionWorld w;
    test::Random random{23};
    Index body;

    explicit RollingStrip(Real offset = 0) : offset_(offset) {
        body = w.add_solid(test::box_mesh({32, 3, 1}, {length, 0.8, 0.25}), w.at(Vec3::Zero()), shell);
        w.body.self_contact[body] = 1;
    }

    /// Position of a point of the strip that is bent by `angle` over its length and turned by `turn` [rad].
    Vec3 place(const Vec3& rest, Real angle, Real turn) const {
        const Real along = rest.x() / length, theta = angle * along;
        Vec3 bent = rest;
        if (std::abs(angle) > 1e-6) {
            const Real radius = length / angle;
            bent = {(radius - rest.z()) * std::sin(theta), rest.y() + offset_ * along,
                    radius - (radius - rest.z()) * std::cos(theta)};
        }
        return Eigen::AngleAxisd(turn, Vec3(0.3, 1, 0.2).normalized()) * bent;
    }

    /// Sets the velocities with which the strip reaches its next shape in one step.
    void steer(Real angle, Real turn, Real tremble) {
        for (std::size_t n = 0; n < w.nodes.position.size(); ++n)
            w.nodes.velocity[n] =
                (place(w.nodes.rest_position[n], angle, turn) - w.nodes.position[n]) / h + tremble * random.vector();
        w.measure_speed();
    }

    Index crossings() {
        const std::vector<Vec3> none(w.nodes.position.size(), Vec3::Zero());
        const Index count =
            find_crossings(*w.executor, w.inputs(), w.settings, h, w.nodes.velocity, none, w.pairs, w.crossings);
        use_crossings(w.pairs, w.crossings);
        return count;
    }

private:
    Real offset_;  // distance of the two ends along the axis of the ring [m]
};

std::set<std::uint64_t> features(const CollisionWorld& w) {
    std::set<std::uint64_t> all;
    for (const ContactKey& key : w.contacts.key) all.insert(key.feature);
    return all;
}

/// All features of the strip that may become contacts in this step, found by a comparison of all pairs of features.
std::set<std::uint64_t> features_within_reach(const RollingStrip& strip) {
    const CollisionInputs inputs = strip.w.inputs();
    const PairScale scale = pair_scale(inputs, PairKind::self, strip.body, strip.body);
    const auto& x = inputs.position;
    std::set<std::uint64_t> all;
    const auto test = [&](std::uint64_t feature, const auto& first, const auto& second, auto&& distance) {
        if ((x[first[0]] - x[second[0]]).norm() > 1.5) return;  // much more than two edges and the reach
        Real speed = 0;
        for (const Index m : first)
            for (const Index n : second) {
                if (m == n) return;
                speed = std::max(speed, (inputs.velocity[m] - inputs.velocity[n]).norm());
            }
        const Real gap = distance() - scale.contact_distance;
        if (gap <= reach(h, speed, strip.w.settings.gravity, scale.shell)) all.insert(feature);
    };
    const SurfaceTables& surface = strip.w.surface;
    for (Index v = 0; v < static_cast<Index>(surface.vertices.node.size()); ++v)
        for (Index t = 0; t < static_cast<Index>(surface.triangles.node.size()); ++t) {
            const std::array<Index, 1> point{surface.vertices.node[v]};
            const auto& corner = surface.triangles.node[t];
            test(point_triangle_feature(false, v, t), point, corner, [&] {
                return std::sqrt(
                    closest_point_on_triangle(x[point[0]], x[corner[0]], x[corner[1]], x[corner[2]]).distance_squared);
            });
        }
    for (Index e = 0; e < static_cast<Index>(surface.edges.node.size()); ++e)
        for (Index f = e + 1; f < static_cast<Index>(surface.edges.node.size()); ++f) {
            const auto &a = surface.edges.node[e], &b = surface.edges.node[f];
            test(edge_edge_feature(e, f), a, b, [&] {
                return std::sqrt(closest_points_of_segments(x[a[0]], x[a[1]], x[b[0]], x[b[1]]).distance_squared);
            });
        }
    return all;
}

}  // namespace

TEST_CASE("the candidates of a strip with itself include all features within reach, whatever the motion",
          "[unit][long]") {
    RollingStrip strip;
    strip.steer(5.9, 0, 0);
    strip.w.drift(h);
    std::size_t most = 0, extended = 0, compared = 0, listed_leaves = 0;
    constexpr int steps = 240;
    Real turn = 0;
    for (int step = 1; step <= steps; ++step) {
        // There are calm phases, and phases in which the strip turns, its ends close up or its nodes tremble.
        turn += step % 120 < 20 ? 0.03 : 0.0005;
        const Real closing = step % 80 < 40 ? 0 : 0.2 * std::sin(2 * M_PI * step / 40);
        strip.steer(5.9 + closing, turn, step % 60 < 50 ? 0.02 : 5);
        const Real before = strip.w.pairs.valid_until.empty() ? 0 : strip.w.pairs.valid_until[0];
        strip.w.find(h);
        CAPTURE(step);
        std::set<std::uint64_t> listed;
        for (const Candidate& candidate : strip.w.pairs.candidates[0]) listed.insert(candidate.feature);
        const std::set<std::uint64_t> expected = features_within_reach(strip);
        REQUIRE(std::ranges::includes(listed, expected));
        most = std::max(most, expected.size());
        const LeafPairTable& leaves = strip.w.pairs.leaf_pairs[0];
        compared += strip.w.pairs.rebuilt[0] != 0 ? leaves.searched.size() : 0;
        listed_leaves += leaves.listed.size();
        extended += strip.w.pairs.rebuilt[0] == 0 && strip.w.pairs.valid_until[0] > before;
        strip.w.drift(h);
    }
    CHECK(most > 20);
    CHECK(extended > steps / 20);
    CHECK(compared < listed_leaves / 3);
}

TEST_CASE("a strip that rolls up and turns finds all contacts with itself while few steps search", "[unit][long]") {
    // With a crossing the ends pass each other, and nothing is held apart.
    const bool crosses = GENERATE(false, true);
    CAPTURE(crosses);
    RollingStrip thrifty, thorough;
    thorough.w.settings.use_budgets = false;
    thrifty.w.settings.continuous = thorough.w.settings.continuous = !crosses;
    for (RollingStrip* strip : {&thrifty, &thorough}) {
        strip->steer(5.4, 0, 0);
        strip->w.drift(h);
    }
    constexpr int steps = 700;
    std::size_t contacts = 0, held = 0, compared = 0, listed = 0;
    for (int step = 0; step < steps; ++step) {
        const Real phase = 2 * M_PI * (step + 1) / 1000, angle = 5.4 + (crosses ? 1.2 : 0.82) * std::sin(phase);
        for (RollingStrip* strip : {&thrifty, &thorough}) strip->steer(angle, 0.4 * phase, step % 100 < 80 ? 0.02 : 2);
        if (step % 25 == 0) thrifty.w.follow_bodies();
        thrifty.w.find(h);
        thorough.w.find(h);
        CAPTURE(step);
        REQUIRE(features(thrifty.w) == features(thorough.w));
        REQUIRE(std::ranges::equal(thrifty.w.contacts.gap, thorough.w.contacts.gap));
        contacts += thorough.w.contacts.size();
        // The travel of the body exceeds the margin of the list, and the motion of its parts does not.
        const PairTable& pairs = thrifty.w.pairs;
        held += !pairs.rebuilt[0] && !(pairs.travel_bound[0] < pairs.valid_until[0]);
        compared += pairs.rebuilt[0] != 0 ? pairs.leaf_pairs[0].searched.size() : 0;
        listed += pairs.leaf_pairs[0].listed.size();
        thrifty.w.drift(h);
        thorough.w.drift(h);
    }
    CHECK(contacts > 300);
    CHECK(held > steps / 4);
    CHECK(compared < listed / 4);
}

TEST_CASE("an end that is thrown through the other end within one step is stopped", "[unit]") {
    RollingStrip strip;
    strip.steer(5.9, 0, 0);  // a ring with a gap
    strip.w.drift(h);
    const std::vector<Vec3> start(strip.w.nodes.position.begin(), strip.w.nodes.position.end());
    const auto rest = [&] {
        std::ranges::fill(strip.w.nodes.velocity, Vec3(Vec3::Zero()));
        strip.w.measure_speed();
    };
    const auto throw_end = [&] {
        for (std::size_t n = 0; n < start.size(); ++n)
            if (strip.w.nodes.rest_position[n].x() > 0.4 * length) strip.w.nodes.velocity[n] = Vec3(-2, 0, 0) / h;
        strip.w.measure_speed();
    };
    rest();
    strip.w.find(h);
    REQUIRE(strip.w.pairs.state[0] == PairState::apart);
    CHECK(strip.crossings() == 0);
    throw_end();
    CHECK(strip.crossings() > 0);
    CHECK(strip.w.crossings.beyond_lists);
    rest();
    strip.w.find(h);  // the next attempt at the step begins with the velocities of the first one
    throw_end();
    CHECK(strip.crossings() > 0);
    CHECK(!strip.w.crossings.beyond_lists);
    CHECK(strip.w.crossings.row.size() > 0);
}

TEST_CASE("an end that is thrown through the other end while the strip turns is noticed", "[unit]") {
    RollingStrip strip;
    strip.steer(5.9, 0, 0);
    strip.w.drift(h);
    const PairTable& pairs = strip.w.pairs;
    Real turn = 0;
    // The strip turns until its list is valid although the travel of the body exceeds the margin of the list.
    for (int step = 0; step < 100; ++step) {
        turn += 0.03;
        strip.steer(5.9, turn, 0);
        strip.w.find(h);
        if (step > 2 && !pairs.rebuilt[0] && !(pairs.travel_bound[0] < pairs.valid_until[0])) break;
        strip.w.drift(h);
    }
    REQUIRE_FALSE(pairs.rebuilt[0]);
    REQUIRE_FALSE(pairs.travel_bound[0] < pairs.valid_until[0]);
    CHECK(strip.crossings() == 0);
    CHECK_FALSE(strip.w.crossings.beyond_lists);

    const std::vector<Vec3> turning(strip.w.nodes.velocity.begin(), strip.w.nodes.velocity.end());
    std::vector<Vec3> thrown = turning;
    for (std::size_t n = 0; n < thrown.size(); ++n)
        if (strip.w.nodes.rest_position[n].x() > 0.4 * length) thrown[n] += Vec3(-2, 0, 0) / h;
    std::ranges::copy(thrown, strip.w.nodes.velocity.begin());
    strip.w.measure_speed();
    std::ranges::copy(turning, strip.w.nodes.velocity.begin());
    const std::vector<Vec3> none(thrown.size(), Vec3::Zero());
    CHECK(find_crossings(*strip.w.executor, strip.w.inputs(), strip.w.settings, h, thrown, none, strip.w.pairs,
                         strip.w.crossings) > 0);
    CHECK(strip.w.crossings.beyond_lists);
}

TEST_CASE("a flat body that is turned does not cross itself, whatever the rounding errors", "[unit]") {
    for (int i = 1; i <= 20; ++i) {
        RollingStrip strip;
        strip.steer(0, 0.05 * i, 0);
        strip.w.drift(h);
        std::ranges::fill(strip.w.nodes.velocity, Vec3(Vec3::Zero()));
        strip.w.measure_speed();
        strip.w.find(h);
        CAPTURE(i);
        CHECK(strip.w.pairs.state[0] == PairState::apart);
    }
}

TEST_CASE("the counted places where a body crosses itself are those that brute force finds", "[unit]") {
    int most = 0;
    for (const Real angle : {0., 3., 6.17, 6.5, 7., 9.}) {
        RollingStrip strip;
        strip.steer(angle, 0.4, angle == 0 ? 0 : 5);
        strip.w.drift(h);
        const CollisionInputs inputs = strip.w.inputs();
        const Real piece = strip.w.body.mean_edge[strip.body];
        refit_bvh(strip.w.body.bvh_nodes[strip.body], inputs.bvh_node, inputs.leaf_nodes, inputs.position,
                  strip.w.bvh.box);
        int expected = 0;
        for (const auto& edge : strip.w.surface.edges.node)
            for (const auto& face : strip.w.surface.triangles.node) {
                const auto& x = inputs.position;
                const Vec3 normal = (x[face[1]] - x[face[0]]).cross(x[face[2]] - x[face[0]]).normalized();
                const auto is_in_plane = [&](Index n) { return std::abs(normal.dot(x[n] - x[face[0]])) < 1e-9; };
                expected += !is_in_plane(edge[0]) && !is_in_plane(edge[1]) &&
                            passes_through(x[edge[0]], x[edge[1]], x[face[0]], x[face[1]], x[face[2]]) &&
                            rest_distance_squared(inputs, edge[0], face) > piece * piece &&
                            rest_distance_squared(inputs, edge[1], face) > piece * piece;
            }
        CAPTURE(angle);
        CHECK(count_self_crossings(inputs, strip.body, strip.w.bvh.box) == expected);
        CHECK((expected > 0) == (angle > 6.4));
        most = std::max(most, expected);
    }
    CHECK(most > 10);
}

}  // namespace skerry::test::self_contact_test
