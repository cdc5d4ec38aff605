#include "systems/contact/keep_resting_contacts.h"

#include <catch2/catch.hpp>
#include <vector>

namespace skerry::test::keep_resting_contacts_test {

namespace {

/// Bodies 0, 1 and 2, the kinematic body 3 of collider 1, and collider 0, a plane. A pair of bodies a and b has the key
/// 10 a + b, a pair with a collider the key 100 + its number.
struct World {
    std::vector<std::uint8_t> asleep{0, 0, 0, 0};
    std::vector<BodyKind> kind{BodyKind::deformable, BodyKind::deformable, BodyKind::deformable, BodyKind::kinematic};
    std::vector<Index> collider_of_body{no_index, no_index, no_index, 1};
    std::vector<RigidMotion> motion{2, {Vec3::Zero(), Mat3::Identity(), Vec3::Zero(), Vec3::Zero()}};
    std::vector<std::uint64_t> pair;
    std::vector<std::uint8_t> idle;
    ContactTable contacts;
    RestingMemory memory;
    RestingContactTable kept;

    void add(std::uint64_t pair_key, Index first, Index second, Index collider = no_index) {
        const std::size_t row = contacts.size();
        contacts.resize(row + 1);
        contacts.key[row] = {pair_key, row};
        contacts.first_body[row] = first;
        contacts.second_body[row] = second;
        contacts.collider[row] = collider;
        contacts.gap[row] = 1e-4 * static_cast<Real>(row);
        contacts.impulse[row] = Vec3(0, 0, static_cast<Real>(row + 1));
        contacts.region[row] = 7;
    }
    bool step(Real h) {
        return keep_resting_contacts(contacts, {pair, idle, asleep, kind, collider_of_body, motion}, h, memory, kept);
    }
    std::vector<std::uint64_t> pairs_kept() const {
        std::vector<std::uint64_t> found;
        for (const ContactKey& key : kept.contact.key) found.push_back(key.pair);
        return found;
    }
};

}  // namespace

TEST_CASE("contacts are kept when all of their sides rest or stand still", "[unit][contact]") {
    World world;
    world.pair = {1, 12, 100, 101};
    world.idle = {0, 0, 0, 0};
    world.add(1, 0, 1);
    world.add(12, 1, 2);
    world.add(100, 1, no_index, 0);
    world.add(101, 1, 3);
    CHECK_FALSE(world.step(0.1));
    world.asleep = {0, 1, 1, 0};
    CHECK(world.step(0.1));
    CHECK(world.pairs_kept() == std::vector<std::uint64_t>{12, 100, 101});
    CHECK(world.kept.contact.gap[0] == 1e-4);
    CHECK(world.kept.contact.impulse[2] == Vec3(0, 0, 4));
    CHECK(world.kept.contact.region[0] == no_index);
    CHECK(std::vector(world.kept.step.begin(), world.kept.step.end()) == std::vector<Real>(3, 0.1));

    // Contacts with a moving side are searched again and are not kept.
    world.motion[1].velocity = Vec3(0.1, 0, 0);
    CHECK(world.step(0.1));
    CHECK(world.pairs_kept() == std::vector<std::uint64_t>{12, 100});
}

TEST_CASE("contacts are kept until a step tests their pair", "[unit][contact]") {
    World world;
    world.pair = {1, 12, 100};
    world.idle = {0, 0, 0};
    world.add(1, 0, 1);
    world.add(12, 1, 2);
    world.add(12, 1, 2);
    world.add(100, 1, no_index, 0);
    world.asleep = {0, 1, 1, 0};
    REQUIRE(world.step(0.1));
    REQUIRE(world.pairs_kept() == std::vector<std::uint64_t>{12, 12, 100});

    world.idle = {0, 1, 1};
    world.contacts.resize(1);
    CHECK_FALSE(world.step(0.2));  // nothing changes
    CHECK(world.kept.size() == 3);
    world.asleep = {0, 1, 0, 0};  // this step woke 2 but did not search pair 12: the next step starts from its contacts
    CHECK_FALSE(world.step(0.2));
    world.idle = {0, 0, 1};
    world.asleep = {1, 1, 0, 0};  // body 0 has come to rest on body 1
    CHECK(world.step(0.2));
    CHECK(world.pairs_kept() == std::vector<std::uint64_t>{1, 100});
    CHECK(world.kept.step[0] == 0.2);
    CHECK(world.kept.step[1] == 0.1);
    world.pair = {1};  // the other pairs are no longer close
    world.idle = {1};
    world.contacts.resize(0);
    CHECK(world.step(0.2));
    CHECK(world.pairs_kept() == std::vector<std::uint64_t>{1});
    world.asleep = {0, 0, 0, 0};
    world.idle = {0};
    CHECK(world.step(0.2));
    CHECK(world.kept.empty());
}

TEST_CASE("contacts of a step and of resting bodies are shown in one order, each once", "[unit][contact]") {
    World world;
    for (const std::uint64_t pair : {1, 1, 12, 100}) world.add(pair, 0, 1);
    RestingContactTable kept;
    const auto rest = [&](ContactKey key) {
        kept.contact.key.push_back(key);
        kept.step.push_back(1);
    };
    rest({1, 0});  // has just come to rest
    rest({2, 5});
    rest({2, 6});
    rest({12, 2});
    rest({200, 0});
    Column<Index> rows;
    merge_contacts(world.contacts, kept, rows);
    CHECK(std::vector(rows.begin(), rows.end()) == std::vector<Index>{0, 1, ~1, ~2, 2, 3, ~4});
}

}  // namespace skerry::test::keep_resting_contacts_test
