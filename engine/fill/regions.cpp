#include "engine/fill/regions.h"

#include <algorithm>
#include <cmath>
#include <functional>
#include <numbers>
#include <numeric>
#include <utility>

#include "engine/mesh/repair/surface_measures.h"
#include "engine/mesh/repair/triangle_tree.h"
#include "engine/mesh/used_nodes.h"
#include "systems/collision/build_surface.h"
#include "systems/collision/narrow/winding_number.h"

namespace skerry::mesh {

namespace {

using Triangle = std::array<Index, 3>;

void reverse(std::vector<Triangle>& triangles) {
    for (Triangle& t : triangles) std::swap(t[1], t[2]);
}

/// True if a shell contains a point: if its winding number at the point is above 1/2. With holes in the shell this
/// number is not an integer.
bool surrounds(const Shell& shell, const std::vector<Vec3>& nodes, const Vec3& point) {
    const auto from_point = [&](Index n) -> Vec3 { return nodes[static_cast<std::size_t>(n)] - point; };
    Real sum = 0;
    for (const auto& [a, b, c] : shell.triangles) sum += half_solid_angle(from_point(a), from_point(b), from_point(c));
    return sum / (2 * std::numbers::pi) > 0.5;
}

void append(std::vector<Triangle>& target, std::vector<Triangle> triangles, bool reversed) {
    if (reversed) reverse(triangles);
    target.insert(target.end(), triangles.begin(), triangles.end());
}

}  // namespace

bool Shells::has_regions() const {
    return std::ranges::any_of(shell, [](const Shell& s) { return s.parent != no_index && !s.cavity; });
}

std::size_t Shells::cavity_count() const {
    return static_cast<std::size_t>(std::ranges::count_if(shell, &Shell::cavity));
}

Shells shells_of(const SurfaceReport& report, bool all_cavities) {
    std::vector<std::size_t> order(report.shells.size());
    std::iota(order.begin(), order.end(), 0);
    std::ranges::stable_sort(order, std::ranges::greater(),
                             [&](std::size_t s) { return std::abs(report.shells[s].volume); });
    std::vector<std::size_t> sorted_row(order.size());
    for (std::size_t s = 0; s < order.size(); ++s) sorted_row[order[s]] = s;
    Shells shells{report.cleaned.nodes, std::vector<Shell>(order.size())};
    for (std::size_t t = 0; t < report.shell.size(); ++t)
        shells.shell[sorted_row[static_cast<std::size_t>(report.shell[t])]].triangles.push_back(
            report.cleaned.triangles[t]);
    std::vector<std::size_t> depth(order.size(), 0);
    int label = 0;
    for (std::size_t s = 0; s < order.size(); ++s) {
        const SurfaceShell& reported = report.shells[order[s]];
        Shell& shell = shells.shell[s];
        if (reported.volume < 0) reverse(shell.triangles);
        shell.volume = std::abs(reported.volume);
        shell.first_triangle = reported.triangle;
        if (reported.around != no_index) {
            const std::size_t around = sorted_row[static_cast<std::size_t>(reported.around)];
            shell.parent = static_cast<Index>(around);
            depth[s] = depth[around] + 1;
        }
        shell.cavity = depth[s] % 2 == 1 && (all_cavities || reported.volume < 0);
        if (!shell.cavity) shell.label = ++label;
    }
    return shells;
}

SurfaceMesh whole_surface(const Shells& shells) {
    SurfaceMesh surface{shells.nodes, {}};
    for (const Shell& shell : shells.shell) append(surface.triangles, shell.triangles, shell.cavity);
    return surface;
}

SurfaceMesh boundary_of_region(const Shells& shells, std::size_t shell) {
    SurfaceMesh surface{shells.nodes, shells.shell[shell].triangles};
    for (const Shell& within : shells.shell)
        if (within.parent == static_cast<Index>(shell)) append(surface.triangles, within.triangles, true);
    return surface;
}

SurfaceMesh without_unused_nodes(const SurfaceMesh& surface, std::vector<Index>* kept_nodes) {
    SurfaceMesh compact{{}, surface.triangles};
    UsedNodes used = drop_unused(surface.nodes, compact.triangles);
    compact.nodes = std::move(used.nodes);
    if (kept_nodes) *kept_nodes = std::move(used.number);
    return compact;
}

void label_regions(Mesh& mesh, const Shells& shells) {
    mesh.label.assign(mesh.tetrahedra.size(), shells.shell.front().label);
    for (std::size_t e = 0; e < mesh.tetrahedra.size(); ++e) {
        Vec3 centroid = Vec3::Zero();
        for (const Index n : mesh.tetrahedra[e]) centroid += mesh.nodes[static_cast<std::size_t>(n)] / 4;
        for (std::size_t s = shells.shell.size(); --s > 0;) {
            const Shell& shell = shells.shell[s];
            if (shell.cavity || !surrounds(shell, shells.nodes, centroid)) continue;
            mesh.label[e] = shell.label;
            break;
        }
    }
}

std::vector<Triangle> faces_of_regions(const Mesh& mesh) {
    std::vector<Triangle> faces;
    if (!mesh.label.empty()) {
        const std::vector<TetrahedronFace> all = sorted_faces(mesh.tetrahedra);
        const auto label = [&](const TetrahedronFace& face) {
            return mesh.label[static_cast<std::size_t>(face.tetrahedron)];
        };
        for (std::size_t i = 1; i < all.size(); ++i)
            if (all[i].node == all[i - 1].node && label(all[i]) != label(all[i - 1])) faces.push_back(all[i].node);
    }
    for (const BoundaryTriangle& triangle : boundary_triangles(mesh.tetrahedra)) faces.push_back(triangle.node);
    return faces;
}

std::vector<std::vector<Triangle>> faces_of_shells(const Mesh& mesh, const Shells& shells) {
    std::vector<TriangleTree> trees;
    for (const Shell& shell : shells.shell) trees.emplace_back(without_unused_nodes({shells.nodes, shell.triangles}));
    std::vector<std::vector<Triangle>> faces(trees.size());
    const SurfaceMesh of_regions{mesh.nodes, faces_of_regions(mesh)};
    for (const Triangle& face : of_regions.triangles) {
        const std::array<Vec3, 3> x = corners(of_regions, face);
        const Vec3 centroid = (x[0] + x[1] + x[2]) / 3;
        std::size_t nearest = 0;
        Real least = infinity;
        for (std::size_t s = 0; s < trees.size(); ++s) {
            const Real squared = trees[s].distance_squared(centroid, least);
            if (squared < least) nearest = s;
            least = std::min(least, squared);
        }
        faces[nearest].push_back(face);
    }
    return faces;
}

}  // namespace skerry::mesh
