// Which clusters follow their elements, against a look at every element (docs/methods/clusters.md 3).
#include <catch2/catch.hpp>
#include <limits>
#include <random>

#include "systems/dynamics/clusters/build_clusters.h"
#include "systems/dynamics/clusters/find_implicit_elements.h"
#include "systems/dynamics/clusters/implicit_elements.h"
#include "systems/dynamics/clusters/stiffen_clusters.h"
#include "systems/dynamics/stability/stable_step.h"
#include "tests/support/elastic_body.h"
#include "tests/support/jittered_box.h"
#include "tests/support/sliver_box.h"

using namespace skerry;

namespace {

/// A box with slivers and the clusters that let it stand three times its step.
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

TEST_CASE("where forces say that elements stiffen is all that a look at every element finds", "[unit][clusters]") {
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
        // more on one side of the body than on the other
        for (std::size_t n = 0; n < rest.size(); ++n)
            box.body.position[n].x() = rest[n].x() * (1 + (stretch - 1) * (1 + 3 * rest[n].x()));
        ElementInputs inputs = box.body.inputs();
        inputs.implicit_modulus = box.body.elements.implicit_modulus;
        inputs.viscous_time = time;
        PatchForces patches = box.body.patch_forces();
        patches.stiffening = stiffening;
        compute_element_forces(
            *executor, inputs, box.body.position, box.body.velocity, 1e-4, 0, box.body.elements.rotation,
            {box.body.elements.rotation_next, box.body.elements.viscous_strain_next, box.body.elements.relaxed},
            patches);
        const auto marked = static_cast<std::size_t>(std::ranges::count(stiffening, 1));
        if (marked > 0) fewest = std::min(fewest, marked);
        quiet += marked == 0;
        const Real energy =
            stiffen_clusters(box.body.inputs(), bodies, stiffening, {box.body.elements.implicit_modulus, box.clusters});
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

TEST_CASE("whether elements are less stiff than they are taken to be is what the bound on their stiffness says",
          "[unit][clusters]") {
    constexpr Real looseness = 1.16;  // of the bound: 9^(1/16)
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
        CHECK(less_stiff_than(inputs, b, F, Real8{}, 0.9, q));  // none is asked for
        // one lane decides
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
