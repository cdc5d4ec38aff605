// Extraction of the rotation nearest to a deformation gradient, by Newton's method. The iteration starts from the
// rotation in the last step (idea: Mueller 2016).
#pragma once

#include "components/element_table.h"
#include "systems/material/lane_math.h"

namespace skerry {

/// A quaternion with components of type T.
template <class T>
struct LaneQuaternion {
    T w, x, y, z;
};

template <class T>
[[gnu::always_inline]] inline LaneMat3<T> rotation_of(const LaneQuaternion<T>& q) {
    const T x2 = q.x + q.x, y2 = q.y + q.y, z2 = q.z + q.z;
    const T xx = q.x * x2, yy = q.y * y2, zz = q.z * z2;
    const T xy = q.x * y2, yz = q.y * z2, zx = q.z * x2;
    const T wx = q.w * x2, wy = q.w * y2, wz = q.w * z2;
    return {
        {1.0 - (yy + zz), xy + wz, zx - wy}, {xy - wz, 1.0 - (xx + zz), yz + wx}, {zx + wy, yz - wx, 1.0 - (xx + yy)}};
}

/// One Newton step towards the rotation R that maximises tr(R^T F) (docs/methods/elasticity.md 3). With S = sym(R^T F),
/// G = tr(S) I - S and the axial vector a of R^T F, it changes R by the rotation vector G^-1 a. The error after the
/// step is the cube of the error before. (The step a / tr(S) of Mueller 2016 leaves a third of the error.)
///
/// `trace`: tr(R^T F) for the new R, correct to fourth order in the rotation angle. Returns true in each lane that
/// needs no further pass (Newton step), under two conditions:
/// - Before the step R was near enough to the maximum for the method to converge.
/// - The step rotated R by less than 2e-5 rad.
template <class T>
[[gnu::always_inline]] inline auto turn_towards(const LaneMat3<T>& F, LaneQuaternion<T>& q, T& trace) {
    // Newton's method ends after a step whose squared rotation angle is below this value [rad^2]. The angle is then
    // below 2e-5, and the error after the step is about its cube, 8e-15.
    constexpr Real settled_turn_squared = 4e-10;
    constexpr Real least_curvature = 1e-3;  // lower bound of det G / (tr S / 3)^3, which is 8 in the rest shape
    const LaneMat3<T> R = rotation_of(q);
    const T a00 = dot(R.c0, F.c0), a11 = dot(R.c1, F.c1), a22 = dot(R.c2, F.c2);
    const T a01 = dot(R.c0, F.c1), a10 = dot(R.c1, F.c0);
    const T a12 = dot(R.c1, F.c2), a21 = dot(R.c2, F.c1);
    const T a20 = dot(R.c2, F.c0), a02 = dot(R.c0, F.c2);
    const LaneVec3<T> axial{a21 - a12, a02 - a20, a10 - a01};
    const T g00 = a11 + a22, g11 = a00 + a22, g22 = a00 + a11;
    const T g01 = -0.5 * (a01 + a10), g12 = -0.5 * (a12 + a21), g20 = -0.5 * (a20 + a02);
    // Adjugate h of the symmetric matrix G.
    const T h00 = g11 * g22 - g12 * g12, h11 = g00 * g22 - g20 * g20, h22 = g00 * g11 - g01 * g01;
    const T h01 = g20 * g12 - g01 * g22, h12 = g01 * g20 - g00 * g12, h20 = g01 * g12 - g20 * g11;
    const T det = g00 * h00 + g01 * h01 + g20 * h20;
    const T before = a00 + a11 + a22, third = before * (1.0 / 3.0);
    const auto inside = (g00 > 0.0) & (h22 > 0.0) & (det > least_curvature * (third * third * third)) & (third > 0.0);
    const T half_inverse = inside ? 0.5 / det : T{};
    const LaneVec3<T> o{half_inverse * (h00 * axial.x + h01 * axial.y + h20 * axial.z),
                        half_inverse * (h01 * axial.x + h11 * axial.y + h12 * axial.z),
                        half_inverse * (h20 * axial.x + h12 * axial.y + h22 * axial.z)};
    // A Newton step changes the value of a quadratic function by half of the slope times the step. Here the slope is
    // `axial` and the step is the rotation vector 2 o.
    trace = before + dot(o, axial);
    // Updates the quaternion by q <- q (1, o), where o is half of the rotation vector. `scale` brings the result to the
    // length 1: it divides by |(1, o)|, and its factor 1.5 - |q|^2 / 2 corrects the rounding error of |q|. `scale` does
    // not depend on q (1, o), so the processor can compute both at the same time.
    const T o_squared = dot(o, o);
    const T scale = (1.5 - 0.5 * (q.w * q.w + q.x * q.x + q.y * q.y + q.z * q.z)) / square_root(1.0 + o_squared);
    const LaneQuaternion<T> p = q;
    q = {scale * (p.w - (p.x * o.x + p.y * o.y + p.z * o.z)), scale * (p.x + (p.w * o.x + (p.y * o.z - p.z * o.y))),
         scale * (p.y + (p.w * o.y + (p.z * o.x - p.x * o.z))), scale * (p.z + (p.w * o.z + (p.x * o.y - p.y * o.x)))};
    return inside & (4.0 * o_squared <= settled_turn_squared);
}

/// The unit quaternion (w, x, y, z) of the rotation R that maximises tr(R^T F), for any F. It is the eigenvector of the
/// largest eigenvalue of Horn's 4x4 matrix. If several rotations are equally good (F of rank one or zero, a mirrored
/// F), the one nearest to `start` is taken. Returns `start` if F is not finite.
std::array<Real, 4> nearest_rotation(const Mat3& F, const std::array<Real, 4>& start);

/// Replaces `start` by nearest_rotation() in all lanes in use (volume not 0). The function is slow, but rarely needed,
/// and therefore not inlined.
template <class T>
void solve_rotations(const LaneMat3<T>& F, const T& volume, LaneQuaternion<T>& start);
extern template void solve_rotations(const LaneMat3<Real4>& F, const Real4& volume, LaneQuaternion<Real4>& start);
extern template void solve_rotations(const LaneMat3<Real8>& F, const Real8& volume, LaneQuaternion<Real8>& start);

/// Finds the rotations R nearest to F in all lanes of N registers, starting from q. Lanes without volume are unused and
/// not waited for. All other lanes take as many passes (Newton steps) as the slowest lane. Returns tr(R^T F).
template <class T, std::size_t N>
[[gnu::always_inline]] inline std::array<T, N> extract_rotations(const std::array<LaneMat3<T>, N>& F,
                                                                 const std::array<T, N>& volume,
                                                                 std::array<LaneQuaternion<T>, N>& q) {
    // Two passes (Newton steps) are enough from a warm start. If four passes are not enough, all lanes are solved one
    // by one.
    constexpr int max_passes = 4;
    const std::array<LaneQuaternion<T>, N> start = q;
    std::array<T, N> trace;
    for (int pass = 0; pass < max_passes; ++pass) {
        bool settled = true;
        for (std::size_t part = 0; part < N; ++part)
            settled = all(turn_towards(F[part], q[part], trace[part]) | (volume[part] == 0.0)) && settled;
        if (settled) return trace;
    }
    q = start;
    for (std::size_t part = 0; part < N; ++part) {
        solve_rotations(F[part], volume[part], q[part]);
        trace[part] = inner_product(rotation_of(q[part]), F[part]);
    }
    return trace;
}

/// Applies extract_rotations to a single register.
template <class T>
[[gnu::always_inline]] inline T extract_rotation(const LaneMat3<T>& F, const T& volume, LaneQuaternion<T>& q) {
    std::array<LaneQuaternion<T>, 1> part_rotation{q};
    const std::array<T, 1> trace =
        extract_rotations(std::array<LaneMat3<T>, 1>{F}, std::array<T, 1>{volume}, part_rotation);
    q = part_rotation[0];
    return trace[0];
}

template <class T>
LaneQuaternion<T> load_part(const ElementRotation& from, std::size_t part) {
    return {load_part<T>(from[0], part), load_part<T>(from[1], part), load_part<T>(from[2], part),
            load_part<T>(from[3], part)};
}
template <class T>
void store_part(const LaneQuaternion<T>& from, ElementRotation& to, std::size_t part) {
    store_part(from.w, to[0], part);
    store_part(from.x, to[1], part);
    store_part(from.y, to[2], part);
    store_part(from.z, to[3], part);
}

}  // namespace skerry
