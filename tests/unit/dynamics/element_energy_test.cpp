#include "systems/dynamics/elements/element_energy.h"

#include <catch2/catch.hpp>
#include <limits>

#include "systems/dynamics/checks/volume_ratios.h"
#include "tests/support/elastic_body.h"
#include "tests/support/material_models.h"

namespace skerry::test::element_energy_test {

using test::ElasticBody;
using test::jittered_box;

namespace {

MaterialConstants rubber(MaterialModel model) {
    return material_constants(model, 1e5, 0.3, 1000);
}

}  // namespace

TEST_CASE("elastic energy is the sum over the elements", "[unit]") {
    for (MaterialModel model : test::material_models) {
        ElasticBody body(jittered_box({2, 3, 2}, 0.1, 0.2, 1), rubber(model));
        CHECK(std::abs(elastic_energy(body.inputs(), body.blocks, body.position)) <= 1e-12);
        std::mt19937_64 random(2);
        for (Vec3& x : body.position) x += 0.02 * test::random_vector(random);
        Real sum = 0;
        for (std::size_t e = 0; e < 72; ++e)
            sum += body.volume(e) * energy_density(body.constants[0], body.deformation(e));
        CHECK(elastic_energy(body.inputs(), body.blocks, body.position) == Approx(sum).epsilon(1e-12));
        CHECK(elastic_energy(body.inputs(), {0, 0}, body.position) == 0);
    }
}

TEST_CASE("von Mises stress of uniaxial strain is 2 mu strain", "[unit]") {
    for (MaterialModel model : test::material_models) {
        ElasticBody body(jittered_box({1, 1, 1}, 0.1, 0, 1), rubber(model));
        const Real strain = 1e-6;
        for (Vec3& x : body.position) x.z() *= 1 + strain;
        std::vector<Mat3> stress(8, Mat3::Identity());
        cauchy_stress(body.inputs(), body.blocks, body.position, stress);
        for (std::size_t e = 0; e < 6; ++e)
            CHECK(von_mises(stress[e]) == Approx(2 * body.constants[0].shear_modulus * strain).epsilon(1e-5));
        CHECK(stress[6] == Mat3::Zero());  // unused lane
    }
}

TEST_CASE("von Mises stress is finite for a flat body", "[unit]") {
    for (MaterialModel model : test::material_models) {
        ElasticBody body(jittered_box({1, 1, 1}, 0.1, 0, 1), rubber(model));
        for (Vec3& x : body.position) x.z() = 0;
        std::vector<Mat3> stress(8);
        cauchy_stress(body.inputs(), body.blocks, body.position, stress);
        for (const Mat3& s : stress) CHECK(std::isfinite(von_mises(s)));
    }
}

TEST_CASE("the worst volume ratio names the tetrahedron that is pressed most", "[unit]") {
    ElasticBody body(jittered_box({4, 1, 1}, 0.1, 0, 1), rubber(MaterialModel::linear));
    const auto ratios = [&] {
        return tetrahedron_volume_ratios(body.tetrahedra.node, body.tetrahedra.volume, body.blocks, body.position);
    };
    CHECK(ratios().smallest == Approx(1).epsilon(1e-13));
    body.position[0].x() += 0.15;  // moves through its neighbours
    const VolumeRatios worst = ratios(), of_elements = element_volume_ratios(body.inputs(), body.blocks, body.position);
    CHECK(worst.smallest < 0);
    REQUIRE(worst.item >= 0);
    CHECK(body.deformation(static_cast<std::size_t>(worst.item)).determinant() == Approx(worst.smallest));
    CHECK(of_elements.item == worst.item);
    CHECK(of_elements.smallest == Approx(worst.smallest));
    CHECK(of_elements.inverted == worst.inverted);
    CHECK(tetrahedron_volume_ratios(body.tetrahedra.node, body.tetrahedra.volume, {0, 0}, body.position).item ==
          no_index);
    body.position[3].x() = std::numeric_limits<Real>::quiet_NaN();
    CHECK(std::isnan(ratios().smallest));
}

}  // namespace skerry::test::element_energy_test
