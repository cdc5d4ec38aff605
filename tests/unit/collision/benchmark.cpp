// Timings of the collision stages: unit_collision [.benchmark]
#include <algorithm>
#include <catch2/catch.hpp>
#include <cstdio>
#include <ctime>

#include "systems/collision/search/find_pairs.h"
#include "tests/support/collision_world.h"

namespace skerry::test::collision_benchmark {

namespace {

constexpr Real h = 2e-4;

/// CPU time of this thread [s], because the machine may be shared. The benchmark runs on one worker.
double cpu_time() {
    timespec t;
    clock_gettime(CLOCK_THREAD_CPUTIME_ID, &t);
    return double(t.tv_sec) + 1e-9 * double(t.tv_nsec);
}

/// Shortest time of one call.
template <class F>
double time_of(int repeats, F&& call) {
    double best = 1e9;
    for (int r = 0; r < repeats; ++r) {
        const double start = cpu_time();
        call();
        best = std::min(best, cpu_time() - start);
    }
    return best;
}

/// A cube of balls that just touch, in a corner of planes.
CollisionWorld heap(int side, Real distance) {
    CollisionWorld w;
    const test::SolidMesh ball = test::ball_mesh(0.1, 4);
    test::Random random(3);
    for (int i = 0; i < side; ++i)
        for (int j = 0; j < side; ++j)
            for (int k = 0; k < side; ++k)
                w.add_solid(ball, w.at(distance * Vec3(i, j, k) + Vec3::Constant(0.1005), random.rotation()), 1e-3);
    w.add_collider(ColliderShape::plane, Vec3::Zero(), w.at(Vec3::Zero()));
    Mat3 x, y;
    x << Vec3::UnitY(), Vec3::UnitZ(), Vec3::UnitX();
    y << Vec3::UnitZ(), Vec3::UnitX(), Vec3::UnitY();
    w.add_collider(ColliderShape::plane, Vec3::Zero(), w.at(Vec3::Zero(), x));
    w.add_collider(ColliderShape::plane, Vec3::Zero(), w.at(Vec3::Zero(), y));
    return w;
}

}  // namespace

TEST_CASE("figures of the collision stages", "[.benchmark]") {
    for (int side : {2, 5}) {
        CollisionWorld w = heap(side, 0.196);
        for (std::size_t b = 0; b < w.body.slot.size(); ++b) w.body.max_speed[b] = w.body.frame_speed[b] = 0.2;
        const auto afresh = [&] {
            w.search.body_valid_until.clear();
            find_candidates(*w.executor, w.inputs(), w.settings, h, w.bvh.box, w.search, w.pairs);
        };
        const double search = time_of(20, afresh);
        const auto expire = [&] {
            for (std::size_t p = 0; p < w.pairs.size(); ++p) w.pairs.valid_until[p] = -1;
            find_candidates(*w.executor, w.inputs(), w.settings, h, w.bvh.box, w.search, w.pairs);
        };
        const double narrow = time_of(20, expire);
        const double check = time_of(
            200, [&] { find_candidates(*w.executor, w.inputs(), w.settings, h, w.bvh.box, w.search, w.pairs); });
        const auto contacts = [&] {
            find_contacts(*w.executor, w.inputs(), w.settings, h, w.pairs, w.crossings, w.contacts);
        };
        contacts();
        const double awake_some = time_of(200, contacts);
        for (auto& column : w.pairs.asleep_until) std::fill(column.begin(), column.end(), 1e9);
        const double asleep = time_of(200, contacts);
        const double awake_all = time_of(50, [&] {
            for (auto& column : w.pairs.asleep_until) std::fill(column.begin(), column.end(), -1e9);
            contacts();
        });
        std::size_t awake = 0, awake_edges = 0, listed = w.search.candidate_count, busy = 0;
        for (std::size_t p = 0; p < w.pairs.size(); ++p) {
            busy += !w.pairs.candidates[p].empty();
            for (std::size_t c = 0; c < w.pairs.candidates[p].size(); ++c) {
                const bool now = !(w.pairs.travel_bound[p] < w.pairs.asleep_until[p][c]);
                awake += now;
                awake_edges += now && w.pairs.candidates[p][c].feature >> 63;
            }
        }
        const double balls = double(w.body.slot.size()), pairs = double(w.pairs.size());
        std::printf(
            "%3.0f balls, %zu pairs (%zu with candidates), %zu candidates, %zu awake (%zu edges), %zu contacts\n",
            balls, w.pairs.size(), busy, listed, awake, awake_edges, w.contacts.size());
        std::printf("  all afresh %.1f us a pair; pairs again %.1f us a pair, %.1f us a pair with candidates\n",
                    search / pairs * 1e6, narrow / pairs * 1e6, narrow / double(busy) * 1e6);
        std::printf("  find_candidates, nothing expired: %.0f ns a ball\n", check / balls * 1e9);
        std::printf(
            "  find_contacts: all asleep %.2f ns a candidate (%.0f ns a ball), all awake %.1f ns a candidate, as it is "
            "%.0f ns a ball\n",
            asleep / double(listed) * 1e9, asleep / balls * 1e9, awake_all / double(listed) * 1e9,
            awake_some / balls * 1e9);
    }
}

TEST_CASE("figures of broad searches", "[.benchmark]") {
    const test::SolidMesh box = test::box_mesh({3, 3, 3}, {0.1, 0.1, 0.1});
    for (const int side : {10, 20, 30}) {
        CollisionWorld w;
        test::Random random(3);
        for (int i = 0; i < side; ++i)
            for (int j = 0; j < side; ++j)
                for (int k = 0; k < side; ++k) w.add_solid(box, w.at(0.13 * Vec3(i, j, k), random.rotation()), 1e-3);
        w.search.memory.body_travel_bound.resize(w.body.slot.size());
        w.search.memory.body_reach.resize(w.body.slot.size());
        w.search.memory.body_forgotten.assign(w.body.slot.size(), 0);
        const double broad = time_of(3, [&] { find_pairs(*w.executor, w.inputs(), w.settings, h, w.search, w.pairs); });
        const double bodies = double(w.body.slot.size()), pairs = double(w.pairs.size());
        std::printf("%6.0f boxes, %.1f pairs each: %6.0f us, %4.0f ns a box\n", bodies, pairs / bodies, broad * 1e6,
                    broad / bodies * 1e9);
    }
}

TEST_CASE("figures of a fall", "[.benchmark]") {
    CollisionWorld w = heap(5, 0.23);
    test::Random random(7);
    for (std::size_t b = 0; b < w.body.slot.size(); ++b) {
        const Vec3 v = 2 * random.vector();
        for (Index n = w.body.nodes[b].begin; n < w.body.nodes[b].end; ++n) w.nodes.velocity[n] = v;
    }
    w.measure_speed();
    constexpr int steps = 300;
    double candidates = 0, contacts = 0;
    std::size_t found = 0;
    for (int s = 0; s < steps; ++s) {
        const double t0 = cpu_time();
        find_candidates(*w.executor, w.inputs(), w.settings, h, w.bvh.box, w.search, w.pairs);
        const double t1 = cpu_time();
        find_contacts(*w.executor, w.inputs(), w.settings, h, w.pairs, w.crossings, w.contacts);
        const double t2 = cpu_time();
        if (s > 0) {
            candidates += t1 - t0;
            contacts += t2 - t1;
        }
        found += w.contacts.size();
        w.drift(h);
    }
    std::printf(
        "fall of %zu balls at 2 m/s: find_candidates %.2f us, find_contacts %.2f us a ball and step; %zu broad, %zu "
        "pair searches in %d "
        "steps; %.0f contacts a step\n",
        w.body.slot.size(), candidates / steps / double(w.body.slot.size()) * 1e6,
        contacts / steps / double(w.body.slot.size()) * 1e6, std::size_t(w.search.broad_searches),
        std::size_t(w.search.pair_searches), steps, double(found) / steps);
}

}  // namespace skerry::test::collision_benchmark
