// Triangle meshes for displaying colliders.
#pragma once

#include <optional>

#include "engine/output/frame.h"
#include "skerry/settings.h"

namespace skerry {

/// The displayed part of an infinite plane: a square around the projection of `center` onto the plane.
struct PlanePatch {
    Vec3 center = Vec3::Zero();  // [m]
    Real half_size = 1;          // [m]
};

/// Returns a patch around the bodies, which is displayed for every plane. Its centre is in world coordinates. Its
/// `half_size` is the diagonal of the bounding box of all bodies. Returns nothing if there are no bodies.
std::optional<PlanePatch> patch_around(std::span<const BodyFrame> bodies);

/// Returns a triangle mesh of a shape in the frame of the shape. `patch`: displayed part of a plane, with its centre in
/// the frame of the plane; not used for other shapes. Triangles are counter-clockwise as seen from outside. Curved
/// shapes have 48 facets around their axis. Vertices are duplicated along sharp edges, so that averaged normals shade
/// the edges correctly.
SurfaceMesh shape_picture(const Shape& shape, const PlanePatch& patch);

/// Transforms a point from the frame of a shape to world coordinates.
Vec3 to_world(const MotionKey& pose, const Vec3& point);

/// Transforms a point from world coordinates to the frame of a shape.
Vec3 to_shape(const MotionKey& pose, const Vec3& point);

}  // namespace skerry
