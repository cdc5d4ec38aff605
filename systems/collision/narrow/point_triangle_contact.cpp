#include "systems/collision/narrow/point_triangle_contact.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <cmath>

namespace skerry {

namespace {

// Tolerance at the borders between the regions of points nearest to a face, edge or vertex of a surface: tie_fraction
// times the distance of the point plus tie_edge_fraction times the edge length. A point within it belongs to both
// features: a contact found twice does no harm, but a contact lost by rounding errors does.
constexpr Real tie_fraction = 1e-6;
constexpr Real tie_edge_fraction = 1e-12;

// If the point is closer to an edge or vertex than normal_distance_fraction times the contact distance, or than
// normal_edge_fraction times the edge length, the direction to the point is too inaccurate for the contact normal
// (docs/methods/collision.md 4.3).
constexpr Real normal_distance_fraction = 0.1;
constexpr Real normal_edge_fraction = 1e-6;

// Tilt of the axis of a capsule that the test whether a vertex touches the axis tolerates [rad]. A capsule that lies on
// an edge thus touches both ends of the edge, even if its axis is slightly tilted. Edges have an equal tolerance
// (border_angle in edge_edge_contact.cpp).
constexpr Real axis_tilt = 0.03;

struct Query {
    const SurfaceTables& surface;
    std::span<const Vec3> position;
    const PairScale& scale;
    Vec3 offset;    // vector from the nearest point of the triangle to the queried point [m]
    Real distance;  // length of `offset` [m]

    const Vec3& at(Index node) const { return position[node]; }
    Real border_tolerance(const Vec3& direction) const {
        return (tie_fraction * distance + tie_edge_fraction * scale.edge) * direction.norm();
    }
    /// Unit normal of a triangle; zero if the triangle has no area.
    Vec3 unit_normal(Index triangle) const {
        const auto& n = surface.triangles.node[triangle];
        const Vec3 normal = (at(n[1]) - at(n[0])).cross(at(n[2]) - at(n[0]));
        const Real length = normal.norm();
        return length > 0 ? Vec3(normal / length) : Vec3(Vec3::Zero());
    }
};

/// Sum of the unit normals of the two faces at edge k of a triangle, on which the point of the triangle nearest to the
/// queried point lies. Zero if the other face is nearer to the queried point than the edge; `face_normal`, the normal
/// of the triangle, if there is no other face.
Vec3 edge_normal(const Query& q, Index triangle, std::size_t k, const Vec3& face_normal) {
    const Index edge = q.surface.triangles.edge[triangle][k];
    const auto& around = q.surface.edges.triangle[edge];
    const Index other = around[0] == triangle ? around[1] : around[0];
    if (other == no_index) return face_normal;
    const auto& ends = q.surface.edges.node[edge];
    for (Index n : q.surface.triangles.node[other]) {
        if (n == ends[0] || n == ends[1]) continue;
        const Vec3 into = q.at(n) - q.at(ends[0]);
        if (q.offset.dot(into) > q.border_tolerance(into)) return Vec3::Zero();
    }
    return face_normal + q.unit_normal(other);
}

/// Sum of the unit normals of the faces around a vertex, weighted by their angles at the vertex. Its scalar product
/// with the vector to a point is positive outside and negative inside (Baerentzen, Aanaes 2005).
///
/// Zero if allowed(side) returns false for any edge of these faces at the vertex; `side`: vector along the edge, from
/// the vertex.
Vec3 vertex_normal(const Query& q, Index vertex, auto&& allowed) {
    const VertexTable& vertices = q.surface.vertices;
    const Index self = vertices.node[vertex];
    Vec3 sum = Vec3::Zero();
    for (Index i = vertices.triangle_begin[vertex]; i < vertices.triangle_end[vertex]; ++i) {
        const Index other = q.surface.vertex_triangle[i];
        const auto& node = q.surface.triangles.node[other];
        const std::size_t c = node[0] == self ? 0 : node[1] == self ? 1 : 2;
        const Vec3 a = q.at(node[(c + 1) % 3]) - q.at(self), b = q.at(node[(c + 2) % 3]) - q.at(self);
        if (!allowed(a) || !allowed(b)) return Vec3::Zero();
        const Vec3 cross = a.cross(b);
        const Real length = cross.norm();
        if (length > 0) sum += cross * (std::atan2(length, a.dot(b)) / length);
    }
    return sum;
}

/// Sets `contact` for the case that an edge or vertex is nearest to the queried point. `mean_normal`: sum of the
/// normals of the adjacent faces; zero: no contact. `straight_behind`: true if q.offset is perpendicular to the
/// triangle.
void touch_border(const Query& q, const Vec3& mean_normal, bool straight_behind, Surfaces surfaces,
                  PointTriangleContact& contact) {
    const Real length = mean_normal.norm();
    if (!(length > 0)) return;
    const bool outside = q.offset.dot(mean_normal) >= 0;
    if (!outside && surfaces == Surfaces::apart) {
        contact.side = Side::behind;
        contact.distance = q.distance;
        contact.normal = q.offset / q.distance;
        return;
    }
    // A point straight behind an edge may lie behind the middle of a flat surface that the edge divides into two faces.
    // Therefore the larger depth limit, that of a face, applies.
    if (!outside && q.distance > (straight_behind ? q.scale.face_depth : q.scale.edge_depth)) return;
    contact.side = outside ? Side::outside : Side::behind;
    contact.distance = outside ? q.distance : -q.distance;
    const bool noise = q.distance <= std::max(normal_distance_fraction * q.scale.contact_distance,
                                              normal_edge_fraction * q.scale.edge);
    contact.normal = noise ? Vec3(mean_normal / length) : Vec3(q.offset / contact.distance);
}

}  // namespace

PointTriangleContact point_triangle_contact(const SurfaceTables& surface, std::span<const Vec3> position,
                                            const Vec3& point, Index triangle, const PairScale& scale,
                                            Real contact_limit, Surfaces surfaces) {
    const auto& corner = surface.triangles.node[triangle];
    PointTriangleContact contact;
    contact.closest = closest_point_on_triangle(point, position[corner[0]], position[corner[1]], position[corner[2]]);
    const Real distance = std::sqrt(contact.closest.distance_squared);
    contact.sleep = distance - scale.zone;
    if (!(distance <= std::max(contact_limit, scale.zone))) return contact;

    const Query q{surface, position, scale, point - contact.closest.nearest, distance};
    if (is_core(corner)) {
        contact.sleep = distance - scale.edge_depth;
        touch_border(q, q.offset, false, surfaces, contact);
        return contact;
    }
    const Vec3 face_normal = q.unit_normal(triangle);
    const Real height = q.offset.dot(face_normal);  // height of the point above the plane of the face
    const Real aside_squared = std::max(Real(0), distance * distance - height * height);
    contact.sleep = distance - scale.edge_depth;  // edge_depth is at least the contact distance
    if (height < 0 && surfaces == Surfaces::may_overlap) {
        // A point behind the plane of the face becomes a contact as soon as it is straight behind the face, at a depth
        // of at most face_depth. `sleep` must not exceed the distance of the point from this region behind the face.
        const Real below = std::max(Real(0), -height - scale.face_depth);
        contact.sleep = std::min(contact.sleep, std::sqrt(aside_squared + below * below));
    }
    const std::size_t region = static_cast<std::size_t>(contact.closest.region);
    if (contact.closest.region == TriangleRegion::face) {
        const bool turned = height < 0 && surfaces == Surfaces::apart;
        // If the surfaces are apart, the core of a round body that lies behind this face is kept there at the distance
        // radii + shell. This distance may exceed face_depth, so the depth limit does not apply.
        if (height < -scale.face_depth && !(turned && scale.radii > 0)) return contact;
        contact.side = height >= 0 ? Side::outside : Side::behind;
        contact.distance = turned ? -height : height;
        contact.normal = turned ? Vec3(-face_normal) : face_normal;
        return contact;
    }
    const bool straight_behind = aside_squared <= tie_fraction * tie_fraction * distance * distance;
    if (region <= static_cast<std::size_t>(TriangleRegion::edge20)) {
        const std::size_t k = region - static_cast<std::size_t>(TriangleRegion::edge01);
        if (surface.triangles.owned_edges[triangle] >> k & 1)
            touch_border(q, edge_normal(q, triangle, k, face_normal), straight_behind, surfaces, contact);
    } else {
        const std::size_t k = region - static_cast<std::size_t>(TriangleRegion::vertex0);
        if (surface.triangles.owned_vertices[triangle] >> k & 1)
            touch_border(
                q,
                vertex_normal(q, surface.triangles.vertex[triangle][k],
                              [&](const Vec3& side) { return q.offset.dot(side) <= q.border_tolerance(side); }),
                straight_behind, surfaces, contact);
    }
    return contact;
}

bool vertex_can_touch_axis(const SurfaceTables& surface, std::span<const Vec3> position, Index vertex,
                           const Vec3& offset, const Vec3& axis, const PairScale& scale) {
    const Query q{surface, position, scale, offset, offset.norm()};
    // If the axis tilts by the small angle t, the vector from the vertex to its nearest point p becomes offset + t *
    // along. Each face limits t to angles at which the vertex is nearer to p than the face. [low, high]: angles that
    // all faces visited so far permit.
    const Vec3 along = q.distance * axis.normalized();
    Real low = -axis_tilt, high = axis_tilt;
    const Vec3 normal = vertex_normal(q, vertex, [&](const Vec3& side) {
        const Real room = q.border_tolerance(side) - offset.dot(side), slope = along.dot(side);
        if (slope > 0)
            high = std::min(high, room / slope);
        else if (slope < 0)
            low = std::max(low, room / slope);
        return low <= high && (slope != 0 || room >= 0);
    });
    return offset.dot(normal) > 0;
}

bool vertex_can_touch_point(const SurfaceTables& surface, std::span<const Vec3> position, Index vertex,
                            const Vec3& offset, const PairScale& scale) {
    const Query q{surface, position, scale, offset, offset.norm()};
    return offset.dot(vertex_normal(
               q, vertex, [&](const Vec3& side) { return offset.dot(side) <= q.border_tolerance(side); })) > 0;
}

}  // namespace skerry
