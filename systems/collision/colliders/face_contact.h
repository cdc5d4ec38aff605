// Contact of a face of a body with a point of a collider, between the nodes and edges of the face.
#pragma once

#include <array>

#include "components/collider_table.h"
#include "systems/collision/colliders/collider_shape.h"
#include "systems/geometry/closest_points.h"

namespace skerry {

/// The corners of a triangle in the frame of the collider, counter-clockwise seen from outside of the body.
using LocalFace = std::array<Vec3, 3>;

struct FaceContact {
    // lower bound of the distance of the face to the point, or to the whole collider if the point follows the face [m]
    Real nearest;
    bool above;             // true if the point is over or behind the face, not beside it
    Real distance;          // signed distance from the face to the collider; negative behind the face [m]
    Vec3 normal;            // outward unit normal of the face
    ColliderPoint point;    // of the collider
    PointTriangle closest;  // point of the face nearest to `point.at`
};

FaceContact face_contact(const ColliderGeometry& geometry, Index k, const LocalFace& face);

}  // namespace skerry
