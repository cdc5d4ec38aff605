// Bodies with automatic dynamics, which the engine chooses.
#include <catch2/catch.hpp>
#include <cmath>
#include <numbers>

#include "skerry/world.h"

namespace skerry::test::dynamics_choice_test {

namespace {

struct Chosen {
    BodyDynamics dynamics;
    DynamicsEstimate estimate;
};

/// Choice of the engine for a cube of 10 cm with this modulus, alone in a world.
Chosen choose(Real young_modulus, const Settings& settings = {}, bool self_contact = false) {
    World world(settings);
    const auto material = world.add_material({.young_modulus = young_modulus});
    const auto body =
        world.add_body(mesh::box(Vec3::Constant(0.1), {4, 4, 4}),
                       {.material = material, .self_contact = self_contact, .dynamics = BodyDynamics::automatic});
    return {world.dynamics(body), world.dynamics_choice(body)};
}

}  // namespace

TEST_CASE("what is stiff becomes implicit, what is soft stays explicit, and both say why", "[scene]") {
    const Chosen steel = choose(2e11);
    CHECK(steel.dynamics == BodyDynamics::implicit_elastic);
    CHECK(steel.estimate.reason == DynamicsReason::cost);
    CHECK(steel.estimate.implicit_cost < steel.estimate.explicit_cost / 2);
    CHECK(steel.estimate.implicit_step == Approx(1.0 / 120));
    CHECK(steel.estimate.explicit_step < 1e-5);
    // omega h = 1/2
    CHECK(steel.estimate.damped_above == Approx(120 / (4 * std::numbers::pi)));

    const Chosen rubber = choose(1e5);
    CHECK(rubber.dynamics == BodyDynamics::explicit_elastic);
    CHECK(rubber.estimate.reason == DynamicsReason::strain);
    // The strain is that of a bar after a fall of a metre: v = sqrt(2 g 1 m) over the wave speed sqrt(E / rho).
    CHECK(rubber.estimate.strain == Approx(std::sqrt(2 * 9.81 * 1) / std::sqrt(1e5 / 1000)));

    const Chosen folded = choose(2e11, {}, true);
    CHECK(folded.dynamics == BodyDynamics::explicit_elastic);
    CHECK(folded.estimate.reason == DynamicsReason::self_contact);
}

TEST_CASE("a body that the world's step suits stays explicit, though it is stiff", "[scene]") {
    Settings settings;
    settings.step_size = 1e-6;
    const Chosen steel = choose(2e11, settings);
    CHECK(steel.dynamics == BodyDynamics::explicit_elastic);
    CHECK(steel.estimate.reason == DynamicsReason::cost);
    CHECK(steel.estimate.explicit_cost < 2 * steel.estimate.implicit_cost);
}

TEST_CASE("step_size above the stable step is granted where what does not stand it is implicit", "[scene]") {
    Settings settings;
    settings.step_size = 1e-3;
    World world(settings);
    const auto steel = world.add_material({.young_modulus = 2e11});
    world.add_body(mesh::box(Vec3::Constant(0.1), {3, 3, 3}),
                   {.material = steel, .position = {0, 0, 0.0501}, .dynamics = BodyDynamics::automatic});
    world.add_collider(Plane{});
    const StepReport report = world.advance(0.02);
    REQUIRE(report.ok());
    CHECK(report.steps == 20);
    CHECK(report.limited == 0);
    CHECK(world.report().dynamics_choices.size() == 1);
}

TEST_CASE("where implicit bodies may take longer steps the choice counts with them", "[scene]") {
    // A block beside a soft box that requires short steps. Implicit dynamics pay off at the longer step only.
    const auto choose_beside = [](Real implicit_step) {
        Settings settings;
        settings.implicit_step = implicit_step;
        settings.gravity = {0, 0, -1};  // a slow fall with little strain
        World world(settings);
        const auto soft = world.add_material({.young_modulus = 1e5}),
                   stiff = world.add_material({.young_modulus = 5.6e7});
        world.add_body(mesh::box(Vec3::Constant(0.03), {4, 4, 4}), {.material = soft, .position = {0, 0, 1}});
        const auto block = world.add_body(mesh::box(Vec3::Constant(0.2), {6, 6, 6}),
                                          {.material = stiff, .dynamics = BodyDynamics::automatic});
        return Chosen{world.dynamics(block), world.dynamics_choice(block)};
    };
    const Chosen alike = choose_beside(0), longer = choose_beside(1.0 / 120);
    CHECK(alike.estimate.implicit_step < 1e-3);
    CHECK(alike.estimate.deforming_step == alike.estimate.implicit_step);
    CHECK(longer.estimate.implicit_step == alike.estimate.implicit_step);
    CHECK(longer.estimate.deforming_step == Approx(1.0 / 120));
    CHECK(longer.estimate.explicit_cost == alike.estimate.explicit_cost);
    CHECK(longer.estimate.damped_above == Approx(120 / (4 * std::numbers::pi)));
    CHECK(longer.estimate.implicit_cost < 0.6 * alike.estimate.implicit_cost);
    CHECK(alike.dynamics == BodyDynamics::explicit_elastic);
    CHECK(longer.dynamics == BodyDynamics::implicit_elastic);
}

TEST_CASE("a body that was chosen has the bits of one that was told", "[scene]") {
    for (const Real modulus : {1e5, 2e11}) {
        INFO(modulus << " Pa");
        std::uint64_t hash[2];
        for (const bool told : {false, true}) {
            World world;
            const auto material = world.add_material({.young_modulus = modulus});
            const BodyDynamics is = modulus > 1e6 ? BodyDynamics::implicit_elastic : BodyDynamics::explicit_elastic;
            world.add_body(
                mesh::box(Vec3::Constant(0.1), {2, 2, 2}),
                {.material = material, .position = {0, 0, 0.06}, .dynamics = told ? is : BodyDynamics::automatic});
            world.add_collider(Plane{});
            REQUIRE(world.advance(0.1).ok());
            hash[told] = world.state_hash();
        }
        CHECK(hash[0] == hash[1]);
    }
}

}  // namespace skerry::test::dynamics_choice_test
