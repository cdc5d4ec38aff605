#include <Eigen/Geometry>
#include <algorithm>
#include <numeric>
#include <optional>

#include "engine/mesh/tetrahedron.h"
#include "engine/mesh/thin/column.h"
#include "systems/collision/build_surface.h"

namespace skerry::mesh {

namespace {

// Greatest thickness of a thin column, as a multiple of the mean edge length of its tetrahedra. If each cubic cell has
// six tetrahedra, two layers of cells have the ratio 1.6 and count as thin; three layers have 2.4 and do not.
constexpr Real thickest = 2;
// Lower limit of the cosine of the angle at which a ray leaves, measured from the outer normal of the triangle (18
// degrees). At a larger angle the two sides form a wedge, such as the rim of a fin, which is not treated as thin.
constexpr Real least_exit_cosine = 0.95;

/// The face of a tetrahedron opposite to `corner` (0 to 3).
struct Face {
    Index tetrahedron = no_index;  // index in NearBoundary::number; no_index: no face
    Index corner = 0;
};

/// Tetrahedra that a ray through a thin part can cross: those with a node on the boundary or one edge away from it.
struct NearBoundary {
    std::vector<Index> number;  // numbers of the tetrahedra in the mesh
    // beyond[t][k]: the face opposite to corner k of tetrahedron t, given as a face of the neighbour beyond it
    std::vector<std::array<Face, 4>> beyond;
    // on_boundary[t][k]: true if the face opposite to corner k of tetrahedron t is on the boundary
    std::vector<std::array<bool, 4>> on_boundary;
    std::vector<Face> boundary;  // faces on the boundary
};

NearBoundary near_boundary(const Mesh& mesh, std::span<const std::array<Index, 3>> boundary) {
    enum : std::uint8_t { far, next, outer };
    std::vector<std::uint8_t> level(mesh.nodes.size(), far);
    for (const std::array<Index, 3>& triangle : boundary)
        for (const Index n : triangle) level[static_cast<std::size_t>(n)] = outer;
    const auto touches = [&](const std::array<Index, 4>& tetrahedron, std::uint8_t least) {
        return std::ranges::any_of(tetrahedron, [&](Index n) { return level[static_cast<std::size_t>(n)] >= least; });
    };
    for (const std::array<Index, 4>& tetrahedron : mesh.tetrahedra)
        if (touches(tetrahedron, outer))
            for (const Index n : tetrahedron)
                level[static_cast<std::size_t>(n)] = std::max<std::uint8_t>(level[static_cast<std::size_t>(n)], next);

    NearBoundary near;
    std::vector<std::array<Index, 4>> tetrahedra;
    for (std::size_t t = 0; t < mesh.tetrahedra.size(); ++t)
        if (touches(mesh.tetrahedra[t], next)) {
            near.number.push_back(static_cast<Index>(t));
            tetrahedra.push_back(mesh.tetrahedra[t]);
        }
    near.beyond.resize(tetrahedra.size());
    near.on_boundary.resize(tetrahedra.size(), {});
    const std::vector<TetrahedronFace> faces = sorted_faces(tetrahedra);
    for (std::size_t f = 0; f < faces.size(); ++f) {
        const Face face{faces[f].tetrahedron, faces[f].corner};
        const auto row = static_cast<std::size_t>(face.tetrahedron), corner = static_cast<std::size_t>(face.corner);
        if (f + 1 < faces.size() && faces[f + 1].node == faces[f].node) {
            ++f;
            near.beyond[row][corner] = {faces[f].tetrahedron, faces[f].corner};
            near.beyond[static_cast<std::size_t>(faces[f].tetrahedron)][faces[f].corner] = face;
        } else if (std::ranges::all_of(faces[f].node,
                                       [&](Index n) { return level[static_cast<std::size_t>(n)] == outer; })) {
            // A face that belongs to only one of these tetrahedra is on the boundary if all of its nodes are boundary
            // nodes. Otherwise the tetrahedron beyond the face is not near the boundary, and therefore not in the list.
            near.on_boundary[row][corner] = true;
            near.boundary.push_back(face);
        }
    }
    std::ranges::sort(near.boundary, {}, [](const Face& face) { return std::pair(face.tetrahedron, face.corner); });
    return near;
}

/// Follows rays through the tetrahedra near the boundary.
class RayWalk {
public:
    RayWalk(const Mesh& mesh, const NearBoundary& near) : mesh_(mesh), near_(near) {}

    /// Returns the column under a boundary face, or nullopt if the mesh is not thin there.
    std::optional<ThinColumn> column_under(Face face) const {
        const std::array<Index, 3> first = nodes_of(face);
        const Vec3 normal = outer_normal(face);
        const Vec3 start = (at(first[0]) + at(first[1]) + at(first[2])) / 3, direction = -normal.normalized();
        ThinColumn column{first, {}, start, direction, normal.norm() / 2, {}, 0};
        Real edges = 0, end = 0;
        while (true) {
            const std::optional<std::pair<Face, Real>> exit = exit_of(column, face);
            if (!exit) return std::nullopt;
            const Real begin = end;
            end = std::max(end, exit->second);
            column.crossings.push_back({number(face), begin, end});
            const std::array<Real, 6> lengths = edge_lengths(mesh_, tetrahedron_of(face));
            edges += std::accumulate(lengths.begin(), lengths.end(), Real{0}) / 6;
            if (end > thickest * edges / static_cast<Real>(column.crossings.size())) return std::nullopt;
            if (is_boundary(exit->first)) {
                column.last = nodes_of(exit->first);
                column.layers = end / mean_extent(column);
                const bool thin = outer_normal(exit->first).normalized().dot(column.direction) > least_exit_cosine;
                return thin ? std::optional(std::move(column)) : std::nullopt;
            }
            face = beyond(exit->first);
            if (face.tetrahedron == no_index) return std::nullopt;
            // Because of rounding errors, a ray through a node or an edge may circle in the tetrahedra around it
            // without end.
            const bool again =
                std::ranges::find(column.crossings, number(face), &Crossing::tetrahedron) != column.crossings.end();
            if (again) return std::nullopt;
        }
    }

private:
    /// Mean over the crossed tetrahedra of their extent in the direction of the ray [m].
    Real mean_extent(const ThinColumn& column) const {
        Real sum = 0;
        for (const Crossing& crossing : column.crossings) {
            Real low = infinity, high = -infinity;
            for (const Index n : mesh_.tetrahedra[static_cast<std::size_t>(crossing.tetrahedron)]) {
                const Real z = at(n).dot(column.direction);
                low = std::min(low, z);
                high = std::max(high, z);
            }
            sum += high - low;
        }
        return sum / static_cast<Real>(column.crossings.size());
    }

    const Vec3& at(Index node) const { return mesh_.nodes[static_cast<std::size_t>(node)]; }
    Index number(Face face) const { return near_.number[static_cast<std::size_t>(face.tetrahedron)]; }
    const std::array<Index, 4>& tetrahedron_of(Face face) const {
        return mesh_.tetrahedra[static_cast<std::size_t>(number(face))];
    }
    bool is_boundary(Face face) const {
        return near_.on_boundary[static_cast<std::size_t>(face.tetrahedron)][static_cast<std::size_t>(face.corner)];
    }
    Face beyond(Face face) const {
        return near_.beyond[static_cast<std::size_t>(face.tetrahedron)][static_cast<std::size_t>(face.corner)];
    }

    /// Nodes of a face in ascending order.
    std::array<Index, 3> nodes_of(Face face) const {
        std::array<Index, 3> nodes{};
        std::size_t count = 0;
        for (std::size_t a = 0; a < 4; ++a)
            if (static_cast<Index>(a) != face.corner) nodes[count++] = tetrahedron_of(face)[a];
        std::ranges::sort(nodes);
        return nodes;
    }

    /// Normal of a face, pointing out of its tetrahedron. The length is twice the area of the face [m^2].
    Vec3 outer_normal(Face face) const {
        const std::array<Index, 3> nodes = nodes_of(face);
        const Vec3 normal = (at(nodes[1]) - at(nodes[0])).cross(at(nodes[2]) - at(nodes[0]));
        const Vec3& inner = at(tetrahedron_of(face)[static_cast<std::size_t>(face.corner)]);
        return normal.dot(inner - at(nodes[0])) > 0 ? Vec3(-normal) : normal;
    }

    /// Returns the face through which the ray leaves a tetrahedron, and the distance of the point of exit from the
    /// start of the ray [m]. `entered`: face through which the ray enters. Returns nullopt if rounding errors leave no
    /// such face.
    std::optional<std::pair<Face, Real>> exit_of(const ThinColumn& ray, Face entered) const {
        std::optional<std::pair<Face, Real>> exit;
        for (Index corner = 0; corner < 4; ++corner) {
            const Face face{entered.tetrahedron, corner};
            if (corner == entered.corner) continue;
            const Vec3 normal = outer_normal(face);
            const Real rate = normal.dot(ray.direction);
            if (!(rate > 0)) continue;
            const Real distance = normal.dot(at(nodes_of(face)[0]) - ray.start) / rate;
            if (!exit || distance < exit->second) exit.emplace(face, distance);
        }
        return exit;
    }

    const Mesh& mesh_;
    const NearBoundary& near_;
};

}  // namespace

std::vector<ThinColumn> thin_columns(const Mesh& mesh, std::span<const std::array<Index, 3>> boundary) {
    const NearBoundary near = near_boundary(mesh, boundary);
    const RayWalk rays(mesh, near);
    std::vector<ThinColumn> columns;
    for (const Face& face : near.boundary)
        if (std::optional<ThinColumn> column = rays.column_under(face)) columns.push_back(std::move(*column));
    return columns;
}

}  // namespace skerry::mesh
