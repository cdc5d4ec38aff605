// Triangles that show a collider.
#pragma once

#include "skerry/settings.h"

namespace skerry {

/// The part of an infinite plane that a picture shows: a square around the foot of `center`, in the frame of the plane.
struct PlanePatch {
    Vec3 center = Vec3::Zero();  // m
    Real half_size = 1;          // m
};

/// Triangles of a shape in its own frame, seen from outside counter-clockwise. Curved shapes have 48 facets around.
/// Vertices are doubled along sharp edges, so that averaged normals shade it right.
SurfaceMesh shape_picture(const Shape& shape, const PlanePatch& patch);

/// The place in the world of a point of a shape.
Vec3 to_world(const MotionKey& pose, const Vec3& point);

/// The inverse.
Vec3 to_shape(const MotionKey& pose, const Vec3& point);

}  // namespace skerry
