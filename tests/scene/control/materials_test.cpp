// Changes of materials and surface properties during the run.
#include <catch2/catch.hpp>

#include <algorithm>

#include "engine/world/world_state.h"
#include "tests/support/worlds.h"

namespace skerry::test::control_materials_test {

namespace {

/// A bar of two layers of different materials, one of which changes.
struct LayeredBar {
    World world;
    Mesh mesh;
    MaterialHandle soft, hard;
    BodyHandle bar;

    LayeredBar(const MaterialSettings& soft_settings, const MaterialSettings& hard_settings)
        : world({.gravity = {0, 0, -9.81}}), mesh(mesh::box({0.2, 0.04, 0.04}, {10, 2, 2})) {
        mesh.label.assign(mesh.tetrahedra.size(), 1);
        for (std::size_t t = 0; t < mesh.tetrahedra.size(); ++t) {
            Real z = 0;
            for (const Index n : mesh.tetrahedra[t]) z += mesh.nodes[static_cast<std::size_t>(n)].z();
            if (z > 0) mesh.label[t] = 2;
        }
        soft = world.add_material(soft_settings);
        hard = world.add_material(hard_settings);
        bar = world.add_body(mesh, {.material = soft, .materials = {{2, hard}}, .name = "bar"});
        std::vector<Index> end;
        for (std::size_t n = 0; n < mesh.nodes.size(); ++n)
            if (mesh.nodes[n].x() < -0.1 + 1e-9) end.push_back(static_cast<Index>(n));
        world.attach(bar, end);
    }
    Real lowest() const {
        Real z = 0;
        for (const Vec3& x : world.positions(bar)) z = std::min(z, x.z());
        return z;
    }
};

}  // namespace

TEST_CASE("a changed material makes its bodies as if they had been added with it", "[scene]") {
    const MaterialSettings one{.young_modulus = 1e5, .density = 1000, .loss_factor = 0.1},
        other{.young_modulus = 3e5, .poisson_ratio = 0.3, .density = 700, .loss_factor = 0.02};
    LayeredBar changed(one, one), added(one, other);
    changed.world.set_material(changed.hard, other);
    CHECK(changed.world.mass(changed.bar) == Approx(added.world.mass(added.bar)).epsilon(1e-12));
    CHECK(changed.world.stable_step() == Approx(added.world.stable_step()).epsilon(0.05));
    const MaterialSettings now = changed.world.material(changed.hard);
    CHECK(now.young_modulus == 3e5);
    CHECK(now.poisson_ratio == 0.3);
    CHECK(now.density == 700);
    CHECK(now.loss_factor == 0.02);
    REQUIRE(changed.world.advance(0.2).ok());
    REQUIRE(added.world.advance(0.2).ok());
    CHECK(changed.lowest() == Approx(added.lowest()).epsilon(0.02));
}

TEST_CASE("a change of material reaches only the bodies that have it, and can be taken back", "[scene]") {
    World world({.gravity = {0, 0, 0}});
    const auto soft = world.add_material({.young_modulus = 1e5}), hard = world.add_material({.young_modulus = 4e5});
    const auto a = world.add_body(mesh::ball(0.05, 4), {.material = soft}),
               b = world.add_body(mesh::ball(0.05, 4), {.material = hard, .position = {1, 0, 0}});
    REQUIRE(world.advance(0.01).ok());
    const std::vector<Real> of_a = world.tetrahedron_steps(a), of_b = world.tetrahedron_steps(b);
    MaterialSettings softer = world.material(soft);
    softer.young_modulus /= 4;
    world.set_material(soft, softer);
    CHECK(world.tetrahedron_steps(b) == of_b);
    CHECK(world.tetrahedron_steps(a)[0] == Approx(2 * of_a[0]).epsilon(0.01));
    softer.young_modulus *= 4;
    world.set_material(soft, softer);
    CHECK(world.tetrahedron_steps(a)[0] == Approx(of_a[0]).epsilon(1e-9));
    softer.young_modulus *= 100;
    world.set_material(soft, softer);
    CHECK(world.stable_step() < 0.25 * of_b[0]);
    REQUIRE(world.advance(0.01).ok());
}

TEST_CASE("constants of a material that cannot change are refused by name, and nothing changes", "[scene]") {
    using Catch::Contains;
    World world;
    const auto rubber = world.add_material({});
    world.add_body(mesh::ball(0.05, 4), {.material = rubber});
    REQUIRE(world.advance(0.01).ok());
    const std::uint64_t before = world.state_hash();
    CHECK_THROWS_WITH(world.set_material(rubber, {.young_modulus = -1}), Contains("young_modulus"));
    CHECK_THROWS_WITH(world.set_material(rubber, {.model = MaterialModel::linear}), Contains("model"));
    // The waves are slower than light, and still no stable step exists.
    CHECK_THROWS_WITH(world.set_material(rubber, {.young_modulus = 1e-290, .density = 1e-306}), Contains("step"));
    CHECK(world.state_hash() == before);
    world.set_material(rubber, {.friction = 0.1, .damping = 3});
    CHECK(world.material(rubber).friction == 0.1);
    REQUIRE(world.advance(0.01).ok());
}

TEST_CASE("a change of material decides anew which elements are implicit", "[scene]") {
    Mesh mesh = mesh::box({0.1, 0.1, 0.1}, {4, 4, 4});
    for (Vec3& x : mesh.nodes)
        if ((x - Vec3(0.025, 0, 0)).norm() < 1e-9) x.x() = 0.0015;  // makes a few thin elements
    World world({.gravity = {0, 0, 0}});
    const auto rubber = world.add_material({});
    world.add_body(mesh, {.material = rubber});
    const Real before = world.stable_step();
    MaterialSettings soft = world.material(rubber);
    soft.young_modulus /= 100;
    world.set_material(rubber, soft);
    CHECK(world.stable_step() == Approx(10 * before).epsilon(0.05));
    REQUIRE(world.advance(0.05).ok());
}

TEST_CASE("friction of a material, a body and a collider can change while a block slides", "[scene]") {
    const auto acceleration = [](auto&& change) {
        Settings settings = accurate(tilted_gravity(20));
        BlockOnPlane scene(settings, {.young_modulus = 1e6, .friction = 0, .damping = 50}, {0.2, 0.2, 0.05}, {3, 3, 1});
        scene.world.advance(0.3);
        change(scene.world, scene.block);
        scene.world.advance(0.2);
        const Real before = scene.velocity().x();
        scene.world.advance(0.2);
        return (scene.velocity().x() - before) / 0.2;
    };
    const Real g = standard_gravity, a = 20 * std::numbers::pi / 180;
    const auto slides = [&](Real mu) { return Approx(g * (std::sin(a) - mu * std::cos(a))).epsilon(0.02); };
    const auto nothing = [](World&, BodyHandle) {};
    CHECK(acceleration(nothing) == slides(0));
    CHECK(acceleration([](World& world, BodyHandle block) {
              world.set_surface_properties(block, {.friction = 0.1});
              world.set_surface_properties(world.colliders()[0], {.friction = 0.1});
          }) == slides(0.1));
    // Friction of a pair is the geometric mean. A collider without its own value uses the body's.
    CHECK(acceleration([](World& world, BodyHandle block) {
              world.set_surface_properties(block, {.friction = 0.2});
          }) == slides(0.2));
    CHECK(acceleration([](World& world, BodyHandle block) {
              world.set_surface_properties(block, {.friction = 0.4});
              world.set_surface_properties(world.colliders()[0], {.friction = 0.1});
          }) == slides(0.2));
}

// Regression: with losses off, kernels leave both buffers of the spring strains alone, and every step swaps them. A
// loaded world, whose buffers are equal, then had another state_hash in every other step.
TEST_CASE("strains that elements have forgotten stay the same once losses are off", "[scene]") {
    MaterialSettings rubber{.young_modulus = 1e5};
    World world({.gravity = Vec3::Zero()});
    const MaterialHandle material = world.add_material(rubber);
    const Mesh ball = mesh::ball(0.1, 4);
    const BodyHandle body = world.add_body(ball, {.material = material});
    std::vector<Vec3> stretched = ball.nodes;
    for (Vec3& x : stretched) x.x() *= 1.2;
    world.set_positions(body, stretched);
    REQUIRE(world.advance(0.01).ok());
    rubber.loss_factor = rubber.bulk_viscosity = 0;
    world.set_material(material, rubber);
    const auto first = [&] { return WorldAccess::state_of(world).model.elements.spring_strain[0][0][0]; };
    const Real forgotten = first();
    CHECK(forgotten != 0);
    for (int i = 0; i < 3; ++i) {
        REQUIRE(world.advance(0.5 * world.stable_step()).steps == 1);
        CHECK(first() == forgotten);
    }
}

TEST_CASE("values that were set for objects can be read, also in a loaded world", "[scene]") {
    World world({.gravity = Vec3::Zero()});
    const MaterialHandle soft = world.add_material({.young_modulus = 1e5}), hard = world.add_material({});
    const BodyHandle first = world.add_body(mesh::box({0.1, 0.1, 0.1}, {1, 1, 1}), {.material = soft, .name = "first"});
    const BodyHandle body = world.add_body(mesh::box({0.1, 0.1, 0.1}, {1, 1, 1}), {.material = hard,
                                                                                   .position = {1, 0, 0},
                                                                                   .velocity = {0, 2, 0},
                                                                                   .angular_velocity = {0, 0, 3},
                                                                                   .name = "body"});
    const ColliderHandle wheel = world.add_collider(mesh::boundary(mesh::box({0.1, 0.1, 0.1}, {1, 1, 1})),
                                                    {.position = {0, 0, 2}, .name = "wheel"});
    const std::vector<Index> held{5, 1, 3};
    const AttachmentHandle attachment = world.attach(first, held);
    std::vector<Vec3> loads(world.positions(body).size(), Vec3(0, 0, 1));
    world.set_loads(body, loads);
    world.set_surface_properties(body, {.friction = 0.25});
    world.set_surface_properties(wheel, {.static_friction = 0.5, .dynamic_friction = 0.25, .restitution = 0.125});
    world.set_collision_groups(body, 4, 6);
    world.set_collision_groups(wheel, 2, 7);
    CHECK(world.velocity(body).velocity.isApprox(Vec3(0, 2, 0)));
    CHECK(world.velocity(body).angular_velocity.isApprox(Vec3(0, 0, 3)));
    world.set_velocity(wheel, {1, 0, 0}, {0, 1, 0});
    world.set_velocity(attachment, {0, 0.5, 0});
    REQUIRE(world.advance(1e-4).ok());
    const World loaded = World::from_bytes(world.to_bytes());
    CHECK(loaded.attachments() == std::vector{attachment});  // without the nodes of the mesh collider
    CHECK(loaded.body(attachment) == first);
    CHECK(loaded.nodes(attachment) == held);
    CHECK(loaded.materials() == std::vector{soft, hard});
    CHECK(loaded.material(first) == soft);
    CHECK(loaded.material(body) == hard);
    CHECK(std::ranges::equal(loaded.loads(body), loads));
    CHECK(loaded.surface_properties(body).friction == 0.25);
    CHECK_FALSE(loaded.surface_properties(body).restitution.has_value());
    CHECK_FALSE(loaded.surface_properties(first).friction.has_value());
    CHECK(loaded.surface_properties(wheel).static_friction == 0.5);
    CHECK(loaded.surface_properties(wheel).dynamic_friction == 0.25);
    CHECK(loaded.surface_properties(wheel).restitution == 0.125);
    CHECK(loaded.collision_groups(body).group == 4);
    CHECK(loaded.collision_groups(body).mask == 6);
    CHECK(loaded.collision_groups(wheel).group == 2);
    CHECK(loaded.collision_groups(wheel).mask == 7);
    CHECK(loaded.velocity(wheel).velocity == Vec3(1, 0, 0));
    CHECK(loaded.velocity(wheel).angular_velocity == Vec3(0, 1, 0));
    CHECK(loaded.velocity(attachment).velocity == Vec3(0, 0.5, 0));
}

}  // namespace skerry::test::control_materials_test
