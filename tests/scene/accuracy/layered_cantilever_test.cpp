// A cantilever of two layers, one much stiffer than the other (docs/accuracy.md, item 39).
#include <catch2/catch.hpp>

#include "tests/support/accuracy.h"
#include "tests/support/mapped_box.h"
#include "tests/support/worlds.h"

namespace skerry::test::layered_cantilever_test {

namespace {

// [m, m, Pa, Pa, Pa]; soft: lower layer, stiff: upper layer
constexpr Real length = 1, height = 0.1, soft = 1e4, stiff = 1e6, shear_stress = 0.01;

/// Load-weighted mean displacement of the loaded end, over F / (E h), with the load F and the E of the soft layer.
Real displacement(ElementKind kind) {
    Settings settings;
    settings.gravity = Vec3::Zero();
    World world(settings);
    // The damping is about critical for the first mode.
    const auto of = [&](Real modulus) {
        return world.add_material(
            lossless({.young_modulus = modulus, .poisson_ratio = 0.3, .damping = 2.4, .model = MaterialModel::linear}));
    };
    Mesh mesh = mesh::box({length, height, height}, {40, 4, 4});
    for (const auto& t : mesh.tetrahedra) {
        Real z = 0;
        for (const Index n : t) z += mesh.nodes[static_cast<std::size_t>(n)].z();
        mesh.label.push_back(z > 0 ? 1 : 0);
    }
    const auto beam = world.add_body(mesh, {.material = of(soft), .materials = {{1, of(stiff)}}, .element = kind});
    world.attach(beam, nodes_where(mesh, [](const Vec3& x) { return x.x() < -length / 2 + 1e-9; }));
    const auto end = [](const Vec3& x) { return x.x() > length / 2 - 1e-9; };
    const std::vector<Vec3> load = surface_loads(
        mesh, world.surface(beam), end, [](const Vec3& area) { return Vec3(0, 0, shear_stress * area.norm()); });
    world.set_loads(beam, load);
    settle(world, 0.5);
    Real force = 0, work = 0;
    for (std::size_t n = 0; n < load.size(); ++n) {
        force += load[n].z();
        work += load[n].dot(world.positions(beam)[n] - mesh.nodes[n]);
    }
    return work / force / (force / (soft * height));
}

}  // namespace

TEST_CASE("a beam of two layers bends as a fine mesh of quadratic elements does", "[scene][accuracy]") {
    // Reference: half of the width in quadratic tetrahedra, six per cell, graded towards the held end: 282.48, 282.52,
    // 282.54, 282.55 with 60 x 3 x 6, 4 x 8, 5 x 10, 6 x 12 cells, 282.53, 282.55 with 80 x 4 x 8, 5 x 10 (Richardson,
    // with the observed order of 1.5). Smoothed elements approach from both sides: 234, 287.9, 288.4 with 2, 4 and 6
    // cells in the height.
    constexpr Real expected = 282.6;
    for (const auto& [kind, tolerance] : {std::pair{ElementKind::linear, 0.5}, {ElementKind::smoothed, 0.03}})
        accuracy::check({.item = 39,
                         .name = "cantilever of two layers, moduli 1 : 100, displacement of the end over F / (E h), " +
                                 std::string(name_of(kind)),
                         .formula = "fine mesh of quadratic elements",
                         .expected = expected,
                         .found = displacement(kind),
                         .tolerance = tolerance});
}

}  // namespace skerry::test::layered_cantilever_test
