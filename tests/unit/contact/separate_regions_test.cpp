#include "systems/contact/separate_regions.h"

#include <algorithm>
#include <catch2/catch.hpp>
#include <limits>
#include <memory>
#include <random>
#include <set>
#include <vector>

#include "profiling/lab/algorithm_1.h"
#include "tests/unit/jobs/executors.h"

namespace skerry::test::separate_regions_test {

namespace {

/// An executor with one worker.
Executor& in_order() {
    static const std::unique_ptr<Executor> executor = make_executor(Backend::serial, 1);
    return *executor;
}

/// A contact that touches these nodes.
Stencil touching(std::vector<Index> nodes) {
    Stencil stencil{{nodes[0], nodes[0], nodes[0], nodes[0]}, {0, 0, 0, 0}};
    for (std::size_t a = 0; a < nodes.size(); ++a) {
        stencil.node[a] = nodes[a];
        stencil.weight[a] = a == 0 ? 1 : -1.0 / static_cast<Real>(nodes.size() - 1);
    }
    return stencil;
}

struct Separated {
    RegionTable regions;
    std::vector<Index> region;
    bool ran;
};

Separated separate(const std::vector<Stencil>& stencil, const std::vector<Real>& inverse_mass, ContactRegions mode) {
    Separated result;
    SeparationMemory memory;
    result.region.resize(stencil.size());
    result.ran =
        separate_regions(in_order(), stencil, inverse_mass, NodeGroups{}, mode, memory, result.regions, result.region);
    return result;
}

/// Separates the regions with Algorithm 1 of the paper.
std::vector<Index> areas_of_the_paper(const std::vector<Stencil>& stencil, const std::vector<Real>& inverse_mass) {
    std::vector<Index> area(stencil.size());
    lab::label_by_algorithm_1(stencil, inverse_mass, area);
    return area;
}

/// Flood fill over pairs of contacts, numbered by the first contact: the definition of regions, in O(K^2).
std::vector<Index> flood_fill(const std::vector<Stencil>& stencil, const std::vector<Real>& inverse_mass) {
    const auto moving = [&](const Stencil& s) {
        std::set<Index> nodes;
        for (std::size_t a = 0; a < 4; ++a)
            if (s.weight[a] != 0 && inverse_mass[static_cast<std::size_t>(s.node[a])] > 0) nodes.insert(s.node[a]);
        return nodes;
    };
    std::vector<Index> region(stencil.size(), no_index);
    Index count = 0;
    for (std::size_t start = 0; start < stencil.size(); ++start) {
        if (region[start] != no_index || moving(stencil[start]).empty()) continue;
        std::vector<std::size_t> open{start};
        region[start] = count;
        while (!open.empty()) {
            const std::set<Index> here = moving(stencil[open.back()]);
            open.pop_back();
            for (std::size_t j = 0; j < stencil.size(); ++j) {
                if (region[j] != no_index) continue;
                for (const Index node : moving(stencil[j]))
                    if (here.count(node)) {
                        region[j] = count;
                        open.push_back(j);
                        break;
                    }
            }
        }
        ++count;
    }
    return region;
}

std::vector<Stencil> random_stencils(std::mt19937& random, int contacts, int nodes) {
    std::uniform_int_distribution<Index> pick(0, nodes - 1);
    std::uniform_int_distribution<int> size(1, 4);
    std::vector<Stencil> stencil;
    for (int i = 0; i < contacts; ++i) {
        std::vector<Index> chosen(static_cast<std::size_t>(size(random)));
        for (Index& node : chosen) node = pick(random);
        stencil.push_back(touching(chosen));
    }
    return stencil;
}

}  // namespace

TEST_CASE("union-find finds the regions of a flood fill on random sets", "[unit][contact]") {
    std::mt19937 random(20100301);
    for (int trial = 0; trial < 300; ++trial) {
        const int contacts = 1 + trial % 40;
        const std::vector<Stencil> stencil = random_stencils(random, contacts, 10 + contacts * (1 + trial % 5));
        std::vector<Real> inverse_mass(10 + static_cast<std::size_t>(contacts) * 5, 1);
        for (Real& m : inverse_mass) m = random() % 4 == 0 ? 0 : 1;
        const Separated result = separate(stencil, inverse_mass, ContactRegions::separate);
        REQUIRE(result.region == flood_fill(stencil, inverse_mass));
        REQUIRE(lab::count_shared_nodes(stencil, inverse_mass, result.region) == 0);
        for (std::size_t r = 0; r < result.regions.size(); ++r) {
            const auto rows = result.regions.contacts[r];
            REQUIRE(std::is_sorted(rows.begin(), rows.end()));
            for (const Index i : rows) REQUIRE(result.region[static_cast<std::size_t>(i)] == static_cast<Index>(r));
        }
    }
}

TEST_CASE("the memory of one step does not leak into the next", "[unit][contact]") {
    SeparationMemory memory;
    RegionTable regions;
    const std::vector<Real> inverse_mass(8, 1);
    std::vector<Index> region(2);
    const std::vector<Stencil> joined{touching({1, 2}), touching({2, 3})}, apart{touching({1, 2}), touching({3, 4})};
    separate_regions(in_order(), joined, inverse_mass, NodeGroups{}, ContactRegions::separate, memory, regions, region);
    CHECK(regions.size() == 1);
    separate_regions(in_order(), apart, inverse_mass, NodeGroups{}, ContactRegions::separate, memory, regions, region);
    CHECK(region == std::vector<Index>{0, 1});
    memory.sets.now = std::numeric_limits<std::uint32_t>::max();  // all stamps are used
    separate_regions(in_order(), apart, inverse_mass, NodeGroups{}, ContactRegions::separate, memory, regions, region);
    CHECK(region == std::vector<Index>{0, 1});
}

/// A pile: pairs of bodies with some contacts each between neighbouring nodes, in the order of the pairs. Some nodes
/// are held, some contacts have no moving node, and now and then a chain passes through many bodies.
struct PileOfContacts {
    static constexpr Index nodes_per_body = 40;
    std::vector<Stencil> stencil;
    std::vector<Real> inverse_mass;

    PileOfContacts(std::mt19937& random, int pairs, int bodies) {
        const auto pick = [&](Index count) { return static_cast<Index>(random() % static_cast<unsigned>(count)); };
        inverse_mass.resize(static_cast<std::size_t>(bodies * nodes_per_body));
        for (Real& m : inverse_mass) m = pick(10) == 0 ? 0 : 1;
        for (int pair = 0; pair < pairs; ++pair) {
            const Index first = pair * bodies / pairs, second = pick(bodies);
            const Index place = pick(nodes_per_body - 4), beside = pick(nodes_per_body - 4);
            for (Index contact = pick(9); contact > 0; --contact) {
                const Index at = first * nodes_per_body + place + pick(3);
                const Index to = second * nodes_per_body + beside;
                stencil.push_back(touching({at, to + pick(4), to + pick(4)}));
                if (pick(8) == 0) stencil.back().weight[static_cast<std::size_t>(pick(3))] = 0;
                if (pick(40) == 0) stencil.push_back(touching({at, pick(bodies) * nodes_per_body}));
            }
        }
    }
};

/// Groups for the nodes of a pile: none; or some rigid bodies with joints between them and to the world; or clusters of
/// some nodes of other bodies.
struct GroupsOfPile {
    std::vector<Index> node_body;
    std::vector<Range> body_nodes, body_rigid;
    std::vector<JointBlock> joints;
    NodeClusters clusters;

    explicit GroupsOfPile(Index bodies) {
        for (Index b = 0; b < bodies; ++b) {
            const Index first = b * PileOfContacts::nodes_per_body;
            body_nodes.push_back({first, first + PileOfContacts::nodes_per_body});
            node_body.insert(node_body.end(), PileOfContacts::nodes_per_body, b);
        }
    }

    NodeGroups rigid(std::mt19937& random) {
        const auto bodies = static_cast<Index>(body_nodes.size());
        for (Index b = 0; b < bodies; ++b) body_rigid.push_back(b % 5 == 0 ? Range{b / 5, b / 5 + 1} : Range{0, 0});
        for (Index b = 0; b + 10 < bodies; b += 10) {
            if (random() % 2 == 0) continue;
            JointBlock block{};
            block.first_node = b * PileOfContacts::nodes_per_body;
            block.second_node = random() % 3 == 0 ? no_index : (b + 10) * PileOfContacts::nodes_per_body;
            joints.insert(random() % 2 == 0 ? joints.begin() : joints.end(), block);
        }
        return {.rigid = {node_body, body_nodes, body_rigid}, .joints = joints};
    }

    NodeGroups clustered() {
        clusters.cluster_of.resize(node_body.size(), no_index);
        clusters.nodes.offset.push_back(0);
        for (std::size_t b = 1; b < body_nodes.size(); b += 3) {
            for (Index node = body_nodes[b].begin; node < body_nodes[b].begin + 12; node += 3) {
                clusters.cluster_of[node] = static_cast<Index>(clusters.body.size());
                clusters.nodes.item.push_back(node);
            }
            clusters.nodes.offset.push_back(static_cast<Index>(clusters.nodes.item.size()));
            clusters.body.push_back(static_cast<Index>(b));
        }
        return {.clusters = &clusters};
    }
};

void check_same(const RegionTable& regions, const RegionTable& twin) {
    CHECK(std::ranges::equal(regions.contacts.offset, twin.contacts.offset));
    CHECK(std::ranges::equal(regions.contacts.item, twin.contacts.item));
    CHECK(std::ranges::equal(regions.joints.offset, twin.joints.offset));
    CHECK(std::ranges::equal(regions.joints.item, twin.joints.item));
    CHECK(regions.iterations.size() == twin.iterations.size());
}

TEST_CASE("many contacts are separated in blocks as in order", "[unit][contact][determinism][long]") {
    std::mt19937 random(14);
    SeparationMemory in_order_memory, memory;  // one for all trials: nothing of the previous step may remain
    RegionTable regions, twin;
    std::uint32_t in_blocks = 0;
    for (int trial = 0; trial < 60; ++trial) {
        INFO("trial " << trial);
        const Index bodies = 20 + trial % 4 * 200;
        PileOfContacts pile(random, 300 + trial * 40 + (trial % 10 == 9 ? 5000 : 0), bodies);
        if (trial == 8) pile.stencil.resize(least_contacts_in_blocks);
        GroupsOfPile of(bodies);
        const NodeGroups groups = trial % 3 == 0 ? NodeGroups{} : trial % 3 == 1 ? of.rigid(random) : of.clustered();
        std::vector<Index> region(pile.stencil.size()), twin_region(pile.stencil.size());
        separate_regions(in_order(), pile.stencil, pile.inverse_mass, groups, ContactRegions::separate, in_order_memory,
                         twin, twin_region);
        if (trial == 30) memory.labels.sets.now = std::numeric_limits<std::uint32_t>::max();  // all stamps are used
        for (const ExecutorChoice& choice : executor_choices({4, 7})) {
            CAPTURE(choice.text());
            const auto executor = choice.make();
            separate_regions(*executor, pile.stencil, pile.inverse_mass, groups, ContactRegions::separate, memory,
                             regions, region);
            REQUIRE(region == twin_region);
            check_same(regions, twin);
        }
        in_blocks += pile.stencil.size() >= least_contacts_in_blocks;
    }
    CHECK(in_blocks > 45);
    CHECK(memory.labels.sets.now > 45);  // starts since the stamps were used up
}

TEST_CASE("a pinned node does not join the contacts that touch it", "[unit][contact]") {
    std::vector<Real> inverse_mass(10, 1);
    const std::vector<Stencil> stencil{touching({1, 5}), touching({2, 5}), touching({3, 5})};
    CHECK(separate(stencil, inverse_mass, ContactRegions::separate).regions.size() == 1);
    inverse_mass[5] = 0;
    CHECK(separate(stencil, inverse_mass, ContactRegions::separate).regions.size() == 3);
}

TEST_CASE("a node of weight zero does not join contacts", "[unit][contact]") {
    std::vector<Stencil> stencil{touching({1, 5}), touching({2, 5})};
    stencil[1].weight[1] = 0;
    CHECK(separate(stencil, std::vector<Real>(6, 1), ContactRegions::separate).regions.size() == 2);
}

TEST_CASE("a contact without a moving node belongs to no region", "[unit][contact]") {
    const std::vector<Real> inverse_mass{0, 0, 1, 1};
    const std::vector<Stencil> stencil{touching({0, 1}), touching({2, 3}), touching({1})};
    CHECK(areas_of_the_paper(stencil, inverse_mass) == std::vector<Index>{no_index, 0, no_index});
    for (const ContactRegions mode : {ContactRegions::separate, ContactRegions::global}) {
        const Separated result = separate(stencil, inverse_mass, mode);
        CHECK(result.region == std::vector<Index>{no_index, 0, no_index});
        CHECK(result.regions.contacts.item.size() == 1);
    }
    const Separated none = separate({touching({0, 1})}, inverse_mass, ContactRegions::separate);
    CHECK(none.ran);
    CHECK(none.regions.size() == 0);
}

TEST_CASE("no contacts are no regions, and old ones go", "[unit][contact]") {
    SeparationMemory memory;
    RegionTable regions;
    std::vector<Index> region(1);
    separate_regions(in_order(), std::vector{touching({1, 2})}, std::vector<Real>(3, 1), NodeGroups{},
                     ContactRegions::separate, memory, regions, region);
    REQUIRE(regions.size() == 1);
    CHECK_FALSE(separate_regions(in_order(), {}, std::vector<Real>(3, 1), NodeGroups{}, ContactRegions::separate,
                                 memory, regions, {}));
    CHECK(regions.size() == 0);
    CHECK(regions.status.size() == 0);
}

TEST_CASE("global puts all contacts into one region in contact order", "[unit][contact]") {
    const Separated result =
        separate({touching({1}), touching({2}), touching({3})}, std::vector<Real>(4, 1), ContactRegions::global);
    CHECK(result.regions.size() == 1);
    CHECK(std::vector<Index>(result.regions.contacts[0].begin(), result.regions.contacts[0].end()) ==
          std::vector<Index>{0, 1, 2});
}

TEST_CASE("the paper's Algorithm 1 leaves areas {1,2,5} and {5,6} apart, which share point 5", "[unit][contact]") {
    const std::vector<Stencil> stencil{touching({1, 2}), touching({5, 6}), touching({2, 5})};
    const std::vector<Real> inverse_mass(7, 1);
    const std::vector<Index> area = areas_of_the_paper(stencil, inverse_mass);
    CHECK(area == std::vector<Index>{0, 1, 0});
    CHECK(lab::count_shared_nodes(stencil, inverse_mass, area) == 1);
    CHECK(separate(stencil, inverse_mass, ContactRegions::separate).region == std::vector<Index>{0, 0, 0});
}

TEST_CASE("the paper's Algorithm 1 is right on chains in order", "[unit][contact]") {
    const std::vector<Stencil> stencil{touching({1, 2}), touching({2, 3}), touching({3, 4}), touching({7, 8}),
                                       touching({8, 9})};
    const std::vector<Real> inverse_mass(10, 1);
    const std::vector<Index> area = areas_of_the_paper(stencil, inverse_mass);
    CHECK(area == separate(stencil, inverse_mass, ContactRegions::separate).region);
    CHECK(lab::count_shared_nodes(stencil, inverse_mass, area) == 0);
}

TEST_CASE("the paper's Algorithm 1 goes wrong more often the more contacts there are", "[unit][contact]") {
    std::mt19937 random(1);
    const auto wrong_of_100 = [&](int contacts) {
        int wrong = 0;
        for (int trial = 0; trial < 100; ++trial) {
            const std::vector<Stencil> stencil = random_stencils(random, contacts, 3 * contacts);
            const std::vector<Real> inverse_mass(3 * static_cast<std::size_t>(contacts), 1);
            const std::vector<Index> area = areas_of_the_paper(stencil, inverse_mass);
            wrong += lab::count_shared_nodes(stencil, inverse_mass, area) > 0;
        }
        return wrong;
    };
    CHECK(wrong_of_100(6) < 60);
    CHECK(wrong_of_100(100) > 80);
}

TEST_CASE("a joint makes one region of its bodies, also without contacts", "[unit][regions]") {
    // Bodies have two nodes each (0 1, 2 3, ...); joints name the first node of a body.
    const auto joining = [](Index first, Index second) {
        JointBlock block{};
        block.first_node = first;
        block.second_node = second;
        return block;
    };
    const std::vector<JointBlock> joints{joining(6, no_index), joining(0, 2), joining(4, no_index), joining(8, 6)};
    const std::vector<Stencil> stencil{touching({2}), touching({0}), touching({4})};
    const std::vector<Real> inverse_mass(10, 1);
    NodeGroups groups;
    groups.joints = joints;
    RegionTable regions;
    SeparationMemory memory;
    std::vector<Index> region(3);
    REQUIRE(
        separate_regions(in_order(), stencil, inverse_mass, groups, ContactRegions::separate, memory, regions, region));
    CHECK(region == std::vector<Index>{0, 0, 1});
    REQUIRE(regions.size() == 3);
    const auto list = [](std::span<const Index> of) { return std::vector<Index>(of.begin(), of.end()); };
    CHECK(list(regions.joints_of(0)) == std::vector<Index>{1});
    CHECK(list(regions.joints_of(1)) == std::vector<Index>{2});
    CHECK(list(regions.joints_of(2)) == std::vector<Index>{0, 3});
    CHECK(regions.contacts[2].empty());
    REQUIRE(
        separate_regions(in_order(), stencil, inverse_mass, groups, ContactRegions::global, memory, regions, region));
    CHECK(regions.size() == 1);
    CHECK(list(regions.joints_of(0)) == std::vector<Index>{0, 1, 2, 3});
    // Without contacts only regions of joints exist. Joints that are gone are in no region.
    std::vector<Index> none;
    REQUIRE(separate_regions(in_order(), {}, inverse_mass, groups, ContactRegions::separate, memory, regions, none));
    CHECK(regions.size() == 3);
    REQUIRE(separate_regions(in_order(), stencil, inverse_mass, NodeGroups{}, ContactRegions::separate, memory, regions,
                             region));
    CHECK(regions.joints_of(0).empty());
    CHECK_FALSE(
        separate_regions(in_order(), {}, inverse_mass, NodeGroups{}, ContactRegions::separate, memory, regions, none));
}

}  // namespace skerry::test::separate_regions_test
