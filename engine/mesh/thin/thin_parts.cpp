#include "engine/mesh/thin/thin_parts.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <utility>

#include "components/union_find.h"
#include "engine/mesh/tetrahedron.h"
#include "engine/mesh/thin/bending.h"
#include "engine/mesh/thin/column.h"
#include "systems/geometry/symmetric_eigen.h"

namespace skerry::mesh {

namespace {

// Lower limit of the ratio of length to thickness of a part. Shorter parts carry loads by shear and compression more
// than by bending.
constexpr Real least_slenderness = 4;
// Lower limit of the volume of a part, as a fraction of the volume of the mesh. It excludes fins and tails of animals
// (up to 2 %) and includes the leg of a table (5 %).
constexpr Real noticeable_volume = 0.03;
// Lower limit of the cosine of the angle between the normals of neighbouring triangles of a part. At a sharper edge
// another side of the body begins, which is a part of its own.
constexpr Real least_edge_cosine = 0.7;
// Upper limit of the number of columns of a part for which the energy is computed. These columns are spread evenly.
constexpr std::size_t most_columns = 500;

/// Groups columns by part. Two columns belong to the same part if their first triangles share a smooth edge, or if one
/// starts at the last triangle of the other.
std::vector<std::vector<const ThinColumn*>> connected(std::span<const ThinColumn> columns) {
    UnionFind parts;
    parts.start(columns.size());
    std::vector<std::pair<std::array<Index, 2>, Index>> sides;
    std::vector<std::pair<std::array<Index, 3>, Index>> triangles;
    for (std::size_t c = 0; c < columns.size(); ++c) {
        const auto& [a, b, d] = columns[c].first;  // ascending
        for (const std::array<Index, 2>& side : {std::array{a, b}, std::array{a, d}, std::array{b, d}})
            sides.emplace_back(side, static_cast<Index>(c));
        triangles.emplace_back(columns[c].first, static_cast<Index>(c));
    }
    std::ranges::sort(sides);
    for (std::size_t s = 1; s < sides.size(); ++s) {
        if (sides[s].first != sides[s - 1].first) continue;
        const ThinColumn &one = columns[static_cast<std::size_t>(sides[s - 1].second)],
                         &other = columns[static_cast<std::size_t>(sides[s].second)];
        if (one.direction.dot(other.direction) > least_edge_cosine) parts.join(sides[s - 1].second, sides[s].second);
    }
    std::ranges::sort(triangles);
    for (std::size_t c = 0; c < columns.size(); ++c) {
        const auto end =
            std::ranges::lower_bound(triangles, columns[c].last, {}, [](const auto& t) { return t.first; });
        if (end != triangles.end() && end->first == columns[c].last) parts.join(static_cast<Index>(c), end->second);
    }
    std::vector<std::vector<const ThinColumn*>> grouped;
    for (std::size_t c = 0; c < columns.size(); ++c) {
        const auto part = static_cast<std::size_t>(parts.number(static_cast<Index>(c)));
        if (part == grouped.size()) grouped.emplace_back();
        grouped[part].push_back(&columns[c]);
    }
    return grouped;
}

/// Measures a part. Sets `axis` to the direction in which the starts of its columns spread most (principal axis).
ThinPart measure(const Mesh& mesh, std::span<const ThinColumn* const> columns, Vec3& axis) {
    ThinPart part;
    Real area = 0;
    for (const ThinColumn* column : columns) {
        area += column->area;
        part.place += column->area * column->start;
        part.thickness += column->area * column->thickness();
        part.layers += column->area * column->layers;
    }
    part.place /= area;
    // Here `thickness` is still the sum of area times thickness. The volume is half of this sum, because columns from
    // opposite triangles fill the same space.
    part.volume = part.thickness / 2;
    part.thickness /= area;
    part.layers /= area;
    Mat3 spread = Mat3::Zero();
    for (const ThinColumn* column : columns) {
        const Vec3 d = column->start - part.place;
        spread += column->area * d * d.transpose();
    }
    axis = symmetric_eigen(spread).vectors.col(2);
    Real low = infinity, high = -infinity;
    for (const ThinColumn* column : columns)
        for (const Index n : column->first) {
            const Real s = mesh.nodes[static_cast<std::size_t>(n)].dot(axis);
            low = std::min(low, s);
            high = std::max(high, s);
        }
    part.length = high - low;
    return part;
}

/// Direction in which the part extends at a column: the component of `axis` perpendicular to the column. If the column
/// is nearly parallel to `axis`, any perpendicular direction is used.
Vec3 tangent_of(const ThinColumn& column, const Vec3& axis) {
    constexpr Real too_steep = 0.1;  // smallest usable sine of the angle between the column and the axis
    const Vec3 along = axis - axis.dot(column.direction) * column.direction;
    return along.norm() > too_steep ? Vec3(along.normalized()) : Vec3(column.direction.unitOrthogonal());
}

}  // namespace

std::vector<ThinPart> thin_parts(const Mesh& mesh, std::span<const std::array<Index, 3>> boundary,
                                 std::span<const MaterialZone> zones, std::span<const ElasticConstants> materials) {
    const std::vector<ThinColumn> columns = thin_columns(mesh, boundary);
    if (columns.empty()) return {};
    Real volume = 0;  // [m^3]
    for (const std::array<Index, 4>& tetrahedron : mesh.tetrahedra) volume += six_volumes(mesh, tetrahedron) / 6;
    std::vector<ThinPart> parts;
    std::vector<BentColumn> bent;
    for (const std::vector<const ThinColumn*>& members : connected(columns)) {
        Vec3 axis;
        const ThinPart part = measure(mesh, members, axis);
        if (part.length < least_slenderness * part.thickness || part.volume < noticeable_volume * volume) continue;
        const std::size_t stride = (members.size() + most_columns - 1) / most_columns;
        for (std::size_t c = 0; c < members.size(); c += stride)
            bent.push_back({members[c], tangent_of(*members[c], axis), parts.size()});
        parts.push_back(part);
    }
    if (parts.empty()) return parts;
    const std::vector<Real> stiffness = bending_stiffness(mesh, bent, parts.size(), zones, materials);
    for (std::size_t p = 0; p < parts.size(); ++p) parts[p].stiffness = stiffness[p];
    std::ranges::stable_sort(parts, std::greater{}, &ThinPart::stiffness);
    return parts;
}

}  // namespace skerry::mesh
