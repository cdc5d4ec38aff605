// Traversal over contacts on bodies that deform in a co-moving frame (docs/methods/implicit_bodies.md 4).
#include <Eigen/Geometry>
#include <catch2/catch.hpp>
#include <random>
#include <vector>

#include "systems/solver/operators/contact_runs.h"

namespace skerry::test::through_groups_test {

namespace {

/// A body of four nodes, of which the last three have contacts, and a free node.
struct Groups {
    std::vector<Index> node_body{0, 0, 0, 0, 1}, node{no_index, no_index, 1, 2, 3, 4};
    std::vector<Range> body_nodes{{0, 4}, {4, 5}}, body_rigid{{0, 1}, {1, 1}}, body_implicit{{0, 4}, {4, 4}};
    std::vector<Real> response = std::vector<Real>(81);
    ImplicitCoupling coupling;
    NodeClusters clusters;
    RigidInputs rigid;
    ImplicitInputs implicit;

    Groups() {
        coupling.nodes.offset.push_back(0);
        for (const Index n : {1, 2, 3}) coupling.nodes.item.push_back(n);
        coupling.nodes.offset.push_back(3);
        for (const Index place : {no_index, Index{0}, Index{1}, Index{2}}) coupling.touched_index.push_back(place);
        std::mt19937 engine(1);
        std::uniform_real_distribution<Real> number(-1, 1);
        for (std::size_t k = 0; k < 9; ++k)
            for (std::size_t l = k; l < 9; ++l) response[9 * k + l] = response[9 * l + k] = number(engine);
        coupling.response.push_back(response);
        const Mat3 turn = Eigen::AngleAxis<Real>(0.7, Vec3(1, 2, -1).normalized()).toRotationMatrix();
        coupling.turn.push_back(turn);
        coupling.impulse_turn.push_back(0.6 * turn.transpose());
        rigid.nodes = {.node_body = node_body, .body_nodes = body_nodes, .body_rigid = body_rigid};
        implicit.body_implicit = body_implicit;
        implicit.coupling = &coupling;
    }
    ThroughGroups traversal() const { return {clusters, implicit, rigid, node}; }
};

/// A contact of rows of `Groups::node`.
LumpedContact contact_of(std::array<Index, 2> node, std::array<Real, 2> weight) {
    LumpedContact contact;
    contact.node_count = 2;
    for (std::size_t a = 0; a < 2; ++a) {
        contact.node[a] = node[a];
        contact.weight[a] = weight[a];
        contact.step[a] = 2 * weight[a];  // for a node of half a kilogram
    }
    return contact;
}

}  // namespace

TEST_CASE("impulses that are summed up, by node or by runs, move contacts as the blocks of W do",
          "[solver][implicit]") {
    const Groups groups;
    const ThroughGroups traversal = groups.traversal();
    const std::vector<LumpedContact> contacts{contact_of({2, 5}, {1, -1}), contact_of({3, 2}, {0.3, 0.7}),
                                              contact_of({4, 3}, {-0.4, -0.6}), contact_of({5, 4}, {1, -1})};
    std::vector<Vec4> by_node(6, Vec4::Zero()), by_run = by_node, impulse;
    for (std::size_t i = 0; i < contacts.size(); ++i) {
        const auto k = static_cast<Real>(i);
        impulse.emplace_back(1 + k, 2 - k, 0.5 * k, 0);
    }
    ContactRuns runs;
    const std::span<Vec4> sum = runs.sums(6);
    for (std::size_t i = 0; i < contacts.size(); ++i)
        traversal.collect(contacts[i], impulse[i], sum.data(), by_node.data());
    CHECK(sum[5].isZero(0));
    runs.spread_sums(traversal, by_node.data());
    const std::size_t most = GENERATE(std::size_t(1), std::size_t(2), std::size_t(24));
    runs.start();
    runs.list(contacts, traversal, 6, most);
    CHECK(runs.runs().size() == (most == 24 ? 1 : most == 2 ? 2 : 4));
    const auto expected = [&](std::size_t i, std::size_t last) {
        Vec3 u = Vec3::Zero();
        for (std::size_t j = 0; j <= last; ++j)
            u += traversal.coupling(contacts[i], contacts[j]) * impulse[j].head<3>();
        return u;
    };
    const auto found = [&](std::size_t i, const std::vector<Vec4>& velocity) {
        return Vec3(add_node_velocities(contacts[i], velocity.data(), Vec4::Zero()).head<3>());
    };
    for (const ContactRuns::Run& run : runs.runs()) {
        for (Index i = run.begin; i < run.end; ++i) {
            const auto at = static_cast<std::size_t>(i);
            runs.apply(at, contacts[at], traversal, impulse[at], by_run.data());
            // all contacts of the run at once
            for (Index j = run.begin; j < run.end; ++j) {
                const auto other = static_cast<std::size_t>(j);
                CHECK((found(other, by_run) - expected(other, at)).norm() < 1e-13);
            }
        }
        runs.spread(run, traversal, by_run.data());
    }
    for (std::size_t i = 0; i < contacts.size(); ++i) {
        REQUIRE(expected(i, 3).norm() > 0.1);
        CHECK((found(i, by_node) - expected(i, 3)).norm() < 1e-13);
        CHECK((found(i, by_run) - expected(i, 3)).norm() < 1e-13);
    }
}

}  // namespace skerry::test::through_groups_test
