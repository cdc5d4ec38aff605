// Budgets of contact_reach.h must not change results: comparison with a twin that searches everything in each step.
#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <catch2/catch.hpp>
#include <cmath>
#include <cstring>
#include <set>

#include "tests/support/collision_world.h"

namespace skerry::test::budgets_test {

using test::CollisionWorld;

namespace {

constexpr Real h = 2e-3;

/// Balls and boxes in a room with a collider of every shape. They drift at random, also through each other.
struct Room {
    CollisionWorld w;
    test::Random random{41};
    std::vector<Vec3> aim, spin;

    Room() {
        const test::SolidMesh ball = test::ball_mesh(0.5, 3), box = test::box_mesh({2, 2, 2}, {0.7, 0.8, 0.9});
        for (int i = 0; i < 7; ++i) {
            const Vec3 where = 1.2 * random.vector() + Vec3(0, 0, 1.5);
            w.add_solid(i % 2 ? ball : box, w.at(where, random.rotation()), i % 3 ? 0.02 : 0);
            w.body.self_contact[i] = i == 3;
        }
        w.add_collider(ColliderShape::plane, Vec3::Zero(), w.at(Vec3::Zero()));
        const Index sphere = w.add_collider(ColliderShape::sphere, {0.4, 0, 0}, w.at({1, 0, 0.5}));
        w.collider.motion[sphere].velocity = {-0.5, 0.2, 0.1};
        w.add_collider(ColliderShape::bucket, {1.5, 0.5, 0.1}, w.at({0, 0, 0.2}));
        w.add_collider(ColliderShape::box, {0.3, 0.2, 0.25}, w.at({-1, 0.5, 1}, random.rotation()));
        const Index capsule =
            w.add_collider(ColliderShape::capsule, {0.1, 0.4, 0}, w.at({0, -1, 1}, random.rotation()));
        w.collider.motion[capsule].velocity = {0.2, 0.3, 0.1};
        w.add_collider(ColliderShape::cylinder, {0.2, 0.3, 0}, w.at({0.5, 1, 1.4}, random.rotation()));
        const std::vector<Vec3> roof{{-2, -2, 2.2}, {2, -2, 2.2}, {2, 2, 2.2}, {-2, 2, 2.2}};
        w.add_kinematic(roof, {{{0, 2, 1}, no_index}, {{0, 3, 2}, no_index}}, 0.01);
        aim.assign(w.body.slot.size(), Vec3::Zero());
        spin.assign(w.body.slot.size(), Vec3::Zero());
    }

    /// Sets a rigid motion and a tremble of each node; now and then a new course or a rest.
    void steer(int step) {
        for (std::size_t b = 0; b < w.body.slot.size(); ++b) {
            if ((step + 7 * static_cast<int>(b)) % 40 == 0) {
                const bool rests = random.number() < -0.6;
                aim[b] = rests ? Vec3(Vec3::Zero()) : Vec3(3 * random.vector());
                spin[b] = rests ? Vec3(Vec3::Zero()) : Vec3(2 * random.vector());
                // back to the middle of the room
                aim[b] -= w.nodes.position[w.body.nodes[b].begin] - Vec3(0, 0, 1);
                if (w.body.kind[b] == BodyKind::kinematic) aim[b] = Vec3(0, 0, 0.3 * random.number());
            }
            const Range nodes = w.body.nodes[b];
            Vec3 centre = Vec3::Zero();
            for (Index n = nodes.begin; n < nodes.end; ++n) centre += w.nodes.position[n] / nodes.size();
            for (Index n = nodes.begin; n < nodes.end; ++n) {
                w.nodes.velocity[n] = aim[b] + spin[b].cross(w.nodes.position[n] - centre);
                if (w.body.kind[b] == BodyKind::deformable) w.nodes.velocity[n] += 0.1 * random.vector();
            }
        }
    }
};

/// The bits of all columns that find_contacts writes.
std::vector<std::uint64_t> bits(ContactTable& contacts) {
    std::vector<std::uint64_t> all;
    const auto take = [&](const auto& column) {
        for (const auto& row : column) {
            std::vector<std::uint64_t> words((sizeof(row) + 7) / 8, 0);
            std::memcpy(words.data(), &row, sizeof(row));
            all.insert(all.end(), words.begin(), words.end());
        }
    };
    take(contacts.key);
    take(contacts.kind);
    take(contacts.stencil);
    take(contacts.point);
    take(contacts.normal);
    take(contacts.gap);
    take(contacts.distance);
    take(contacts.surface_velocity);
    take(contacts.static_friction);
    take(contacts.first_body);
    take(contacts.second_body);
    take(contacts.collider);
    return all;
}

}  // namespace

TEST_CASE("budgets find exactly the contacts that a search of everything finds, over hundreds of random steps",
          "[unit][long]") {
    const bool frames = GENERATE(false, true);
    CAPTURE(frames);
    Room thrifty, thorough;
    thorough.w.settings.use_budgets = false;
    // Nothing keeps these bodies from passing through each other: a pair that was apart may overlap later.
    thrifty.w.settings.continuous = thorough.w.settings.continuous = false;
    std::size_t contacts = 0, pressed = 0, passed = 0, differing_steps = 0;
    std::array<std::size_t, 5> of_kind{};
    for (int step = 0; step < 600; ++step) {
        thrifty.steer(step);
        thorough.steer(step);
        // A course may change at any moment, so the speeds are those of the step. (In the engine forces are bounded,
        // and the factor speed_safety covers the speed that they add within one step.)
        if (frames && step % 25 == 0) thrifty.w.follow_bodies();
        thrifty.w.measure_speed();
        thorough.w.measure_speed();
        thrifty.w.find(h);
        thorough.w.find(h);
        const bool same = bits(thrifty.w.contacts) == bits(thorough.w.contacts);
        differing_steps += !same;
        if (!same) {
            std::set<std::pair<std::uint64_t, std::uint64_t>> have;
            for (const ContactKey& key : thrifty.w.contacts.key) have.insert({key.pair, key.feature});
            for (std::size_t i = 0; i < thorough.w.contacts.size(); ++i) {
                const ContactKey key = thorough.w.contacts.key[i];
                if (have.count({key.pair, key.feature})) continue;
                UNSCOPED_INFO("step " << step << " missed pair " << std::hex << key.pair << " feature " << key.feature
                                      << " gap " << thorough.w.contacts.gap[i] << " distance "
                                      << thorough.w.contacts.distance[i]);
            }
            REQUIRE(same);
        }
        contacts += thorough.w.contacts.size();
        for (std::size_t i = 0; i < thorough.w.contacts.size(); ++i) {
            pressed += thorough.w.contacts.gap[i] <= 0;
            passed += thorough.w.contacts.distance[i] < 0 && thorough.w.contacts.kind[i] <= ContactKind::edge_edge;
            ++of_kind[static_cast<std::size_t>(thorough.w.contacts.kind[i])];
        }
        thrifty.w.drift(h);
        thorough.w.drift(h);
    }
    INFO("contacts " << contacts << ", gap <= 0 " << pressed << ", overlap between bodies " << passed);
    CHECK(contacts > 10000);
    CHECK(pressed > 5000);
    CHECK(passed > 1000);
    for (const std::size_t count : of_kind) CHECK(count > 500);
    // The budgets must also have saved searches.
    CHECK(thrifty.w.search.broad_searches < 300);
    CHECK(thrifty.w.search.pair_searches * 3 < thorough.w.search.pair_searches);
}

TEST_CASE("features that are held apart are searched within less distance, and all contacts are found", "[unit]") {
    // Balls swing above and below a plate that is thinner than the search depth behind a face.
    struct Swing {
        CollisionWorld w;
        test::Random random{17};
        std::size_t candidates = 0, contacts = 0;

        Swing() {
            w.add_solid(test::box_mesh({4, 4, 1}, {4, 4, 0.1}), w.at({0, 0, -0.05}), 0.02);
            const test::SolidMesh ball = test::ball_mesh(0.5, 3);
            w.add_solid(ball, w.at({-0.4, 0.2, 0.905}, random.rotation()), 0.02);
            w.add_solid(ball, w.at({0.7, 0.2, -1.005}, random.rotation()), 0.02);
        }
        void step(int number) {
            const Real phase = 2 * M_PI * number / 100, speed = -0.2 * 2 * M_PI / (100 * h) * std::sin(phase);
            const std::array<Vec3, 3> aim{Vec3::Zero(), Vec3(0.3, 0.1, speed), Vec3(-0.2, 0.4, -speed)};
            for (std::size_t b = 0; b < aim.size(); ++b)
                for (Index n = w.body.nodes[b].begin; n < w.body.nodes[b].end; ++n)
                    w.nodes.velocity[n] = aim[b] + 0.1 * random.vector();
            if (number % 10 == 0) w.follow_bodies();
            w.measure_speed();
            w.find(h);
            candidates += w.search.candidate_count;
            contacts += w.contacts.size();
        }
    } held, thorough, deep;
    std::size_t test_count = 0;
    thorough.w.settings.use_budgets = false;
    deep.w.settings.continuous = false;
    for (int step = 0; step < 300; ++step) {
        for (Swing* swing : {&held, &thorough, &deep}) swing->step(step);
        REQUIRE(bits(held.w.contacts) == bits(thorough.w.contacts));
        // Bounds that the test for crossings relies on, also for candidates that are asleep again.
        for (std::size_t b = 0; b < held.w.pairs.block_nearest.size(); ++b)
            for (const NearCandidate& near : held.w.pairs.near[b]) {
                REQUIRE(held.w.pairs.block_nearest[b] <= near.distance * (1 + 1e-12));
                ++test_count;
            }
        for (const PairState state : held.w.pairs.state) REQUIRE(state == PairState::apart);
        for (Swing* swing : {&held, &thorough, &deep}) swing->w.drift(h);
    }
    CHECK(held.contacts > 100);
    CHECK(test_count > held.contacts);
    CHECK(10 * held.candidates < 9 * deep.candidates);
}

TEST_CASE("contacts are the same bits on any number of workers", "[unit][determinism]") {
    std::vector<std::vector<std::uint64_t>> found;
    for (int workers : {1, 2, 4}) {
        Room room;
        room.w.executor = make_executor(workers == 1 ? Backend::serial : available_backends().front(), workers);
        std::vector<std::uint64_t> all;
        for (int step = 0; step < 40; ++step) {
            room.steer(step);
            room.w.measure_speed();
            room.w.find(h);
            const auto now = bits(room.w.contacts);
            all.insert(all.end(), now.begin(), now.end());
            room.w.drift(h);
        }
        found.push_back(all);
    }
    REQUIRE(found[0].size() > 1000);
    CHECK(found[0] == found[1]);
    CHECK(found[0] == found[2]);
}

TEST_CASE("removal of other bodies does not change the keys of a contact", "[unit]") {
    const auto keys = [](bool with_other) {
        CollisionWorld w;
        const test::SolidMesh ball = test::ball_mesh(0.5, 2);
        if (with_other)
            w.add_solid(ball, w.at({20, 0, 0}), 0.02);
        else
            ++w.next_slot;  // its slot stays empty
        w.add_solid(ball, w.at(Vec3::Zero()), 0.02);
        w.add_solid(ball, w.at({0, 0, 1}), 0.02);
        w.find(h);
        return std::vector<ContactKey>(w.contacts.key.begin(), w.contacts.key.end());
    };
    REQUIRE(!keys(true).empty());
    CHECK(keys(true) == keys(false));
}

TEST_CASE("a row of pairs in contact needs several blocks, and their contacts come out in key order", "[unit]") {
    CollisionWorld w;
    const test::SolidMesh box = test::box_mesh({4, 4, 4}, {1, 1, 1});
    for (int i = 0; i < 12; ++i) w.add_solid(box, w.at({0, 0, 1.01 * i}), 0.01);
    w.find(h);
    REQUIRE(w.pairs.block.size() > 3);
    CHECK(w.contacts.size() == 11 * 50);
    for (std::size_t i = 1; i < w.contacts.size(); ++i) CHECK(w.contacts.key[i - 1] < w.contacts.key[i]);
}

TEST_CASE("blocks cover all candidates in order, with about a fifth as many of those against a collider", "[unit]") {
    CollisionWorld w;
    const test::SolidMesh slab = test::box_mesh({24, 24, 1}, {4, 4, 0.1});
    w.add_collider(ColliderShape::plane, Vec3::Zero(), w.at({0, 0, -0.055}));
    for (int i = 0; i < 3; ++i) w.add_solid(slab, w.at({0, 0, 0.11 * i}), 0.01);
    w.find(h);
    const std::size_t blocks = w.pairs.block.size() - 1;
    std::size_t seen = 0, most_of_surfaces = 0, most_of_collider = 0;
    for (std::size_t b = 0; b < blocks; ++b) {
        const CandidateIndex begin = w.pairs.block[b], end = w.pairs.block[b + 1];
        std::size_t of_surfaces = 0, of_collider = 0;
        for (Index p = begin.pair; p < static_cast<Index>(w.pairs.size()) && p <= end.pair; ++p) {
            const Index from = p == begin.pair ? begin.candidate : 0;
            const auto all = static_cast<Index>(w.pairs.candidates[static_cast<std::size_t>(p)].size());
            const Index to = p == end.pair ? end.candidate : all;
            REQUIRE((0 <= from && from <= to && to <= all));
            const bool collider = w.pairs.kind[static_cast<std::size_t>(p)] == PairKind::collider;
            (collider ? of_collider : of_surfaces) += static_cast<std::size_t>(to - from);
        }
        seen += of_surfaces + of_collider;
        most_of_surfaces = std::max(most_of_surfaces, of_surfaces);
        most_of_collider = std::max(most_of_collider, of_collider);
    }
    std::size_t all = 0, against_plane = 0;
    for (std::size_t p = 0; p < w.pairs.size(); ++p) {
        all += w.pairs.candidates[p].size();
        if (w.pairs.kind[p] == PairKind::collider) against_plane += w.pairs.candidates[p].size();
    }
    CHECK(seen == all);
    REQUIRE(most_of_surfaces > 1000);
    CHECK(against_plane > most_of_collider);
    CHECK(most_of_collider < most_of_surfaces / 4);
    const CandidateIndex first = w.pairs.block[0], last = w.pairs.block[blocks];
    CHECK((first.pair == 0 && first.candidate == 0));
    CHECK((last.pair == static_cast<Index>(w.pairs.size()) && last.candidate == 0));
}

}  // namespace skerry::test::budgets_test
