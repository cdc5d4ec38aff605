// The step bound for locally strained bodies, against the exact limit (docs/methods/stable_step.md 2.5).
#include "systems/dynamics/stability/strained_step.h"

#include <catch2/catch.hpp>
#include <cmath>
#include <limits>
#include <random>
#include <vector>

#include "systems/dynamics/stability/mass_forms.h"
#include "systems/dynamics/stability/stable_step.h"
#include "tests/support/elastic_body.h"
#include "tests/support/element_kinds.h"
#include "tests/support/exact_frequency.h"
#include "tests/support/material_models.h"

namespace skerry::test::strained_step_test {

using test::ElasticBody;
using test::jittered_box;

namespace {

ElementInputs inputs_of(const ElasticBody& body) {
    ElementInputs inputs = body.inputs();
    inputs.implicit_modulus = body.elements.implicit_modulus;
    return inputs;
}

void find_forms(ElasticBody& body) {
    find_mass_forms(inputs_of(body), body.blocks, body.position, body.mass, products_of_group,
                    body.elements.mass_form.span());
}

Range nodes_of(const ElasticBody& body) {
    return {0, static_cast<Index>(body.position.size())};
}

/// Step bound of a body that is known to be stable at `stands`.
Real strained_step_of(const ElasticBody& body, Real asked, Real stands) {
    std::vector<Real> memory(strained_step_memory(nodes_of(body), body.blocks),
                             std::numeric_limits<Real>::quiet_NaN());  // contents must be written before they are read
    return strained_step(inputs_of(body), body.blocks, nodes_of(body), body.position, body.mass, {asked, stands},
                         memory);
}

/// Nodes in the middle third of the box move towards its middle.
void press_middle(ElasticBody& body, const Vec3& size, Real by) {
    const Vec3 middle = size / 2;
    for (Vec3& x : body.position)
        if ((x - middle).cwiseQuotient(size).cwiseAbs().maxCoeff() < 0.2) x = middle + (1 - by) * (x - middle);
}

}  // namespace

TEST_CASE("the step of a body that is strained in places is below the limit", "[unit][long]") {
    for (const ElementKind kind : test::element_kinds)
        for (const MaterialModel model : test::material_models)
            for (const Real pressed : {0.0, 0.3, 0.6, -0.6})
                for (const Real moved : {0.0, 0.25}) {
                    ElasticBody body(jittered_box({4, 3, 3}, 0.1, 0.1, 12), material_constants(model, 1e5, 0.4, 1000),
                                     Mat3::Identity(), kind);
                    find_forms(body);
                    const Real at_rest = test::stable_step_of(body);
                    press_middle(body, {0.4, 0.3, 0.3}, pressed);
                    std::mt19937_64 random(13);
                    for (Vec3& x : body.position) x += 0.1 * moved * test::random_vector(random);
                    const Real limit = test::exact_limit(body), stands = test::stable_step_of(body);
                    for (const Real asked : {at_rest, 3 * at_rest, 0.5 * at_rest}) {
                        const Real step = strained_step_of(body, asked, stands);
                        INFO(name_of(kind) << ", " << name_of(model) << ", pressed by " << pressed << ", moved by "
                                           << moved << ": " << stands / limit << " -> " << step / limit);
                        CHECK(step <= 0.9 * limit * (1 + 1e-5));
                        CHECK(step <= asked);
                    }
                }
}

TEST_CASE("a few elements that are pressed make no step as short as the worst of them", "[unit]") {
    ElasticBody body(jittered_box({6, 5, 5}, 0.1, 0.1, 3),
                     material_constants(MaterialModel::stable_neo_hookean, 1e5, 0.4, 1000), Mat3::Identity(),
                     ElementKind::edge_node_smoothed);
    find_forms(body);
    const Real at_rest = test::stable_step_of(body);
    // nothing is strained: the full requested step, reduced only by the margin for strain
    CHECK(strained_step_of(body, at_rest, 0.9 * at_rest) == Approx(at_rest / std::sqrt(1.1)));
    body.position[body.position.size() / 2] += Vec3(0.07, 0.04, 0.06);
    const Real stands = test::stable_step_of(body), step = strained_step_of(body, at_rest, stands);
    INFO("of the step at rest: " << stands / at_rest << " by the worst, " << step / at_rest);
    CHECK(stands < 0.75 * at_rest);
    CHECK(step > 1.2 * stands);
}

// Springs count by 2 / (2 + h r): the longer the step, the less they count.
TEST_CASE("the step of a body that is strained in places is one in which it relaxes enough", "[unit]") {
    MaterialConstants material = material_constants(MaterialModel::stable_neo_hookean, 1e5, 0.4, 1000);
    material.loss_factor = 0.1;
    ElasticBody body(jittered_box({5, 4, 4}, 0.1, 0.1, 5), material, Mat3::Identity(), ElementKind::edge_node_smoothed);
    const Real elastic = test::stable_step_of(body);
    for (std::size_t b = 0; b < body.elements.relaxing_share.size(); ++b) {
        body.elements.relaxing_share[b] = 0.5;
        for (Real& rate : body.elements.relaxation_rate[b]) rate = std::pow(10, static_cast<Real>(b % 4)) / elastic;
    }
    find_forms(body);
    const Real at_rest = test::stable_step_of(body);
    body.position[body.position.size() / 2] += Vec3(0.07, 0.04, 0.06);
    const Real stands = test::stable_step_of(body), step = strained_step_of(body, at_rest, stands);
    INFO("of the step at rest: " << stands / at_rest << " by the worst, " << step / at_rest);
    CHECK(step > 1.1 * stands);
    // The shorter the certain step, the more springs may still act at its end.
    CHECK(strained_step_of(body, at_rest, 1e-6 * stands) < step);
    for (std::size_t b = 0; b < body.elements.relaxing_share.size(); ++b)
        body.elements.relaxing_share[b] *= 2 / (2 + step * body.elements.relaxation_rate[b][0]);
    CHECK(step <= 0.9 * test::exact_limit(body) * (1 + 1e-6));
}

TEST_CASE("elements of clusters take no part in the step of a strained body", "[unit]") {
    ElasticBody body(jittered_box({4, 3, 3}, 0.1, 0.1, 5),
                     material_constants(MaterialModel::stable_neo_hookean, 1e5, 0.4, 1000), Mat3::Identity(),
                     ElementKind::edge_node_smoothed);
    const std::size_t moved = body.position.size() / 2;
    find_forms(body);
    const Real at_rest = test::stable_step_of(body), all_asked = at_rest / std::sqrt(1.1);
    const Vec3 before = body.position[moved];
    body.position[moved] += Vec3(0.07, 0.04, 0.06);
    CHECK(strained_step_of(body, at_rest, 0.5 * at_rest) < 0.97 * all_asked);
    body.position[moved] = before;
    for (std::size_t e = 0; e < body.elements.volume.size() * element_lanes; ++e)
        for (std::size_t k = 0; k < body.node_count(e); ++k)
            if (body.node(e, k) == moved) body.elements.implicit_modulus[e / element_lanes][e % element_lanes] = 1e6;
    find_forms(body);
    body.position[moved] += Vec3(0.07, 0.04, 0.06);
    CHECK(strained_step_of(body, at_rest, 0.5 * at_rest) == Approx(all_asked));
}

TEST_CASE("elements without mass do not limit the step of a strained body", "[unit]") {
    ElasticBody body(jittered_box({4, 3, 3}, 0.1, 0.1, 5),
                     material_constants(MaterialModel::stable_neo_hookean, 1e5, 0.4, 1000), Mat3::Identity(),
                     ElementKind::edge_node_smoothed);
    find_forms(body);
    const Real at_rest = test::stable_step_of(body);
    const std::size_t moved = body.position.size() / 2;
    body.position[moved] += Vec3(0.07, 0.04, 0.06);
    const Real free = strained_step_of(body, at_rest, 0.5 * at_rest);
    body.mass[moved] = 0;
    const Real held = strained_step_of(body, at_rest, 0.5 * at_rest);
    CHECK(held > free);
    CHECK(held <= at_rest / std::sqrt(1.1));
}

TEST_CASE("a strained body that is not finite has the stable step zero", "[unit]") {
    ElasticBody body(jittered_box({2, 2, 2}, 0.1, 0, 1), material_constants(MaterialModel::linear, 1e5, 0.3, 1000));
    find_forms(body);
    body.position[0].x() = std::numeric_limits<Real>::quiet_NaN();
    CHECK_FALSE(strained_step_of(body, 1, 0.1) > 0);
}

}  // namespace skerry::test::strained_step_test
