// Boxes with mapped nodes, loads on a part of their surface, and their state of rest.
#pragma once

#include <Eigen/Geometry>
#include <catch2/catch.hpp>
#include <span>
#include <vector>

#include "skerry/world.h"

namespace skerry::test {

/// A box of cells. `map` maps a point of the unit cube to the position of the node.
template <class Map>
Mesh mapped_box(const std::array<int, 3>& cells, Map map) {
    Mesh mesh = mesh::box({1, 1, 1}, cells);
    for (Vec3& x : mesh.nodes) x = map(Vec3(x + Vec3::Constant(0.5)));
    const MeshReport report = inspect(mesh);
    REQUIRE(report.inverted + report.flat == 0);
    return mesh;
}

/// Indices of the nodes for whose position `chosen` returns true.
template <class Chosen>
std::vector<Index> nodes_where(const Mesh& mesh, Chosen chosen) {
    std::vector<Index> rows;
    for (std::size_t n = 0; n < mesh.nodes.size(); ++n)
        if (chosen(mesh.nodes[n])) rows.push_back(static_cast<Index>(n));
    return rows;
}

/// Forces on the nodes [N] from a load on the surface triangles all of whose corners satisfy `loaded`. `force` maps the
/// area vector of a triangle (outward [m^2]) to its force; each corner takes a third of it.
template <class Loaded, class Force>
std::vector<Vec3> surface_loads(const Mesh& mesh, std::span<const std::array<Index, 3>> surface, Loaded loaded,
                                Force force) {
    std::vector<Vec3> load(mesh.nodes.size(), Vec3::Zero());
    for (const auto& t : surface) {
        const auto at = [&](std::size_t i) -> const Vec3& { return mesh.nodes[static_cast<std::size_t>(t[i])]; };
        if (!loaded(at(0)) || !loaded(at(1)) || !loaded(at(2))) continue;
        const Vec3 area = 0.5 * (at(1) - at(0)).cross(at(2) - at(0));
        for (Index n : t) load[static_cast<std::size_t>(n)] += force(area) / 3;
    }
    return load;
}

/// Advances by `look` seconds at a time until the kinetic energy is at most 1e-10 of the elastic energy.
inline void settle(World& world, Real look) {
    Energy energy;
    do {
        const StepReport report = world.advance(look);
        INFO(report.message());
        REQUIRE(report.ok());
        energy = world.energy();
    } while (energy.kinetic > 1e-10 * energy.elastic);
}

}  // namespace skerry::test
