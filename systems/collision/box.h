// Axis-aligned boxes that stand numbers which are not finite: such a point does not enter a box, and an empty box is far from everything.
#pragma once

#include <algorithm>
#include <limits>

#include "components/bvh_table.h"

namespace skerry {

inline Aabb empty_box() {
    constexpr Real infinite = std::numeric_limits<Real>::infinity();
    return {Vec3::Constant(infinite), Vec3::Constant(-infinite)};
}

inline void grow(Aabb& box, const Vec3& point) {
    for (int i = 0; i < 3; ++i) {
        box.lower[i] = point[i] < box.lower[i] ? point[i] : box.lower[i];
        box.upper[i] = point[i] > box.upper[i] ? point[i] : box.upper[i];
    }
}

inline void grow(Aabb& box, const Aabb& other) {
    for (int i = 0; i < 3; ++i) {
        box.lower[i] = other.lower[i] < box.lower[i] ? other.lower[i] : box.lower[i];
        box.upper[i] = other.upper[i] > box.upper[i] ? other.upper[i] : box.upper[i];
    }
}

/// m^2, 0 when they overlap.
inline Real distance_squared(const Aabb& a, const Aabb& b) {
    Real sum = 0;
    for (int i = 0; i < 3; ++i) {
        const Real gap = std::max(Real(0), std::max(a.lower[i] - b.upper[i], b.lower[i] - a.upper[i]));
        sum += gap * gap;
    }
    return sum;
}

/// m^2, 0 when the point is inside.
inline Real distance_squared(const Aabb& box, const Vec3& point) {
    Real sum = 0;
    for (int i = 0; i < 3; ++i) {
        const Real gap = std::max(Real(0), std::max(box.lower[i] - point[i], point[i] - box.upper[i]));
        sum += gap * gap;
    }
    return sum;
}

}  // namespace skerry
