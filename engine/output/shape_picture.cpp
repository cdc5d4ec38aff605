#include "engine/output/shape_picture.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <span>

#include "systems/geometry/rotation.h"

namespace skerry {
namespace {

// number of facets around the axis; each covers 7.5 degrees, so that corners are hardly visible
constexpr int sectors = 48;
constexpr int arc_steps = 12;    // number of facets per quarter circle of a profile; each covers 7.5 degrees
constexpr int plane_cells = 10;  // number of grid cells per edge of the displayed square of a plane

// points (radius, z) of a curve; seen along the curve, the outside of the shape lies on the right
using Profile = std::vector<std::array<Real, 2>>;

/// Adds a circular arc with centre (0, z) to a profile. The angles `start` and `end` are measured from the horizontal,
/// upwards [rad].
void add_arc(Profile& profile, Real radius, Real z, Real start, Real end) {
    const int steps = static_cast<int>(std::lround(std::abs(end - start) / (std::numbers::pi / 2) * arc_steps));
    for (int i = 0; i <= steps; ++i) {
        const Real angle = start + (end - start) * i / steps;
        const bool pole = i == 0 ? start == -std::numbers::pi / 2 : i == steps && end == std::numbers::pi / 2;
        profile.push_back({pole ? 0 : radius * std::cos(angle), z + radius * std::sin(angle)});
    }
}

/// Revolves a profile about the z axis. The outside is on the right of the profile, and triangles are counter-clockwise
/// as seen from outside.
void revolve(const Profile& profile, SurfaceMesh& mesh) {
    const Index first = static_cast<Index>(mesh.nodes.size());
    for (const auto& [radius, z] : profile)
        for (int s = 0; s < sectors; ++s) {
            const Real angle = 2 * std::numbers::pi * s / sectors;
            mesh.nodes.push_back({radius * std::cos(angle), radius * std::sin(angle), z});
        }
    for (std::size_t ring = 0; ring + 1 < profile.size(); ++ring)
        for (int s = 0; s < sectors; ++s) {
            const Index a = first + static_cast<Index>(ring) * sectors + s,
                        b = first + static_cast<Index>(ring) * sectors + (s + 1) % sectors;
            // At a pole the ring has radius 0, so one of the two triangles has no area and is left out.
            if (profile[ring][0] > 0) mesh.triangles.push_back({a, b, b + sectors});
            if (profile[ring + 1][0] > 0) mesh.triangles.push_back({a, b + sectors, a + sectors});
        }
}

/// Adds the parallelogram with the edges u and v from `corner`, divided into cells x cells parts. Its normal is u x v.
void add_patch(const Vec3& corner, const Vec3& u, const Vec3& v, int cells, SurfaceMesh& mesh) {
    const Index first = static_cast<Index>(mesh.nodes.size());
    for (int j = 0; j <= cells; ++j)
        for (int i = 0; i <= cells; ++i) mesh.nodes.push_back(corner + u * (Real(i) / cells) + v * (Real(j) / cells));
    for (int j = 0; j < cells; ++j)
        for (int i = 0; i < cells; ++i) {
            const Index a = first + j * (cells + 1) + i, b = a + cells + 1;
            mesh.triangles.push_back({a, a + 1, b + 1});
            mesh.triangles.push_back({a, b + 1, b});
        }
}

struct Picture {
    const PlanePatch& patch;

    /// The pose of the collider already includes the normal and the point of the plane. In the frame of the collider
    /// the plane is therefore z = 0.
    SurfaceMesh operator()(const Plane&) const {
        SurfaceMesh mesh;
        const Real half = patch.half_size;
        const Vec3 corner(patch.center.x() - half, patch.center.y() - half, 0);
        add_patch(corner, 2 * half * Vec3::UnitX(), 2 * half * Vec3::UnitY(), plane_cells, mesh);
        return mesh;
    }
    SurfaceMesh operator()(const Sphere& sphere) const {
        SurfaceMesh mesh;
        Profile outside;
        add_arc(outside, sphere.radius, 0, -std::numbers::pi / 2, std::numbers::pi / 2);
        revolve(outside, mesh);
        return mesh;
    }
    SurfaceMesh operator()(const Box& box) const {
        SurfaceMesh mesh;
        for (int axis = 0; axis < 3; ++axis)
            for (const Real side : {-0.5, 0.5}) {
                Vec3 u = Vec3::Zero(), v = Vec3::Zero();
                u[(axis + 1) % 3] = box.size[(axis + 1) % 3];
                v[(axis + 2) % 3] = box.size[(axis + 2) % 3];
                Vec3 corner = -box.size / 2;
                corner[axis] = side * box.size[axis];
                add_patch(corner, side > 0 ? u : v, side > 0 ? v : u, 1, mesh);
            }
        return mesh;
    }
    SurfaceMesh operator()(const Capsule& capsule) const {
        SurfaceMesh mesh;
        Profile outside;
        add_arc(outside, capsule.radius, -capsule.length / 2, -std::numbers::pi / 2, 0);
        add_arc(outside, capsule.radius, capsule.length / 2, 0, std::numbers::pi / 2);
        revolve(outside, mesh);
        return mesh;
    }
    SurfaceMesh operator()(const Cylinder& cylinder) const {
        SurfaceMesh mesh;
        const Real r = cylinder.radius, top = cylinder.height / 2;
        revolve({{0, -top}, {r, -top}}, mesh);
        revolve({{r, -top}, {r, top}}, mesh);
        revolve({{r, top}, {0, top}}, mesh);
        return mesh;
    }
    SurfaceMesh operator()(const Bucket& bucket) const {
        SurfaceMesh mesh;
        const Real inner = bucket.radius, outer = bucket.radius + bucket.thickness, top = bucket.height,
                   bottom = -bucket.thickness;
        revolve({{0, bottom}, {outer, bottom}}, mesh);
        revolve({{outer, bottom}, {outer, top}}, mesh);
        revolve({{outer, top}, {inner, top}}, mesh);
        revolve({{inner, top}, {inner, 0}}, mesh);
        revolve({{inner, 0}, {0, 0}}, mesh);
        return mesh;
    }
    SurfaceMesh operator()(const SurfaceMesh& mesh) const { return mesh; }
};

}  // namespace

std::optional<PlanePatch> patch_around(std::span<const BodyFrame> bodies) {
    Vec3 lower = Vec3::Constant(infinity), upper = -lower;
    for (const BodyFrame& body : bodies)
        for (const Vec3& point : body.position) {
            lower = lower.cwiseMin(point);
            upper = upper.cwiseMax(point);
        }
    if ((lower.array() > upper.array()).any()) return std::nullopt;
    // The minimum size is needed if the bounding box of all bodies is a single point.
    return PlanePatch{(lower + upper) / 2, std::max((upper - lower).norm(), 1e-6)};
}

SurfaceMesh shape_picture(const Shape& shape, const PlanePatch& patch) {
    return std::visit(Picture{patch}, shape);
}

Vec3 to_world(const MotionKey& pose, const Vec3& point) {
    return pose.position + rotation_matrix(pose.rotation) * point;
}

Vec3 to_shape(const MotionKey& pose, const Vec3& point) {
    return rotation_matrix(pose.rotation).transpose() * (point - pose.position);
}

}  // namespace skerry
