// Rows of the contact problem that hold nodes along single directions.
#include "systems/dynamics/motion/hold_axes.h"

#include <array>
#include <catch2/catch.hpp>
#include <cmath>

#include "components/cable_table.h"
#include "components/write_contact.h"

namespace skerry::test::hold_axes_test {

TEST_CASE("each held direction of a node has a key of its own, and the keys ascend", "[unit]") {
    // Two orthonormal directions whose largest component is x.
    const Real half = 0.5, root = std::sqrt(half);
    Mat3 held = Mat3::Zero();
    held.col(0) = Vec3(root, half, half);
    held.col(2) = Vec3(root, -half, -half);
    const std::array held_of{held};
    const std::array<RigidMotion, 1> motion{};
    const std::array nodes{Range{0, 2}};
    const std::array<Index, 2> node{0, 1}, body{0, 0};
    const std::array<Vec3, 2> zero{Vec3::Zero(), Vec3::Zero()};
    const std::array<Real, 2> one{1, 1};
    const AxisHoldInputs inputs{.held = held_of,
                                .motion = motion,
                                .nodes = nodes,
                                .node = node,
                                .anchor = zero,
                                .position = zero,
                                .velocity = zero,
                                .load = {},
                                .mass = one,
                                .inverse_mass = one,
                                .body = body,
                                .resting = {},
                                .ghosts = {}};
    ContactTable contacts;
    for (const Index n : node) {
        ContactRow row{};
        row.key = {0, static_cast<std::uint64_t>(n)};
        row.kind = ContactKind::point_collider;
        row.stencil = {{n, n, n, n}, {1, 0, 0, 0}};
        row.normal = Vec3::UnitZ();
        append_row(row, Vec3::Zero(), contacts);
    }
    HeldRows rows;
    prepare_held_rows(inputs, CableBlockTable{}, 0.01, contacts, rows);
    REQUIRE(rows.entry.size() == 4);
    REQUIRE(contacts.size() == 6);
    for (std::size_t c = 1; c < contacts.size(); ++c) CHECK(contacts.key[c - 1] < contacts.key[c]);
    for (std::size_t c = 2; c < contacts.size(); ++c) {
        CHECK(rows.entry[c - 2] == static_cast<Index>((c - 2) / 2));
        CHECK(contacts.normal[c] == held.col(c % 2 == 0 ? 0 : 2));
    }
}

}  // namespace skerry::test::hold_axes_test
