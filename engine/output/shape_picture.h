// Triangle meshes that display colliders.
#pragma once

#include "skerry/settings.h"

namespace skerry {

/// The part of an infinite plane that is displayed: a square around the foot point of `center`, in the plane's frame.
struct PlanePatch {
    Vec3 center = Vec3::Zero();  // [m]
    Real half_size = 1;          // [m]
};

/// Triangulates a shape in its own frame, counter-clockwise seen from outside. Curved shapes have 48 facets around.
/// Vertices are duplicated along sharp edges, so that averaged normals shade them correctly.
SurfaceMesh shape_picture(const Shape& shape, const PlanePatch& patch);

/// Transforms a point from the frame of a shape to the world.
Vec3 to_world(const MotionKey& pose, const Vec3& point);

/// Transforms a point from the world to the frame of a shape.
Vec3 to_shape(const MotionKey& pose, const Vec3& point);

}  // namespace skerry
