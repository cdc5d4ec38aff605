#include "systems/dynamics/stability/stable_step.h"

#include <catch2/catch.hpp>
#include <limits>

#include "tests/support/elastic_body.h"
#include "tests/support/exact_frequency.h"
#include "tests/support/material_models.h"

namespace skerry::test::stable_step_test {

using test::ElasticBody;
using test::exact_frequency_squared;
using test::jittered_box;

namespace {

StableStep step_of(const ElasticBody& body) {
    std::vector<Real> scratch(body.position.size(), 1e300);  // old contents must not matter
    return stable_step(body.inputs(), body.blocks, body.position, body.mass, scratch);
}

}  // namespace

TEST_CASE("the stable step is never above the limit and not far below it", "[unit][long]") {
    // docs/methods/stable_step.md 2: 0.60 to 0.83 of the exact limit; the step uses 0.9 of that.
    for (MaterialModel model : test::material_models) {
        for (Real jitter : {0.0, 0.1, 0.3}) {
            for (Real nu : {0.0, 0.3, 0.45, 0.499}) {
                ElasticBody body(jittered_box({4, 3, 3}, 0.1, jitter, 11, 0.02),
                                 material_constants(model, 1e5, nu, 1000));
                const Real limit = 2 / std::sqrt(exact_frequency_squared(body));
                const Real step = step_of(body).step;
                INFO("model " << name_of(model) << " jitter " << jitter << " nu " << nu << ": " << step / limit);
                CHECK(step <= 0.9 * limit * (1 + 1e-6));  // 1e-6: error of the differences
                CHECK(step >= 0.6 * 0.9 * limit);
            }
        }
    }
}

TEST_CASE("the stable step stays below the limit under large deformation", "[unit]") {
    for (MaterialModel model : test::material_models) {
        for (const Vec3& stretch :
             {Vec3(1.6, 1.6, 1.6), Vec3(2.5, 0.7, 0.7), Vec3(0.5, 0.5, 0.5), Vec3(1, 1, 0.2), Vec3(1.3, 1, -0.5)}) {
            if (model == MaterialModel::orthotropic && stretch == Vec3(0.5, 0.5, 0.5)) continue;  // no stiffness left
            ElasticBody body(jittered_box({3, 3, 2}, 0.1, 0.2, 12), material_constants(model, 1e5, 0.4, 1000));
            std::mt19937_64 random(13);
            const Eigen::AngleAxis<Real> turn(2.5, Vec3(1, -2, 0.5).normalized());
            for (Vec3& x : body.position) x = turn * (stretch.cwiseProduct(x) + 0.004 * test::random_vector(random));
            const Real limit = 2 / std::sqrt(exact_frequency_squared(body));
            const Real step = step_of(body).step;
            INFO("model " << name_of(model) << " stretch " << stretch.transpose() << ": " << step / limit);
            CHECK(step <= 0.9 * limit * (1 + 1e-5));
            CHECK(step >= 0.25 * limit);
        }
    }
}

TEST_CASE(
    "a stable neo-Hookean body pressed, stretched or inside out is stepped below its limit, for every Poisson ratio",
    "[unit]") {
    for (Real nu : {-0.9, -0.5, 0.0, 0.3, 0.49})
        for (const Vec3& stretch :
             {Vec3(1, 1, 1), Vec3(3, 3, 3), Vec3(4, 0.6, 0.6), Vec3(0.3, 0.3, 0.3), Vec3(0.02, 0.02, 0.02),
              Vec3(0, 0, 0), Vec3(1, 1, 0), Vec3(1, 0.1, -0.1), Vec3(-1, -1, -1), Vec3(-2, 1, 1)}) {
            ElasticBody body(jittered_box({3, 2, 2}, 0.1, 0.2, 14),
                             material_constants(MaterialModel::stable_neo_hookean, 1e5, nu, 1000));
            std::mt19937_64 random(15);
            for (Vec3& x : body.position) x = stretch.cwiseProduct(x) + 0.002 * test::random_vector(random);
            const Real limit = test::exact_limit(body);  // NaN if no force is restoring
            const Real step = step_of(body).step;
            INFO("nu " << nu << " stretch " << stretch.transpose() << ": " << step / limit);
            CHECK(!(step > 0.9 * limit * (1 + 1e-5)));
            CHECK(std::isfinite(step));  // compressed to a point: soft, but no softer in shear than at rest
        }
}

TEST_CASE("a sliver does not ruin the step", "[unit]") {
    // A free node lies almost in the plane of its neighbours' faces. The usual element bound drops with the altitude,
    // the bound with shared masses does not.
    const MaterialConstants material = material_constants(MaterialModel::linear, 1e5, 0.3, 1000);
    ElasticBody even(jittered_box({4, 4, 4}, 0.1, 0, 1), material),
        slivers(jittered_box({4, 4, 4}, 0.1, 0.35, 3, 1e-3), material);
    const Real ratio = step_of(slivers).step / step_of(even).step;
    const Real limit = 2 / std::sqrt(exact_frequency_squared(slivers));
    CHECK(step_of(slivers).step <= 0.9 * limit * (1 + 1e-6));
    CHECK(step_of(slivers).step >= 0.55 * limit);
    CHECK(ratio > 0.02);
}

TEST_CASE("the element named is the one that bounds the step", "[unit]") {
    test::TetMesh mesh = jittered_box({5, 3, 3}, 0.1, 0, 1);
    for (Vec3& x : mesh.nodes)
        if (x.x() > 0.45) x.x() -= 0.09;  // the last layer is ten times thinner
    const ElasticBody body(mesh, material_constants(MaterialModel::stable_neo_hookean, 1e5, 0.3, 1000));
    const StableStep step = step_of(body);
    REQUIRE(step.element >= 0);
    const std::size_t e = static_cast<std::size_t>(step.element);
    Real right = 0;
    for (std::size_t a = 0; a < 4; ++a) right = std::max(right, body.position[body.node(e, a)].x());
    CHECK(right > 0.4);
}

TEST_CASE("a body without elements has no limit, one that is not finite has no step", "[unit]") {
    const StableStep none = stable_step({}, {0, 0}, {}, {}, {});
    CHECK(none.step == std::numeric_limits<Real>::infinity());
    CHECK(none.element == no_index);
    for (MaterialModel model : test::material_models) {
        ElasticBody body(jittered_box({2, 2, 2}, 0.1, 0, 1), material_constants(model, 1e5, 0.3, 1000));
        body.position[0].x() = std::numeric_limits<Real>::quiet_NaN();
        CHECK(step_of(body).step == 0);
    }
}

TEST_CASE("a flat body and a point have a finite step", "[unit]") {
    for (MaterialModel model : test::material_models) {
        for (const Vec3& stretch : {Vec3(1, 1, 0), Vec3(1, 0, 0), Vec3(0, 0, 0)}) {
            ElasticBody body(jittered_box({2, 2, 2}, 0.1, 0, 1), material_constants(model, 1e5, 0.4, 1000));
            for (Vec3& x : body.position) x = stretch.cwiseProduct(x);
            const Real step = step_of(body).step;
            CHECK(std::isfinite(step));
            CHECK(step > 0);
        }
    }
}

}  // namespace skerry::test::stable_step_test
