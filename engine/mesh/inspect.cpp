#include <algorithm>
#include <cmath>
#include <utility>

#include "components/counting_sort.h"
#include "engine/mesh/labels.h"
#include "engine/mesh/manifold_fault.h"
#include "engine/mesh/tetrahedron.h"
#include "skerry/mesh.h"
#include "systems/collision/build_surface.h"

namespace skerry {
namespace {

// Tetrahedra with a smaller quality() count as slivers. The small altitudes of slivers shorten the stable time step and
// reduce accuracy.
constexpr Real poor_quality = 0.1;

using Edge = std::pair<Index, Index>;  // nodes of an edge, the lower number first

std::vector<Edge> unique_edges(const Mesh& mesh) {
    std::vector<Edge> edges;
    edges.reserve(6 * mesh.tetrahedra.size() + 3 * mesh.triangles.size());
    for (const std::array<Index, 4>& t : mesh.tetrahedra)
        for (std::size_t a = 0; a < 4; ++a)
            for (std::size_t b = a + 1; b < 4; ++b) edges.emplace_back(std::minmax(t[a], t[b]));
    for (const auto& [a, b, c] : mesh.triangles)
        for (const Edge& edge : {Edge(std::minmax(a, b)), Edge(std::minmax(b, c)), Edge(std::minmax(c, a))})
            edges.push_back(edge);
    std::vector<Edge> spare;
    const auto node_count = static_cast<Index>(mesh.nodes.size());
    counting_sort(edges, spare, node_count, [](const Edge& edge) { return edge.second; });
    counting_sort(edges, spare, node_count, [](const Edge& edge) { return edge.first; });
    edges.erase(std::unique(edges.begin(), edges.end()), edges.end());
    return edges;
}

void measure_edges(const Mesh& mesh, MeshReport& report) {
    const std::vector<Edge> edges = unique_edges(mesh);
    if (edges.empty()) return;
    report.min_edge = infinity;
    Real sum = 0;
    for (const auto& [a, b] : edges) {
        const Real length = (mesh.nodes[static_cast<std::size_t>(b)] - mesh.nodes[static_cast<std::size_t>(a)]).norm();
        report.min_edge = std::min(report.min_edge, length);
        report.max_edge = std::max(report.max_edge, length);
        sum += length;
    }
    report.mean_edge = sum / static_cast<Real>(edges.size());
}

/// Mean-ratio quality of a tetrahedron: 12 (3 |V|)^(2/3) / (sum of squared edge lengths), with the sign of the volume
/// V. It is 1 for a regular tetrahedron and 0 for a flat one.
Real quality(Real six_volumes, const std::array<Real, 6>& edges) {
    Real squares = 0;
    for (const Real length : edges) squares += length * length;
    if (!(squares > 0)) return 0;
    const Real root = std::cbrt(std::abs(six_volumes) / 2);
    return std::copysign(12 * root * root / squares, six_volumes);
}

void measure_tetrahedra(const Mesh& mesh, MeshReport& report) {
    if (mesh.tetrahedra.empty()) return;
    report.min_altitude = report.min_quality = infinity;
    for (const std::array<Index, 4>& t : mesh.tetrahedra) {
        const Real volume = mesh::six_volumes(mesh, t);
        const Real face = std::sqrt(mesh::largest_face_squared(mesh, t));  // twice the area of the largest face
        const Real shape = quality(volume, mesh::edge_lengths(mesh, t));
        report.volume += volume / 6;
        report.min_altitude = std::min(report.min_altitude, face > 0 ? std::abs(volume) / face : 0);
        report.min_quality = std::min(report.min_quality, shape);
        report.mean_quality += shape / static_cast<Real>(mesh.tetrahedra.size());
        const mesh::Orientation side = mesh::orientation(mesh, t);
        report.inverted += side == mesh::Orientation::inverted;
        report.flat += side == mesh::Orientation::flat;
        report.slivers += side == mesh::Orientation::positive && shape < poor_quality;
    }
}

}  // namespace

MeshReport inspect(const Mesh& mesh) {
    mesh::require_valid(mesh, "mesh");
    MeshReport report;
    report.nodes = mesh.nodes.size();
    report.tetrahedra = mesh.tetrahedra.size();
    if (!mesh.nodes.empty()) report.lower = report.upper = mesh.nodes.front();
    for (const Vec3& node : mesh.nodes) {
        report.lower = report.lower.cwiseMin(node);
        report.upper = report.upper.cwiseMax(node);
    }
    std::vector<BoundaryTriangle> triangles = boundary_triangles(mesh.tetrahedra);
    for (const std::array<Index, 3>& triangle : mesh.triangles) triangles.push_back({triangle, no_index});
    report.boundary_triangles = triangles.size();
    report.labels = mesh::count_labels(mesh);
    for (const auto& [name, set] : mesh.sets)
        report.sets[name] = {set.nodes.size(), set.faces.size(), set.tetrahedra.size()};
    report.boundary_fault = mesh::manifold_fault(triangles);
    report.closed_manifold = report.boundary_fault.empty();
    report.components = mesh::count_parts(mesh);
    measure_edges(mesh, report);
    measure_tetrahedra(mesh, report);
    // The volume enclosed by a surface is the sum of the signed volumes of tetrahedra that join each triangle with node
    // 0 (divergence theorem).
    for (const auto& [a, b, c] : mesh.triangles) report.volume += mesh::six_volumes(mesh, {0, a, b, c}) / 6;
    return report;
}

}  // namespace skerry
