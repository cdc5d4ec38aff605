// Arithmetic of the element kernels. Each template works on one element (T = Real) and on element_lanes elements side
// by side (T = Real8).
#pragma once

#include <array>
#include <cmath>

#include "components/lanes.h"
#include "components/types.h"
#include "systems/geometry/lane_mask.h"
#include "systems/geometry/lane_vec3.h"

namespace skerry {

/// log(1 + x), computed lane by lane, so that each lane gets the same bits as a single element. Speed does not matter,
/// because only reports use energies, not the step.
inline Real log_of_one_plus(Real x) {
    return std::log1p(x);
}
inline Real8 log_of_one_plus(const Real8& x) {
    Real8 log;
    for (int l = 0; l < element_lanes; ++l) log[l] = std::log1p(x[l]);
    return log;
}

/// True if a comparison holds in all lanes.
inline bool all(bool mask) {
    return mask;
}
[[gnu::always_inline]] inline bool all(const LaneBits& mask) {
    return bits_of(mask) == (1U << element_lanes) - 1;
}
template <class Mask>
bool all(const Mask& mask) {
    auto both = mask[0];
    for (std::size_t l = 1; l < lanes_of<Mask>; ++l) both &= mask[l];
    return both != 0;
}

/// A 3x3 matrix of T, stored by columns. Functions that the force kernel uses are forced inline. By itself gcc does not
/// inline them, and would pass the nine entries through memory.
template <class T>
struct LaneMat3 {
    LaneVec3<T> c0, c1, c2;
};

template <class T>
[[gnu::always_inline]] inline LaneMat3<T> operator+(const LaneMat3<T>& a, const LaneMat3<T>& b) {
    return {a.c0 + b.c0, a.c1 + b.c1, a.c2 + b.c2};
}
template <class T>
[[gnu::always_inline]] inline LaneMat3<T> operator-(const LaneMat3<T>& a, const LaneMat3<T>& b) {
    return {a.c0 - b.c0, a.c1 - b.c1, a.c2 - b.c2};
}
template <class S, class T>
[[gnu::always_inline]] inline LaneMat3<T> operator*(const S& s, const LaneMat3<T>& a) {
    return {s * a.c0, s * a.c1, s * a.c2};
}
template <class T>
[[gnu::always_inline]] inline LaneVec3<T> multiply(const LaneMat3<T>& a, const LaneVec3<T>& b) {
    return b.x * a.c0 + b.y * a.c1 + b.z * a.c2;
}
template <class T>
[[gnu::always_inline]] inline LaneMat3<T> multiply(const LaneMat3<T>& a, const LaneMat3<T>& b) {
    return {multiply(a, b.c0), multiply(a, b.c1), multiply(a, b.c2)};
}
template <class T>
[[gnu::always_inline]] inline T inner_product(const LaneMat3<T>& a, const LaneMat3<T>& b) {
    return dot(a.c0, b.c0) + dot(a.c1, b.c1) + dot(a.c2, b.c2);
}
template <class T>
[[gnu::always_inline]] inline T determinant(const LaneMat3<T>& a) {
    return dot(a.c0, cross(a.c1, a.c2));
}
/// Cofactor matrix det(a) a^-T, defined for every matrix a.
template <class T>
[[gnu::always_inline]] inline LaneMat3<T> cofactor(const LaneMat3<T>& a) {
    return {cross(a.c1, a.c2), cross(a.c2, a.c0), cross(a.c0, a.c1)};
}

/// A stress as a sum of two terms: the factor `of_F` times the deformation gradient F, plus the factor `of_other` times
/// the matrix `other` [Pa]. In this form a caller can scale the stress or add multiples of F by changing two numbers
/// per lane. Laws whose stress has another form return a matrix.
template <class T>
struct SplitStress {
    T of_F, of_other;
    LaneMat3<T> other;
};
template <class T>
[[gnu::always_inline]] inline LaneMat3<T> whole(const SplitStress<T>& P, const LaneMat3<T>& F) {
    return P.of_F * F + P.of_other * P.other;
}
template <class T>
[[gnu::always_inline]] inline LaneMat3<T> whole(const LaneMat3<T>& P, const LaneMat3<T>&) {
    return P;
}
template <class T>
[[gnu::always_inline]] inline SplitStress<T> scaled(const T& scale, const SplitStress<T>& P) {
    return {scale * P.of_F, scale * P.of_other, P.other};
}
template <class T>
[[gnu::always_inline]] inline LaneMat3<T> scaled(const T& scale, const LaneMat3<T>& P) {
    return scale * P;
}

/// The identity matrix as a compile-time constant, so that a product with it needs no arithmetic.
struct IdentityMatrix {};
template <class T>
[[gnu::always_inline]] inline const LaneMat3<T>& multiply(IdentityMatrix, const LaneMat3<T>& b) {
    return b;
}

/// Returns the matrix in lane l.
template <class T>
Mat3 lane_of(const LaneMat3<T>& a, int l) {
    Mat3 m;
    m << a.c0.x[l], a.c1.x[l], a.c2.x[l], a.c0.y[l], a.c1.y[l], a.c2.y[l], a.c0.z[l], a.c1.z[l], a.c2.z[l];
    return m;
}
inline LaneMat3<Real> from_matrix(const Mat3& m) {
    return {{m(0, 0), m(1, 0), m(2, 0)}, {m(0, 1), m(1, 1), m(2, 1)}, {m(0, 2), m(1, 2), m(2, 2)}};
}
inline Mat3 to_matrix(const LaneMat3<Real>& a) {
    Mat3 m;
    m << a.c0.x, a.c1.x, a.c2.x, a.c0.y, a.c1.y, a.c2.y, a.c0.z, a.c1.z, a.c2.z;
    return m;
}

}  // namespace skerry
