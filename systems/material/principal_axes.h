// Signed singular value decomposition of deformation gradients, lane by lane.
#pragma once

#include "systems/material/lane_math.h"

namespace skerry {

/// F = left diag(stretch) right^T with rotations `left` and `right`. Stretches are in descending order of magnitude.
/// The last one is negative if F contains a reflection.
template <class T>
struct LaneAxes {
    LaneMat3<T> left, right;
    LaneVec3<T> stretch;
};

namespace principal_axes_detail {

/// Jacobi rotation in the plane of the axes p and q: makes the entry `pq` of a symmetric matrix zero. `r` is the third
/// axis. The eigenvector columns vp and vq are rotated, too.
template <class T>
[[gnu::always_inline]] inline void turn(T& pp, T& qq, T& pq, T& pr, T& qr, LaneVec3<T>& vp, LaneVec3<T>& vq) {
    constexpr Real tiny = 1e-150;  // keeps the division finite if pq and qq - pp are zero
    const T difference = qq - pp, root = square_root(difference * difference + 4.0 * (pq * pq));
    const T tangent = 2.0 * pq / (difference < 0.0 ? difference - root - tiny : difference + root + tiny);
    const T c = 1.0 / square_root(1.0 + tangent * tangent), s = tangent * c;
    pp = pp - tangent * pq;
    qq = qq + tangent * pq;
    pq = T{};
    const T old_pr = pr;
    pr = c * old_pr - s * qr;
    qr = s * old_pr + c * qr;
    const LaneVec3<T> old = vp;
    vp = c * old - s * vq;
    vq = s * old + c * vq;
}

template <class T>
[[gnu::always_inline]] inline void put_larger_first(T& first, T& second, LaneVec3<T>& v, LaneVec3<T>& w) {
    const auto ordered = first >= second;
    const T a = first, x = v.x, y = v.y, z = v.z;
    first = ordered ? a : second;
    second = ordered ? second : a;
    v = {ordered ? x : w.x, ordered ? y : w.y, ordered ? z : w.z};
    w = {ordered ? w.x : x, ordered ? w.y : y, ordered ? w.z : z};
}

/// Unit vector along v, or `other` if v is almost zero. `length`: |v|.
template <class T>
[[gnu::always_inline]] inline LaneVec3<T> unit_along(const LaneVec3<T>& v, const T& length, const LaneVec3<T>& other) {
    const auto known = length > 1e-150;
    const T inverse = 1.0 / (known ? length : T{} + 1.0);
    return {known ? inverse * v.x : other.x, known ? inverse * v.y : other.y, known ? inverse * v.z : other.z};
}

}  // namespace principal_axes_detail

/// Decomposes F in each lane. The right axes are the eigenvectors of F^T F. They come from a fixed number of Jacobi
/// rotations (Golub, Van Loan, 8.5), so that no lane depends on the others. Equal stretches need no special treatment.
template <class T>
LaneAxes<T> principal_axes(const LaneMat3<T>& F) {
    using namespace principal_axes_detail;
    constexpr int sweeps = 5;  // convergence is quadratic: four sweeps are enough for 3x3 matrices
    T xx = dot(F.c0, F.c0), yy = dot(F.c1, F.c1), zz = dot(F.c2, F.c2);
    T xy = dot(F.c0, F.c1), yz = dot(F.c1, F.c2), zx = dot(F.c2, F.c0);
    const T one = T{} + 1.0, zero{};
    LaneVec3<T> v0{one, zero, zero}, v1{zero, one, zero}, v2{zero, zero, one};
    for (int sweep = 0; sweep < sweeps; ++sweep) {
        turn(xx, yy, xy, zx, yz, v0, v1);
        turn(yy, zz, yz, xy, zx, v1, v2);
        turn(xx, zz, zx, xy, yz, v0, v2);
    }
    put_larger_first(xx, yy, v0, v1);
    put_larger_first(yy, zz, v1, v2);
    put_larger_first(xx, yy, v0, v1);
    LaneAxes<T> axes;
    const LaneVec3<T> first = multiply(F, v0);
    axes.stretch.x = square_root(dot(first, first));
    const LaneVec3<T> u0 = unit_along(first, axes.stretch.x, v0);
    LaneVec3<T> second = multiply(F, v1);
    second = second - dot(u0, second) * u0;
    axes.stretch.y = square_root(dot(second, second));
    // If the second stretch is zero, any unit vector perpendicular to u0 can be the second left axis.
    const auto flat = u0.x * u0.x < 0.5;
    const LaneVec3<T> beside{flat ? zero : -u0.z, flat ? u0.z : zero, flat ? -u0.y : u0.x};
    const LaneVec3<T> u1 =
        unit_along(second, axes.stretch.y, unit_along(beside, square_root(dot(beside, beside)), beside));
    v2 = cross(v0, v1);
    const LaneVec3<T> u2 = cross(u0, u1);
    axes.stretch.z = dot(u2, multiply(F, v2));
    axes.left = {u0, u1, u2};
    axes.right = {v0, v1, v2};
    return axes;
}

}  // namespace skerry
