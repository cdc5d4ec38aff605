// Tangents of a contact, computed from its normal alone.
#pragma once

#include <cmath>

#include "components/types.h"

namespace skerry {

struct TangentFrame {
    Vec3 first, second;
};

/// Unit tangents that form a right-handed frame (normal, first, second) with the unit normal. The method is from Duff
/// et al. 2017, "Building an orthonormal basis, revisited". It has no branch, and is continuous except where the z
/// component of the normal is 0. For the normal (0, 0, 1) the tangents are the x and y axes.
inline TangentFrame tangent_frame(const Vec3& normal) {
    const Real sign = std::copysign(Real(1), normal.z());
    const Real a = -1 / (sign + normal.z());
    const Real b = normal.x() * normal.y() * a;
    return {Vec3(1 + sign * normal.x() * normal.x() * a, sign * b, -sign * normal.x()),
            Vec3(b, sign + normal.y() * normal.y() * a, -normal.y())};
}

}  // namespace skerry
