// Clusters: groups of the few elements that are not stable at the step of the others (docs/methods/clusters.md).
#include <algorithm>
#include <catch2/catch.hpp>
#include <random>
#include <vector>

#include "engine/world/step/step.h"
#include "engine/world/tuning.h"
#include "skerry/world.h"
#include "systems/dynamics/clusters/implicit_elements.h"
#include "tests/support/jittered_box.h"
#include "tests/support/sliver_box.h"

namespace skerry::test::scene_clusters_test {

using skerry::test::sliver_box;

namespace {

Settings weightless(bool clusters) {
    Settings settings;
    settings.gravity = Vec3::Zero();
    settings.integrator = Integrator::leapfrog;
    settings.clusters = clusters;
    return settings;
}

/// Tetrahedra of many shapes. None has less than `least_volume` times the volume it would have in an even box.
Mesh uneven_box(Real least_volume) {
    const test::TetMesh box = test::jittered_box({8, 6, 6}, 0.02, 0.4, 21, least_volume);
    return {box.nodes, box.tetrahedra};
}

/// A box of 2 cm cells with `layers` thinner layers at one end.
Mesh graded_box(const std::array<Index, 3>& cells, Index layers, Real thickness) {
    test::TetMesh box = test::jittered_box(cells, 0.02, 0, 1);
    for (Vec3& x : box.nodes) x.x() -= 0.02 * (1 - thickness) * std::min<Real>(x.x() / 0.02, layers);
    return {box.nodes, box.tetrahedra};
}

MaterialSettings lossless_rubber() {
    return {.young_modulus = 1e5, .poisson_ratio = 0.3, .loss_factor = 0, .bulk_viscosity = 0};
}

}  // namespace

TEST_CASE("slivers no longer set the step of a body", "[scene][clusters]") {
    World plain(weightless(false)), clustered(weightless(true));
    for (World* world : {&plain, &clustered})
        world->add_body(sliver_box(0.2, 8, 0.01, 0.005), {.material = world->add_material(lossless_rubber())});
    CHECK(clustered.stable_step() > 1.9 * plain.stable_step());
    const WorldReport report = clustered.report();
    CHECK(report.clusters > 0);
    CHECK(report.implicit_elements > 0);
    CHECK(report.cluster_nodes * 4 < report.nodes);
    CHECK(plain.report().clusters == 0);
}

TEST_CASE("a body without bad elements has no clusters, and the bits that it had", "[scene][clusters]") {
    std::vector<std::uint64_t> hash;
    for (const bool clusters : {false, true}) {
        Settings settings;
        settings.clusters = clusters;
        World world(settings);
        world.add_body(mesh::ball(0.1, 4), {.material = world.add_material({}), .position = {0, 0, 0.11}});
        world.add_collider(Plane{});
        REQUIRE(world.advance(0.05).ok());
        CHECK(world.report().clusters == 0);
        hash.push_back(world.state_hash());
    }
    CHECK(hash[0] == hash[1]);
}

TEST_CASE("where some elements allow a little less than the others there are clusters, too", "[scene][clusters]") {
    for (const Real least_volume : {0.02, 0.1, 0.2}) {
        World plain(weightless(false)), clustered(weightless(true));
        for (World* world : {&plain, &clustered})
            world->add_body(uneven_box(least_volume), {.material = world->add_material(lossless_rubber())});
        CHECK(clustered.stable_step() > 1.5 * plain.stable_step());
        CHECK(clustered.report().clusters > 0);
    }
}

TEST_CASE("clusters add at most a hundredth to a moment of inertia, or a quarter of the share of lumped masses",
          "[scene][clusters][long]") {
    Real most = 0, least = 1;
    for (const Mesh& mesh :
         {graded_box({8, 3, 3}, 2, 0.3), graded_box({8, 6, 6}, 2, 0.3), graded_box({8, 6, 6}, 4, 0.5),
          graded_box({12, 12, 12}, 6, 0.6), sliver_box(0.2, 8, 0.01, 0.005)}) {
        World world(weightless(true));
        const BodyHandle body =
            world.add_body(mesh, {.material = world.add_material({.young_modulus = 1e5, .poisson_ratio = 0.47})});
        REQUIRE(world.stable_step() > 0);  // this finds the clusters
        const Model& model = WorldAccess::state_of(world).model;
        const Real of_lumping =
            moment_of_lumping(model.tetrahedra.node, model.tetrahedra.volume, model.nodes.rest_position);
        for (const Vec3& axis : {Vec3(1, 0, 0), Vec3(0, 1, 0), Vec3(0, 0, 1), Vec3(1, 1, 1)}) {
            const Vec3 turn = axis.normalized();
            std::vector<Vec3> velocity;
            for (const Vec3& x : world.positions(body)) velocity.push_back(turn.cross(x));
            world.set_velocities(body, velocity);
            Real of_masses = 0;
            for (std::size_t n = 0; n < velocity.size(); ++n)
                of_masses += model.nodes.mass[n] * velocity[n].squaredNorm() / 2;
            const Real added = added_energy(model) / of_masses;
            CHECK(added <= std::max<Real>(0.01, of_lumping / 4));
            most = std::max(most, added);
            least = std::min(least, added);
        }
    }
    CHECK(most > 0.011);
    CHECK(least < 0.001);
}

TEST_CASE("a body with clusters that is strained in one place is stable at the step of its mass shares",
          "[scene][clusters]") {
    World world(weightless(true));
    const BodyHandle body = world.add_body(uneven_box(0.2), {.material = world.add_material(lossless_rubber())});
    const Real rest = world.stable_step();
    const auto now = world.positions(body);
    std::vector<Vec3> position(now.begin(), now.end());
    position.front() -= Vec3(0.04, 0.04, 0.04);  // a corner, pulled out by twice the size of a cell
    world.set_positions(body, position);
    REQUIRE(world.report().clusters > 0);
    CHECK(world.stable_step() > 0.3 * rest);  // mass forms would give 0.25
}

TEST_CASE("bodies that are alike have the same implicit elements, as many as one alone", "[scene][clusters][long]") {
    const Mesh mesh = sliver_box(0.2, 6, 0.01, 0.005), other = sliver_box(0.2, 6, 0.01, 0.005, 2);
    const auto implicit = [&](std::initializer_list<const Mesh*> meshes, Index held) {
        World world(weightless(true));
        const MaterialHandle rubber = world.add_material(lossless_rubber());
        Index i = 0;
        for (const Mesh* body_mesh : meshes) {
            const BodyHandle body = world.add_body(
                *body_mesh, {.material = rubber, .position = {0.3 * i, 0, 0}, .rotation = {0, 0.1 * i, 0}});
            if (i++ == held) world.attach(body, std::vector<Index>{0, 1, 2, 3, 4, 5});
        }
        return world.report().implicit_elements;
    };
    const std::size_t one = implicit({&mesh}, -1), mixed = implicit({&mesh, &other}, -1);
    CHECK(one > 0);
    CHECK(implicit({&mesh, &mesh, &mesh}, -1) == 3 * one);
    CHECK(implicit({&mesh, &other, &mesh, &other}, -1) == 2 * mixed);
    CHECK(implicit({&mesh, &mesh}, 1) == one + implicit({&mesh}, 0));
    World alone(weightless(true)), together(weightless(true));
    for (const int bodies : {1, 3}) {
        World& world = bodies == 1 ? alone : together;
        const MaterialHandle rubber = world.add_material(lossless_rubber());
        for (int b = 0; b < bodies; ++b) world.add_body(mesh, {.material = rubber, .position = {0.3 * b, 0, 0}});
    }
    CHECK(together.stable_step() == Approx(alone.stable_step()).epsilon(1e-9));
}

TEST_CASE("where implicit elements of some bodies change, all clusters are those that building them anew makes",
          "[scene][clusters]") {
    World world(weightless(true));
    const auto rubber = world.add_material(lossless_rubber());
    for (int b = 0; b < 5; ++b)
        world.add_body(b == 2 ? mesh::ball(0.1, 4) : sliver_box(0.2, 6, 0.02, 0.02, static_cast<std::uint64_t>(b + 1)),
                       {.material = rubber, .position = {0.5 * b, 0, 0}});
    world.stable_step();
    Model& model = WorldAccess::state_of(world).model;
    const NodeClusters before = model.clusters;
    const auto clusters_of = [&](Index body) { return std::ranges::count(model.clusters.body, body); };
    for (const Index b : {0, 1, 3, 4}) REQUIRE(clusters_of(b) > 0);
    REQUIRE(clusters_of(2) == 0);

    // Body 1 gets more implicit elements, body 3 loses all, body 2 gets its first.
    const auto modulus_of = [&](std::size_t b) {
        return rows_of(model.elements.implicit_modulus, model.bodies.blocks[b]);
    };
    for (ElementLane& of_block : modulus_of(1).first(2)) std::ranges::fill(of_block.lane, Real(2e5));
    std::ranges::fill(modulus_of(3), ElementLane{});
    modulus_of(2)[0].lane[0] = 1e5;
    model.bodies.cluster_step[2] = model.bodies.cluster_step[1];
    const std::vector<std::uint8_t> changed{0, 1, 1, 1, 0};
    model.rebuild_clusters(changed);
    CHECK(clusters_of(2) == 1);
    CHECK(clusters_of(3) == 0);
    NodeClusters quick = model.clusters;
    model.rebuild_clusters();
    CHECK(std::ranges::equal(quick.nodes.offset, model.clusters.nodes.offset));
    CHECK(std::ranges::equal(quick.nodes.item, model.clusters.nodes.item));
    CHECK(std::ranges::equal(quick.body, model.clusters.body));
    CHECK(std::ranges::equal(quick.first_entry, model.clusters.first_entry));
    CHECK(std::ranges::equal(quick.inverse, model.clusters.inverse));
    CHECK(std::ranges::equal(quick.cluster_of, model.clusters.cluster_of));
    CHECK(std::ranges::equal(quick.index_in_cluster, model.clusters.index_in_cluster));
    CHECK(quick.inverse.size() != before.inverse.size());

    // Bodies that are not reported as changed are skipped: the altered entry of the matrix stays.
    model.clusters.inverse[0] *= 1.5;
    const Real followed = model.clusters.inverse[0];
    model.rebuild_clusters(changed);
    CHECK(model.clusters.inverse[0] == followed);
}

TEST_CASE("a spinning body with clusters keeps energy, momentum and angular momentum", "[scene][clusters][long]") {
    World world(weightless(true));
    const BodyHandle body =
        world.add_body(sliver_box(0.2, 8, 0.01, 0.005), {.material = world.add_material(lossless_rubber()),
                                                         .velocity = {0.3, -0.2, 0.1},
                                                         .angular_velocity = {4, 3, 2}});
    const Vec3 angular = world.report().angular_momentum;
    REQUIRE(world.advance(1).ok());
    const WorldReport report = world.report();
    CHECK(report.clusters > 0);
    CHECK(report.momentum_error_share < 1e-12);
    CHECK(report.energy_error_share < 1e-4);
    // Angular momentum of the nodes with their own masses. It oscillates with the part that the clusters hold.
    CHECK((report.angular_momentum - angular).norm() < 2e-3 * angular.norm());
    CHECK(world.center_of_mass(body).x() == Approx(0.3).epsilon(1e-6));
}

TEST_CASE("the energy that damping takes out of clusters is recorded", "[scene][clusters]") {
    // error of unresolved velocities: 0.04 of the energy at the full step, 3e-4 here
    World world = tuned_world(weightless(true), {.step_safety = 0.3});
    MaterialSettings rubber = lossless_rubber();
    rubber.damping = 30;
    const auto body = world.add_body(sliver_box(0.2, 8, 0.01, 0.005),
                                     {.material = world.add_material(rubber), .angular_velocity = {0, 0, 3}});
    REQUIRE(world.report().clusters > 0);
    std::vector<Vec3> velocity(world.velocities(body).begin(), world.velocities(body).end());
    std::mt19937_64 random(5);
    std::uniform_real_distribution<Real> speed(-0.5, 0.5);
    for (Vec3& v : velocity) v += Vec3(speed(random), speed(random), speed(random));
    world.set_velocities(body, velocity);
    const WorldReport start = world.report();
    REQUIRE(world.advance(0.1).ok());
    const WorldReport end = world.report();
    CHECK(end.energy.dissipated > 0.1 * start.energy.kinetic);
    // Stiffening must not add energy. With velocities that it kept, 8.6 J would be dissipated from 1.2 J.
    CHECK(end.energy.dissipated + end.energy.kinetic + end.energy.elastic < 1.5 * start.energy.kinetic);
    CHECK(end.energy_error_share < 1e-2);  // 0.13 if computed with the masses of the nodes
}

TEST_CASE("a body with clusters hangs as low as without", "[scene][clusters][long]") {
    std::vector<Real> height;
    for (const bool clusters : {false, true}) {
        Settings settings;
        settings.clusters = clusters;
        World world(settings);
        MaterialSettings material = lossless_rubber();
        material.damping = 20;
        const Mesh mesh = sliver_box(0.2, 6, 0.01, 0.005);
        const BodyHandle body = world.add_body(mesh, {.material = world.add_material(material)});
        std::vector<Index> top;
        for (std::size_t n = 0; n < mesh.nodes.size(); ++n)
            if (mesh.nodes[n].z() > 0.0999) top.push_back(static_cast<Index>(n));
        world.attach(body, top);
        REQUIRE(world.advance(1.5).ok());
        CHECK((world.report().clusters > 0) == clusters);
        height.push_back(world.center_of_mass(body).z());
    }
    CHECK(height[0] < -1e-4);
    CHECK(height[1] == Approx(height[0]).epsilon(1e-3));
}

TEST_CASE("bodies with clusters that meet exchange momentum, and energy adds up as their step is short",
          "[scene][clusters][long]") {
    std::vector<Real> energy_error;
    for (const Real safety : {1.0, 0.5}) {
        World world = tuned_world(weightless(true), {.step_safety = safety});
        const MaterialHandle rubber = world.add_material(lossless_rubber());
        for (const Real side : {-1.0, 1.0})
            world.add_body(
                sliver_box(0.2, 6, 0.01, 0.005, side > 0 ? 2 : 1),
                {.material = rubber, .position = {0.11 * side, 0.03 * side, 0}, .velocity = {-0.7 * side, 0, 0}});
        REQUIRE(world.advance(0.3).ok());
        const WorldReport report = world.report();
        CHECK(report.clusters > 1);
        CHECK(report.contact_sum > 0);
        CHECK(report.momentum_error_share < 1e-12);
        CHECK(report.max_penetration < 1e-4);
        CHECK(report.unconverged == 0);
        energy_error.push_back(report.energy_error_share);
    }
    // Errors of a second-order method at a step that is just stable for the vibrations after the impact.
    CHECK(energy_error[0] < 1e-2);
    CHECK(energy_error[1] < 0.35 * energy_error[0]);
}

TEST_CASE("with clusters a vibration converges with the second order", "[scene][clusters]") {
    std::vector<Vec3> corner;
    std::vector<Index> clusters;
    for (const int halvings : {0, 1, 2, 5}) {
        Settings settings = weightless(true);
        settings.step_size = 1.2e-3 / (1 << halvings);
        World world(settings);
        const BodyHandle body = world.add_body(
            sliver_box(0.2, 4, 0.02, 0.0002),
            {.material = world.add_material(lossless_rubber()), .velocity = {0, 0, 0}, .angular_velocity = {0, 0, 8}});
        REQUIRE(world.advance(0.08).ok());
        clusters.push_back(static_cast<Index>(world.report().implicit_elements));
        corner.push_back(world.positions(body)[0]);
    }
    CHECK(std::min(clusters[0], clusters[1]) > 0);
    CHECK(clusters[3] == 0);  // the reference run has no implicit elements
    const Real coarse = (corner[0] - corner[3]).norm(), half = (corner[1] - corner[3]).norm(),
               quarter = (corner[2] - corner[3]).norm();
    INFO(coarse << " " << half << " " << quarter);
    CHECK(half < 0.35 * coarse);
    CHECK(quarter < 0.35 * half);
}

}  // namespace skerry::test::scene_clusters_test
