// Vectors whose components are registers. Functions of these vectors work on one vector (T = Real) or on several
// vectors side by side, one per lane.
#pragma once

#include <cmath>

#include "components/lanes.h"
#include "components/types.h"

namespace skerry {

inline Real square_root(Real x) {
    return std::sqrt(x);
}
template <class T>
requires(lanes_of<T> > 1) [[gnu::always_inline]] inline T square_root(const T& x) {
    Lanes<Real, element_lanes> root;
    store_part(x, root, 0);
#pragma omp simd
    for (std::size_t l = 0; l < lanes_of<T>; ++l) root.lane[l] = std::sqrt(root.lane[l]);
    return load_part<T>(root, 0);
}

/// A vector with three components of type T. The components are named members instead of an array, so that they stay in
/// registers at every optimisation level.
template <class T>
struct LaneVec3 {
    T x, y, z;
};

template <class T>
[[gnu::always_inline]] inline LaneVec3<T> operator+(const LaneVec3<T>& a, const LaneVec3<T>& b) {
    return {a.x + b.x, a.y + b.y, a.z + b.z};
}
template <class T>
[[gnu::always_inline]] inline LaneVec3<T> operator-(const LaneVec3<T>& a, const LaneVec3<T>& b) {
    return {a.x - b.x, a.y - b.y, a.z - b.z};
}
template <class S, class T>
[[gnu::always_inline]] inline LaneVec3<T> operator*(const S& s, const LaneVec3<T>& a) {
    return {s * a.x, s * a.y, s * a.z};
}
template <class T>
[[gnu::always_inline]] inline T dot(const LaneVec3<T>& a, const LaneVec3<T>& b) {
    return a.x * b.x + a.y * b.y + a.z * b.z;
}
template <class T>
[[gnu::always_inline]] inline LaneVec3<T> cross(const LaneVec3<T>& a, const LaneVec3<T>& b) {
    return {a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x};
}

}  // namespace skerry
