#include "systems/collision/narrow/winding_number.h"

#include <Eigen/Geometry>
#include <cmath>
#include <numbers>

namespace skerry {

Real half_solid_angle(const Vec3& a, const Vec3& b, const Vec3& c) {
    const Real la = a.norm(), lb = b.norm(), lc = c.norm();
    return std::atan2(a.dot(b.cross(c)), la * lb * lc + a.dot(b) * lc + b.dot(c) * la + c.dot(a) * lb);
}

Real winding_number(const CollisionInputs& inputs, Index body, const Vec3& point) {
    const Range triangles = inputs.body.triangles[body];
    Real sum = 0;
    for (Index t = triangles.begin; t < triangles.end; ++t) {
        const auto& node = inputs.surface.triangles.node[t];
        sum += half_solid_angle(inputs.position[node[0]] - point, inputs.position[node[1]] - point,
                                inputs.position[node[2]] - point);
    }
    return sum / (2 * std::numbers::pi);
}

bool is_outside(const CollisionInputs& inputs, Index body, const Vec3& point) {
    return std::abs(winding_number(inputs, body, point)) < 0.5;
}

}  // namespace skerry
