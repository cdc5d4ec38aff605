// Named sets of bodies in a world.
#include "skerry/sets.h"

#include <catch2/catch.hpp>

#include "tests/support/worlds.h"

namespace skerry::test::sets_test {

using Catch::Matchers::Contains;
using Names = std::vector<std::string>;

namespace {

Mesh cube() {
    Mesh mesh = mesh::box({1, 1, 1}, {2, 2, 2});
    mesh.label.assign(mesh.tetrahedra.size(), 4);
    mesh.sets["corner"] = {.nodes = {0}};
    mesh.sets["core"] = {.tetrahedra = {1, 2}};
    return mesh;
}

}  // namespace

TEST_CASE("a body has the sets and labels of its mesh, also as a copy, from a file and with other dynamics",
          "[scene]") {
    World world{Settings{}};
    const auto body =
        world.add_body(cube(), {.material = world.add_material({}), .dynamics = BodyDynamics::explicit_elastic});
    Sets(world).add(body, "more", {.nodes = {5, 3, 5}});
    const std::uint64_t hash = world.state_hash();
    World loaded = World::from_bytes(world.to_bytes()), copy = world.clone();
    CHECK(loaded.state_hash() == hash);
    world.set_dynamics(body, BodyDynamics::rigid);
    for (World* tested : {&world, &loaded, &copy}) {
        const Sets sets(*tested);
        CHECK(sets.names(body) == Names{"core", "corner", "more"});
        CHECK(sets.get(body, "core") == MeshSet{.tetrahedra = {1, 2}});
        CHECK(sets.nodes(body, "more") == std::vector<Index>{3, 5});
        CHECK(sets.labels(body).size() == cube().tetrahedra.size());
        CHECK(sets.labels(body).back() == 4);
    }
    Sets(world).remove(body, "corner");
    CHECK(Sets(world).names(body) == Names{"core", "more"});
}

TEST_CASE("sets that do not fit a body are refused by name", "[scene]") {
    World world{Settings{}};
    const auto material = world.add_material({});
    const auto body = world.add_body(cube(), {.material = material, .name = "cube"});
    Sets sets(world);
    CHECK_THROWS_WITH(sets.nodes(body, "cornr"),
                      Contains("body 'cube': set: found \"cornr\", expected one of the sets \"core\", \"corner\" (did "
                               "you mean \"corner\"?)"));
    CHECK_THROWS_WITH(sets.faces(body, "corner"), Contains("contains no face"));
    CHECK_THROWS_WITH(sets.tetrahedra(body, "corner"), Contains("contains no tetrahedron"));
    CHECK_THROWS_WITH(sets.add(body, "core", {.nodes = {1}}), Contains("already the name of a set"));
    CHECK_THROWS_WITH(sets.add(body, "a", {}), Contains("the empty set \"a\""));
    CHECK_THROWS_WITH(sets.add(body, "a", {.nodes = {27}}), Contains("sets[\"a\"]: found node 27, expected numbers"));
    CHECK_THROWS_WITH(sets.add(body, "a", {.faces = {{0, 1, 26}}}), Contains("a face of a tetrahedron"));
    Mesh wrong = cube();
    wrong.sets["far"] = {.tetrahedra = {1000}};
    CHECK_THROWS_WITH(world.add_body(wrong, {.material = material, .name = "b"}),
                      Contains("body 'b': sets[\"far\"]: found tetrahedron 1000"));
    CHECK_THROWS_WITH(world.add_body(cube(), {.material = material, .materials_of_sets = {{"cor", material}}}),
                      Contains("materials_of_sets: found \"cor\""));
}

}  // namespace skerry::test::sets_test
