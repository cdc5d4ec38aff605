// Bodies whose tetrahedra have different materials, assigned by labels.
#include <catch2/catch.hpp>
#include <random>

#include "tests/support/element_kinds.h"
#include "tests/support/message_of.h"
#include "tests/support/worlds.h"

namespace skerry::test::scene_materials_test {

using Catch::Matchers::Contains;

namespace {

/// A block whose upper half (z > 0) has label 1 and whose lower half has label 0.
Mesh two_layers(const std::array<int, 3>& cells = {4, 2, 2}) {
    Mesh mesh = mesh::box({0.2, 0.1, 0.1}, cells);
    for (const auto& t : mesh.tetrahedra) {
        Real z = 0;
        for (const Index n : t) z += mesh.nodes[static_cast<std::size_t>(n)].z();
        mesh.label.push_back(z > 0 ? 1 : 0);
    }
    return mesh;
}

World weightless() {
    return World(Settings{.gravity = Vec3::Zero()});
}

std::vector<Vec3> random_velocities(const Mesh& mesh, Real size) {
    std::mt19937_64 random(5);
    std::uniform_real_distribution<Real> speed(-size, size);
    std::vector<Vec3> velocity(mesh.nodes.size());
    for (Vec3& v : velocity) v = {speed(random), speed(random), speed(random)};
    return velocity;
}

std::string refusal(World& world, const Mesh& mesh, const BodySettings& body) {
    return message_of([&] { world.add_body(mesh, body); });
}

}  // namespace

TEST_CASE("each tetrahedron has the density of its material", "[scene]") {
    World world = weightless();
    const auto light = world.add_material({.density = 500}), heavy = world.add_material({.density = 3500});
    const auto body = world.add_body(two_layers(), {.material = light, .materials = {{1, heavy}}});
    CHECK(world.mass(body) == Approx(0.001 * 500 + 0.001 * 3500));
    // Lumped masses: the nodes between the layers carry mass of both, at the height where the layers meet.
    CHECK(world.center_of_mass(body).z() == Approx(0.025 * (3500 - 500) / 4000.0));
}

TEST_CASE("stress is that of each tetrahedron's own material, and a node between two has a mean", "[scene]") {
    const MaterialSettings soft =
        lossless({.young_modulus = 1e5, .poisson_ratio = 0.4, .model = MaterialModel::linear});
    const MaterialSettings stiff =
        lossless({.young_modulus = 5e6, .poisson_ratio = 0.2, .model = MaterialModel::corotational});
    const Mesh mesh = two_layers();
    for (const ElementKind kind : element_kinds) {
        INFO(name_of(kind));
        World world = weightless();
        const auto body = world.add_body(
            mesh,
            {.material = world.add_material(soft), .materials = {{1, world.add_material(stiff)}}, .element = kind});
        std::vector<Vec3> velocity;
        for (const Vec3& x : mesh.nodes) velocity.emplace_back(0.5 * x.x(), -0.2 * x.y(), 0.1 * x.z());
        world.set_velocities(body, velocity);
        // The body is free of stress: the first step moves every node by h times its velocity.
        const Real h = world.stable_step() / 2;
        REQUIRE(world.advance(h).steps == 1);
        const Mat3 small = h * Vec3(0.5, -0.2, 0.1).asDiagonal().toDenseMatrix(), F = Mat3::Identity() + small;
        const auto stress_in = [&](const MaterialSettings& m) -> Mat3 {
            const Real mu = m.young_modulus / (2 * (1 + m.poisson_ratio));
            const Real lambda = 2 * mu * m.poisson_ratio / (1 - 2 * m.poisson_ratio);
            return (lambda * small.trace() * Mat3::Identity() + 2 * mu * small) * F / F.determinant();
        };
        const Mat3 below = stress_in(soft), above = stress_in(stiff);
        const std::vector<Mat3> stress = world.stress(body), of_nodes = world.node_stress(body);
        Real worst = 0;
        for (std::size_t t = 0; t < stress.size(); ++t)
            worst = std::max(worst, (stress[t] - (mesh.label[t] == 1 ? above : below)).norm());
        CHECK(worst <= 1e-9 * above.norm());
        for (std::size_t n = 0; n < mesh.nodes.size(); ++n) {
            Real share = 0, all = 0;  // number of the tetrahedra around the node, all of equal size
            for (std::size_t t = 0; t < mesh.tetrahedra.size(); ++t)
                for (const Index corner : mesh.tetrahedra[t])
                    if (static_cast<std::size_t>(corner) == n) {
                        share += mesh.label[t];
                        ++all;
                    }
            CHECK((of_nodes[n] - (share * above + (all - share) * below) / all).norm() <= 1e-9 * above.norm());
        }
    }
}

TEST_CASE("smoothing goes by the Poisson ratio of each material", "[scene]") {
    World world = weightless();
    const auto cork = world.add_material({.poisson_ratio = 0.1}), rubber = world.add_material({.poisson_ratio = 0.45});
    const Mesh mesh = two_layers();
    CHECK(world.element(world.add_body(mesh, {.material = cork})) == ElementKind::edge_smoothed);
    CHECK(world.element(world.add_body(mesh, {.material = cork, .materials = {{0, rubber}}})) ==
          ElementKind::edge_node_smoothed);
    CHECK(world.element(world.add_body(mesh, {.material = rubber, .materials = {{0, cork}, {1, cork}}})) ==
          ElementKind::edge_smoothed);
}

TEST_CASE("a Poisson ratio of exactly 0 gives the motion of a tiny one, with each kind of element", "[scene]") {
    const Mesh mesh = mesh::box({0.2, 0.1, 0.1}, {2, 1, 1});
    for (const MaterialModel model : {MaterialModel::linear, MaterialModel::corotational})
        for (const ElementKind kind : element_kinds) {
            INFO(name_of(model) << ", " << name_of(kind));
            const auto end = [&](Real poisson_ratio) {
                World world = weightless();
                const auto material =
                    world.add_material({.young_modulus = 1e5, .poisson_ratio = poisson_ratio, .model = model});
                const BodyHandle body = world.add_body(
                    mesh, {.material = material, .dynamics = BodyDynamics::explicit_elastic, .element = kind});
                world.set_velocities(body, random_velocities(mesh, 0.5));
                REQUIRE(world.advance(0.02).ok());
                return std::vector<Vec3>(world.positions(body).begin(), world.positions(body).end());
            };
            const std::vector<Vec3> zero = end(0), tiny = end(1e-9);
            for (std::size_t n = 0; n < zero.size(); ++n) CHECK((zero[n] - tiny[n]).norm() < 1e-6 * 0.5 * 0.02);
        }
}

TEST_CASE("labels that name the body's own material change no bit", "[scene][determinism]") {
    const Mesh mesh = two_layers();
    const auto hash_of = [&](bool labelled) {
        World world;
        const auto rubber = world.add_material({});
        world.add_collider(Plane{});
        BodySettings body{.material = rubber, .position = {0, 0, 0.06}, .velocity = {0.1, 0, -0.3}};
        if (labelled) body.materials = {{0, rubber}, {1, rubber}};
        world.add_body(mesh, body);
        REQUIRE(world.advance(0.05).ok());
        return world.state_hash();
    };
    CHECK(hash_of(true) == hash_of(false));
}

TEST_CASE("the state of a body tells which of its tetrahedra have which material", "[scene][determinism]") {
    const auto hash_of = [](bool swapped) {
        World world = weightless();
        const auto a = world.add_material({.young_modulus = 1e5}), b = world.add_material({.young_modulus = 2e5});
        world.add_body(two_layers(), {.material = a, .materials = {{swapped ? 0 : 1, b}}});
        return world.state_hash();
    };
    CHECK(hash_of(false) == hash_of(false));
    CHECK(hash_of(true) != hash_of(false));
}

TEST_CASE("a body of several materials has the same bits on any number of threads", "[scene][determinism][long]") {
    std::vector<std::uint64_t> hashes;
    for (const int threads : {1, 2, 8}) {
        World world(Settings{.threads = threads});
        const auto soft = world.add_material({.young_modulus = 1e4, .poisson_ratio = 0.45});
        const auto stiff = world.add_material(
            {.young_modulus = 1e6, .poisson_ratio = 0.1, .density = 2000, .model = MaterialModel::corotational});
        world.add_collider(Plane{});
        world.add_body(two_layers({12, 8, 8}),
                       {.material = soft, .materials = {{1, stiff}}, .position = {0, 0, 0.051}});
        REQUIRE(world.advance(0.01).ok());
        hashes.push_back(world.state_hash());
    }
    CHECK(hashes == std::vector<std::uint64_t>(3, hashes.front()));
}

TEST_CASE("losses of several materials in one body add up", "[scene][long]") {
    struct Case {
        MaterialModel below, above;
        Real loss_below, loss_above;
    };
    for (const Case& c : {Case{MaterialModel::linear, MaterialModel::corotational, 0.3, 0},
                          Case{MaterialModel::stable_neo_hookean, MaterialModel::corotational, 0, 0.3},
                          Case{MaterialModel::corotational, MaterialModel::stable_neo_hookean, 0.05, 0.2}}) {
        INFO(name_of(c.below) << " with " << c.loss_below << " below " << name_of(c.above) << " with " << c.loss_above);
        // The step is a fraction of the stable step, because velocities are half a step off the positions.
        World world(Settings{.gravity = Vec3::Zero(), .step_size = 5e-5});
        const auto material = [&](Real modulus, Real loss, MaterialModel model) {
            return world.add_material({.young_modulus = modulus,
                                       .poisson_ratio = 0.4,
                                       .loss_factor = loss,
                                       .bulk_viscosity = loss / 2,
                                       .model = model});
        };
        const Mesh mesh = two_layers();
        const auto body = world.add_body(mesh, {.material = material(1e4, c.loss_below, c.below),
                                                .materials = {{1, material(1e6, c.loss_above, c.above)}}});
        REQUIRE(world.stable_step() > 2e-4);
        world.set_velocities(body, random_velocities(mesh, 0.1));
        const WorldReport start = world.report();
        REQUIRE(world.advance(0.5).ok());
        const WorldReport end = world.report();
        const Real before = start.energy.kinetic;
        const Real after = end.energy.kinetic + end.energy.elastic + end.energy.dissipated;
        CHECK(end.energy.dissipated > 0.3 * before);
        CHECK(after < 1.01 * before);
        CHECK(after > 0.99 * before);
        CHECK((end.momentum - start.momentum).norm() < 1e-12 * world.mass(body));
    }
}

TEST_CASE("materials of tetrahedra that do not fit the mesh are refused", "[scene]") {
    World world = weightless(), other = weightless();
    const auto rubber = world.add_material({}), steel = world.add_material({});
    other.add_material({}), other.add_material({});
    const auto foreign = other.add_material({});
    const Mesh mesh = two_layers();
    const std::uint64_t before = world.state_hash();
    CHECK_THAT(refusal(world, mesh, {.material = rubber, .materials = {{2, steel}}, .name = "beam"}),
               Contains("body 'beam': materials: found label 2, expected one of the labels of the mesh: 0, 1"));
    CHECK_THAT(refusal(world, mesh::ball(1, 2), {.material = rubber, .materials = {{0, steel}}}),
               Contains("materials: found label 0, expected no label, because the mesh has no labels"));
    CHECK_THAT(refusal(world, mesh, {.material = rubber, .materials = {{1, foreign}}}),
               Contains("add_body: material: found a handle without an object"));
    CHECK_THAT(refusal(world, mesh, {.material = rubber, .materials = {{1, {}}}}),
               Contains("a handle without an object"));
    Mesh short_of_one = mesh;
    short_of_one.label.pop_back();
    CHECK_THAT(refusal(world, short_of_one, {.material = rubber}),
               Contains("mesh: found 95 labels, expected 96 labels, one for each tetrahedron, or none"));
    CHECK(world.state_hash() == before);
}

}  // namespace skerry::test::scene_materials_test
