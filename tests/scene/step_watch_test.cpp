// The stable steps of bodies are computed in parts, during the steps that rely on them (docs/methods/stable_step.md 6).
#include <algorithm>
#include <catch2/catch.hpp>
#include <deque>
#include <map>
#include <utility>

#include "engine/world/step/step.h"
#include "engine/world/tuning.h"
#include "systems/dynamics/stability/stable_step.h"
#include "systems/dynamics/stability/watch_stable_steps.h"
#include "tests/support/worlds.h"

namespace skerry::test::step_watch_test {

namespace {

constexpr std::size_t two_rounds = 256;  // length of two rounds of the evaluation [steps]

/// Stable step of each body, by slot, computed in one go after each of the last steps.
class History {
public:
    explicit History(World& world) : world_(world) {}

    /// Call after a step or an edit. Checks that every body's stable step is one of its recent exact values.
    void look() {
        Model& model = WorldAccess::state_of(world_).model;
        for (std::size_t b = 0; b < model.bodies.slot.size(); ++b) {
            if (model.bodies.tetrahedron_count[b] == 0) continue;
            std::deque<Real>& known = found_[model.bodies.slot[b]];
            known.push_back(evaluate_stable_step(model, b, model.nodes.position, scratch_));
            if (known.size() > two_rounds + 1) known.pop_front();
            CAPTURE(model.body_records[b].name, known.size());
            REQUIRE(std::ranges::count(known, model.bodies.stable_step[b]) > 0);
        }
    }
    void take_steps(int count) {
        for (int i = 0; i < count; ++i) {
            REQUIRE(world_.advance(0.999 * world_.stable_step()).steps == 1);
            look();
        }
    }

private:
    World& world_;
    Column<Real> scratch_;
    std::map<std::uint32_t, std::deque<Real>> found_;
};

/// Balls that are stretched in one direction and compressed in another at the start, and vibrate.
struct Swinging {
    World world;
    MaterialHandle rubber;
    std::vector<BodyHandle> balls;
    ElementKind element;

    explicit Swinging(World empty, ElementKind kind = ElementKind::smoothed) : world(std::move(empty)), element(kind) {
        // no losses, because relaxation would go on while a saved shape is evaluated
        rubber = world.add_material(
            {.young_modulus = 1e5, .loss_factor = 0, .bulk_viscosity = 0, .model = MaterialModel::stable_neo_hookean});
        for (const int cells : {3, 5, 4}) add(cells);
    }
    void add(int cells) {
        const Real at = static_cast<Real>(balls.size());
        balls.push_back(
            world.add_body(mesh::ball(0.1, cells), {.material = rubber, .position = {at, 0, 0}, .element = element}));
        std::vector<Vec3> stretched(world.positions(balls.back()).begin(), world.positions(balls.back()).end());
        for (Vec3& x : stretched) x.x() = at + (x.x() - at) * 1.2, x.y() *= 0.85;
        world.set_positions(balls.back(), stretched);
    }
};

World without_clusters() {
    return tuned_world({.gravity = Vec3::Zero(), .clusters = false}, {.max_strain_step = 10});
}

}  // namespace

TEST_CASE("a step relies on positions at most two rounds old", "[scene]") {
    Swinging scene(without_clusters());
    History history(scene.world);
    history.look();
    const Real first = WorldAccess::state_of(scene.world).model.bodies.stable_step[0];
    history.take_steps(600);
    CHECK(WorldAccess::state_of(scene.world).model.bodies.stable_step[0] != first);
}

// Linear elements have masses in the frame of their body (docs/methods/stable_step.md 2.4).
TEST_CASE("a stable-step check in the frame of a body gives the same result in pieces, and for a rotated body",
          "[scene]") {
    Swinging scene(without_clusters(), ElementKind::linear);
    const Model& model = WorldAccess::state_of(scene.world).model;
    REQUIRE(model.elements.frame_bound[0] > 0);
    History history(scene.world);
    history.look();
    const Real first = model.bodies.stable_step[0];
    history.take_steps(400);
    CHECK(model.bodies.stable_step[0] != first);

    const auto stands = [&](const Vec3& rotation, const Vec3& velocity, ElementKind element, int steps) {
        World world = without_clusters();
        const auto rubber = world.add_material({.young_modulus = 1e5, .model = MaterialModel::stable_neo_hookean});
        world.add_body(mesh::ball(0.1, 4),
                       {.material = rubber, .rotation = rotation, .angular_velocity = velocity, .element = element});
        const ElementBlockTable& elements = WorldAccess::state_of(world).model.elements;
        CHECK((elements.frame_bound[0] > 0) == (element == ElementKind::linear));
        for (int i = 0; i < steps; ++i) REQUIRE(world.advance(0.9 * world.stable_step()).ok());
        return world.stable_step();
    };
    const Vec3 zero = Vec3::Zero();
    const Real at_rest = stands(zero, zero, ElementKind::linear, 0);
    CHECK(stands({0.3, -2, 1}, zero, ElementKind::linear, 0) == Approx(at_rest).epsilon(0.005));
    // three rounds, in which the body turns by several radians
    CHECK(stands(zero, {5, 3, 0}, ElementKind::linear, 400) == Approx(at_rest).epsilon(0.02));
    stands(zero, zero, ElementKind::smoothed, 0);
}

TEST_CASE("bodies that come, go and change while they are looked at leave the looks at others right", "[scene]") {
    Swinging scene(without_clusters());
    World& world = scene.world;
    History history(world);
    history.look();
    history.take_steps(150);
    world.remove(scene.balls[0]);  // this ball has already been evaluated in this round
    history.take_steps(40);
    scene.add(4);
    history.look();
    history.take_steps(50);
    std::vector<Vec3> at_rest = mesh::ball(0.1, 5).nodes;
    for (Vec3& x : at_rest) x.x() += 1;
    world.set_positions(scene.balls[1], at_rest);  // this ball is being evaluated
    history.look();
    history.take_steps(60);
    world.remove(scene.balls[2]);
    history.take_steps(400);
}

TEST_CASE("no step takes more than its share of the looks", "[scene]") {
    Swinging scene(without_clusters());
    World& world = scene.world;
    REQUIRE(world.advance(1e-3).ok());
    Model& model = WorldAccess::state_of(world).model;
    std::uint64_t all = 0;
    for (std::size_t b = 0; b < model.bodies.slot.size(); ++b)
        all += pieces_of_check(model.all_elements(), model.bodies.blocks[b]);
    REQUIRE(all > 128);
    const auto done = [&] { return model.watch.before + model.watch.evaluation.piece; };
    std::uint64_t before = done(), greatest = 0;
    int rounds = 0;
    for (int i = 0; i < 300; ++i) {
        const std::uint64_t steps = model.watch.steps;
        REQUIRE(world.advance(0.999 * world.stable_step()).steps == 1);
        rounds += model.watch.steps < steps;
        if (model.watch.steps > steps) greatest = std::max(greatest, done() - before);
        before = model.watch.steps > 0 ? done() : 0;
    }
    CHECK(rounds >= 2);
    CHECK(greatest > 0);
    CHECK(greatest <= all / 128 + 1);
}

TEST_CASE("bodies at rest are not looked at", "[scene]") {
    World world = tuned_world({.sleep_time = 0.02}, {.sleep_speed = 0.01});
    const auto rubber = world.add_material({.young_modulus = 1e5});
    world.add_collider(Plane{});
    world.add_body(mesh::box({0.1, 0.1, 0.1}, {3, 3, 3}), {.material = rubber, .position = {0, 0, 0.0501}});
    REQUIRE(world.advance(1).ok());
    Model& model = WorldAccess::state_of(world).model;
    REQUIRE(model.bodies.asleep[0]);
    for (int i = 0; i < 200; ++i) {
        REQUIRE(world.advance(0.999 * world.stable_step()).steps == 1);
        if (i > 130) CHECK(model.watch.evaluation.piece == 0);
    }
}

}  // namespace skerry::test::step_watch_test
