// A face of a body against a point of a collider, between its nodes and edges.
#pragma once

#include <array>

#include "components/collider_table.h"
#include "systems/collision/colliders/collider_shape.h"
#include "systems/geometry/closest_points.h"

namespace skerry {

/// The corners of a triangle in the frame of the collider, counter-clockwise seen from outside of the body.
using LocalFace = std::array<Vec3, 3>;

struct FaceContact {
    Real nearest;           // m: no point of the face is nearer to the collider's point than this, nor to what moves it
    bool above;             // the point is over the face, or behind it, not beside it
    Real distance;          // m, from the face to the collider; below zero behind the face
    Vec3 normal;            // unit, outward of the face
    ColliderPoint point;    // m
    PointTriangle closest;  // to the point's middle
};

FaceContact face_contact(const ColliderGeometry& geometry, Index k, const LocalFace& face);

}  // namespace skerry
