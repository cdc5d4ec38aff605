// Bodies that are refused, and the message that says why.
#include <catch2/catch.hpp>
#include <cmath>
#include <utility>

#include "skerry/world.h"

namespace skerry::test::bad_bodies_test {

using Catch::Contains;

namespace {

/// Two tetrahedra with right-angled corners, one on each side of the plane z = 0.
Mesh two_sided() {
    return {.nodes = {Vec3(0, 0, 0), Vec3(1, 0, 0), Vec3(0, 1, 0), Vec3(0, 0, 1), Vec3(0, 0, -1)},
            .tetrahedra = {{0, 1, 2, 3}, {0, 2, 1, 4}}};
}

}  // namespace

TEST_CASE("tetrahedra that lie in each other are refused by their numbers", "[scene]") {
    World world;
    const MaterialHandle rubber = world.add_material({});
    CHECK_NOTHROW(world.add_body(two_sided(), {.material = rubber}));

    Mesh twice = two_sided();
    twice.tetrahedra.push_back({2, 0, 1, 3});  // a copy of the first tetrahedron
    CHECK_THROWS_WITH(world.add_body(twice, {.material = rubber, .name = "twice"}),
                      Contains("body 'twice'") && Contains("tetrahedra 0 and 2 on the same side of a shared face"));

    twice.tetrahedra.push_back({0, 1, 2, 3});
    CHECK_THROWS_WITH(world.add_body(twice, {.material = rubber}),
                      Contains("tetrahedra 0 and 2 on the same side of a shared face (8 such pairs)"));

    Mesh inside = two_sided();
    inside.nodes.push_back(Vec3(0.2, 0.2, 0.2));
    inside.tetrahedra.push_back({0, 1, 2, 5});  // inside the first one, on its base
    CHECK_THROWS_WITH(world.add_body(inside, {.material = rubber}), Contains("tetrahedra 0 and 2 on the same side"));
    CHECK(world.bodies().size() == 1);
}

TEST_CASE("a mesh is looked at though one like it came before, if it is not the same", "[scene]") {
    World world;
    const MaterialHandle rubber = world.add_material({});
    for (int i = 0; i < 2; ++i) CHECK_NOTHROW(world.add_body(two_sided(), {.material = rubber}));

    Mesh turned = two_sided();
    std::swap(turned.tetrahedra[1][0], turned.tetrahedra[1][1]);
    CHECK_THROWS_WITH(world.add_body(turned, {.material = rubber, .name = "turned"}), Contains("body 'turned'"));
    Mesh flat = two_sided();
    flat.nodes[4].z() = 1e-300;
    CHECK_THROWS_WITH(world.add_body(flat, {.material = rubber, .name = "flat"}), Contains("body 'flat'"));
    // A known mesh does not excuse other invalid settings.
    CHECK_THROWS_WITH(world.add_body(two_sided(), {.material = rubber, .position = Vec3(0, 0, NAN), .name = "nowhere"}),
                      Contains("body 'nowhere'") && Contains("position"));
    CHECK(world.bodies().size() == 2);
}

TEST_CASE("a mesh collider with a triangle that has a node twice is refused by its number", "[scene]") {
    World world;
    const SurfaceMesh surface{.nodes = two_sided().nodes, .triangles = {{0, 1, 2}, {0, 1, 3}}};
    CHECK_NOTHROW(world.add_collider(surface));
    for (const std::array<Index, 3>& flat : {std::array{1, 2, 2}, {2, 1, 2}, {2, 2, 1}}) {
        SurfaceMesh wrong = surface;
        wrong.triangles.push_back(flat);
        CHECK_THROWS_WITH(
            world.add_collider(wrong, {.name = "knife"}),
            Contains("collider 'knife'") &&
                Contains("triangle 2 of nodes " + std::to_string(flat[0]) + ", " + std::to_string(flat[1])) &&
                Contains("three different nodes"));
    }
    CHECK(world.colliders().size() == 1);
}

TEST_CASE("a material with waves faster than light is refused by its numbers", "[scene]") {
    World world;
    CHECK_THROWS_WITH(world.add_material({.young_modulus = 1e308}),
                      Contains("material: young_modulus, density: found 1e+308 Pa and 1000 kg/m^3"));
    CHECK_THROWS_WITH(world.add_material({.density = 1e-300}),
                      Contains("1e-300 kg/m^3, which give a wave speed of") && Contains("light"));
    CHECK_NOTHROW(world.add_material({.young_modulus = 1e12, .density = 1}));
}

TEST_CASE("a body whose stable step is not finite is refused by name, with its size and material", "[scene]") {
    World world;
    const MaterialHandle rubber = world.add_material({});
    world.add_body(mesh::box({1, 1, 1}, {2, 2, 2}), {.material = rubber, .position = {9, 0, 0}});
    const std::uint64_t before = world.state_hash();
    CHECK_THROWS_WITH(world.add_body(mesh::box({1e-30, 1e-30, 1e-30}, {2, 2, 2}), {.material = rubber, .name = "dot"}),
                      Contains("body 'dot': mesh, material: found a mean edge length of") &&
                          Contains("100000 Pa and a density of 1000 kg/m^3") && Contains("stable step"));
    CHECK(world.bodies().size() == 1);
    CHECK(world.state_hash() == before);
    CHECK(world.advance(0.01).ok());
}

TEST_CASE("a time that needs too many steps is refused with the name of the body with the shortest step", "[scene]") {
    World world;
    const MaterialHandle hard = world.add_material({.young_modulus = 1e15, .density = 0.1});
    world.add_body(mesh::box({1e-6, 1e-6, 1e-6}, {2, 2, 2}),
                   {.material = hard, .dynamics = BodyDynamics::explicit_elastic, .name = "grain"});
    CHECK_THROWS_WITH(world.advance(1),
                      Contains("dt: found 1 s in steps of") && Contains("stable step of body 'grain'"));
}

}  // namespace skerry::test::bad_bodies_test
