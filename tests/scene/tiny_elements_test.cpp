// Bodies of smoothed elements some of whose tetrahedra are linear ones (docs/methods/elasticity.md 7.7), in a world.
#include <algorithm>
#include <catch2/catch.hpp>
#include <vector>

#include "engine/world/step/step.h"
#include "skerry/world.h"
#include "tests/support/knotted_box.h"
#include "tests/support/temporary_folder.h"
#include "tests/support/worlds.h"

using namespace skerry;

namespace {

Mesh knotted() {
    const test::TetMesh box = test::knotted_box(test::jittered_box({4, 3, 3}, 0.05, 0.2, 5), {40, 100});
    return {box.nodes, box.tetrahedra};
}

std::size_t tiny_of(const Mesh& mesh) {
    return static_cast<std::size_t>(std::ranges::count(tiny_tetrahedra({mesh.tetrahedra, mesh.nodes}), 1));
}

MaterialSettings rubber() {
    return {.young_modulus = 1e5, .poisson_ratio = 0.4, .density = 1000, .friction = 0.3};
}

/// Falls on a corner.
World falling(const Settings& settings = {}, const BodySettings& as = {}) {
    World world(settings);
    BodySettings body = as;
    body.material = world.add_material(rubber());
    body.position = {0, 0, 0.01};
    body.velocity = {0, 0, -2};
    world.add_collider(Plane{.normal = {0.1, 0, 1}});
    world.add_body(knotted(), body);
    return world;
}

std::size_t table_elements(const World& world) {
    std::size_t count = 0;
    for (const ElementLane& volume : WorldAccess::state_of(world).model.elements.volume)
        count += static_cast<std::size_t>(std::ranges::count_if(volume.lane, [](Real v) { return v > 0; }));
    return count;
}

}  // namespace

TEST_CASE("a report counts tiny tetrahedra where smoothed elements stand for two kinds, and nowhere else", "[scene]") {
    const std::size_t tiny = tiny_of(knotted());
    REQUIRE(tiny > 10);
    CHECK(falling().report().tiny_elements == tiny);
    CHECK(falling({}, {.dynamics = BodyDynamics::implicit_elastic}).report().tiny_elements == tiny);
    CHECK(falling({}, {.dynamics = BodyDynamics::rigid}).report().tiny_elements == 0);
    for (const ElementKind kind : {ElementKind::linear, ElementKind::edge_smoothed, ElementKind::edge_node_smoothed})
        CHECK(falling({}, {.element = kind}).report().tiny_elements == 0);
    CHECK(falling({.multirate = true}).report().tiny_elements == 0);
}

TEST_CASE("of several materials each has its tiny tetrahedra as linear elements", "[scene]") {
    Mesh mesh = knotted();
    const std::vector<std::uint8_t> tiny = tiny_tetrahedra({mesh.tetrahedra, mesh.nodes});
    // one material has all that is tiny, and another is of edges alone
    for (const Real poisson_ratio : {0.2, 0.4}) {
        mesh.label.clear();
        for (std::size_t t = 0; t < tiny.size(); ++t) mesh.label.push_back(tiny[t] != 0 ? 1 : 2);
        World world;
        MaterialSettings other = rubber();
        other.poisson_ratio = poisson_ratio;
        const BodyHandle body = world.add_body(
            mesh, {.material = world.add_material(rubber()), .materials = {{2, world.add_material(other)}}});
        CHECK(world.report().tiny_elements == tiny_of(mesh));
        CHECK(world.element(body) ==
              (poisson_ratio < 0.25 ? ElementKind::edge_smoothed : ElementKind::edge_node_smoothed));
    }
}

TEST_CASE("a body with tiny tetrahedra whose strain is the same everywhere says so", "[scene]") {
    World world({.gravity = Vec3::Zero()});
    const Mesh mesh = knotted();
    MaterialSettings linear = test::lossless(rubber());
    linear.model = MaterialModel::linear;
    const BodyHandle body = world.add_body(mesh, {.material = world.add_material(linear)});
    Mat3 rate;  // 1/s
    rate << 0.8, 0.3, 0, -0.1, -0.5, 0.2, 0.4, 0, 0.6;
    std::vector<Vec3> velocity;
    for (const Vec3& x : mesh.nodes) velocity.push_back(rate * x);
    world.set_velocities(body, velocity);
    const Real h = world.stable_step() / 2;
    REQUIRE(world.advance(h).steps == 1);
    const Mat3 F = Mat3::Identity() + h * rate;
    const Mat3 strain = (F.transpose() * F - Mat3::Identity()) / 2;
    const Mat3 stress = world.stress(body)[0];
    for (const Mat3& of : world.strain(body)) CHECK((of - strain).norm() <= 1e-10 * strain.norm());
    for (const Mat3& of : world.stress(body)) CHECK((of - stress).norm() <= 1e-10 * stress.norm());
}

TEST_CASE("an implicit body has the elements that it has as an explicit one, and gets them back", "[scene]") {
    World world = falling();
    const BodyHandle body = world.bodies()[0];
    const std::size_t elements = table_elements(world);
    const Real step = world.stable_step();
    world.set_dynamics(body, BodyDynamics::implicit_elastic);
    CHECK(table_elements(world) == 0);
    CHECK(WorldAccess::state_of(world).model.elements_of_implicit(0).size() == elements);
    REQUIRE(world.advance(0.02).ok());
    world.set_dynamics(body, BodyDynamics::explicit_elastic);
    CHECK(table_elements(world) == elements);
    CHECK(world.report().tiny_elements == tiny_of(knotted()));
    CHECK(falling().stable_step() == step);
}

TEST_CASE("bodies of one mesh with tiny tetrahedra share what is found of it, other kinds of elements do not",
          "[scene]") {
    const auto step_of = [](std::initializer_list<ElementKind> kinds) {
        World world({.clusters = false});
        const MaterialHandle material = world.add_material(rubber());
        Real x = 0;
        for (const ElementKind kind : kinds)
            world.add_body(knotted(), {.material = material, .position = {x += 0.5, 0, 0}, .element = kind});
        std::vector<Real> step;
        for (const Real s : WorldAccess::state_of(world).model.bodies.rest_step) step.push_back(s);
        return step;
    };
    const ElementKind smoothed = ElementKind::smoothed, whole = ElementKind::edge_node_smoothed;
    const Real of_smoothed = step_of({smoothed})[0], of_whole = step_of({whole})[0];
    CHECK(of_smoothed != of_whole);
    CHECK(step_of({smoothed, whole, smoothed, whole}) ==
          std::vector<Real>{of_smoothed, of_whole, of_smoothed, of_whole});
}

TEST_CASE("a world with tiny tetrahedra goes on with its bits when it is saved, on any number of threads", "[scene]") {
    std::vector<std::uint64_t> hash;
    for (const int threads : {1, 2, 4}) {
        World world = falling({.threads = threads});
        REQUIRE(world.report().clusters > 0);
        REQUIRE(world.advance(0.03).ok());
        const TemporaryFolder folder;
        world.save(folder.path() / "world.h5");
        World loaded = World::load(folder.path() / "world.h5"), copy = world.clone();
        for (World* each : {&world, &loaded, &copy}) {
            REQUIRE(each->advance(0.05).ok());
            CHECK(each->report().tiny_elements == tiny_of(knotted()));
            hash.push_back(each->state_hash());
        }
    }
    CHECK(std::ranges::count(hash, hash[0]) == static_cast<std::ptrdiff_t>(hash.size()));
}

TEST_CASE("a material that is set as it was leaves a body with tiny tetrahedra as it was", "[scene]") {
    World world, set;
    MaterialHandle material;
    for (World* each : {&world, &set}) {
        material = each->add_material(rubber());
        each->add_body(knotted(), {.material = material});
    }
    MaterialSettings other = rubber();
    other.young_modulus *= 2;
    set.set_material(material, other);
    CHECK(set.stable_step() < world.stable_step());
    set.set_material(material, rubber());
    CHECK(set.stable_step() == world.stable_step());
}
