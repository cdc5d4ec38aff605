#include <cmath>
#include <numbers>

#include "engine/mesh/shapes/add_tetrahedron.h"

namespace skerry::mesh {
namespace {

constexpr int around = 24;  // nodes of a rim

Vec3 on_rim(Real radius, Real z, int k) {
    const Real turn = 2 * std::numbers::pi * k / around;
    return {radius * std::cos(turn), radius * std::sin(turn), z};
}

}  // namespace

Mesh cylinder_picture(Real radius, Real height) {
    require_size("cylinder radius", radius);
    require_size("cylinder height", height);
    const Real half = height / 2;
    Mesh mesh;
    mesh.nodes = {Vec3::Zero(), {0, 0, half}};
    for (int k = 0; k < around; ++k) mesh.nodes.push_back(on_rim(radius, half, k));
    const auto upper = [](int k) { return static_cast<Index>(2 + k % around); };
    const auto lower = [](int k) { return static_cast<Index>(3 + around + k % around); };
    const Index bottom = 2 + around;
    mesh.nodes.emplace_back(0, 0, -half);
    for (int k = 0; k < around; ++k) mesh.nodes.push_back(on_rim(radius, -half, k));
    for (int k = 0; k < around; ++k) {
        add_tetrahedron(mesh, {0, 1, upper(k), upper(k + 1)});
        add_tetrahedron(mesh, {0, bottom, lower(k + 1), lower(k)});
        add_tetrahedron(mesh, {0, lower(k), lower(k + 1), upper(k + 1)});
        add_tetrahedron(mesh, {0, lower(k), upper(k + 1), upper(k)});
    }
    return mesh;
}

}  // namespace skerry::mesh
