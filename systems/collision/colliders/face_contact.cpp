#include "systems/collision/colliders/face_contact.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>

namespace skerry {

FaceContact face_contact(const ColliderGeometry& geometry, Index k, const LocalFace& face) {
    const Vec3 area = (face[1] - face[0]).cross(face[2] - face[0]);
    const Real length = area.norm();
    FaceContact contact;
    contact.normal = length > 0 ? Vec3(area / length) : Vec3(Vec3::Zero());
    contact.point = collider_point(geometry, k, contact.normal);
    contact.closest = closest_point_on_triangle(contact.point.at, face[0], face[1], face[2]);
    const Real height = contact.normal.dot(contact.point.at - face[0]);
    contact.above = length > 0 && contact.closest.region == TriangleRegion::face;
    contact.distance = height - contact.point.radius;
    // A point that follows the face moves around the rim as the face turns.
    contact.nearest = collider_point_follows(geometry.shape, k)
                          ? hull_distance(geometry, face)
                          : std::sqrt(contact.closest.distance_squared) - contact.point.radius;
    return contact;
}

}  // namespace skerry
