// Selection of the clusters that stiffen with their elements, against a test of every element (docs/methods/clusters.md
// 3).
#include <Eigen/Core>
#include <algorithm>
#include <array>
#include <catch2/catch.hpp>
#include <functional>
#include <limits>
#include <random>

#include "systems/dynamics/checks/measure_viscosity.h"
#include "systems/dynamics/clusters/build_clusters.h"
#include "systems/dynamics/clusters/find_implicit_elements.h"
#include "systems/dynamics/clusters/implicit_elements.h"
#include "systems/dynamics/clusters/stiffen_clusters.h"
#include "systems/dynamics/stability/stable_step.h"
#include "tests/support/dense_algebra.h"
#include "tests/support/elastic_body.h"
#include "tests/support/jittered_box.h"
#include "tests/support/sliver_box.h"

namespace skerry::test::stiffen_clusters_test {

namespace {

/// A box with slivers and the clusters that keep it stable at three times its step.
struct SliverBox {
    test::ElasticBody body;
    std::vector<Range> body_blocks;
    std::vector<Real> cluster_step;
    NodeClusters clusters;

    explicit SliverBox(ElementKind kind, const Mesh& mesh = test::sliver_box(0.2, 4, 0.05, 0.01))
        : body({mesh.nodes, mesh.tetrahedra}, material_constants(MaterialModel::stable_neo_hookean, 1e5, 0.4, 1000),
               Mat3::Identity(), kind),
          body_blocks{body.blocks} {
        std::vector<Real> sums(body.position.size());
        const Real step = 3 * stable_step(body.inputs(), body.blocks, body.position, body.mass, sums).step;
        cluster_step = {step};
        constexpr Real anything = std::numeric_limits<Real>::infinity();
        ImplicitSearch(body.inputs(), body.blocks, body.position, body.mass, sums,
                       {body.elements.mass_share, body.elements.implicit_modulus})
            .find({step, step, 4, anything});
        build_clusters(body.inputs(),
                       {body_blocks, cluster_step, body.elements.implicit_modulus, body.mass, body.inverse_mass},
                       clusters);
    }
};

}  // namespace

TEST_CASE("an estimate of the implicit volume leaves mass shares and moduli as they are", "[unit][clusters]") {
    SliverBox box(ElementKind::edge_node_smoothed);
    const std::span<ElementLane> share = box.body.elements.mass_share, modulus = box.body.elements.implicit_modulus;
    const auto has_implicit = [](const ElementLane& lanes) {
        return std::ranges::any_of(lanes.lane, [](Real x) { return x > 0; });
    };
    REQUIRE(std::ranges::any_of(modulus, has_implicit));
    const std::vector<ElementLane> shares(share.begin(), share.end()), moduli(modulus.begin(), modulus.end());
    std::vector<Real> sums(box.body.position.size());
    const ImplicitSearch search(box.body.inputs(), box.body.blocks, box.body.position, box.body.mass, sums,
                                {share, modulus});
    CHECK(search.estimate_volume(box.cluster_step[0]) > 0);
    const auto equal = [](const ElementLane& a, const ElementLane& b) { return std::ranges::equal(a.lane, b.lane); };
    CHECK(std::ranges::equal(share, shares, equal));
    CHECK(std::ranges::equal(modulus, moduli, equal));
}

TEST_CASE("an estimate of the implicit volume counts the mass of each node of an element once", "[unit][clusters]") {
    const test::TetMesh mesh = test::jittered_box({4, 4, 4}, 0.05, 0.3, 1);  // no two elements need the same mass
    SliverBox box(ElementKind::edge_node_smoothed, {.nodes = mesh.nodes, .tetrahedra = mesh.tetrahedra});
    test::ElasticBody& body = box.body;
    std::vector<ElementLane> frequency(body.elements.mass_share.size());  // squared angular frequencies [1/s^2]
    lone_frequencies(body.inputs(), body.blocks, body.position, body.mass, frequency);
    std::vector<Real> sums(body.position.size());
    const ImplicitSearch search(body.inputs(), body.blocks, body.position, body.mass, sums,
                                {body.elements.mass_share, body.elements.implicit_modulus});
    for (const Real step : {0.5 * box.cluster_step[0], 0.7 * box.cluster_step[0], box.cluster_step[0]}) {
        std::vector<std::array<Real, 3>> demands;  // mass over volume [kg/m^3], mass [kg], volume [m^3]
        Real lacking = 0, total = 0;
        for (const Real mass : body.mass) lacking -= mass;
        for (std::size_t e = 0; e < body.element_at.size(); ++e) {
            const Real volume = body.volume(e);
            if (!(volume > 0)) continue;  // an unused lane
            const std::size_t nodes = body.list.nodes_of(static_cast<std::size_t>(body.element_at[e]));
            Real mass = 0;
            for (std::size_t k = 0; k < nodes; ++k) mass += body.mass[body.node(e, k)];
            mass *= frequency[e / element_lanes][e % element_lanes] * step * step / (1.8 * 1.8);
            demands.push_back({mass / volume, mass, volume});
            lacking += mass;
            total += volume;
        }
        std::ranges::sort(demands, std::greater<>());
        Real implicit = 0;
        for (std::size_t i = 0; i < demands.size() && lacking > 0; ++i) {
            lacking -= demands[i][1];
            implicit += demands[i][2];
        }
        CAPTURE(step);
        CHECK(implicit > 0);
        CHECK(search.estimate_volume(step) == Approx(implicit / total).epsilon(1e-9));
    }
}

TEST_CASE("bounds by forces find all elements that stiffen, as a test of every element does", "[unit][clusters]") {
    const auto kind = GENERATE(ElementKind::linear, ElementKind::edge_node_smoothed);
    INFO(name_of(kind));
    SliverBox box(kind), twin(kind);
    const auto executor = make_executor(Backend::serial, 1);
    const std::vector<Vec3> rest = box.body.position;
    const std::vector<std::uint8_t> asleep{0};
    const StiffenInputs bodies{box.body_blocks,   box.cluster_step,  asleep,
                               box.body.position, box.body.velocity, box.body.inverse_mass};
    std::vector<std::uint8_t> stiffening(box.body.elements.first.size());
    std::mt19937_64 random(5);
    for (Vec3& v : box.body.velocity) v = test::random_vector(random);
    std::vector<Real> time(stiffening.size());
    find_viscous_times(box.body.elements.implicit_modulus, box.cluster_step[0], time);
    int quiet = 0, raised = 0;
    std::size_t fewest = stiffening.size();
    for (const Real stretch : {1.0, 1.1, 1.25, 1.3, 1.35, 1.6, 1.3, 2.4, 3.0}) {
        // more strain on one side of the body than on the other
        for (std::size_t n = 0; n < rest.size(); ++n)
            box.body.position[n].x() = rest[n].x() * (1 + (stretch - 1) * (1 + 3 * rest[n].x()));
        ElementInputs inputs = box.body.inputs();
        inputs.implicit_modulus = box.body.elements.implicit_modulus;
        inputs.viscous_time = time;
        PatchForces patches = box.body.patch_forces();
        patches.stiffening = stiffening;
        compute_element_forces(*executor, inputs, box.body.position, box.body.velocity, 1e-4,
                               box.body.elements.rotation,
                               {box.body.elements.rotation_next, box.body.elements.spring_strain_next}, patches);
        const auto marked = static_cast<std::size_t>(std::ranges::count(stiffening, 1));
        if (marked > 0) fewest = std::min(fewest, marked);
        quiet += marked == 0;
        const Real energy = stiffen_clusters(box.body.inputs(), bodies, 1e-4, patches,
                                             {box.body.elements.implicit_modulus, box.clusters});
        CHECK(energy ==
              stiffen_all_clusters(box.body.inputs(), bodies, {twin.body.elements.implicit_modulus, twin.clusters}));
        raised += energy > 0;
        CHECK(std::ranges::count(stiffening, 1) == 0);
        CHECK(std::ranges::equal(box.clusters.inverse, twin.clusters.inverse));
        for (std::size_t b = 0; b < stiffening.size(); ++b)
            CHECK(std::ranges::equal(box.body.elements.implicit_modulus[b].lane,
                                     twin.body.elements.implicit_modulus[b].lane));
    }
    CHECK(quiet > 0);
    CHECK(raised > 1);
    CHECK(fewest < stiffening.size() / 2);
}

// If a stiffening element kept its velocity, its energy would double each time, and knots of a mesh would reach 1e5
// times their inertia. Therefore the momentum is kept.
TEST_CASE("elements that stiffen keep their momentum, and the lost energy is recorded", "[unit][clusters]") {
    constexpr Real kick = 1e-4;
    SliverBox box(ElementKind::edge_node_smoothed);
    const auto executor = make_executor(Backend::serial, 1);
    std::mt19937_64 random(6);
    const std::size_t blocks = box.body.elements.first.size();
    for (std::size_t n = 0; n < box.body.position.size(); ++n) {
        box.body.velocity[n] = test::random_vector(random);
        Real& x = box.body.position[n].x();
        x *= 1 + 1.4 * (1 + 3 * x);  // more strain on one side of the body than on the other
    }
    const std::vector<std::uint8_t> asleep{0};
    const StiffenInputs bodies{box.body_blocks,   box.cluster_step,  asleep,
                               box.body.position, box.body.velocity, box.body.inverse_mass};
    std::vector<std::uint8_t> stiffening(blocks), viscous(blocks);
    std::vector<ElementViscousImpulse> impulse(blocks);
    std::vector<Real> time(blocks);
    find_viscous_times(box.body.elements.implicit_modulus, box.cluster_step[0], time);
    ElementInputs inputs = box.body.inputs();
    inputs.implicit_modulus = box.body.elements.implicit_modulus;
    inputs.viscous_time = time;
    PatchForces patches = box.body.patch_forces();
    patches.stiffening = stiffening;
    patches.viscous = viscous;
    patches.viscous_impulse = impulse;
    compute_element_forces(*executor, inputs, box.body.position, box.body.velocity, kick, box.body.elements.rotation,
                           {box.body.elements.rotation_next, box.body.elements.spring_strain_next}, patches);
    const std::vector<PaddedVec3> force_before(patches.force.begin(), patches.force.end());
    std::vector<ElementViscousImpulse> impulse_before = impulse;
    for (std::size_t b = 0; b < blocks; ++b)
        if (!viscous[b]) impulse_before[b] = {};
    const std::vector<Real> inverse_before(box.clusters.inverse.begin(), box.clusters.inverse.end());
    const Real brought =
        stiffen_clusters(box.body.inputs(), bodies, kick, patches, {box.body.elements.implicit_modulus, box.clusters});
    REQUIRE(brought > 0);

    std::vector<Vec3> given(box.body.position.size(), Vec3::Zero());  // [N s]
    Vec3 sum = Vec3::Zero();
    for (std::size_t s = 0; s < patches.node.size(); ++s) {
        Vec3 more;
        for (std::size_t i = 0; i < 3; ++i)
            more[static_cast<Eigen::Index>(i)] = kick * (patches.force[s].lane[i] - force_before[s].lane[i]);
        given[static_cast<std::size_t>(patches.node[s])] += more;
        sum += more;
    }
    std::vector<Vec3> velocity_next(box.body.velocity.begin(), box.body.velocity.end());
    Real before = 0, after = 0, largest = 0;  // [J], [J], [N s]
    for (std::size_t c = 0; c < box.clusters.size(); ++c) {
        const auto nodes = box.clusters.nodes[c];
        const auto count = static_cast<Eigen::Index>(nodes.size());
        const auto matrix_of = [&](const Real* inverse) {
            return Eigen::MatrixXd(
                Eigen::Map<const Eigen::MatrixXd>(inverse + box.clusters.first_entry[c], count, count));
        };
        const Eigen::MatrixXd inverse = matrix_of(box.clusters.inverse.data());
        Eigen::MatrixXd velocity(count, 3), kicks(count, 3);
        for (Eigen::Index k = 0; k < count; ++k) {
            const auto n = static_cast<std::size_t>(nodes[static_cast<std::size_t>(k)]);
            velocity.row(k) = box.body.velocity[n].transpose();
            kicks.row(k) = given[n].transpose();
            largest = std::max(largest, given[n].norm());
        }
        const Eigen::MatrixXd momentum = solve_symmetric(matrix_of(inverse_before.data()), velocity);
        const Eigen::MatrixXd next = velocity + inverse * kicks;
        CHECK((next - inverse * momentum).norm() < 1e-9 * velocity.norm());
        before += velocity.cwiseProduct(momentum).sum() / 2;
        after += next.cwiseProduct(momentum).sum() / 2;
        for (Eigen::Index k = 0; k < count; ++k)
            velocity_next[static_cast<std::size_t>(nodes[static_cast<std::size_t>(k)])] = next.row(k).transpose();
    }
    CHECK(sum.norm() < 1e-12 * largest);
    Real taken = 0;  // [J]
    for (std::size_t b = 0; b < blocks; ++b) {
        const LaneMat3<Real8> rate = deformation_of(inputs, b, box.body.velocity),
                              rate_next = deformation_of(inputs, b, velocity_next);
        const LaneMat3<Real8> mean = 0.5 * (rate + rate_next);
        const LaneVec3<Real8> column[3] = {mean.c0, mean.c1, mean.c2};
        for (std::size_t l = 0; l < element_lanes; ++l)
            for (std::size_t i = 0; i < 3; ++i)
                taken += (impulse[b][3 * i][l] - impulse_before[b][3 * i][l]) * column[i].x[l] +
                         (impulse[b][3 * i + 1][l] - impulse_before[b][3 * i + 1][l]) * column[i].y[l] +
                         (impulse[b][3 * i + 2][l] - impulse_before[b][3 * i + 2][l]) * column[i].z[l];
    }
    CHECK(after < before);
    CHECK(after - before == Approx(brought - taken).epsilon(1e-9));
}

TEST_CASE("the bound on the stiffness decides whether elements are softer than assumed", "[unit][clusters]") {
    constexpr Real looseness = 1.16;  // ratio to the bound: 9^(1/16)
    SliverBox box(ElementKind::edge_node_smoothed);
    const ElementInputs inputs = box.body.inputs();
    LaneQuaternion<Real8> q{Real8{} + 1.0, {}, {}, {}};
    std::mt19937_64 random(8);
    for (Vec3& x : box.body.position) x += 0.004 * test::random_vector(random);
    int less = 0, more = 0;
    for (std::size_t b = 0; b < box.body.elements.first.size(); ++b) {
        const LaneMat3<Real8> F = deformation_of(inputs, b, box.body.position);
        const Real8 bound = stiffness_of(inputs, b, F, q);
        CHECK(less_stiff_than(inputs, b, F, bound, 1.001, q));
        CHECK(less_stiff_than(inputs, b, F, Real8(2.0 * bound), 0.501, q));
        CHECK(less_stiff_than(inputs, b, F, Real8{}, 0.9, q));  // modulus 0: not implicit, nothing to test
        // a single lane decides
        for (std::size_t l = 0; l < element_lanes; ++l) {
            if (!(inputs.volume[b][l] > 0)) continue;
            Real8 modulus = 2.0 * bound;
            modulus[l] = bound[l] / (1.001 * looseness);
            CHECK_FALSE(less_stiff_than(inputs, b, F, modulus, 1, q));
            ++more;
        }
        less += all(load(inputs.volume[b]) > 0.0);
    }
    CHECK(less > 0);
    CHECK(more > 0);
}

TEST_CASE("the energy that viscosity takes is the work of its impulses on the nodes", "[unit][clusters]") {
    constexpr Real kick = 1e-4;
    SliverBox box(ElementKind::edge_node_smoothed);
    const auto executor = make_executor(Backend::serial, 1);
    std::mt19937_64 random(9);
    std::vector<Vec3> next;
    for (std::size_t n = 0; n < box.body.position.size(); ++n) {
        box.body.position[n].x() *= 3;  // implicit elements are viscous far from rest
        box.body.velocity[n] = test::random_vector(random);
        next.push_back(box.body.velocity[n] + 0.5 * test::random_vector(random));
    }
    const std::size_t blocks = box.body.elements.first.size();
    std::vector<std::uint8_t> viscous(blocks);
    std::vector<ElementViscousImpulse> impulse(blocks);
    std::vector<Real> time(blocks);
    find_viscous_times(box.body.elements.implicit_modulus, box.cluster_step[0], time);
    ElementInputs inputs = box.body.inputs();
    inputs.implicit_modulus = box.body.elements.implicit_modulus;
    PatchForces patches = box.body.patch_forces();
    patches.viscous = viscous;
    patches.viscous_impulse = impulse;
    const auto forces = [&] {
        compute_element_forces(*executor, inputs, box.body.position, box.body.velocity, kick,
                               box.body.elements.rotation,
                               {box.body.elements.rotation_next, box.body.elements.spring_strain_next}, patches);
        box.body.gather();
        return box.body.force;
    };
    const std::vector<Vec3> elastic = forces();
    inputs.viscous_time = time;
    const std::vector<Vec3> all = forces();
    Real expected = 0;
    for (std::size_t n = 0; n < all.size(); ++n)
        expected -= kick * (all[n] - elastic[n]).dot(box.body.velocity[n] + next[n]) / 2;
    Column<Real> parts;
    const auto taken = [&] {
        return measure_viscosity(*executor, inputs, box.body.patches.blocks, impulse, viscous, box.body.velocity, next,
                                 parts);
    };
    CHECK(expected > 0);
    CHECK(taken() == Approx(expected).epsilon(1e-9));
    const std::vector<Index> of_body(blocks, 0);
    const std::vector<std::uint8_t> asleep{1};
    inputs.body = of_body;
    inputs.body_idle = asleep;
    CHECK(taken() == 0);
}

}  // namespace skerry::test::stiffen_clusters_test
