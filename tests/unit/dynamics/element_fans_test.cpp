// Fans of tetrahedra around edges, and the forces that are added by fans.
#include "systems/dynamics/elements/element_fans.h"

#include <catch2/catch.hpp>

#include <algorithm>
#include <set>

#include "tests/support/elastic_body.h"
#include "tests/support/material_models.h"

namespace skerry::test::element_fans_test {

using test::ElasticBody;
using test::jittered_box;

namespace {

/// A box of which a third of the tetrahedra, chosen by chance, are missing: most fans are short.
test::TetMesh box_with_holes() {
    test::TetMesh mesh = jittered_box({6, 6, 6}, 0.1, 0.2, 3);
    std::mt19937_64 random(4);
    std::erase_if(mesh.tetrahedra, [&](const auto&) { return random() % 3 == 0; });
    return mesh;
}

/// Tetrahedra that all have one edge, in three rings: no mesh that a body may have, but fans do not care.
test::TetMesh book() {
    test::TetMesh mesh;
    mesh.nodes = {Vec3(0, 0, 0), Vec3(0, 0, 1)};
    for (Index page = 0; page < 40; ++page) {
        const Real angle = 0.5 * page;
        mesh.nodes.push_back(Vec3(std::cos(angle), std::sin(angle), 0.5));
        if (page > 0) mesh.tetrahedra.push_back({0, 1, page + 1, page + 2});
    }
    return mesh;
}

struct FanCount {
    std::size_t blocks = 0, going_on = 0, longest = 0;
};
FanCount count_fans(const ElementBlockTable& elements) {
    FanCount count;
    std::size_t length = 0;
    for (const std::uint8_t goes_on : elements.continues_fan) {
        length = goes_on != 0 ? length + 1 : 1;
        ++count.blocks;
        count.going_on += goes_on;
        count.longest = std::max(count.longest, length);
    }
    return count;
}

}  // namespace

TEST_CASE("in fans are the elements of the list, each once, with the gradients of its nodes", "[unit]") {
    const test::TetMesh mesh = GENERATE(jittered_box({6, 5, 4}, 0.1, 0.2, 1), box_with_holes(), book());
    const ElasticBody body(mesh, material_constants(MaterialModel::linear, 1e5, 0.3, 1000));
    std::vector<int> times(body.list.size(), 0);
    for (std::size_t place = 0; place < body.element_at.size(); ++place) {
        if (body.element_at[place] == no_index) continue;
        const auto e = static_cast<std::size_t>(body.element_at[place]);
        ++times[e];
        std::set<Index> seen;
        for (std::size_t k = 0; k < 4; ++k) {
            const auto node = static_cast<Index>(body.node(place, k));
            seen.insert(node);
            const auto at =
                std::find(body.list.node.begin() + static_cast<std::ptrdiff_t>(body.list.first_node[e]),
                          body.list.node.begin() + static_cast<std::ptrdiff_t>(body.list.first_node[e + 1]), node) -
                body.list.node.begin();
            REQUIRE(static_cast<std::size_t>(at) < body.list.first_node[e + 1]);
            const Vec3& of_list = body.list.gradient[static_cast<std::size_t>(at)];
            CHECK((body.gradient(place, k) - of_list).norm() <= 1e-13 * of_list.norm());
        }
        CHECK(seen.size() == 4);
        CHECK(body.gradient(place, 0) ==
              -(body.gradient(place, 1) + body.gradient(place, 2) + body.gradient(place, 3)));
    }
    CHECK(std::ranges::all_of(times, [](int t) { return t == 1; }));
}

TEST_CASE("most elements of a mesh go on with a fan", "[unit]") {
    const ElasticBody box(jittered_box({8, 8, 8}, 0.1, 0.2, 1), material_constants(MaterialModel::linear, 1e5, 0.3, 1));
    const FanCount of_box = count_fans(box.elements);
    CHECK(10 * of_box.going_on > 6 * of_box.blocks);
    CHECK(of_box.longest == 6);
    const ElasticBody holes(box_with_holes(), material_constants(MaterialModel::linear, 1e5, 0.3, 1));
    const FanCount of_holes = count_fans(holes.elements);
    CHECK(10 * of_holes.going_on > 3 * of_holes.blocks);
    // blocks go on within a patch, with the nodes that the kernel takes for granted
    for (const ElasticBody* body : {&box, &holes})
        for (const Range& patch : body->patches.blocks)
            for (auto b = static_cast<std::size_t>(patch.begin); b < static_cast<std::size_t>(patch.end); ++b) {
                if (body->elements.continues_fan[b] == 0) continue;
                REQUIRE(b > static_cast<std::size_t>(patch.begin));
                for (std::size_t l = 0; l < element_lanes; ++l) {
                    const std::size_t at = b * element_lanes + l, before = at - element_lanes;
                    CHECK(body->node(at, 0) == body->node(before, 0));
                    CHECK(body->node(at, 1) == body->node(before, 1));
                    CHECK(body->node(at, 2) == body->node(before, 3));
                }
            }
}

TEST_CASE("fans add the forces that their elements add one by one", "[unit]") {
    const auto executor = make_executor(Backend::serial, 1);
    const test::TetMesh mesh = GENERATE(jittered_box({6, 5, 4}, 0.1, 0.2, 1), box_with_holes());
    for (const MaterialModel model : test::material_models) {
        std::vector<Index> material_of;  // two that alternate, in runs that cut fans
        for (std::size_t t = 0; t < mesh.tetrahedra.size(); ++t) material_of.push_back(t % 5 == 0 ? 1 : 0);
        ElasticBody body(mesh, {material_constants(model, 1e5, 0.4, 1000), material_constants(model, 3e5, 0.2, 1000)},
                         material_of);
        REQUIRE(count_fans(body.elements).going_on > 10);
        std::mt19937_64 random(2);
        for (Vec3& x : body.position) x += 0.01 * test::random_vector(random);
        const auto forces = [&] {
            body.compute_elements(*executor);
            body.gather();
            return body.force;
        };
        const std::vector<Vec3> by_fans = forces();
        for (std::uint8_t& goes_on : body.elements.continues_fan) goes_on = 0;
        const std::vector<Vec3> one_by_one = forces();
        Real largest = 0;
        for (const Vec3& f : one_by_one) largest = std::max(largest, f.norm());
        CHECK(largest > 10);
        for (std::size_t n = 0; n < by_fans.size(); ++n) CHECK((by_fans[n] - one_by_one[n]).norm() < 1e-13 * largest);
    }
}

}  // namespace skerry::test::element_fans_test
