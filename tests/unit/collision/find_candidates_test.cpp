#include "systems/collision/find_candidates.h"

#include <catch2/catch.hpp>
#include <limits>
#include <map>
#include <set>

#include "systems/collision/inputs/contact_key.h"
#include "systems/collision/inputs/may_collide.h"
#include "systems/collision/narrow/collider_distance.h"
#include "systems/collision/search/find_pairs.h"
#include "systems/geometry/closest_points.h"
#include "tests/support/collision_world.h"

namespace skerry::test::find_candidates_test {

using test::CollisionWorld;

namespace {

constexpr Real h = 1e-4;

/// Every feature of the pair closer than `distance`, by brute force.
std::set<std::uint64_t> all_features(const CollisionWorld& w, Index first, Index second, Real distance) {
    std::set<std::uint64_t> near;
    const auto& x = w.nodes.position;
    const auto points = [&](Index a, Index b, bool of_second) {
        const Range vertices = w.body.vertices[a], triangles = w.body.triangles[b];
        for (Index v = vertices.begin; v < vertices.end; ++v)
            for (Index t = triangles.begin; t < triangles.end; ++t) {
                const auto& n = w.surface.triangles.node[t];
                if (std::sqrt(closest_point_on_triangle(x[w.surface.vertices.node[v]], x[n[0]], x[n[1]], x[n[2]])
                                  .distance_squared) < distance)
                    near.insert(point_triangle_feature(of_second, v - vertices.begin, t - triangles.begin));
            }
    };
    points(first, second, false);
    points(second, first, true);
    const Range ea = w.body.edges[first], eb = w.body.edges[second];
    for (Index a = ea.begin; a < ea.end; ++a)
        for (Index b = eb.begin; b < eb.end; ++b) {
            const auto &m = w.surface.edges.node[a], &n = w.surface.edges.node[b];
            if (std::sqrt(closest_points_of_segments(x[m[0]], x[m[1]], x[n[0]], x[n[1]]).distance_squared) < distance)
                near.insert(edge_edge_feature(a - ea.begin, b - eb.begin));
        }
    return near;
}

void check_order(const PairTable& pairs) {
    for (std::size_t p = 0; p < pairs.size(); ++p) {
        if (p > 0) CHECK(pairs.key[p - 1] < pairs.key[p]);
        REQUIRE(pairs.asleep_until[p].size() == pairs.candidates[p].size());
        for (std::size_t c = 1; c < pairs.candidates[p].size(); ++c)
            CHECK(pairs.candidates[p][c - 1].feature < pairs.candidates[p][c].feature);
    }
}

bool search(CollisionWorld& w) {
    return find_candidates(*w.executor, w.inputs(), w.settings, h, w.bvh.box, w.search, w.pairs);
}

}  // namespace

TEST_CASE("the candidates of two bodies are all features within contact distance and skin, each once", "[unit]") {
    test::Random random(21);
    const test::SolidMesh ball = test::ball_mesh(1, 3), box = test::box_mesh({2, 3, 2}, {1.2, 1.5, 1});
    std::size_t found_in_all = 0;
    for (int trial = 0; trial < 12; ++trial) {
        CollisionWorld w;
        // From deep overlap to far apart.
        const Vec3 apart = random.vector().normalized() * (0.3 * trial);
        const Index a = w.add_solid(trial % 2 ? ball : box, w.at(Vec3::Zero(), random.rotation()), 0.05);
        const Index b = w.add_solid(trial % 3 ? box : ball, w.at(apart, random.rotation()), 0.15);
        search(w);
        check_order(w.pairs);
        const Real edge = std::min(w.body.mean_edge[a], w.body.mean_edge[b]);
        const std::set<std::uint64_t> near = all_features(w, a, b, 0.1 + w.settings.pair_skin * edge);
        found_in_all += near.size();
        if (near.empty()) continue;
        REQUIRE(w.pairs.size() == 1);
        std::set<std::uint64_t> listed;
        for (const Candidate& c : w.pairs.candidates[0]) listed.insert(c.feature);
        CHECK(std::includes(listed.begin(), listed.end(), near.begin(), near.end()));
        // The list does not reach much further: search depth, plus the distance that a step may close.
        const std::set<std::uint64_t> far = all_features(w, a, b, 0.1 + (w.settings.pair_skin + 0.3) * edge);
        CHECK(std::includes(far.begin(), far.end(), listed.begin(), listed.end()));
    }
    CHECK(found_in_all > 1000);
}

TEST_CASE("candidate rows are the features that their numbers name", "[unit]") {
    CollisionWorld w;
    w.add_solid(test::ball_mesh(1, 2), w.at({9, 9, 9}), 0.01);  // makes rows and local numbers differ
    const Index a = w.add_solid(test::ball_mesh(1, 2), w.at(Vec3::Zero()), 0.01);
    const Index b = w.add_solid(test::ball_mesh(1, 2), w.at({0.1, 0.2, 2}), 0.01);
    search(w);
    std::size_t test_count = 0;
    for (std::size_t p = 0; p < w.pairs.size(); ++p)
        for (const Candidate& c : w.pairs.candidates[p]) {
            ++test_count;
            REQUIRE(w.pairs.first[p] == a);
            REQUIRE(w.pairs.second[p] == b);
            const Index first_local = static_cast<Index>(point_of_feature(c.feature) & local_mask),
                        second = second_local(c.feature);
            if (is_edge_edge(c.feature)) {
                CHECK(c.first == w.body.edges[a].begin + first_local);
                CHECK(c.second == w.body.edges[b].begin + second);
            } else {
                const bool turned = is_point_of_second(c.feature);
                CHECK(c.first == w.body.vertices[turned ? b : a].begin + first_local);
                CHECK(c.second == w.body.triangles[turned ? a : b].begin + second);
            }
        }
    CHECK(test_count > 20);
}

TEST_CASE("the candidates of a collider are all surface points near it", "[unit]") {
    CollisionWorld w;
    const Index b = w.add_solid(test::ball_mesh(1, 4), w.at({0, 0, 1.1}), 0.02);
    w.add_collider(ColliderShape::plane, Vec3::Zero(), w.at(Vec3::Zero()));
    search(w);
    REQUIRE(w.pairs.size() == 1);
    CHECK(w.pairs.kind[0] == PairKind::collider);
    std::set<Index> listed;
    for (const Candidate& c : w.pairs.candidates[0]) listed.insert(c.first);
    std::size_t near = 0;
    for (Index v = w.body.vertices[b].begin; v < w.body.vertices[b].end; ++v) {
        const Real z = w.nodes.position[w.surface.vertices.node[v]][2];
        if (z >= 0.01 + w.settings.pair_skin * w.body.mean_edge[b]) continue;
        ++near;
        CHECK(listed.count(v) == 1);
    }
    CHECK(near > 0);
    CHECK(listed.size() < static_cast<std::size_t>(w.body.vertices[b].size()));
}

TEST_CASE("the broad search lists the pairs whose boxes meet, in key order, and no others", "[unit]") {
    test::Random random(17);
    const test::SolidMesh box = test::box_mesh({1, 1, 1}, {1, 1, 1});
    std::size_t listed = 0;
    for (int trial = 0; trial < 4; ++trial) {
        CollisionWorld w;
        w.add_collider(ColliderShape::sphere, Vec3::Constant(0.8), w.at(random.vector()));
        w.add_collider(ColliderShape::box, Vec3(4, 4, 0.1), w.at(Vec3(0, 0, -3)));
        w.add_kinematic(box.nodes, boundary_triangles(box.tetrahedra), 0.05);
        for (int i = 0; i < 100; ++i) {
            test::SolidMesh mesh = box;
            for (Vec3& x : mesh.nodes) x *= std::pow(2, 2 * random.number());
            w.add_solid(mesh, w.at((4 + trial) * random.vector(), random.rotation()), 0.05);
        }
        // Handles are reused, so slots are not in the order of rows.
        for (std::size_t b = 1; b + 1 < w.body.slot.size(); b += 2) std::swap(w.body.slot[b + 1], w.body.slot[b]);
        auto& memory = w.search.memory;
        memory.body_travel_bound.resize(w.body.slot.size());
        memory.body_reach.resize(w.body.slot.size());
        memory.body_forgotten.resize(w.body.slot.size());
        memory.collider_forgotten.resize(w.collider.slot.size());
        find_pairs(*w.executor, w.inputs(), w.settings, h, w.search, w.pairs);
        for (std::size_t p = 1; p < w.pairs.size(); ++p) CHECK(w.pairs.key[p - 1] < w.pairs.key[p]);
        std::set<std::uint64_t> expected;
        const Index bodies = static_cast<Index>(w.body.slot.size());
        const auto meet = [&](Index a, Index b) {
            const Aabb &one = memory.box[a], &other = memory.box[b];
            return (one.lower.array() <= other.upper.array()).all() && (other.lower.array() <= one.upper.array()).all();
        };
        for (Index a = 0; a < bodies; ++a) {
            if (w.body.kind[a] == BodyKind::kinematic) continue;
            for (Index b = 0; b < bodies; ++b) {
                const bool held = w.body.kind[b] == BodyKind::kinematic;
                if (a == b || (b < a && !held) || !meet(a, b)) continue;
                const Real apart = (memory.sphere[a].centre - memory.sphere[b].centre).norm();
                if (apart <= memory.sphere[a].radius + memory.sphere[b].radius)
                    expected.insert(pair_key(w.body, w.collider, PairKind::bodies, a, b));
            }
            for (Index c = 0; c < static_cast<Index>(w.collider.slot.size()); ++c)
                if (w.collider.geometry[c].shape != ColliderShape::mesh && meet(a, bodies + c))
                    expected.insert(pair_key(w.body, w.collider, PairKind::collider, a, c));
        }
        CHECK(std::set<std::uint64_t>(w.pairs.key.begin(), w.pairs.key.end()) == expected);
        listed += expected.size();
    }
    CHECK(listed > 400);
}

TEST_CASE("pairs without a deformable body are never looked at", "[unit]") {
    CollisionWorld w;
    const test::SolidMesh mesh = test::box_mesh({1, 1, 1}, {1, 1, 1});
    const Index a = w.add_kinematic(mesh.nodes, boundary_triangles(mesh.tetrahedra), 0);
    w.add_kinematic(mesh.nodes, boundary_triangles(mesh.tetrahedra), 0);
    w.add_collider(ColliderShape::plane, Vec3::Zero(), w.at(Vec3::Zero()));
    w.add_collider(ColliderShape::sphere, {1, 0, 0}, w.at(Vec3::Zero()));
    search(w);
    CHECK(w.pairs.size() == 0);

    const Index b = w.add_solid(mesh, w.at({0, 0, 1}), 0.1);
    search(w);
    // The body has pairs with both mesh colliders, the plane and the sphere. The body of a mesh collider comes second,
    // under the key of the collider.
    REQUIRE(w.pairs.size() == 4);
    for (std::size_t p = 0; p < 4; ++p) CHECK(w.pairs.first[p] == b);
    CHECK(w.pairs.key[0] == collider_pair_key(w.body.slot[b], w.body.slot[a]));
    CHECK(w.pairs.second[0] == a);
}

TEST_CASE("a scene in which nothing moves is searched once", "[unit]") {
    CollisionWorld w;
    w.add_solid(test::ball_mesh(1, 3), w.at({0, 0, 1.01}), 0.02);
    w.add_solid(test::ball_mesh(1, 3), w.at({0, 0, 3.02}), 0.02);
    w.add_collider(ColliderShape::plane, Vec3::Zero(), w.at(Vec3::Zero()));
    CHECK(search(w));
    const auto broad = w.search.broad_searches, narrow = w.search.pair_searches;
    CHECK(broad == 1);
    CHECK(narrow == w.pairs.size());
    for (int step = 0; step < 100; ++step) {
        CHECK_FALSE(search(w));
        w.drift(h);
    }
    CHECK(w.search.broad_searches == broad);
    CHECK(w.search.pair_searches == narrow);
}

TEST_CASE("a pair that stays near keeps its list over a broad search, and one that leaves is dropped", "[unit]") {
    CollisionWorld w;
    w.add_solid(test::ball_mesh(1, 3), w.at({0, 0, 0}), 0.02);
    w.add_solid(test::ball_mesh(1, 3), w.at({0, 0, 2.05}), 0.02);
    const Index goes = w.add_solid(test::ball_mesh(1, 3), w.at({2.05, 0, 0}), 0.02);
    search(w);
    const std::size_t pairs_before = w.pairs.size();
    REQUIRE(pairs_before >= 2);
    const std::uint64_t kept_key = body_pair_key(w.body.slot[0], w.body.slot[1]);
    REQUIRE(w.pairs.key[0] == kept_key);
    const Candidate* const memory = w.pairs.candidates[0].data();
    const auto narrow = w.search.pair_searches;

    for (Index n = w.body.nodes[goes].begin; n < w.body.nodes[goes].end; ++n) w.nodes.position[n] += Vec3(50, 0, 0);
    w.body.travel[goes] += 50;
    CHECK(search(w));
    CHECK(w.search.broad_searches == 2);
    CHECK(w.pairs.size() < pairs_before);
    REQUIRE(w.pairs.key[0] == kept_key);
    CHECK(w.pairs.candidates[0].data() == memory);
    CHECK(w.search.pair_searches == narrow);  // nothing else had moved
}

TEST_CASE("all pairs of new or forgotten bodies are searched, and no others", "[unit]") {
    CollisionWorld w;
    for (int i = 0; i < 4; ++i) w.add_solid(test::ball_mesh(1, 3), w.at({2.05 * i, 0, 1.02}), 0.02);
    w.add_collider(ColliderShape::plane, Vec3::Zero(), w.at(Vec3::Zero()));
    // `concerned`: true for rows of PairTable that have to be searched
    const auto look = [&](std::uint64_t broad, auto&& concerned) {
        const auto broad_before = w.search.broad_searches, pairs_before = w.search.pair_searches;
        search(w);
        CHECK(w.search.broad_searches - broad_before == broad);
        std::uint64_t pairs = 0;
        for (std::size_t p = 0; p < w.pairs.size(); ++p) {
            pairs += concerned(p);
            CHECK((w.pairs.rebuilt[p] != 0) == concerned(p));
        }
        CHECK(w.search.pair_searches - pairs_before == pairs);
        check_order(w.pairs);
        return pairs;
    };
    const auto all = [](std::size_t) { return true; };
    const auto none = [](std::size_t) { return false; };
    const auto of_body = [&](Index body) {
        return [&, body](std::size_t p) {
            return w.pairs.first[p] == body || (w.pairs.kind[p] != PairKind::collider && w.pairs.second[p] == body);
        };
    };
    const auto of_collider = [&](Index collider) {
        return [&, collider](std::size_t p) {
            return w.pairs.kind[p] == PairKind::collider && w.pairs.second[p] == collider;
        };
    };
    CHECK(look(1, all) >= 7);
    look(0, none);
    const Index ball = w.add_collider(ColliderShape::sphere, {0.5, 0, 0}, w.at({0, 1.6, 1}));
    CHECK(look(1, of_collider(ball)) >= 1);
    look(0, none);
    w.collider.motion[ball].position = {50, 0, 0};
    w.search.forget_collider(static_cast<std::size_t>(ball));
    CHECK(look(1, of_collider(ball)) == 0);
    w.search.forget_collider(0);
    CHECK(look(1, of_collider(0)) == 4);
    // An overlapping pair counts as overlapping until one of its two bodies is forgotten.
    REQUIRE(w.pairs.key[0] == body_pair_key(w.body.slot[0], w.body.slot[1]));
    w.pairs.state[0] = PairState::overlapping;
    w.search.forget_body(3);
    CHECK(look(1, of_body(3)) >= 2);
    CHECK(w.pairs.state[0] == PairState::overlapping);
    w.search.forget_body(1);
    CHECK(look(1, of_body(1)) >= 3);
    CHECK(w.pairs.state[0] == PairState::apart);
    const Index late = w.add_solid(test::ball_mesh(1, 3), w.at({2.05 * 4, 0, 1.02}), 0.02);
    CHECK(look(1, of_body(late)) >= 2);
    w.search.body_valid_until.clear();
    CHECK(look(1, all) >= 9);
}

TEST_CASE("pairs of forgotten bodies are searched with their present velocities", "[unit]") {
    CollisionWorld w;
    const Index low = w.add_solid(test::ball_mesh(1, 3), w.at({0, 0, 0}), 0.02);
    const Index high = w.add_solid(test::ball_mesh(1, 3), w.at({0, 0, 2.3}), 0.02);
    search(w);
    for (Index n = w.body.nodes[high].begin; n < w.body.nodes[high].end; ++n) w.nodes.velocity[n] = {0, 0, -0.5 / h};
    w.search.forget_body(static_cast<std::size_t>(high));
    search(w);
    REQUIRE(w.pairs.size() == 1);
    CHECK(w.pairs.first[0] == low);
    CHECK_FALSE(w.pairs.candidates[0].empty());
    find_contacts(*w.executor, w.inputs(), w.settings, h, w.pairs, w.crossings, w.contacts);
    CHECK(w.contacts.size() > 0);
}

TEST_CASE("the pair of a body with itself omits neighbours and features nearer than the contact distance at rest",
          "[unit]") {
    CollisionWorld w;
    // A flat body whose two faces are closer than the skin.
    const Index b = w.add_solid(test::box_mesh({6, 6, 1}, {6, 6, 0.3}), w.at(Vec3::Zero()), 0.1);
    w.body.self_contact[b] = 1;
    search(w);
    REQUIRE(w.pairs.size() == 1);
    CHECK(w.pairs.kind[0] == PairKind::self);
    CHECK(w.pairs.candidates[0].size() > 0);
    for (const Candidate& c : w.pairs.candidates[0]) {
        if (is_edge_edge(c.feature)) {
            CHECK(c.first < c.second);
            for (Index m : w.surface.edges.node[c.first])
                for (Index n : w.surface.edges.node[c.second]) CHECK(m != n);
        } else {
            for (Index n : w.surface.triangles.node[c.second]) CHECK(n != w.surface.vertices.node[c.first]);
        }
    }
    // The contact distance exceeds the thickness: the other face is part of the same shell.
    w.body.contact_distance[b] = 0.31;
    w.search.body_valid_until.clear();
    search(w);
    for (const Candidate& c : w.pairs.candidates[0]) {
        if (is_edge_edge(c.feature)) continue;
        const auto& n = w.surface.triangles.node[c.second];
        const auto& x = w.nodes.rest_position;
        CHECK(closest_point_on_triangle(x[w.surface.vertices.node[c.first]], x[n[0]], x[n[1]], x[n[2]])
                  .distance_squared >= 0.31 * 0.31);
    }
}

TEST_CASE("no bodies, or one alone, give no pairs", "[unit]") {
    CollisionWorld w;
    search(w);
    CHECK(w.pairs.size() == 0);
    w.add_solid(test::ball_mesh(1, 2), w.at(Vec3::Zero()), 0.02);
    search(w);
    CHECK(w.pairs.size() == 0);
    CHECK_FALSE(find_contacts(*w.executor, w.inputs(), w.settings, h, w.pairs, w.crossings, w.contacts));
    CHECK(w.contacts.size() == 0);
}

}  // namespace skerry::test::find_candidates_test
