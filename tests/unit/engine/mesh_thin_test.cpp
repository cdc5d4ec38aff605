// Thin parts of meshes and their stiffness in bending.
#include <Eigen/Geometry>
#include <algorithm>
#include <catch2/catch.hpp>
#include <cmath>
#include <numeric>

#include "engine/mesh/thin/thin_parts.h"
#include "systems/collision/build_surface.h"
#include "tests/support/mapped_box.h"

namespace skerry::test::mesh_thin_test {

namespace {

constexpr Real no_error = 1.25;  // a stiffness below this value counts as right

/// Thin parts of a body of these materials. Tetrahedra with the label m have the material m; without labels all have
/// the first material.
std::vector<mesh::ThinPart> thin_parts_of(const Mesh& mesh, ElementKind kind,
                                          const std::vector<mesh::ElasticConstants>& materials) {
    std::vector<MaterialZone> zones;
    for (std::size_t m = 0; m < materials.size(); ++m) {
        zones.push_back({static_cast<Index>(m), resolved(kind, materials[m].poisson_ratio), {}});
        for (std::size_t t = 0; t < mesh.tetrahedra.size(); ++t)
            if ((mesh.label.empty() ? 0 : mesh.label[t]) == static_cast<int>(m))
                zones.back().tetrahedra.push_back(static_cast<Index>(t));
    }
    std::vector<std::array<Index, 3>> boundary;
    for (const BoundaryTriangle& triangle : boundary_triangles(mesh.tetrahedra)) boundary.push_back(triangle.node);
    return mesh::thin_parts(mesh, boundary, zones, materials);
}

std::vector<mesh::ThinPart> thin_parts_of(const Mesh& mesh, ElementKind kind, Real poisson_ratio = 0.3) {
    return thin_parts_of(mesh, kind, {{1e6, poisson_ratio}});
}

/// A strip along x, which is bent about y.
struct Strip {
    Vec3 size;  // [m]
    std::array<int, 3> cells;
    std::vector<mesh::ElasticConstants> material;  // one material, or those of the lower and the upper half

    Mesh mesh() const {
        Mesh strip = mesh::box(size, cells);
        if (material.size() > 1)
            for (const auto& t : strip.tetrahedra) {
                Real z = 0;
                for (const Index n : t) z += strip.nodes[static_cast<std::size_t>(n)].z();
                strip.label.push_back(z > 0 ? 1 : 0);
            }
        return strip;
    }

    /// Bending stiffness of beam theory, per width [N m].
    Real stiffness() const {
        const Real h = size.z();
        if (material.size() == 1) return material[0].young_modulus * h * h * h / 12;
        const Real lower = material[0].young_modulus * h / 2, upper = material[1].young_modulus * h / 2;
        const Real neutral = (upper - lower) / (upper + lower) * h / 4;
        const auto of_half = [&](Real tension, Real z) {
            return tension * (h * h / 48 + (z - neutral) * (z - neutral));
        };
        return of_half(lower, -h / 4) + of_half(upper, h / 4);
    }

    /// The deflection of beam theory under the own weight, divided by the static deflection of the elements.
    Real measured(ElementKind kind) const {
        constexpr Real density = 1000, static_step = 1;  // [kg/m^3], [s]; the period is a thousand times shorter
        Settings settings;
        settings.step_size = static_step;
        World world(settings);
        BodySettings body{.dynamics = BodyDynamics::implicit_elastic, .element = kind};
        std::vector<MaterialHandle> handles;
        for (const mesh::ElasticConstants& constants : material)
            handles.push_back(world.add_material({.young_modulus = constants.young_modulus,
                                                  .poisson_ratio = constants.poisson_ratio,
                                                  .density = density,
                                                  .loss_factor = 0,
                                                  .bulk_viscosity = 0,
                                                  .model = MaterialModel::linear}));
        body.material = handles.front();
        if (handles.size() > 1) body.materials = {{0, handles[0]}, {1, handles[1]}};
        const Mesh strip = mesh();
        const BodyHandle handle = world.add_body(strip, body);
        const Real end = size.x() / 2 * (1 - 1e-9), length = size.x();
        world.attach(handle, nodes_where(strip, [&](const Vec3& x) { return x.x() < -end; }));
        REQUIRE(world.advance(10 * static_step).ok());
        const std::vector<Index> tip = nodes_where(strip, [&](const Vec3& x) { return x.x() > end; });
        Real deflection = 0;
        for (const Index n : tip) {
            const auto row = static_cast<std::size_t>(n);
            deflection += (strip.nodes[row].z() - world.positions(handle)[row].z()) / static_cast<Real>(tip.size());
        }
        const Real weight = density * settings.gravity.norm() * size.z();  // per area [Pa]
        return weight * length * length * length * length / (8 * stiffness()) / deflection;
    }
};

}  // namespace

TEST_CASE("the stiffness of a thin strip in bending is estimated within a factor of 1.5", "[unit]") {
    const std::vector<mesh::ElasticConstants> plain{{3e8, 0}}, rubber{{3e8, 0.45}};
    const std::vector<Strip> strips{
        {{0.05, 0.01, 0.001}, {20, 4, 1}, plain},          // 2.5 times as long as high
        {{0.05, 0.01, 0.001}, {10, 2, 1}, plain},          // 5 times
        {{0.025, 0.005, 0.001}, {25, 5, 1}, plain},        // cubic cells
        {{0.05, 0.004, 0.001}, {24, 2, 1}, {{3e8, 0.3}}},  // narrow
        {{0.05, 0.01, 0.001}, {20, 4, 2}, rubber},         // two layers
        {{0.04, 0.04, 0.002}, {10, 10, 1}, {{3e8, 0.3}}},  // a plate
        {{0.05, 0.01, 0.001}, {20, 4, 2}, {{3e7, 0}, {3e9, 0}}},
    };
    for (const Strip& strip : strips)
        for (const ElementKind kind : {ElementKind::linear, ElementKind::smoothed}) {
            CAPTURE(name_of(kind), strip.cells[0], strip.cells[1], strip.cells[2], strip.material[0].poisson_ratio);
            const std::vector<mesh::ThinPart> parts = thin_parts_of(strip.mesh(), kind, strip.material);
            REQUIRE_FALSE(parts.empty());
            const mesh::ThinPart& part = parts.front();
            CHECK(part.layers == Approx(strip.cells[2]));
            CHECK(part.thickness == Approx(strip.size.z()));
            CHECK(part.length == Approx(strip.size.x()).epsilon(0.05));
            CHECK(part.volume == Approx(strip.size.prod()));
            const Real measured = strip.measured(kind);
            CHECK(part.stiffness < 1.5 * measured);
            CHECK(part.stiffness > measured / 1.5);
        }
}

TEST_CASE("a strip with long cells in one half bends like its two halves in series", "[unit]") {
    const auto with_cells = [](int count) { return mesh::box({0.05, 0.01, 0.001}, {count, 10, 1}); };
    Mesh strip = with_cells(30);  // 25 cubic cells, then 5 cells five times as long
    for (Vec3& x : strip.nodes) {
        const long plane = std::lround((x.x() + 0.025) / (0.05 / 30));
        x.x() = plane <= 25 ? -0.025 + 0.001 * static_cast<Real>(plane) : 0.005 * static_cast<Real>(plane - 25);
    }
    for (const ElementKind kind : {ElementKind::linear, ElementKind::smoothed}) {
        const auto stiffness = [&](const Mesh& mesh) { return thin_parts_of(mesh, kind).front().stiffness; };
        const Real in_series = 2 / (1 / stiffness(with_cells(50)) + 1 / stiffness(with_cells(10)));
        CHECK(stiffness(strip) == Approx(in_series).epsilon(0.25));
    }
}

TEST_CASE("the estimate does not depend on the place, the orientation and the unit of length", "[unit]") {
    const Mesh strip = mesh::box({0.05, 0.01, 0.001}, {20, 4, 1});
    const Real expected = thin_parts_of(strip, ElementKind::smoothed).front().stiffness;
    const Mat3 turn = Eigen::AngleAxis<Real>(1, Vec3(1, 2, 3).normalized()).toRotationMatrix();
    for (const Real scale : {1e-3, 1e3}) {
        Mesh moved = strip;
        for (Vec3& x : moved.nodes) x = scale * (turn * x + Vec3(0.1, -0.2, 0.3));
        const mesh::ThinPart part = thin_parts_of(moved, ElementKind::smoothed).front();
        CHECK(part.stiffness == Approx(expected));
        CHECK(part.thickness == Approx(scale * 0.001));
        CHECK((part.place - scale * Vec3(0.1, -0.2, 0.3)).norm() < 1e-9 * scale);
    }
}

TEST_CASE("ordinary meshes have no part that is too stiff in bending", "[unit]") {
    const std::string folder = SKERRY_SOURCE_DIR "/scenes/meshes/";
    for (const auto& [name, mesh] :
         std::vector<std::pair<std::string, Mesh>>{{"tetrahedra of a cube", mesh::box({1, 1, 1}, {1, 1, 1})},
                                                   {"cube", mesh::box({1, 1, 1}, {2, 2, 2})},
                                                   {"block", mesh::box({0.2, 0.2, 0.1}, {4, 4, 2})},
                                                   {"plate of two layers", mesh::box({0.5, 0.5, 0.1}, {10, 10, 2})},
                                                   {"bar of two layers", mesh::box({1, 0.1, 0.1}, {20, 2, 2})},
                                                   {"coarse ball", mesh::ball(0.05, 2)},
                                                   {"ball", mesh::ball(0.05, 6)},
                                                   {"cylinder", mesh::cylinder(0.05, 1, 2)},
                                                   {"skittle", mesh::skittle(0.38, 4)},
                                                   {"table", mesh::table({.cells_per_leg = 2})},
                                                   {"drop_ball", mesh::read(folder + "drop_ball.msh")},
                                                   {"torus", mesh::read(folder + "torus.msh")},
                                                   {"cross", mesh::read(folder + "cross.vtk")},
                                                   {"letter_s", mesh::read(folder + "letter_s.node")}}) {
        CAPTURE(name);
        for (const mesh::ThinPart& part : thin_parts_of(mesh, ElementKind::smoothed, 0.4))
            CHECK(part.stiffness < no_error);
    }
}

TEST_CASE("a wedge and a small fin are not thin parts, a sheet on a block is one", "[unit]") {
    // The sides of the wedge are inclined by 22 degrees.
    const Mesh wedge = mapped_box({10, 10, 1}, [](const Vec3& x) {
        const Real distance = 0.1 + 0.9 * x.x();  // from the edge [m]
        return Vec3(distance, 4 * x.y(), 0.8 * distance * (x.z() - 0.5));
    });
    CHECK(thin_parts_of(wedge, ElementKind::smoothed).empty());

    // a block of 10 x 4 x 10 cells, and above its left end a sheet one cell thick and `height` cells high
    const auto block_with_sheet = [](int height, Real thickness) {
        Mesh mesh = mesh::box({10, 4, 10.0 + height}, {10, 4, 10 + height});
        const Real top = 5 - height / 2.0;
        std::erase_if(mesh.tetrahedra, [&](const std::array<Index, 4>& t) {
            Vec3 centre = Vec3::Zero();
            for (const Index n : t) centre += mesh.nodes[static_cast<std::size_t>(n)] / 4;
            return centre.z() > top && centre.x() > -4;
        });
        for (Vec3& x : mesh.nodes)
            if (x.z() > top + 0.5 && x.x() < -3.5) x.x() = -5 + thickness * (x.x() + 5);
        std::vector<Index> row(mesh.nodes.size(), no_index);
        Mesh used;
        for (std::array<Index, 4>& t : mesh.tetrahedra)
            for (Index& n : t) {
                Index& known = row[static_cast<std::size_t>(n)];
                if (known == no_index) {
                    known = static_cast<Index>(used.nodes.size());
                    used.nodes.push_back(mesh.nodes[static_cast<std::size_t>(n)]);
                }
                n = known;
            }
        used.tetrahedra = mesh.tetrahedra;
        return used;
    };
    for (const mesh::ThinPart& part : thin_parts_of(block_with_sheet(4, 0.1), ElementKind::smoothed)) {
        CAPTURE(part.place.transpose(), part.thickness, part.length, part.volume, part.stiffness);
        CHECK(part.stiffness < no_error);  // 1.6 of 401.6 m^3
    }
    const std::vector<mesh::ThinPart> parts = thin_parts_of(block_with_sheet(10, 0.5), ElementKind::smoothed);
    REQUIRE_FALSE(parts.empty());
    CHECK(parts.front().stiffness > no_error);
    CHECK(parts.front().thickness == Approx(0.5).epsilon(0.1));
    CHECK(parts.front().layers == Approx(1).epsilon(0.1));
    CHECK(parts.front().place.x() < -4);
    CHECK(parts.front().place.z() > 0);
}

}  // namespace skerry::test::mesh_thin_test
