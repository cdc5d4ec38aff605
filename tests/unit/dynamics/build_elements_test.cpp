#include "systems/dynamics/elements/build_elements.h"

#include <algorithm>
#include <catch2/catch.hpp>
#include <random>
#include <utility>
#include <vector>

#include "components/check.h"
#include "systems/dynamics/elements/element_block.h"
#include "tests/support/elastic_body.h"
#include "tests/support/sliver_box.h"

namespace skerry::test::build_elements_test {

using test::ElasticBody;
using test::jittered_box;

namespace {

MaterialConstants rubber() {
    return material_constants(MaterialModel::stable_neo_hookean, 1e5, 0.4, 1000);
}

}  // namespace

TEST_CASE("a body's elements are undeformed where it is put, turned or not", "[unit]") {
    const Mat3 turn = Eigen::AngleAxis<Real>(2.0, Vec3(1, 2, 3).normalized()).toRotationMatrix();
    const ElasticBody body(jittered_box({2, 3, 2}, 0.1, 0.2, 1), rubber(), turn);
    for (std::size_t e = 0; e < 72; ++e) CHECK((body.deformation(e) - Mat3::Identity()).norm() <= 1e-13);
}

TEST_CASE("smoothed elements come in the order of their first tetrahedra, and cover all around", "[unit]") {
    const test::TetMesh mesh = jittered_box({2, 3, 2}, 0.1, 0.2, 1);
    std::vector<std::pair<std::array<Index, 2>, std::vector<Index>>> edges;
    std::vector<std::pair<Index, std::vector<Index>>> nodes;
    const auto note = [](auto& groups, const auto& key, Index tetrahedron) {
        auto found = std::ranges::find_if(groups, [&](const auto& group) { return group.first == key; });
        if (found == groups.end()) found = groups.insert(groups.end(), {key, {}});
        found->second.push_back(tetrahedron);
    };
    for (std::size_t t = 0; t < mesh.tetrahedra.size(); ++t)
        for (std::size_t a = 0; a < 4; ++a) {
            const std::array<Index, 4>& node = mesh.tetrahedra[t];
            note(nodes, node[a], static_cast<Index>(t));
            for (std::size_t b = a + 1; b < 4; ++b)
                note(edges, std::array{std::min(node[a], node[b]), std::max(node[a], node[b])}, static_cast<Index>(t));
        }
    const auto expect = [](const ElementList& list, const auto& groups) {
        REQUIRE(list.size() == groups.size());
        for (std::size_t e = 0; e < list.size(); ++e) {
            const std::vector<Index> covered(
                list.tetrahedron.begin() + static_cast<std::ptrdiff_t>(list.first_tetrahedron[e]),
                list.tetrahedron.begin() + static_cast<std::ptrdiff_t>(list.first_tetrahedron[e + 1]));
            CHECK(covered == groups[e].second);
        }
    };
    ElementList of_edges, of_nodes;
    add_edge_elements({mesh.tetrahedra, mesh.nodes}, ElementPart::whole, of_edges);
    add_node_elements({mesh.tetrahedra, mesh.nodes}, ElementPart::volume, of_nodes);
    expect(of_edges, edges);
    expect(of_nodes, nodes);
}

TEST_CASE("volumes and masses add up to those of the box", "[unit]") {
    const ElasticBody body(jittered_box({3, 2, 4}, 0.1, 0, 1), rubber());
    Real volume = 0, mass = 0;
    for (const ElementLane& lanes : body.elements.volume)
        for (Real v : lanes.lane) volume += v;
    for (Real m : body.mass) mass += m;
    CHECK(volume == Approx(24e-3).epsilon(1e-13));
    CHECK(mass == Approx(24).epsilon(1e-13));
}

TEST_CASE("lanes that are left over have no volume, no gradient and a node of the body", "[unit]") {
    const test::TetMesh mesh = jittered_box({1, 1, 1}, 0.1, 0, 1);  // six tetrahedra
    const ElementList list = elements_of({mesh.tetrahedra, mesh.nodes}, ElementKind::linear, 2);
    TetrahedronBlockTable tetrahedra;
    ElementBlockTable elements;
    ElementNodeTable nodes;
    CHECK(append_tetrahedra(mesh.tetrahedra, mesh.nodes, 0, tetrahedra) == Range{0, 1});
    CHECK(append_tetrahedra(mesh.tetrahedra, mesh.nodes, 8, tetrahedra) == Range{1, 2});
    CHECK(append_elements(list, mesh.nodes, 0, 0, elements, nodes).blocks == Range{0, 1});
    const AppendedElements second = append_elements(list, mesh.nodes, 8, 1, elements, nodes);
    CHECK(second.blocks == Range{1, 2});
    CHECK(second.nodes == Range{4, 8});
    CHECK(elements.body[1] == 1);
    CHECK(elements.material[1] == 2);
    for (std::size_t l = 6; l < 8; ++l) {
        CHECK(second.element[l] == no_index);
        CHECK(elements.volume[1][l] == 0);
        CHECK(tetrahedra.volume[1][l] == 0);
        for (std::size_t a = 0; a < 4; ++a) {
            CHECK(tetrahedra.node[1][a][l] == 8);
            const auto& leader = mesh.tetrahedra[0];
            CHECK(std::ranges::find(leader, nodes.node[4 + a][l] - 8) != leader.end());
            for (std::size_t i = 0; i < 3; ++i) CHECK(nodes.gradient[4 + a][i][l] == 0);
        }
        CHECK(elements.rotation[1][0][l] == 1);
        CHECK(elements.rotation_next[1][0][l] == 1);
    }
    CHECK(nodes.node[4][0] == 8 + mesh.tetrahedra[0][0]);
    CHECK(tetrahedra.node[1][0][0] == 8 + mesh.tetrahedra[0][0]);
}

TEST_CASE("a sliver has next to no volume beside what is around it: flat cells among flat ones are none", "[unit]") {
    const auto slivers = [](const Mesh& mesh) {
        TetrahedronBlockTable table;
        append_tetrahedra(mesh.tetrahedra, mesh.nodes, 0, table);
        std::vector<std::size_t> found;
        for (std::size_t t = 0; t < mesh.tetrahedra.size(); ++t)
            if ((table.sliver[t / element_lanes] >> t % element_lanes & 1) != 0) found.push_back(t);
        return found;
    };
    Mesh mesh = test::sliver_box(0.2, 6, 0.01, 0.02);
    std::vector<std::size_t> flat;
    for (std::size_t t = 0; t < mesh.tetrahedra.size(); ++t)
        if (six_volumes(mesh.tetrahedra[t], mesh.nodes) < 0.021 * std::pow(0.2 / 6, 3)) flat.push_back(t);
    REQUIRE(flat.size() > 8);
    CHECK(slivers(mesh) == flat);
    for (Vec3& x : mesh.nodes) x.z() *= 0.01;  // the result is independent of the shape of the body
    CHECK(slivers(mesh) == flat);
    CHECK(slivers(test::sliver_box(0.2, 6, 0.01, 0.1)).empty());
    CHECK(slivers(test::mirrored_box(0.2, 6)).empty());
}

TEST_CASE("few forces are added to a node shortly after another force on this node", "[unit]") {
    const ElementKind kind = GENERATE(ElementKind::linear, ElementKind::edge_smoothed, ElementKind::edge_node_smoothed);
    const ElasticBody body(jittered_box({5, 5, 5}, 0.1, 0.1, 1), rubber(), Mat3::Identity(), kind);
    constexpr std::size_t shortly = 4;  // An addition takes about as long as this number of independent additions.
    std::vector<Index> added,
        in_order;  // nodes to which the kernel adds forces, and the same with nodes as in the list
    for (std::size_t b = 0; b < body.elements.count.size(); ++b) {
        const auto first = static_cast<std::size_t>(body.elements.first[b]),
                   count = static_cast<std::size_t>(body.elements.count[b]);
        for (std::size_t k = 1; k <= count; ++k)
            for (std::size_t l = 0; l < element_lanes; ++l) {
                added.push_back(body.element_nodes.node[first + k % count][l]);
                const Index in_lane = body.element_at[element_lanes * b + l];
                const auto e =
                    static_cast<std::size_t>(in_lane != no_index ? in_lane : body.element_at[element_lanes * b]);
                in_order.push_back(body.list.node[body.list.first_node[e] + k % count % body.list.nodes_of(e)]);
            }
    }
    const auto waits = [](const std::vector<Index>& nodes) {
        std::size_t waiting = 0;
        for (std::size_t i = shortly; i < nodes.size(); ++i) {
            const auto recent = std::span(nodes).subspan(i - shortly, shortly);
            waiting += std::ranges::find(recent, nodes[i]) != recent.end();
        }
        return waiting;
    };
    const std::size_t waits_now = waits(added), waits_in_order = waits(in_order);
    CHECK(2 * waits_now < waits_in_order);
}

TEST_CASE("the nodes of a lane are counted without the rows that pad its block", "[unit]") {
    const ElementKind kind = GENERATE(ElementKind::linear, ElementKind::edge_smoothed, ElementKind::edge_node_smoothed);
    const ElasticBody body(jittered_box({3, 3, 3}, 0.1, 0.1, 1), rubber(), Mat3::Identity(), kind);
    std::size_t padded = 0;
    for (std::size_t b = 0; b < body.elements.count.size(); ++b) {
        const BlockNodes nodes = body.inputs().nodes_of(b);
        for (std::size_t l = 0; l < element_lanes; ++l) {
            const Index e = body.element_at[element_lanes * b + l];
            if (e == no_index) continue;
            CHECK(nodes.count_in_lane(l) == static_cast<Index>(body.list.nodes_of(static_cast<std::size_t>(e))));
            padded += nodes.count_in_lane(l) < nodes.count;
        }
    }
    CHECK((padded > 0) == (kind != ElementKind::linear));
}

TEST_CASE("no tetrahedra make no blocks", "[unit]") {
    TetrahedronBlockTable tetrahedra;
    ElementBlockTable elements;
    ElementNodeTable nodes;
    CHECK(append_tetrahedra({}, {}, 0, tetrahedra) == Range{0, 0});
    CHECK(append_elements({}, std::vector<Vec3>{}, 0, 0, elements, nodes).blocks == Range{0, 0});
    ElementPatches patches;
    build_patches(elements, 3, nodes, patches);
    CHECK(patches.blocks.empty());
    CHECK(patches.slots_of_node.size() == 3);
    CHECK(patches.slots_of_node[1].empty());
}

TEST_CASE("a mirrored tetrahedron is refused", "[unit]") {
    test::TetMesh mesh = jittered_box({1, 1, 1}, 0.1, 0, 1);
    std::swap(mesh.tetrahedra[0][1], mesh.tetrahedra[0][2]);
    for (const ElementKind kind : {ElementKind::linear, ElementKind::edge_smoothed})
        CHECK_THROWS_AS(elements_of({mesh.tetrahedra, mesh.nodes}, kind), CheckFailed);
}

TEST_CASE("a patch has every node of its elements once, and a node its patches in order", "[unit]") {
    const ElementKind kind = GENERATE(ElementKind::linear, ElementKind::edge_node_smoothed);
    const ElasticBody body(jittered_box({7, 6, 5}, 0.1, 0.1, 1), rubber(), Mat3::Identity(), kind);
    const ElementPatches& patches = body.patches;
    REQUIRE(patches.blocks.size() > 3);
    CHECK(patches.blocks[0].begin == 0);
    CHECK(patches.blocks.back().end == static_cast<Index>(body.elements.first.size()));
    std::vector<int> times(body.position.size(), 0);
    for (std::size_t p = 0; p < patches.blocks.size(); ++p) {
        if (p > 0) CHECK(patches.blocks[p].begin == patches.blocks[p - 1].end);
        const Range slots = patches.slots[p];
        std::vector<Index> own(patches.node.begin() + slots.begin, patches.node.begin() + slots.end);
        std::vector<Index> sorted = own;
        std::sort(sorted.begin(), sorted.end());
        CHECK(std::adjacent_find(sorted.begin(), sorted.end()) == sorted.end());
        std::size_t elements = 0;
        for (auto b = static_cast<std::size_t>(patches.blocks[p].begin);
             b < static_cast<std::size_t>(patches.blocks[p].end); ++b) {
            for (const Real volume : body.elements.volume[b].lane) elements += volume > 0;
            for (Index k = 0; k < body.elements.count[b]; ++k) {
                const auto row = static_cast<std::size_t>(body.elements.first[b] + k);
                for (std::size_t l = 0; l < element_lanes; ++l)
                    CHECK(own[static_cast<std::size_t>(body.element_nodes.slot[row][l] / slot_width)] ==
                          body.element_nodes.node[row][l]);
            }
        }
        CHECK(elements <= elements_per_patch);
        CHECK(elements >= elements_per_patch / 2);
        // The patch is compact: neighbours share their nodes.
        CHECK(own.size() < elements);
    }
    for (std::size_t n = 0; n < body.position.size(); ++n) {
        const std::span<const Index> slots = patches.slots_of_node[n];
        CHECK(std::is_sorted(slots.begin(), slots.end()));
        for (const Index s : slots) CHECK(patches.node[static_cast<std::size_t>(s)] == static_cast<Index>(n));
        times[n] += static_cast<int>(slots.size());
    }
    CHECK(std::accumulate(times.begin(), times.end(), std::size_t{0}) == patches.node.size());
}

TEST_CASE("patches of bodies that come one after the other, and go again, are those of all at once", "[unit]") {
    ElementBlockTable blocks;
    ElementNodeTable nodes;
    ElementPatches grown;
    std::vector<ElementPatches> after;
    std::vector<std::array<Index, 2>> ends;  // blocks, nodes
    Index node_count = 0;
    const auto check_same = [](const ElementPatches& a, const ElementPatches& b) {
        CHECK(std::ranges::equal(a.blocks, b.blocks));
        CHECK(std::ranges::equal(a.slots, b.slots));
        CHECK(std::ranges::equal(a.node, b.node));
        CHECK(std::ranges::equal(a.slots_of_node.offset, b.slots_of_node.offset));
        CHECK(std::ranges::equal(a.slots_of_node.item, b.slots_of_node.item));
    };
    for (Index body = 0; body < 4; ++body) {
        const test::TetMesh mesh = jittered_box({3 + body, 4, 3}, 0.1, 0.1, 1);
        const ElementKind kind = body % 2 == 0 ? ElementKind::linear : ElementKind::edge_node_smoothed;
        append_elements(elements_of({mesh.tetrahedra, mesh.nodes}, kind), mesh.nodes, node_count, body, blocks, nodes);
        node_count += static_cast<Index>(mesh.nodes.size());
        if (body == 1) ++node_count;  // a node without elements
        build_patches(blocks, static_cast<std::size_t>(node_count), nodes, grown);
        const Column<NodeLane> slots = nodes.slot;
        ElementPatches whole;
        build_patches(blocks, static_cast<std::size_t>(node_count), nodes, whole);
        check_same(grown, whole);
        for (std::size_t row = 0; row < slots.size(); ++row)
            CHECK(std::ranges::equal(slots[row].lane, nodes.slot[row].lane));
        after.push_back(whole);
        ends.push_back({static_cast<Index>(blocks.first.size()), node_count});
    }
    for (std::size_t body = 4; body-- > 0;) {
        truncate_patches(ends[body][0], ends[body][1], grown);
        check_same(grown, after[body]);
    }
    truncate_patches(0, 0, grown);
    CHECK(grown.blocks.empty());
    CHECK(grown.slots_of_node.size() == 0);
    build_patches(blocks, static_cast<std::size_t>(node_count), nodes, grown);
    check_same(grown, after.back());
}

TEST_CASE("a block is clear of the end if, and only if, no lane of its rows has the last node", "[unit]") {
    constexpr std::size_t rows = 5, node_count = 60;
    const std::vector<Vec3> position(node_count);
    std::vector<NodeLane> node(rows);
    std::mt19937 random(3);
    for (std::size_t place = 0; place <= rows * element_lanes; ++place) {
        for (NodeLane& row : node)
            for (Index& of_lane : row.lane) of_lane = static_cast<Index>(random() % (node_count - 1));
        const bool has_last = place < rows * element_lanes;
        if (has_last) node[place / element_lanes][place % element_lanes] = node_count - 1;
        CHECK(clear_of_end(node.data(), rows, position) == !has_last);
    }
}

TEST_CASE("a comparison holds in all lanes, or not", "[unit]") {
    for (unsigned pattern = 0; pattern < 1U << element_lanes; ++pattern) {
        Real8 value{};
        for (int l = 0; l < element_lanes; ++l) value[l] = (pattern >> l & 1U) != 0 ? 1 : -1;
        CHECK(all(value > 0.0) == (pattern == (1U << element_lanes) - 1));
    }
}

}  // namespace skerry::test::build_elements_test
