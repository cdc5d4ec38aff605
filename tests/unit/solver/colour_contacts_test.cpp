#include "systems/solver/coloured/colour_contacts.h"

#include <catch2/catch.hpp>
#include <random>
#include <set>
#include <vector>

namespace skerry::test::colour_contacts_test {

namespace {

ContactNodes nodes(Index a, Index b = no_index, Index c = no_index, Index d = no_index) {
    return {a, b, c, d};
}

ColouredOrder coloured(const std::vector<ContactNodes>& contact, Index node_count) {
    ColouringMemory memory;
    ColouredOrder order;
    colour_contacts(contact, node_count, memory, order);
    return order;
}

/// Checks that every contact occurs once, blocks of a phase share no node, and phases and blocks cover all places.
void check_proper(const std::vector<ContactNodes>& contact, const ColouredOrder& order) {
    REQUIRE(order.contact.size() == contact.size());
    std::vector<int> times(contact.size(), 0);
    for (const Index k : order.contact) ++times.at(static_cast<std::size_t>(k));
    REQUIRE(std::count(times.begin(), times.end(), 1) == static_cast<std::ptrdiff_t>(contact.size()));

    REQUIRE(order.phase_offset[0] == 0);
    REQUIRE(order.block_offset[0] == 0);
    REQUIRE(order.block_offset.back() == static_cast<Index>(contact.size()));
    REQUIRE(order.phase_offset.back() + 1 == static_cast<Index>(order.block_offset.size()));
    for (std::size_t phase = 0; phase + 1 < order.phase_offset.size(); ++phase) {
        REQUIRE(order.phase_offset[phase] < order.phase_offset[phase + 1]);
        std::set<Index> earlier;
        for (Index block = order.phase_offset[phase]; block < order.phase_offset[phase + 1]; ++block) {
            REQUIRE(order.block_offset[block] < order.block_offset[block + 1]);
            std::set<Index> own;
            for (Index place = order.block_offset[block]; place < order.block_offset[block + 1]; ++place)
                for (const Index node : contact[static_cast<std::size_t>(order.contact[place])])
                    if (node != no_index) own.insert(node);
            for (const Index node : own) REQUIRE(earlier.insert(node).second);
        }
    }
}

/// Triangles of one strip against the points of another, and vice versa.
std::vector<ContactNodes> strips(int length, unsigned seed) {
    std::mt19937 random(seed);
    std::vector<ContactNodes> contact;
    for (int i = 0; i + 2 < length; ++i) {
        const Index near = std::min<Index>(length - 3, i + static_cast<Index>(random() % 2));
        contact.push_back(nodes(i, length + near, length + near + 1, length + near + 2));
        contact.push_back(nodes(length + i, near, near + 1, near + 2));
    }
    return contact;
}

}  // namespace

TEST_CASE("the order of contacts that share nodes is proper, and no node is twice in a colour", "[unit][solver]") {
    for (unsigned seed = 0; seed < 6; ++seed) {
        const int length = 40 << seed;
        const std::vector<ContactNodes> contact = strips(length, seed);
        const ColouredOrder order = coloured(contact, 2 * length);
        check_proper(contact, order);
        CHECK(order.hub_phase_count == 0);
        for (Index phase = 0; phase < order.colour_count; ++phase) {
            std::set<Index> seen;
            const Index begin = order.block_offset[order.phase_offset[phase]],
                        end = order.block_offset[order.phase_offset[phase + 1]];
            CHECK(end - begin >= smallest_colour);
            for (Index place = begin; place < end; ++place)
                for (const Index node : contact[static_cast<std::size_t>(order.contact[place])])
                    REQUIRE(seen.insert(node).second);
        }
        if (seed == 5) {
            CHECK(order.colour_count >= 4);  // some nodes are in four contacts or more
            CHECK(order.tail_size < 200);
        }
    }
}

TEST_CASE("no contact, one contact and contacts without a node have an order", "[unit][solver]") {
    CHECK(coloured({}, 0).phase_offset.back() == 0);
    const std::vector<ContactNodes> one{nodes(0)};
    check_proper(one, coloured(one, 1));
    const std::vector<ContactNodes> fixed(500, nodes(no_index));
    check_proper(fixed, coloured(fixed, 0));
    CHECK(coloured(fixed, 0).colour_count == 1);
}

TEST_CASE("a contact may name a node twice", "[unit][solver]") {
    std::vector<ContactNodes> contact;
    for (Index i = 0; i < 300; ++i) contact.push_back(nodes(i, i, (i + 1) % 300, i));
    check_proper(contact, coloured(contact, 300));
}

TEST_CASE("a node with hundreds of contacts has one block for them, in their order", "[unit][solver]") {
    std::vector<ContactNodes> contact;
    // Three hubs; every contact has its own point.
    for (Index i = 0; i < 700; ++i) contact.push_back(nodes(i + 3, i % 3));
    for (Index i = 0; i < 700; ++i) contact.push_back(nodes(i + 3));
    const ColouredOrder order = coloured(contact, 703);
    check_proper(contact, order);
    CHECK(order.colour_count == 1);
    CHECK(order.hub_phase_count == 1);  // the hubs share no point: all three are side by side
    CHECK(order.tail_size == 0);
    const Index first = order.phase_offset[1];
    CHECK(order.phase_offset[2] - first == 3);
    for (Index place = order.block_offset[first] + 1; place < order.block_offset[first + 1]; ++place)
        CHECK(order.contact[place] == order.contact[place - 1] + 3);
}

TEST_CASE("hubs that meet are not side by side", "[unit][solver]") {
    std::vector<ContactNodes> contact;
    for (Index i = 0; i < 400; ++i) contact.push_back(nodes(10 + i, i % 9, i % 9 + 1));  // a chain of ten hubs
    const ColouredOrder order = coloured(contact, 410);
    check_proper(contact, order);
    CHECK(order.hub_phase_count == 2);
    CHECK(order.tail_size == 0);
}

TEST_CASE("contacts without a free one of 64 colours go to the tail", "[unit][solver]") {
    // The 13 lines of the projective plane of order 3, each eight times. Any two lines share one of the 13 points, and
    // no point is in more than 32 of them.
    std::vector<ContactNodes> contact;
    constexpr Index planes = 70;
    for (Index plane = 0; plane < planes; ++plane)
        for (Index k = 0; k < 8 * 13; ++k) {
            ContactNodes line{0, 1, 3, 9};
            for (Index& node : line) node = 13 * plane + (node + k) % 13;
            contact.push_back(line);
        }
    const ColouredOrder order = coloured(contact, 13 * planes);
    check_proper(contact, order);
    CHECK(order.colour_count == 64);
    CHECK(order.hub_phase_count == 0);
    CHECK(order.tail_size == planes * (8 * 13 - 64));
    for (std::size_t place = contact.size() - static_cast<std::size_t>(order.tail_size) + 1; place < contact.size();
         ++place)
        REQUIRE(order.contact[place] > order.contact[place - 1]);
}

TEST_CASE("the order depends on the contacts alone, not on earlier contents of the memory", "[determinism][solver]") {
    ColouringMemory memory;
    ColouredOrder order;
    for (const int length : {3000, 100, 2000, 3000}) {
        const std::vector<ContactNodes> contact = strips(length, 3);
        colour_contacts(contact, 2 * length, memory, order);
        const ColouredOrder fresh = coloured(contact, 2 * length);
        CHECK(std::equal(order.contact.begin(), order.contact.end(), fresh.contact.begin(), fresh.contact.end()));
        CHECK(std::equal(order.block_offset.begin(), order.block_offset.end(), fresh.block_offset.begin(),
                         fresh.block_offset.end()));
        CHECK(std::equal(order.phase_offset.begin(), order.phase_offset.end(), fresh.phase_offset.begin(),
                         fresh.phase_offset.end()));
    }
}

}  // namespace skerry::test::colour_contacts_test
