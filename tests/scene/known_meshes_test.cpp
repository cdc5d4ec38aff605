// Data that are derived from a mesh once and shared by consecutive bodies of that mesh.
#include <array>
#include <catch2/catch.hpp>
#include <cstdint>

#include "skerry/mesh.h"
#include "skerry/world.h"

namespace skerry::test::known_meshes_test {

TEST_CASE("bodies that come one after the other have the bits of bodies that come by themselves", "[scene]") {
    Mesh ball = mesh::ball(0.05, 4), long_one = ball, labelled = ball;
    for (Vec3& node : long_one.nodes) node.x() *= 1.5;
    for (std::size_t t = 0; t < labelled.tetrahedra.size(); ++t) labelled.label.push_back(static_cast<int>(t % 2));
    for (const ElementKind element : {ElementKind::linear, ElementKind::smoothed}) {
        std::array<std::uint64_t, 2> hash{};
        for (const bool by_themselves : {false, true}) {
            World world;
            world.add_collider(Plane{});
            const MaterialHandle soft = world.add_material({.young_modulus = 2e4, .density = 900}),
                                 hard = world.add_material({.young_modulus = 5e4, .loss_factor = 0.1});
            Real x = 0;
            const auto add = [&](const Mesh& mesh, BodySettings body) {
                body.position = {x, 0, 0.08};
                body.rotation = {x, 0.3, 0};
                body.element = element;
                x += 0.2;
                const BodyHandle handle = world.add_body(mesh, body);
                if (by_themselves) CHECK(world.positions(handle).size() == mesh.nodes.size());  // settles the world
            };
            for (int round = 0; round < 2; ++round) {
                for (const Mesh* mesh : {&ball, &long_one, &ball}) add(*mesh, {.material = soft});
                add(ball, {.material = hard});
                add(ball, {.material = soft, .dynamics = BodyDynamics::rigid});
                add(labelled, {.material = soft, .materials = {{0, soft}, {1, hard}}});
                add(labelled, {.material = hard, .materials = {{0, soft}}});
            }
            world.advance(0.02);
            hash[by_themselves ? 1 : 0] = world.state_hash();
        }
        INFO("smoothed: " << (element == ElementKind::smoothed));
        CHECK(hash[0] == hash[1]);
    }
}

}  // namespace skerry::test::known_meshes_test
