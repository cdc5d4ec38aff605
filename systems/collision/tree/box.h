// Axis-aligned boxes. NaN coordinates do not extend a box. An empty box has an infinite distance from all other boxes.
#pragma once

#include <algorithm>
#include <cmath>

#include "components/bvh_table.h"
#include "components/pair_table.h"

namespace skerry {

inline Aabb empty_box() {
    return {Vec3::Constant(infinity), Vec3::Constant(-infinity)};
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

/// Squared distance of two boxes; 0 if the boxes overlap [m^2]. A search spends half of its time in this function.
/// There is no loop, because -O2 does not unroll loops.
inline Real distance_squared(const Aabb& a, const Aabb& b) {
    const auto gap = [&](int i) {
        return std::max(Real(0), std::max(a.lower[i] - b.upper[i], b.lower[i] - a.upper[i]));
    };
    const Real x = gap(0), y = gap(1), z = gap(2);
    return x * x + y * y + z * z;
}

/// Squared distance of a point from a box; 0 if the point is inside the box [m^2].
inline Real distance_squared(const Aabb& box, const Vec3& point) {
    return distance_squared(box, Aabb{point, point});
}

/// Sphere that contains the points point_of(i) for begin <= i < end. `box`: box of these points; its centre is the
/// centre of the sphere. Points with NaN coordinates are ignored.
template <class PointOf>
BoundingSphere sphere_around(const Aabb& box, Index begin, Index end, PointOf&& point_of) {
    const Vec3 centre = 0.5 * (box.lower + box.upper);
    Real squared = 0;
    for (Index i = begin; i < end; ++i) {
        const Real candidate = (point_of(i) - centre).squaredNorm();
        squared = candidate > squared ? candidate : squared;
    }
    return {centre, std::sqrt(squared)};
}

/// Lower bound of the distance between objects inside two spheres [m]; 0 if the spheres overlap or are not finite.
inline Real gap_between(const BoundingSphere& a, const BoundingSphere& b) {
    const Real gap = (a.centre - b.centre).norm() - a.radius - b.radius;
    return gap > 0 && gap < infinity ? gap : 0;
}

}  // namespace skerry
