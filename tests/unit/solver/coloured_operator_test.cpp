// The coloured operator against its serial reference, a LumpedOperator over the contacts in the same order.
#include <catch2/catch.hpp>

#include "systems/solver/methods/run_method.h"
#include "systems/solver/regions/solve_large_regions.h"
#include "tests/support/contact_scene.h"
#include "tests/unit/jobs/executors.h"

namespace skerry::test::coloured_operator_test {

namespace {

/// A region of sheets with a hub that touches many of their nodes, a pinned node, repeated nodes, and contacts without
/// a movable node.
ContactScene rough_scene(int size) {
    ContactScene scene;
    add_sheets(scene, size, 0.5, 7);
    const Index nodes = static_cast<Index>(scene.velocity.size());
    const Index hub = scene.add_node(50, Vec3(0, 0, 3)), pinned = scene.add_node(0, Vec3(0.1, 0, 0));
    for (Index n = 0; n < nodes; n += 9) scene.touch_node(hub, n, Vec3(0.1, 0.2, -1), 0.4);
    for (Index n = 0; n < nodes; n += 11) scene.touch_node(n, pinned, Vec3(0, 0.1, 1), 0.3);
    for (Index n = 0; n < nodes; n += 13)
        scene.touch({{n, n, pinned, pinned}, {0.5, 0.5, -0.5, -0.5}}, Vec3(0, 0, 1), 0.3);
    for (Index n = 0; n < nodes; n += 17)
        scene.touch({{pinned, n, pinned, pinned}, {1 - 1e-9, 1e-9, 0, 0}}, Vec3(0, 0, 1), 0.3);
    return scene;
}

/// One region whose contacts are loaded in coloured order.
struct LoadedScene {
    explicit LoadedScene(const ContactScene& scene)
        : impulse_out(scene.impulse),
          velocity_next(scene.velocity),
          push_out(scene.velocity.size()),
          inputs(scene.inputs()),
          out{impulse_out, velocity_next, push_out},
          stage{inputs, settings, scene.h, out, data} {
        settings.method = SolverMethod::pcg_pgs;  // this method needs the most vectors
        for (std::size_t k = 0; k < scene.stencil.size(); ++k) row.push_back(static_cast<Index>(k));
        data.make_room_for(row.size(), 4 * row.size(), scene.velocity.size(), settings);
        Team alone;
        order_region(inputs, row, alone, data.node_index.span(), kept);
        const RegionByColour loaded = load_by_colour(stage, row, 0, alone, kept);
        memory = loaded.memory;
        scale = loaded.scale;
    }
    LumpedOperator serial(Friction friction) { return {memory, friction, scale}; }
    ColouredOperator coloured(Team& team, Friction friction) { return {memory, friction, scale, kept.traversal(team)}; }
    bool same_vectors(const LoadedScene& other) const {
        const auto same = [](std::span<const Vec4> a, std::span<const Vec4> b) { return std::ranges::equal(a, b); };
        bool all = same(memory.impulse, other.memory.impulse) && same(memory.velocity, other.memory.velocity);
        for (const std::size_t slot : {1, 2, 3}) all &= same(memory.workspace[slot], other.memory.workspace[slot]);
        return all;
    }

    std::vector<Vec3> impulse_out, velocity_next, push_out;
    std::vector<Index> row;
    SolverSettings settings;
    RegionInputs inputs;
    RegionOutputs out;
    RegionMemory data;
    RegionStage stage;
    ColouredRegion kept;
    LumpedMemory memory;
    Real scale = 0;
};

/// Performs once every operation that methods use; returns the measured values.
template <class Op>
std::vector<Real> exercise(Op op) {
    std::vector<Real> seen;
    op.remember();
    for (int k = 0; k < 8; ++k) {
        const SweepChange change = op.accelerated_sweep(1);
        seen.insert(seen.end(), {change.squared_change, change.reversal});
        if (k % 3 == 2) seen.push_back(op.error());
        if (k == 5) op.refresh_all();
        op.extrapolate(0.1 * k);
    }
    seen.push_back(op.sweep(1.2));
    op.extrapolate(0.3);
    seen.push_back(op.error());
    op.residual(op.workspace(2));
    op.multiply(op.workspace(2), op.workspace(3));
    op.refresh();
    return seen;
}

}  // namespace

TEST_CASE("a coloured operator gives bitwise the result of a lumped one in the same order", "[determinism][solver]") {
    const ContactScene scene = rough_scene(45);
    for (const Friction friction : {Friction::cone, Friction::pyramid}) {
        LoadedScene twin(scene);
        REQUIRE(twin.kept.order.colour_count >= 4);
        REQUIRE(twin.kept.order.hub_phase_count == 1);
        REQUIRE(twin.kept.order.tail_size > 0);
        const std::vector<Real> expected = exercise(twin.serial(friction));
        std::vector<Real> first;
        for (const ExecutorChoice& choice : executor_choices({1, 2, 3, 4, 8})) {
            CAPTURE(choice.text());
            const auto executor = choice.make();
            LoadedScene loaded(scene);
            Team team;
            std::vector<Real> seen;
            team.gather(*executor, [&] { seen = exercise(loaded.coloured(team, friction)); });
            REQUIRE(loaded.same_vectors(twin));
            // Sums are taken in another order than in the twin, but the order is always the same.
            REQUIRE(seen.size() == expected.size());
            for (std::size_t i = 0; i < seen.size(); ++i)
                REQUIRE(std::abs(seen[i] - expected[i]) <=
                        1e-9 * std::abs(expected[i]) + 1e-9 * std::abs(expected[i % 2]));
            if (first.empty()) first = seen;
            REQUIRE(seen == first);
        }
    }
}

TEST_CASE("contacts are ordered again when one of them has another moving node, and not before", "[unit][solver]") {
    ContactScene scene = rough_scene(20);
    std::vector<Index> row, place(scene.velocity.size());
    for (std::size_t k = 0; k < scene.stencil.size(); ++k) row.push_back(static_cast<Index>(k));
    Team alone;
    ColouredRegion region;
    const auto order = [&] { return order_region(scene.inputs(), row, alone, place, region); };
    CHECK(order());
    scene.normal[3] = Vec3::UnitX();
    scene.stencil[5].weight = {1, -0.5, -0.25, -0.25};
    CHECK_FALSE(order());
    scene.stencil[600].weight[3] = 0;  // one node fewer
    CHECK(order());
    CHECK_FALSE(order());
    scene.inverse_mass[static_cast<std::size_t>(scene.stencil[700].node[0])] = 0;  // pinned
    CHECK(order());
    row.pop_back();
    CHECK(order());
    ColouredRegion fresh;
    order_region(scene.inputs(), row, alone, place, fresh);
    CHECK(std::equal(fresh.order.contact.begin(), fresh.order.contact.end(), region.order.contact.begin(),
                     region.order.contact.end()));
    CHECK(std::equal(fresh.local.begin(), fresh.local.end(), region.local.begin(), region.local.end()));
}

}  // namespace skerry::test::coloured_operator_test
