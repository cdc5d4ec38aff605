#include "engine/mesh/require_positive.h"

#include <algorithm>
#include <cmath>
#include <span>
#include <sstream>
#include <vector>

#include "components/union_find.h"
#include "engine/mesh/manifold_fault.h"
#include "engine/mesh/tetrahedron.h"
#include "skerry/error.h"
#include "systems/collision/tree/box.h"
#include "systems/collision/tree/box_tree.h"
#include "systems/geometry/passes_through.h"

namespace skerry::mesh {

void require_positive(const Mesh& mesh, const std::string& what) {
    if (mesh.tetrahedra.empty()) Complaint{what, "mesh", {}, "no tetrahedra", "at least one tetrahedron", {}}.raise();
    require_valid(mesh, what);
    std::size_t inverted = 0, flat = 0, first = mesh.tetrahedra.size();
    for (std::size_t e = 0; e < mesh.tetrahedra.size(); ++e) {
        const Orientation side = orientation(mesh, mesh.tetrahedra[e]);
        if (side == Orientation::positive) continue;
        (side == Orientation::flat ? flat : inverted) += 1;
        if (first == mesh.tetrahedra.size()) first = e;
    }
    if (inverted + flat == 0) return;

    const std::array<Index, 4>& t = mesh.tetrahedra[first];
    std::ostringstream object, found, hint;
    object << "tetrahedron " << first << " (nodes " << t[0] << ' ' << t[1] << ' ' << t[2] << ' ' << t[3] << ')';
    found << six_volumes(mesh, t) / 6 << " m^3";
    hint << "inverted: " << inverted << ", flat: " << flat << " of " << mesh.tetrahedra.size()
         << " tetrahedra, numbered from 0; repair the mesh with skerry inspect MESH --repair OUT.msh";
    Complaint{what, object.str(), "rest volume", found.str(), "a positive volume", hint.str()}.raise();
}

namespace {

/// A part of a surface: triangles that common nodes connect.
struct Shell {
    Vec3 lower = Vec3::Constant(infinity), upper = Vec3::Constant(-infinity);  // bounding box [m]
    Real volume = 0;                                                           // [m^3]
    Index node = no_index;                                                     // one of its nodes

    bool encloses(const Shell& other) const {
        return volume > 0 && (lower.array() <= other.lower.array()).all() &&
               (other.upper.array() <= upper.array()).all();
    }
};

std::vector<Shell> shells_of(const SurfaceMesh& surface) {
    UnionFind parts;
    parts.start(surface.nodes.size());
    for (const std::array<Index, 3>& triangle : surface.triangles)
        for (const Index n : triangle) parts.join(triangle[0], n);
    std::vector<Shell> shells;
    for (const std::array<Index, 3>& triangle : surface.triangles) {
        const auto number = static_cast<std::size_t>(parts.number(triangle[0]));
        if (number == shells.size()) shells.emplace_back().node = triangle[0];
        Shell& shell = shells[number];
        Mat3 corners;
        for (std::size_t k = 0; k < 3; ++k) {
            const Vec3& x = surface.nodes[static_cast<std::size_t>(triangle[k])];
            corners.col(static_cast<Index>(k)) = x - surface.nodes[static_cast<std::size_t>(shell.node)];
            shell.lower = shell.lower.cwiseMin(x);
            shell.upper = shell.upper.cwiseMax(x);
        }
        shell.volume += corners.determinant() / 6;
    }
    return shells;
}

/// True if an edge of the first triangle passes through the second one, more than by rounding errors.
bool passes(const SurfaceMesh& surface, const std::array<Index, 3>& first, const std::array<Index, 3>& second) {
    constexpr Real rounding = 1e-6;  // least height of an end above the plane, relative to the length of the edge
    const auto at = [&](Index n) -> const Vec3& { return surface.nodes[static_cast<std::size_t>(n)]; };
    const Vec3 &a = at(second[0]), &b = at(second[1]), &c = at(second[2]), normal = (b - a).cross(c - a);
    for (std::size_t k = 0; k < 3; ++k) {
        const Vec3 &p = at(first[k]), &q = at(first[(k + 1) % 3]);
        const Real least = rounding * (q - p).norm() * normal.norm();
        if (std::abs(normal.dot(p - a)) > least && std::abs(normal.dot(q - a)) > least && passes_through(p, q, a, b, c))
            return true;
    }
    return false;
}

/// Bounding boxes of all triangles.
std::vector<Aabb> boxes_of(const SurfaceMesh& surface) {
    std::vector<Aabb> boxes(surface.triangles.size(), empty_box());
    for (std::size_t t = 0; t < boxes.size(); ++t)
        for (const Index n : surface.triangles[t]) grow(boxes[t], surface.nodes[static_cast<std::size_t>(n)]);
    return boxes;
}

/// Describes the first two triangles that cross, or returns an empty text. `tree`: made of the boxes.
std::string crossing_of(const SurfaceMesh& surface, std::span<const Aabb> boxes, const BoxTree& tree) {
    std::string found;
    for (std::size_t t = 0; t < boxes.size() && found.empty(); ++t)
        tree.for_each_overlap(boxes[t], [&](Index other) {
            if (found.empty() &&
                passes(surface, surface.triangles[t], surface.triangles[static_cast<std::size_t>(other)]))
                found = "triangles " + std::to_string(t) + " and " + std::to_string(other) + ", which cross";
        });
    return found;
}

/// Sign of the side of the line through `p` and `q` on which `x` lies, seen along the first axis. The sign of a point
/// on the line depends on the line only, so that exactly one of two triangles at an edge contains the point.
int side_of(const Vec3& x, const Vec3& p, const Vec3& q) {
    const bool swapped = q.z() < p.z() || (q.z() == p.z() && q.y() < p.y());
    const Vec3 &a = swapped ? q : p, &b = swapped ? p : q;
    const bool left = (b.y() - a.y()) * (x.z() - a.z()) - (b.z() - a.z()) * (x.y() - a.y()) >= 0;
    return left == swapped ? -1 : 1;
}

/// Describes the first triangle with a point behind it that lies in two volumes, or returns an empty text. It finds
/// shells whose faces coincide where they overlap, such as aligned boxes, and shells that are within others.
std::string doubled_volume_of(const SurfaceMesh& surface, const BoxTree& tree) {
    constexpr Real depth = 1e-6;  // depth of the points, relative to the size of the surface
    Aabb whole = empty_box();
    for (const Vec3& x : surface.nodes) grow(whole, x);
    const Real size = (whole.upper - whole.lower).norm();
    const auto corner = [&](std::size_t t, std::size_t k) -> const Vec3& {
        return surface.nodes[static_cast<std::size_t>(surface.triangles[t][k])];
    };
    for (std::size_t t = 0; t < surface.triangles.size(); ++t) {
        const Vec3 &a = corner(t, 0), &b = corner(t, 1), &c = corner(t, 2);
        const Vec3 normal = (b - a).cross(c - a).normalized();
        if (normal.isZero()) continue;
        const Vec3 x = 0.41 * a + 0.35 * b + 0.24 * c - depth * size * normal;
        Aabb ray = empty_box();
        grow(ray, x);
        grow(ray, Vec3(x.x() + 2 * size, x.y(), x.z()));
        int winding = 0;  // number of volumes that contain the point
        tree.for_each_overlap(ray, [&](Index found) {
            const auto other = static_cast<std::size_t>(found);
            const Vec3 &p = corner(other, 0), &q = corner(other, 1), &r = corner(other, 2);
            const int side = side_of(x, p, q);
            if (side_of(x, q, r) != side || side_of(x, r, p) != side) return;
            const Vec3 across = (q - p).cross(r - p);
            if (across.dot(p - x) * across.x() > 0) winding += side;
        });
        if (winding > 1) return "triangle " + std::to_string(t) + ", behind which volumes overlap";
    }
    return {};
}

}  // namespace

void require_shells(const SurfaceMesh& surface, const std::string& what, bool may_cross) {
    std::vector<BoundaryTriangle> triangles;
    for (const std::array<Index, 3>& triangle : surface.triangles) triangles.push_back({triangle, no_index});
    if (const std::string fault = open_edge(triangles); !fault.empty())
        Complaint{what, "mesh", "triangles", fault, "a closed surface", "close the holes of the surface"}.raise();
    const std::vector<Shell> shells = shells_of(surface);
    for (const Shell& shell : shells) {
        constexpr Real flat = 1e-12;  // rounding error of the volume, relative to the cube of the size
        const Real size = (shell.upper - shell.lower).maxCoeff();
        const auto around = [&](const Shell& other) { return other.encloses(shell); };
        if (shell.volume > flat * size * size * size || (shell.volume < 0 && std::ranges::any_of(shells, around)))
            continue;
        std::ostringstream found;
        found << shell.volume << " m^3 inside the shell at node " << shell.node;
        Complaint{what,
                  "mesh",
                  "triangles",
                  found.str(),
                  "a positive volume",
                  "triangles must be counter-clockwise as seen from outside: reverse the order of their nodes"}
            .raise();
    }
    if (may_cross) return;
    const std::vector<Aabb> boxes = boxes_of(surface);
    const BoxTree tree(boxes);
    std::string found = crossing_of(surface, boxes, tree);
    if (found.empty()) found = doubled_volume_of(surface, tree);
    if (!found.empty())
        Complaint{what,
                  "mesh",
                  "triangles",
                  found,
                  "shells that do not overlap",
                  "or give mass, center_of_mass and inertia, because volumes that overlap count twice"}
            .raise();
}

}  // namespace skerry::mesh
