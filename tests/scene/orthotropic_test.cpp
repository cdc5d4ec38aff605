// Bodies of orthotropic material: axes that turn with the mesh, stable steps, implicit bodies, saving, and refusals.
#include <Eigen/Geometry>
#include <catch2/catch.hpp>
#include <cmath>
#include <string>
#include <vector>

#include "skerry/materials.h"
#include "skerry/scene.h"
#include "tests/support/element_kinds.h"
#include "tests/support/same_bits.h"
#include "tests/support/worlds.h"

namespace skerry::test::scene_orthotropic_test {

namespace {

/// Stiff along the axis of the first direction, soft across it.
OrthotropicModuli composite() {
    return {.young_modulus = {2e6, 1e5, 5e4},
            .poisson_ratio = {0.3, 0.35, 0.25},
            .shear_modulus = {6e4, 2e4, 4e4},
            .first_axis = {0, 0, 1},
            .second_axis = {1, 0, 0}};
}

struct Bar {
    Mesh mesh = mesh::box({0.06, 0.06, 0.12}, {2, 2, 4});
    World world;
    BodyHandle body;

    explicit Bar(const MaterialSettings& material, BodyDynamics dynamics = BodyDynamics::explicit_elastic,
                 ElementKind kind = ElementKind::smoothed, const Settings& settings = accurate(Vec3::Zero()),
                 const Vec3& rotation = Vec3::Zero())
        : world(settings) {
        body = world.add_body(mesh, {.material = world.add_material(material),
                                     .rotation = rotation,
                                     .dynamics = dynamics,
                                     .element = kind,
                                     .name = "bar"});
    }
    void deform(const Mat3& F) { test::deform(world, body, mesh, F); }
};

MaterialSettings wood() {
    return lossless(orthotropic(composite(), {.density = 800}));
}

}  // namespace

TEST_CASE("the axes of an orthotropic material turn with the mesh, for all kinds of elements", "[scene]") {
    const Vec3 rotation(0.4, -1.2, 0.8);
    const Mat3 turn = Eigen::AngleAxis<Real>(rotation.norm(), rotation.normalized()).toRotationMatrix();
    for (const ElementKind kind : element_kinds)
        for (const BodyDynamics dynamics : {BodyDynamics::explicit_elastic, BodyDynamics::implicit_elastic}) {
            INFO(name_of(kind) << ", implicit " << (dynamics == BodyDynamics::implicit_elastic));
            Bar bar(wood(), dynamics, kind, accurate(Vec3::Zero()), rotation);
            // A pull along the first axis of the material, z in the mesh. Second axis: x, third axis: y.
            constexpr Real small = 1e-6;
            const Mat3 strain = small * Mat3(Vec3(-0.3, -0.25, 1).asDiagonal());
            bar.deform(turn * (Mat3::Identity() + strain));
            for (const Mat3& stress : bar.world.stress(bar.body)) {
                const Mat3 in_mesh = turn.transpose() * stress * turn;
                CHECK(in_mesh(2, 2) == Approx(2e6 * small).epsilon(1e-5));
                CHECK((in_mesh - Mat3(Vec3(0, 0, in_mesh(2, 2)).asDiagonal())).norm() < 1e-5 * in_mesh(2, 2));
            }
            // After a change of the dynamics the axes are those of the mesh, in the present pose.
            bar.world.set_dynamics(bar.body, BodyDynamics::rigid);
            bar.world.set_dynamics(bar.body, BodyDynamics::explicit_elastic);
            CHECK(bar.world.report().energy.elastic < 1e-9);
            bar.deform(turn * (Mat3::Identity() + strain));
            for (const Mat3& stress : bar.world.stress(bar.body))
                CHECK((turn.transpose() * stress * turn)(2, 2) == Approx(2e6 * small).epsilon(1e-4));
        }
}

TEST_CASE("an orthotropic body keeps energy and momenta at its stable step, however it is turned", "[scene]") {
    const Real step = Bar(wood()).world.stable_step();
    // The energy of symplectic Euler oscillates in proportion to the step, but does not grow.
    for (const Real share : {1.0, 0.05})
        for (const Vec3& rotation : {Vec3(0, 0, 1e-9), Vec3(1, 2, 0.5)}) {
            Settings settings = accurate(Vec3::Zero());
            if (share < 1) settings.step_size = share * step;
            Bar bar(wood(), BodyDynamics::explicit_elastic, ElementKind::smoothed, settings, rotation);
            CHECK(bar.world.stable_step() == Approx(step).epsilon(1e-6));
            const Mat3 turn = Eigen::AngleAxis<Real>(rotation.norm(), rotation.normalized()).toRotationMatrix();
            bar.deform(turn * Mat3(Vec3(1.05, 0.97, 1.03).asDiagonal()));
            const Real start = energy_of(bar.world), tolerance = share < 1 ? 0.05 : 0.7;
            for (int k = 0; k < 40; ++k) {
                REQUIRE(bar.world.advance(2e-3).ok());
                CHECK(energy_of(bar.world) == Approx(start).epsilon(tolerance));
            }
            CHECK(bar.world.report().momentum.norm() < 1e-12 * std::sqrt(start));
        }
    // A wave along the stiff axis takes at least one step from node to node.
    CHECK(step < 0.03 / std::sqrt(2e6 / 800));
}

TEST_CASE("orthotropic bodies continue with the same bits, and can be read back and changed", "[scene]") {
    const auto simulate = [](int threads) {
        Settings settings = accurate();
        settings.threads = threads;
        Bar bar(orthotropic(composite()), BodyDynamics::explicit_elastic, ElementKind::smoothed, settings, {0.3, 0, 1});
        bar.world.add_collider(Plane{.point = {0, 0, -0.08}});
        REQUIRE(bar.world.advance(0.02).ok());
        return bar;
    };
    check_same_bits(simulate, [](World& world) { REQUIRE(world.advance(0.05).ok()); });
    CHECK(simulate(3).world.state_hash() == simulate(1).world.state_hash());
    Bar bar = simulate(1);
    const MaterialHandle handle = bar.world.material(bar.body);
    const MaterialSettings before = bar.world.material(handle);
    CHECK(before.orthotropic == composite());
    CHECK(before.young_modulus == Approx(orthotropic(composite()).young_modulus));
    const std::uint64_t hash = bar.world.state_hash();
    bar.world.set_material(handle, before);
    CHECK(bar.world.state_hash() == hash);
    MaterialSettings stiffer = before;
    stiffer.orthotropic.young_modulus *= 4;
    stiffer.orthotropic.shear_modulus *= 4;
    bar.world.set_material(handle, stiffer);
    CHECK(bar.world.stable_step() < 0.6 * simulate(1).world.stable_step());
}

TEST_CASE("orthotropic constants without a positive definite stiffness are refused with the condition", "[scene]") {
    using Catch::Matchers::Contains;
    const auto refused = [](auto&& change, const char* text) {
        OrthotropicModuli moduli = composite();
        change(moduli);
        CHECK_THROWS_WITH(orthotropic(moduli), Contains(text));
        CHECK_THROWS_WITH(World().add_material({.model = MaterialModel::orthotropic, .orthotropic = moduli}),
                          Contains(text));
    };
    refused([](OrthotropicModuli& m) { m.young_modulus[1] = -1; },
            "material: orthotropic.young_modulus[1]: found -1, expected a modulus > 0 (Pa)");
    refused([](OrthotropicModuli& m) { m.shear_modulus[2] = 0; }, "orthotropic.shear_modulus[2]: found 0");
    refused(
        [](OrthotropicModuli& m) { m.poisson_ratio[1] = 1.5; },
        "orthotropic.poisson_ratio[1]: found 1.5, expected a number between -1.41421 and 1.41421, the root of E2/E3");
    refused([](OrthotropicModuli& m) { m.poisson_ratio = {4, 1.2, 5}; }, "1 - nu12^2 E2/E1 - nu23^2 E3/E2");
    refused([](OrthotropicModuli& m) { m.second_axis = m.first_axis; }, "two directions that are not parallel");
    const auto scene = [](const std::string& keys) {
        return R"({"materials": {"wood": {"orthotropic": {"young_modulus": [2e6, 1e5, 5e4], "poisson_ratio":
            [0.3, 0.35, 0.25], "shear_modulus": [6e4, 2e4, 4e4], "first_axis": [0, 0, 1], "second_axis": [1, 0, 0]})" +
               keys + R"(}}, "bodies": [{"name": "bar", "mesh": {"box": {"size": [1, 1, 1], "cells": [1, 1, 1]}},
            "material": "wood"}]})";
    };
    Scene loaded = load_scene_text(scene(""), ".");
    CHECK(loaded.world.material(loaded.world.materials()[0]).orthotropic == composite());
    CHECK_THROWS_WITH(load_scene_text(scene(R"(, "E": 1e5)"), "."), Contains("at most one of the keys"));
}

}  // namespace skerry::test::scene_orthotropic_test
