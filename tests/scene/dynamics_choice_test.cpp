// Bodies with automatic dynamics, which the engine chooses.
#include <catch2/catch.hpp>
#include <cmath>
#include <numbers>
#include <optional>

#include "engine/world/edit/edit_model.h"
#include "engine/world/world_state.h"
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
        world.add_body(mesh::box(Vec3::Constant(0.1), {4, 4, 4}), {.material = material, .self_contact = self_contact});
    return {world.dynamics(body), world.dynamics_choice(body)};
}

}  // namespace

TEST_CASE("stiff bodies become implicit, soft bodies stay explicit, and both report the reason", "[scene]") {
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

TEST_CASE("implicit bodies have no losses: a set loss_factor makes automatic explicit, and is refused else",
          "[scene]") {
    World world;
    const auto steel = world.add_material({.young_modulus = 2e11}),
               with_losses = world.add_material({.young_modulus = 2e11, .loss_factor = 0.01}),
               without = world.add_material({.young_modulus = 2e11, .loss_factor = 0});
    const Mesh cube = mesh::box(Vec3::Constant(0.1), {2, 2, 2});
    const auto add = [&](MaterialHandle material, BodyDynamics dynamics) {
        return world.add_body(cube, {.material = material, .dynamics = dynamics, .name = "cube"});
    };
    CHECK(world.dynamics(add(without, BodyDynamics::automatic)) == BodyDynamics::implicit_elastic);
    const auto implicit = add(steel, BodyDynamics::implicit_elastic);
    const auto chosen = add(with_losses, BodyDynamics::automatic);
    CHECK(world.dynamics(chosen) == BodyDynamics::explicit_elastic);
    CHECK(world.dynamics_choice(chosen).reason == DynamicsReason::losses);

    const std::string refusal = "'cube': loss_factor";
    const std::uint64_t before = world.state_hash();
    CHECK_THROWS_WITH(add(with_losses, BodyDynamics::implicit_elastic), Catch::Contains(refusal));
    CHECK_THROWS_WITH(world.set_dynamics(chosen, BodyDynamics::implicit_elastic), Catch::Contains("loss_factor"));
    MaterialSettings lossy = world.material(steel);
    CHECK_FALSE(lossy.loss_factor.has_value());
    lossy.loss_factor = 0.1;
    CHECK_THROWS_WITH(world.set_material(steel, lossy), Catch::Contains("loss_factor"));
    CHECK(world.state_hash() == before);
    CHECK(world.dynamics(implicit) == BodyDynamics::implicit_elastic);
    CHECK(world.material(with_losses).loss_factor == 0.01);
    CHECK(world.material(without).loss_factor == 0.0);
}

TEST_CASE("a body that the world's step suits stays explicit, though it is stiff", "[scene]") {
    Settings settings;
    settings.step_size = 1e-6;
    const Chosen steel = choose(2e11, settings);
    CHECK(steel.dynamics == BodyDynamics::explicit_elastic);
    CHECK(steel.estimate.reason == DynamicsReason::cost);
    CHECK(steel.estimate.explicit_cost < 2 * steel.estimate.implicit_cost);
}

TEST_CASE("step_size above the stable step is accepted if all bodies with shorter stable steps are implicit",
          "[scene]") {
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
    // A block beside a soft box that requires short steps.
    const auto choose_beside = [](Real implicit_step) {
        Settings settings;
        settings.implicit_step = implicit_step;
        World world(settings);
        const auto soft = world.add_material({.young_modulus = 1e5}),
                   stiff = world.add_material({.young_modulus = 1e9});
        world.add_body(mesh::box(Vec3::Constant(0.03), {4, 4, 4}), {.material = soft, .position = {0, 0, 1}});
        const auto block = world.add_body(mesh::box(Vec3::Constant(0.2), {6, 6, 6}), {.material = stiff});
        return Chosen{world.dynamics(block), world.dynamics_choice(block)};
    };
    const Chosen alike = choose_beside(0), longer = choose_beside(1.0 / 120);
    CHECK(alike.estimate.implicit_step < 1e-3);
    CHECK(alike.estimate.deforming_step == alike.estimate.implicit_step);
    CHECK(longer.estimate.implicit_step == alike.estimate.implicit_step);
    CHECK(longer.estimate.deforming_step == Approx(1.0 / 120));
    CHECK(longer.estimate.explicit_cost == alike.estimate.explicit_cost);
    CHECK(longer.estimate.damped_above == Approx(120 / (4 * std::numbers::pi)));
    // Contacts still take part in every short step. They are assumed to be those of a body in a pile.
    CHECK(longer.estimate.implicit_cost < 0.99 * alike.estimate.implicit_cost);
}

TEST_CASE("without gravity a soft body stays explicit, because nothing is known about its later speed", "[scene]") {
    Settings settings;
    settings.gravity = Vec3::Zero();
    const Chosen rubber = choose(1e5, settings);
    CHECK(rubber.dynamics == BodyDynamics::explicit_elastic);
    CHECK(rubber.estimate.reason == DynamicsReason::strain);
    CHECK(choose(2e11, settings).dynamics == BodyDynamics::implicit_elastic);
}

TEST_CASE("in a pile of stiff cubes the predicted costs are those that were measured", "[scene]") {
    // 27 such cubes took 0.67 s of CPU time per simulated second as implicit and 4.5 s as explicit bodies.
    World world;
    const auto material = world.add_material({.young_modulus = 1e8, .poisson_ratio = 0.3, .friction = 0.5});
    const auto cube = world.add_body(mesh::box(Vec3::Constant(0.1), {2, 2, 2}), {.material = material});
    CHECK(world.dynamics(cube) == BodyDynamics::implicit_elastic);
    const DynamicsEstimate estimate = world.dynamics_choice(cube);
    CHECK(27 * estimate.implicit_cost == Approx(0.67).epsilon(0.5));
    CHECK(27 * estimate.explicit_cost == Approx(4.5).epsilon(0.5));
}

TEST_CASE("an implicit body becomes explicit when a later body requires short steps, if this costs less", "[scene]") {
    World world;
    const auto firm = world.add_material({.young_modulus = 1e8}), steel = world.add_material({.young_modulus = 2e11}),
               rubber = world.add_material({.young_modulus = 1e5});
    const Mesh cube = mesh::box(Vec3::Constant(0.1), {4, 4, 4});
    const auto changes = world.add_body(cube, {.material = firm, .velocity = {1, 0, 0}, .name = "changes"}),
               stays = world.add_body(cube, {.material = steel, .position = {1, 0, 0}}),
               told = world.add_body(
                   cube, {.material = firm, .position = {-1, 0, 0}, .dynamics = BodyDynamics::implicit_elastic});
    world.add_body(mesh::box(Vec3::Constant(1), {2, 2, 2}), {.material = rubber, .position = {0, 0, 9}});
    CHECK(world.dynamics(changes) == BodyDynamics::implicit_elastic);  // the long steps of a large body suit it
    REQUIRE(world.advance(0.01).ok());
    const Vec3 before = world.center_of_mass(changes);
    world.add_body(mesh::box(Vec3::Constant(0.03), {4, 4, 4}), {.material = rubber, .position = {0, 0, 5}});
    CHECK(world.dynamics(changes) == BodyDynamics::explicit_elastic);
    CHECK(world.dynamics(stays) == BodyDynamics::implicit_elastic);
    CHECK(world.dynamics(told) == BodyDynamics::implicit_elastic);
    const DynamicsEstimate now = world.dynamics_choice(changes);
    CHECK(now.reason == DynamicsReason::cost);
    CHECK(now.implicit_step < 1e-3);
    CHECK(2 * now.implicit_cost > now.explicit_cost);
    CHECK(world.name(changes) == "changes");
    CHECK((world.center_of_mass(changes) - before).norm() < 1e-12);  // rounding
    CHECK((world.velocities(changes)[0] - Vec3(1, 0, -9.81 * 0.01)).norm() < 1e-9);
    REQUIRE(world.advance(1e-3).ok());
}

TEST_CASE("with default settings a stiff block holds half a degree below the critical angle", "[scene]") {
    constexpr Real mu = 0.3;
    const Real angle = std::atan(mu) - 0.5 * std::numbers::pi / 180;
    Settings settings;
    settings.gravity = 9.81 * Vec3(std::sin(angle), 0, -std::cos(angle));
    World world(settings);
    const auto material = world.add_material({.young_modulus = 1e8, .poisson_ratio = 0.3, .friction = mu});
    const auto block =
        world.add_body(mesh::box({0.2, 0.2, 0.1}, {4, 4, 2}), {.material = material, .position = {0, 0, 0.05}});
    world.add_collider(Plane{});
    const Vec3 start = world.center_of_mass(block);
    REQUIRE(world.advance(1).ok());
    CHECK(world.asleep(block));
    // Shear under the weight, rho g h^2/(2 G), is 4e-7 m. As an explicit body the block slides by 4 mm.
    CHECK(std::abs(world.center_of_mass(block).x() - start.x()) < 1e-6);
}

TEST_CASE("a body that became implicit by itself becomes explicit when it is attached", "[scene]") {
    World world;
    const auto steel = world.add_material({.young_modulus = 2e11});
    const Mesh box = mesh::box(Vec3::Constant(0.1), {2, 2, 2});
    const auto other = world.add_body(box, {.material = steel, .position = {1, 0, 0}}),
               chosen = world.add_body(box, {.material = steel, .name = "chosen"}),
               told = world.add_body(
                   box, {.material = steel, .position = {-1, 0, 0}, .dynamics = BodyDynamics::implicit_elastic});
    REQUIRE(world.dynamics(chosen) == BodyDynamics::implicit_elastic);
    const Index corner[] = {0};
    CHECK_THROWS_AS(world.attach(told, corner), SceneError);  // one node does not hold a frame
    const std::vector<Index> face{0, 1, 2, 3, 4};
    CHECK_THROWS_AS(world.attach(chosen, corner, {.velocity = Vec3::Constant(infinity)}), SceneError);
    CHECK_THROWS_WITH(world.attach(chosen, corner, {.angular_velocity = Vec3::UnitZ()}, Vec3::Zero(), {Vec3::UnitX()}),
                      Catch::Contains("a motion with a rotation"));
    CHECK(world.dynamics(chosen) == BodyDynamics::implicit_elastic);  // a refused call changes nothing
    world.attach(chosen, corner);
    world.attach(told, face);
    CHECK(world.dynamics(chosen) == BodyDynamics::explicit_elastic);
    CHECK(world.dynamics_choice(chosen).reason == DynamicsReason::given);
    CHECK(world.name(chosen) == "chosen");
    CHECK(world.dynamics(told) == BodyDynamics::implicit_elastic);
    CHECK(world.dynamics(other) == BodyDynamics::implicit_elastic);
    const Vec3 held = world.positions(chosen)[0];
    REQUIRE(world.advance(1e-4).ok());
    CHECK(world.positions(chosen)[0] == held);
}

TEST_CASE("the elements of equal bodies are tried once", "[scene]") {
    World world;
    WorldState& state = WorldAccess::state_of(world);
    Model& model = state.model;
    const MaterialHandle steel = world.add_material({.young_modulus = 2e11});
    const Mesh mesh = mesh::box(Vec3::Constant(0.1), {2, 2, 2});
    NewBody body{.element = BodySettings{}.element,
                 .material = model.row(steel, "test"),
                 .nodes = mesh.nodes,
                 .tetrahedra = mesh.tetrahedra,
                 .triangles = {},
                 .position = Vec3::Zero(),
                 .rotation = Mat3::Identity(),
                 .velocity = Vec3::Zero(),
                 .angular_velocity = Vec3::Zero()};
    DynamicsEstimate first, second;
    std::optional<KnownElements> trial;
    REQUIRE(choose_dynamics(model, body, first, trial) == BodyDynamics::implicit_elastic);
    REQUIRE(trial);
    // The first body becomes implicit and has no elements. The results of its trial are stored all the same.
    world.add_body(mesh, {.material = steel});
    REQUIRE(model.known_elements.size() == 1);
    CHECK(model.known_elements[0].rest_step == trial->rest_step);
    trial.reset();
    CHECK(choose_dynamics(model, body, second, trial) == BodyDynamics::implicit_elastic);
    CHECK(!trial);
    CHECK(second.explicit_cost == first.explicit_cost);
    // An explicit body uses the results as if it had computed them itself.
    const auto as_explicit = [&](World& in, MaterialHandle material) {
        const BodyHandle added = in.add_body(mesh, {.material = material, .dynamics = BodyDynamics::explicit_elastic});
        return WorldAccess::state_of(in)
            .model.bodies.rest_step[static_cast<std::size_t>(WorldAccess::state_of(in).model.row(added, "test"))];
    };
    World alone;
    CHECK(as_explicit(world, steel) == as_explicit(alone, alone.add_material({.young_modulus = 2e11})));
}

TEST_CASE("automatic dynamics give the bits of the same dynamics given by hand", "[scene]") {
    for (const Real modulus : {1e5, 2e11}) {
        INFO(modulus << " Pa");
        std::uint64_t hash[2];
        for (const bool by_hand : {false, true}) {
            World world;
            const auto material = world.add_material({.young_modulus = modulus});
            const BodyDynamics is = modulus > 1e6 ? BodyDynamics::implicit_elastic : BodyDynamics::explicit_elastic;
            world.add_body(
                mesh::box(Vec3::Constant(0.1), {2, 2, 2}),
                {.material = material, .position = {0, 0, 0.06}, .dynamics = by_hand ? is : BodySettings{}.dynamics});
            world.add_collider(Plane{});
            REQUIRE(world.advance(0.1).ok());
            hash[by_hand] = world.state_hash();
        }
        CHECK(hash[0] == hash[1]);
    }
}

}  // namespace skerry::test::dynamics_choice_test
