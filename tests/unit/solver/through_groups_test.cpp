// The walk of contacts on bodies that deform in the frame that moves with them (docs/methods/implicit_bodies.md 4).
#include <catch2/catch.hpp>
#include <random>
#include <vector>

#include "systems/solver/operators/through_groups.h"

using namespace skerry;

namespace {

/// A body of four nodes, of which the last three are touched, and a free node.
struct Groups {
    std::vector<Index> node_body{0, 0, 0, 0, 1}, node{no_index, no_index, 1, 2, 3, 4};
    std::vector<Range> body_nodes{{0, 4}, {4, 5}}, body_rigid{{0, 1}, {1, 1}}, body_implicit{{0, 4}, {4, 4}};
    ImplicitCoupling coupling;
    NodeClusters clusters;
    RigidInputs rigid;
    ImplicitInputs implicit;

    Groups() {
        coupling.nodes.offset.push_back(0);
        for (const Index n : {1, 2, 3}) coupling.nodes.item.push_back(n);
        coupling.nodes.offset.push_back(3);
        coupling.first_block.push_back(0);
        for (const Index place : {no_index, Index{0}, Index{1}, Index{2}}) coupling.place.push_back(place);
        std::mt19937 engine(1);
        std::uniform_real_distribution<Real> number(-1, 1);
        for (int k = 0; k < 9; ++k) {
            PaddedMat3 block = PaddedMat3::Zero();
            for (Index r = 0; r < 3; ++r)
                for (Index c = 0; c < 3; ++c) block(r, c) = number(engine);
            coupling.block.push_back(block);
        }
        rigid.nodes = {.node_body = node_body, .body_nodes = body_nodes, .body_rigid = body_rigid};
        implicit.body_implicit = body_implicit;
        implicit.coupling = &coupling;
    }
    ThroughGroups walk() const { return {clusters, implicit, rigid, node}; }
};

/// Of rows of `Groups::node`.
LumpedContact contact_of(std::array<Index, 2> node, std::array<Real, 2> weight) {
    LumpedContact contact;
    contact.node_count = 2;
    for (std::size_t a = 0; a < 2; ++a) {
        contact.node[a] = node[a];
        contact.weight[a] = weight[a];
        contact.step[a] = 2 * weight[a];  // of a node of half a kilogram
    }
    return contact;
}

}  // namespace

TEST_CASE("impulses that are summed up by node move what they move one by one", "[solver][implicit]") {
    const Groups groups;
    const ThroughGroups walk = groups.walk();
    const std::vector<LumpedContact> contacts{contact_of({2, 5}, {1, -1}), contact_of({3, 2}, {0.3, 0.7}),
                                              contact_of({4, 3}, {-0.4, -0.6}), contact_of({5, 4}, {1, -1})};
    std::vector<Vec4> one_by_one(6, Vec4(1, 2, 3, 0)), summed = one_by_one, sum(6, Vec4::Zero());
    for (std::size_t i = 0; i < contacts.size(); ++i) {
        const auto k = static_cast<Real>(i);
        const Vec4 impulse(1 + k, 2 - k, 0.5 * k, 0);
        walk.apply(contacts[i], impulse, one_by_one.data());
        walk.collect(contacts[i], impulse, sum.data(), summed.data());
    }
    CHECK(sum[5].isZero(0));
    CHECK((summed[2] - one_by_one[2]).norm() > 0.1);
    for (const Index n : {2, 3, 4}) walk.spread(n, sum[static_cast<std::size_t>(n)], summed.data());
    for (std::size_t n = 0; n < summed.size(); ++n) CHECK((summed[n] - one_by_one[n]).norm() < 1e-14);
    CHECK((summed[5] - Vec4(1, 2, 3, 0)).norm() > 0.1);
}
