#include "systems/contact/match_warm_start.h"

#include <Eigen/Geometry>
#include <catch2/catch.hpp>
#include <cmath>
#include <memory>
#include <random>
#include <vector>

namespace skerry::test::match_warm_start_test {

namespace {

ContactKey key(std::uint64_t feature) {
    return {7, feature};
}
const std::unique_ptr<Executor> serial = make_executor(Backend::serial, 1);

}  // namespace

TEST_CASE("impulses follow their contacts when others appear and vanish", "[unit][contact]") {
    const std::vector<ContactKey> before{key(10), key(20), key(30), key(40)};
    const std::vector<Vec3> normal(4, Vec3::UnitZ());
    const std::vector<Vec3> impulse{{0, 0, 1}, {0, 0, 2}, {0, 1, 3}, {0, 0, 4}};
    WarmStartTable last;
    store_warm_start(*serial, {before, normal, impulse}, 0.1, last);

    const std::vector<ContactKey> now{key(5), key(10), key(25), key(30), key(50)};  // no 20, 40; new 5, 25, 50
    std::vector<Vec3> matched(5, Vec3::Ones());
    CHECK(match_warm_start(*serial, now, std::vector<Vec3>(5, Vec3::UnitZ()), last, {}, 0.1, matched));
    CHECK(matched == std::vector<Vec3>{{0, 0, 0}, {0, 0, 1}, {0, 0, 0}, {0, 1, 3}, {0, 0, 0}});
}

TEST_CASE("keys differ by the pair before the feature", "[unit][contact]") {
    WarmStartTable last;
    store_warm_start(*serial,
                     {std::vector<ContactKey>{{1, 9}, {2, 3}}, std::vector<Vec3>(2, Vec3::UnitX()),
                      std::vector<Vec3>{{1, 0, 0}, {2, 0, 0}}},
                     1, last);
    std::vector<Vec3> matched(3);
    match_warm_start(*serial, std::vector<ContactKey>{{1, 3}, {2, 3}, {2, 9}}, std::vector<Vec3>(3, Vec3::UnitX()),
                     last, {}, 1, matched);
    CHECK(matched == std::vector<Vec3>{{0, 0, 0}, {2, 0, 0}, {0, 0, 0}});
}

TEST_CASE("a contact that was not in the last step starts from its impulse before rest", "[unit][contact]") {
    WarmStartTable last;
    const auto ups = [](std::size_t count) { return std::vector<Vec3>(count, Vec3::UnitZ()); };
    store_warm_start(
        *serial, {std::vector<ContactKey>{{1, 1}, {4, 1}}, ups(2), std::vector<Vec3>{{1, 0, 0}, {4, 0, 0}}}, 1, last);
    RestingContactTable resting;
    resting.contact.resize(3);
    const std::vector<ContactKey> rest{{1, 1}, {2, 1}, {2, 2}};  // the pair of the first has been searched again since
    for (std::size_t row = 0; row < rest.size(); ++row) {
        resting.contact.key[row] = rest[row];
        resting.contact.normal[row] = Vec3::UnitZ();
        resting.contact.impulse[row] = Vec3(0, 0, 10 + static_cast<Real>(row));
        resting.step.push_back(0.25 * static_cast<Real>(row + 1));
    }
    std::vector<Vec3> matched(4);
    const std::vector<ContactKey> now{{1, 1}, {2, 1}, {2, 2}, {3, 1}};
    CHECK(match_warm_start(*serial, now, ups(4), last, resting, 0.5, matched));
    CHECK(matched == std::vector<Vec3>{{0.5, 0, 0}, {0, 0, 11}, {0, 0, 0.5 / 0.75 * 12}, {0, 0, 0}});
    CHECK(match_warm_start(*serial, now, ups(4), {}, resting, 0.5, matched));
    CHECK(matched[0] == Vec3(0, 0, 20));
}

TEST_CASE("an impulse turns with its normal and keeps its place in the cone", "[unit][contact]") {
    std::mt19937 random(4);
    std::normal_distribution<Real> normal_number;
    for (int trial = 0; trial < 200; ++trial) {
        const Vec3 from = Vec3(normal_number(random), normal_number(random), normal_number(random)).normalized();
        const Vec3 to =
            (from + 0.5 * Vec3(normal_number(random), normal_number(random), normal_number(random))).normalized();
        if (from.dot(to) < -0.99) continue;
        const Vec3 impulse(normal_number(random), normal_number(random), normal_number(random));
        WarmStartTable last;
        store_warm_start(*serial, {std::vector{key(1)}, std::vector{from}, std::vector{impulse}}, 0.2, last);
        std::vector<Vec3> matched(1);
        match_warm_start(*serial, std::vector{key(1)}, std::vector{to}, last, {}, 0.1, matched);
        const Vec3 expected = 0.5 * (Eigen::AngleAxisd(std::acos(from.dot(to)), from.cross(to).normalized()) * impulse);
        REQUIRE((matched[0] - expected).norm() < 1e-7 * impulse.norm());  // acos loses half the digits near 0
        REQUIRE(matched[0].dot(to) == Approx(0.5 * impulse.dot(from)).margin(1e-14));
    }
}

TEST_CASE("a normal that flipped carries nothing over", "[unit][contact]") {
    WarmStartTable last;
    store_warm_start(*serial, {std::vector{key(1)}, std::vector<Vec3>{Vec3::UnitZ()}, std::vector<Vec3>{Vec3::UnitZ()}},
                     1, last);
    std::vector<Vec3> matched(1, Vec3::Ones());
    match_warm_start(*serial, std::vector{key(1)}, std::vector<Vec3>{-Vec3::UnitZ()}, last, {}, 1, matched);
    CHECK(matched[0] == Vec3::Zero());
}

TEST_CASE("without a last step all impulses start at zero and the stage is skipped", "[unit][contact]") {
    std::vector<Vec3> matched(2, Vec3::Ones());
    CHECK_FALSE(match_warm_start(*serial, std::vector{key(1), key(2)}, std::vector<Vec3>(2, Vec3::UnitZ()), {}, {}, 1,
                                 matched));
    CHECK(matched == std::vector<Vec3>(2, Vec3::Zero()));
    CHECK_FALSE(match_warm_start(*serial, {}, {}, {}, {}, 1, {}));
}

TEST_CASE("matching many contacts gives the same on any number of workers", "[unit][contact][determinism]") {
    std::vector<ContactKey> before, now;
    for (std::uint64_t f = 0; f < 20000; ++f) {
        if (f % 3 != 0) before.push_back(key(f));
        if (f % 5 != 0) now.push_back(key(f));
    }
    std::vector<Vec3> impulse(before.size());
    for (std::size_t i = 0; i < before.size(); ++i) impulse[i] = Vec3(0, 0, static_cast<Real>(before[i].feature));
    WarmStartTable last;
    store_warm_start(*serial, {before, std::vector<Vec3>(before.size(), Vec3::UnitZ()), impulse}, 1, last);
    for (const int workers : {1, 2, 3, 8}) {
        std::vector<Vec3> matched(now.size());
        const auto executor = make_executor(Backend::threads, workers);
        match_warm_start(*executor, now, std::vector<Vec3>(now.size(), Vec3::UnitZ()), last, {}, 1, matched);
        for (std::size_t i = 0; i < now.size(); ++i)
            REQUIRE(matched[i].z() == (now[i].feature % 3 == 0 ? 0 : static_cast<Real>(now[i].feature)));
    }
}

namespace {

/// Contacts of one pair: body 0 with body 1, which is rigid unless a test makes its nodes move independently.
struct Stacked {
    std::vector<ContactKey> key;
    std::vector<Vec3> normal, point;
    std::vector<Index> first, second;
    std::vector<Range> rigid{{0, 0}, {0, 1}};
    std::vector<Real> distance{0.01, 0.01};

    void add(ContactKey of, const Vec3& at, const Vec3& along = Vec3::UnitZ()) {
        key.push_back(of);
        normal.push_back(along);
        point.push_back(at);
        first.push_back(0);
        second.push_back(1);
    }
    ContactsNow now() const { return {key, normal, point, first, second, rigid, distance}; }
};

}  // namespace

TEST_CASE("the impulse of a vanished contact goes to the nearest contact of its pair", "[unit][contact]") {
    Stacked before, after;
    for (std::uint64_t f : {1, 2, 3, 4, 5}) before.add(key(f), {0.1 * static_cast<Real>(f), 0, 0});
    before.add({9, 1}, {0.1, 0, 0});
    WarmStartTable last;
    const std::vector<Vec3> impulse{{0, 0, 1}, {0, 0.5, 2}, {0, 0, 4}, {0, 0, 8}, {0, 0, 16}, {0, 0, 32}};
    store_warm_start(*serial, {before.key, before.normal, impulse, before.point}, 0.2, last);

    after.add(key(1), {0.1, 0, 0});
    after.add(key(6), {0.205, 0, 0});                // replaces 2, and is nearer to it than 8
    after.add(key(7), {0.3, 0, 0}, -Vec3::UnitZ());  // at the place of 3, but on the other side
    after.add(key(8), {0.21, 0, 0});
    after.add(key(9), {0.421, 0, 0});                    // further from 4 than twice the contact distance
    after.add(key(10), {0.5, 0.001, 0}, {0, 0.6, 0.8});  // about where 5 was, but turned by too much
    std::vector<Vec3> matched(6, Vec3::Zero());
    matched[0] = {0, 0, 0.5};
    matched[1] = {1, 0, 0};
    CHECK(hand_on_impulses(*serial, after.now(), last, 0.1, matched));
    const std::vector<Vec3> expected{{0, 0, 0.5}, {1, 0.25, 1}, {0, 0, 0}, {0, 0, 0}, {0, 0, 0}, {0, 0, 0}};
    CHECK(matched == expected);

    SECTION("turned with the normal") {
        after.normal[1] = Vec3(0, 0.28, 0.96);
        std::fill(matched.begin(), matched.end(), Vec3::Zero());
        hand_on_impulses(*serial, after.now(), last, 0.2, matched);
        CHECK(matched[1].dot(after.normal[1]) == Approx(2));
        CHECK(matched[1].norm() == Approx(std::hypot(0.5, 2)));
    }
    SECTION("not between bodies that move node by node") {
        after.rigid[1] = {0, 0};
        std::fill(matched.begin(), matched.end(), Vec3::Zero());
        hand_on_impulses(*serial, after.now(), last, 0.1, matched);
        CHECK(matched == std::vector<Vec3>(6, Vec3::Zero()));
    }
    SECTION("a step whose places were not kept has nothing to hand on") {
        store_warm_start(*serial, {before.key, before.normal, impulse}, 0.2, last);
        CHECK_FALSE(hand_on_impulses(*serial, after.now(), last, 0.1, matched));
        CHECK(matched == expected);
    }
}

TEST_CASE("handing on gives the same on any number of workers", "[unit][contact][determinism]") {
    std::mt19937 random(8);
    std::uniform_real_distribution<Real> number(0, 0.05);
    Stacked before, after;
    std::vector<Vec3> impulse;
    for (std::uint64_t pair = 0; pair < 300; ++pair)
        for (std::uint64_t f = 0; f < 3 + pair % 50; ++f) {
            const Vec3 at(number(random), number(random), 0);
            if (random() % 4 != 0) {
                before.add({pair, f}, at);
                impulse.emplace_back(number(random), number(random), 1);
            }
            if (random() % 4 != 0) after.add({pair, f}, at);
        }
    WarmStartTable last;
    store_warm_start(*serial, {before.key, before.normal, impulse, before.point}, 1, last);
    std::vector<Vec3> expected;
    for (const int workers : {1, 2, 3, 8}) {
        std::vector<Vec3> matched(after.key.size(), Vec3::Zero());
        const auto executor = make_executor(Backend::threads, workers);
        CHECK(hand_on_impulses(*executor, after.now(), last, 1, matched));
        if (workers == 1) {
            expected = matched;
            // The contacts fill more than one block, and most of the vanished ones have found a neighbour.
            REQUIRE(before.key.size() > 5000);
            Real carried = 0;
            for (const Vec3& r : matched) carried += r.z();
            CHECK(carried > 500);
        }
        CHECK(matched == expected);
    }
}

}  // namespace skerry::test::match_warm_start_test
