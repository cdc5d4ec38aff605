#include <cmath>
#include <numbers>

#include "engine/mesh/shapes/add_tetrahedron.h"

namespace skerry::mesh {
namespace {

constexpr int rim_nodes = 24;

Vec3 on_rim(Real radius, Real z, int k) {
    const Real turn = 2 * std::numbers::pi * k / rim_nodes;
    return {radius * std::cos(turn), radius * std::sin(turn), z};
}

}  // namespace

Mesh cylinder_picture(Real radius, Real height) {
    require_size("cylinder", "radius", radius);
    require_size("cylinder", "height", height);
    const Real half = height / 2;
    Mesh mesh;
    mesh.nodes = {Vec3::Zero(), {0, 0, half}};
    for (int k = 0; k < rim_nodes; ++k) mesh.nodes.push_back(on_rim(radius, half, k));
    const auto upper = [](int k) { return static_cast<Index>(2 + k % rim_nodes); };
    const auto lower = [](int k) { return static_cast<Index>(3 + rim_nodes + k % rim_nodes); };
    const Index bottom = 2 + rim_nodes;
    mesh.nodes.emplace_back(0, 0, -half);
    for (int k = 0; k < rim_nodes; ++k) mesh.nodes.push_back(on_rim(radius, -half, k));
    for (int k = 0; k < rim_nodes; ++k) {
        add_tetrahedron(mesh, {0, 1, upper(k), upper(k + 1)});
        add_tetrahedron(mesh, {0, bottom, lower(k + 1), lower(k)});
        add_tetrahedron(mesh, {0, lower(k), lower(k + 1), upper(k + 1)});
        add_tetrahedron(mesh, {0, lower(k), upper(k + 1), upper(k)});
    }
    return mesh;
}

}  // namespace skerry::mesh
