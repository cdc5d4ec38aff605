// Stress and strain of tetrahedra and nodes (docs/methods/elasticity.md 7.5).
#include <atomic>
#include <catch2/catch.hpp>
#include <chrono>
#include <latch>
#include <thread>

#include "engine/world/state/field_cache.h"
#include "systems/dynamics/recovery/recovery_plan.h"
#include "tests/support/element_kinds.h"
#include "tests/support/jittered_box.h"
#include "tests/support/material_models.h"
#include "tests/support/worlds.h"

namespace skerry::test::body_fields_test {

namespace {

Real farthest(std::span<const Mat3> values, const Mat3& expected) {
    Real most = 0;
    for (const Mat3& value : values) most = std::max(most, (value - expected).norm());
    return most;
}

}  // namespace

TEST_CASE("a body of uniform strain reports this strain, with every kind of element", "[scene]") {
    constexpr Real modulus = 1e5, nu = 0.4;  // Pa
    constexpr Real mu = modulus / (2 * (1 + nu)), lambda = modulus * nu / ((1 + nu) * (1 - 2 * nu));
    Mat3 rate;  // 1/s
    rate << 0.8, 0.3, 0, -0.1, -0.5, 0.2, 0.4, 0, 0.6;
    const auto [nodes, tetrahedra] = test::jittered_box({3, 3, 2}, 0.1, 0.25, 1);
    for (const ElementKind kind : test::element_kinds) {
        Settings settings;
        settings.gravity = Vec3::Zero();
        World world(settings);
        const auto material = world.add_material(
            test::lossless({.young_modulus = modulus, .poisson_ratio = nu, .model = MaterialModel::linear}));
        const auto body =
            world.add_body({nodes, tetrahedra}, {.material = material, .rotation = {0.3, -0.2, 0.5}, .element = kind});
        std::vector<Vec3> velocity;
        for (const Vec3& x : world.positions(body)) velocity.push_back(rate * x);
        world.set_velocities(body, velocity);
        // The body is free of stress: the first step moves every node by h times its velocity.
        const Real h = world.stable_step() / 2;
        REQUIRE(world.advance(h).steps == 1);

        const Mat3 F = Mat3::Identity() + h * rate, small = h * (rate + rate.transpose()) / 2;
        const Mat3 strain = (F.transpose() * F - Mat3::Identity()) / 2;
        const Mat3 stress =
            (lambda * small.trace() * Mat3::Identity() + 2 * mu * small) * F.transpose() / F.determinant();
        INFO(name_of(kind));
        CHECK(world.strain(body).size() == tetrahedra.size());
        CHECK(farthest(world.strain(body), strain) <= 1e-10 * strain.norm());
        CHECK(farthest(world.stress(body), stress) <= 1e-10 * stress.norm());
        CHECK(world.node_strain(body).size() == nodes.size());
        CHECK(farthest(world.node_strain(body), strain) <= 1e-10 * strain.norm());
        CHECK(farthest(world.node_stress(body), stress) <= 1e-10 * stress.norm());
    }
}

TEST_CASE("a node with too few others around it has the mean of its elements", "[scene]") {
    // All nodes of a row of cells are at edges of the surface, so that there is nothing to extrapolate from.
    Settings settings;
    settings.gravity = Vec3::Zero();
    World world(settings);
    const auto [nodes, tetrahedra] = test::jittered_box({3, 1, 1}, 0.1, 0.25, 1);
    const auto body = world.add_body(
        {nodes, tetrahedra}, {.material = world.add_material(test::lossless({})), .element = ElementKind::linear});
    std::vector<Vec3> moved;
    for (const Vec3& x : nodes) moved.emplace_back(x + 0.1 * x.squaredNorm() * Vec3(1, -2, 0.5));
    world.set_positions(body, moved);
    const std::vector<Mat3> stress = world.stress(body), of_nodes = world.node_stress(body);
    for (std::size_t n = 0; n < nodes.size(); ++n) {
        Mat3 sum = Mat3::Zero();
        Real weight = 0;
        for (std::size_t t = 0; t < tetrahedra.size(); ++t) {
            if (std::ranges::count(tetrahedra[t], static_cast<Index>(n)) == 0) continue;
            const Real volume = test::volume_of({nodes, tetrahedra}, tetrahedra[t]);
            sum += volume * stress[t];
            weight += volume;
        }
        REQUIRE(of_nodes[n].norm() > 0);
        CHECK((of_nodes[n] - sum / weight).norm() <= 1e-12 * of_nodes[n].norm());
    }
}

TEST_CASE("the stress of some nodes is bitwise the stress of these nodes among all", "[scene][long]") {
    const ElementKind kind = GENERATE(from_range(test::element_kinds));
    const MaterialModel model = GENERATE(from_range(test::material_models));
    const BodyDynamics dynamics = GENERATE(BodyDynamics::explicit_elastic, BodyDynamics::implicit_elastic);
    Settings settings;
    settings.gravity = Vec3::Zero();
    World world(settings);
    const auto [nodes, tetrahedra] = test::jittered_box({5, 4, 3}, 0.1, 0.25, 1);
    const auto material = world.add_material(test::lossless({.model = model}));
    world.add_body({nodes, tetrahedra}, {.material = material, .position = {2, 0, 0}, .element = kind});
    const auto body =
        world.add_body({nodes, tetrahedra},
                       {.material = material, .rotation = {0.3, -0.2, 0.5}, .dynamics = dynamics, .element = kind});
    std::vector<Vec3> velocity;
    for (const Vec3& x : nodes) velocity.push_back(10 * x.squaredNorm() * Vec3(1, -2, 0.5));
    world.set_velocities(body, velocity);
    REQUIRE(world.advance(10 * world.stable_step()).ok());

    INFO(name_of(kind) << ", " << name_of(model) << ", " << name_of(dynamics));
    const std::vector<Mat3> all = world.node_stress(body);
    REQUIRE(all.size() == nodes.size());
    std::vector<Index> everything;
    for (Index n = 0; n < static_cast<Index>(nodes.size()); ++n) everything.push_back(n);
    const auto last = static_cast<Index>(nodes.size()) - 1;
    for (const std::vector<Index>& asked : {std::vector<Index>{}, {0}, {last}, {40, 3, last, 40, 17}, everything}) {
        const std::vector<Mat3> some = world.node_stress(body, asked);
        REQUIRE(some.size() == asked.size());
        for (std::size_t i = 0; i < asked.size(); ++i) {
            CHECK(some[i] == all[static_cast<std::size_t>(asked[i])]);
            CHECK(some[i].norm() > 0);
        }
    }
    CHECK_THROWS_WITH(world.node_stress(body, std::vector<Index>{0, last + 1}),
                      Catch::Contains("node indices of the body"));
    CHECK_THROWS_WITH(world.node_stress(body, std::vector<Index>{-1}), Catch::Contains("node indices of the body"));
}

TEST_CASE("fields of a body are those of a clone, which has no plans, after every change of the world", "[scene]") {
    Settings settings;
    settings.gravity = Vec3::Zero();
    World world(settings);
    const auto [nodes, tetrahedra] = test::jittered_box({4, 3, 3}, 0.1, 0.25, 1);
    const auto material = world.add_material(test::lossless({.young_modulus = 1e5}));
    const auto other = world.add_body({nodes, tetrahedra},
                                      {.material = material, .position = {2, 0, 0}, .element = ElementKind::linear});
    const auto body = world.add_body({nodes, tetrahedra}, {.material = material, .rotation = {0.3, -0.2, 0.5}});
    const std::vector<Index> some{7, 0, 31};
    const auto check = [&](std::string_view change) {
        INFO(change);
        std::vector<Vec3> velocity;
        for (const Vec3& x : nodes) velocity.push_back(x.squaredNorm() * Vec3(1, -2, 0.5));
        if (world.dynamics(body) != BodyDynamics::rigid) world.set_velocities(body, velocity);
        REQUIRE(world.advance(5e-3).ok());
        const World clone = world.clone();
        CHECK(world.node_stress(body) == clone.node_stress(body));
        CHECK(world.node_strain(body) == clone.node_strain(body));
        CHECK(world.node_stress(body, some) == clone.node_stress(body, some));
        CHECK(world.stress(body) == clone.stress(body));
        CHECK((world.node_stress(body)[31].norm() > 0) == (world.dynamics(body) != BodyDynamics::rigid));
    };
    check("nothing");
    const World before = world.clone();
    world.remove(other);
    check("removal of another body");
    world.set_material(material, test::lossless({.young_modulus = 3e5, .poisson_ratio = 0.1}));
    check("another stiffness");
    world.reset(body, {.position = {0, 0, 1}, .rotation = {1, 0, 0}});
    check("reset");
    for (const BodyDynamics dynamics :
         {BodyDynamics::implicit_elastic, BodyDynamics::explicit_elastic, BodyDynamics::rigid,
          BodyDynamics::explicit_elastic, BodyDynamics::implicit_elastic}) {
        world.set_dynamics(body, dynamics);
        check(name_of(dynamics));
    }
    world.reset(before);
    check("reset to a clone");
}

TEST_CASE("several threads that read fields of a new world get the same values", "[scene]") {
    World world;
    const auto [nodes, tetrahedra] = test::jittered_box({4, 3, 3}, 0.1, 0.25, 1);
    const auto material = world.add_material({});
    std::vector<BodyHandle> bodies;
    for (const BodyDynamics dynamics : {BodyDynamics::explicit_elastic, BodyDynamics::implicit_elastic})
        bodies.push_back(world.add_body({nodes, tetrahedra}, {.material = material,
                                                              .position = {0, 0, Real(bodies.size())},
                                                              .velocity = {0, 0, 1},
                                                              .dynamics = dynamics}));
    REQUIRE(world.advance(0.01).ok());
    const World expected = world.clone();
    for (const BodyHandle body : bodies) {
        std::array<std::vector<Mat3>, 4> found;
        {
            std::vector<std::jthread> threads;
            for (auto& own : found)
                threads.emplace_back([&own, &world = std::as_const(world), body] { own = world.node_stress(body); });
        }
        for (const auto& own : found) CHECK(own == expected.node_stress(body));
    }
}

TEST_CASE("threads that ask for one plan at the same time share it", "[scene]") {
    const FieldCache cache;
    const std::vector<Index> nodes{3, 5};
    std::atomic<int> made = 0;
    {
        std::latch start(4);
        std::vector<std::jthread> threads;
        for (int i = 0; i < 4; ++i)
            threads.emplace_back([&] {
                start.arrive_and_wait();
                cache.plan(nodes, [&] {
                    ++made;
                    // long enough for the other threads to ask
                    std::this_thread::sleep_for(std::chrono::milliseconds(50));
                    RecoveryPlan plan;
                    plan.nodes = nodes;
                    return plan;
                });
            });
    }
    CHECK(made == 1);
}

TEST_CASE("a plan is made once for each list of nodes, and the latest 64 lists are kept", "[scene]") {
    const FieldCache cache;
    int made = 0;
    const auto ask = [&](const FieldCache& from, Index node) {
        const std::vector<Index> nodes{node, 5};
        const auto found = from.plan(nodes, [&] {
            ++made;
            RecoveryPlan plan;
            plan.nodes = nodes;
            return plan;
        });
        CHECK(found->nodes == nodes);
    };
    for (int pass = 0; pass < 2; ++pass)
        for (Index node = 0; node < 64; ++node) ask(cache, node);
    CHECK(made == 64);
    ask(cache, 64);  // drops the list of node 0, which was used least recently
    ask(cache, 1);
    CHECK(made == 65);
    ask(cache, 0);
    CHECK(made == 66);
    const FieldCache copy = cache;
    ask(copy, 1);
    CHECK(made == 67);
}

}  // namespace skerry::test::body_fields_test
