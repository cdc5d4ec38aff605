// Elements of a freely flying body are skipped (docs/methods/skipping.md 1.1). The body is compared with a twin in
// which one node's velocity differs in the last bit, so that its elements are not skipped.
#include <algorithm>
#include <catch2/catch.hpp>
#include <cmath>

#include "engine/world/world_state.h"
#include "systems/dynamics/elements/find_unstrained.h"
#include "tests/support/same_bits.h"
#include "tests/support/sliver_box.h"
#include "tests/support/worlds.h"

namespace skerry::test::flight_test {

namespace {

/// A block above a floor.
struct Fall {
    World world;
    MaterialHandle material;
    BodyHandle body;

    explicit Fall(const Settings& settings, const MaterialSettings& rubber = {.young_modulus = 1e5},
                  const Mesh& mesh = mesh::box({0.2, 0.2, 0.1}, {4, 4, 2}), Real height = 0.1)
        : world(settings), material(world.add_material(rubber)) {
        world.add_collider(Plane{});
        body = world.add_body(mesh, {.material = material,
                                     .position = {0, 0, 0.1 + height},
                                     .rotation = {0.3, 0.2, 0.1},
                                     .velocity = {0.5, 0.25, 0}});
    }
    /// Changes one velocity by its last bit, which does not visibly change the motion.
    void nudge() {
        std::vector<Vec3> velocity(world.velocities(body).begin(), world.velocities(body).end());
        velocity.back().x() = std::nextafter(velocity.back().x(), 1);
        world.set_velocities(body, velocity);
    }
    Real apart(const Fall& other) const {
        Real most = 0;
        const auto a = world.positions(body), b = other.world.positions(other.body);
        for (std::size_t n = 0; n < a.size(); ++n) most = std::max(most, (a[n] - b[n]).norm());
        return most;
    }
};

Settings with_gravity() {
    Settings settings;
    settings.tolerance = 1e-10;
    settings.max_iterations = 20000;
    return settings;
}

}  // namespace

TEST_CASE("a flying body computes no elements until it touches, and bounces like its twin", "[scene]") {
    Settings settings = with_gravity();
    settings.integrator = GENERATE(Integrator::symplectic_euler, Integrator::leapfrog);
    const Real damping = GENERATE(0.0, 3.0);
    INFO(name_of(settings.integrator) << ", damping " << damping);
    Fall fall(settings, {.young_modulus = 1e5, .damping = damping}),
        twin(settings, {.young_modulus = 1e5, .damping = damping});
    twin.nudge();
    for (Fall* one : {&fall, &twin}) REQUIRE(one->world.advance(0.1).ok());
    CHECK(fall.world.report().unstrained == fall.world.report().steps);
    CHECK(twin.world.report().unstrained == 0);
    CHECK(fall.apart(twin) < 1e-12);
    const auto velocity = fall.world.velocities(fall.body);
    CHECK(std::ranges::all_of(velocity, [&](const Vec3& v) { return v == velocity.front(); }));
    for (Fall* one : {&fall, &twin}) REQUIRE(one->world.advance(0.2).ok());
    CHECK(fall.world.report().max_contacts > 0);
    CHECK(fall.world.report().unstrained < fall.world.report().steps);
    CHECK(fall.world.energy().elastic == Approx(twin.world.energy().elastic).epsilon(1e-6));
    CHECK(fall.apart(twin) < 1e-8);
}

TEST_CASE("bodies with clusters fly as others do", "[scene][clusters][long]") {
    Settings settings = with_gravity();
    settings.tolerance = 1e-8;
    const Mesh mesh = sliver_box(0.2, 8, 0.01, 0.005);
    Fall fall(settings, {.young_modulus = 1e5}, mesh), twin(settings, {.young_modulus = 1e5}, mesh);
    REQUIRE(fall.world.advance(0).ok());
    REQUIRE(fall.world.report().clusters > 0);
    twin.nudge();
    for (Fall* one : {&fall, &twin}) REQUIRE(one->world.advance(0.05).ok());
    CHECK(fall.world.report().unstrained == fall.world.report().steps);
    CHECK(twin.world.report().unstrained == 0);
    CHECK(fall.apart(twin) < 1e-12);
}

TEST_CASE("nodes that are moved, pushed or loaded end the flight", "[scene]") {
    Settings settings;
    settings.gravity = Vec3::Zero();
    settings.start_overlaps = StartOverlaps::ignore;
    SECTION("by a hand") {
        Fall fall(settings);
        REQUIRE(fall.world.advance(0.01).ok());
        std::vector<Vec3> position(fall.world.positions(fall.body).begin(), fall.world.positions(fall.body).end());
        position[0] -= Vec3(1e-3, 0, 0);
        fall.world.set_positions(fall.body, position);
        const std::uint64_t before = fall.world.report().unstrained;
        CHECK(before == fall.world.report().steps);
        REQUIRE(fall.world.advance(0.01).ok());
        CHECK(fall.world.report().unstrained == before);
        CHECK(fall.world.energy().elastic > 0);
    }
    SECTION("by a contact that pushes and gives no velocity") {
        Fall fall(settings), twin(settings);
        for (Fall* one : {&fall, &twin}) {
            std::vector<Vec3> position;
            for (const Vec3& x : one->world.positions(one->body)) position.push_back(x - Vec3(0, 0, 0.13));
            one->world.set_positions(one->body, position);
            one->world.set_velocity(one->body, Vec3::Zero());
        }
        twin.nudge();
        for (Fall* one : {&fall, &twin}) REQUIRE(one->world.advance(0.05).ok());
        CHECK(fall.world.report().max_penetration > 0);
        CHECK(fall.world.report().unstrained < fall.world.report().steps / 2);
        CHECK(fall.apart(twin) < 1e-9);
    }
    SECTION("by a load") {
        Fall fall(settings), twin(settings);
        twin.nudge();
        for (Fall* one : {&fall, &twin}) {
            REQUIRE(one->world.advance(0.01).ok());
            std::vector<Vec3> load(one->world.positions(one->body).size(), Vec3::Zero());
            load[3] = {0, 0.1, 0};
            one->world.set_loads(one->body, load);
            REQUIRE(one->world.advance(0.05).ok());
        }
        CHECK(fall.world.report().unstrained < fall.world.report().steps / 2);
        CHECK(fall.apart(twin) < 1e-12);
    }
}

TEST_CASE("a body in flight stays known as unstrained while contacts push another body", "[scene]") {
    Settings settings;
    settings.start_overlaps = StartOverlaps::ignore;
    Fall fall(settings);
    fall.world.add_body(mesh::box({0.2, 0.2, 0.1}, {4, 4, 2}), {.material = fall.material, .position = {2, 0, 5}});
    std::vector<Vec3> position;
    for (const Vec3& x : fall.world.positions(fall.body)) position.push_back(x - Vec3(0, 0, 0.13));
    fall.world.set_positions(fall.body, position);
    fall.world.set_velocity(fall.body, Vec3::Zero());
    REQUIRE(fall.world.advance(0.05).ok());
    CHECK(fall.world.report().max_penetration > 0);
    // The mark of a body counts its steps without a new check of the strains.
    const auto steps = static_cast<Index>(fall.world.report().steps);
    REQUIRE(steps > 10);
    CHECK(WorldAccess::state_of(fall.world).model.bodies.unstrained[1] == unstrained_steps - (steps - 1));
}

TEST_CASE("a flight goes on with the same bits from a file and on any number of threads", "[scene]") {
    const MaterialModel model = GENERATE(MaterialModel::stable_neo_hookean, MaterialModel::corotational);
    const auto simulate = [&](int threads) {
        Settings settings;
        settings.threads = threads;
        Fall fall(settings, {.young_modulus = 1e5, .model = model});
        REQUIRE(fall.world.advance(0.05).ok());
        CHECK(fall.world.report().unstrained > 0);
        return fall;
    };
    check_same_bits(simulate, [](World& world) { REQUIRE(world.advance(0.3).ok()); });
}

}  // namespace skerry::test::flight_test
