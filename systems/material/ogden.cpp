#include "systems/material/ogden.h"

#include <Eigen/LU>
#include <algorithm>
#include <cmath>

namespace skerry {

namespace {

/// A positive number y(x): x above a limit, limit^2 / (2 limit - x) below it. `value`: y. `slope`: logarithmic
/// derivative y'/y. `curvature`: derivative of `slope` by x.
template <class T>
struct Limited {
    T value, slope, curvature;
};
template <class T>
Limited<T> limited(const T& x, Real limit) {
    const auto above = x >= limit;
    const T value = above ? x : (limit * limit) / (2.0 * limit - (above ? T{} : x));
    const T slope = above ? 1.0 / value : value / (limit * limit);
    return {value, slope, above ? -(slope * slope) : slope * slope};
}

/// x^a for x > 0. `log`: natural logarithm of x.
template <class T>
T power_of(const T& x, const T& log, Real a) {
    if (a == 2) return x * x;
    if (a == -2) return 1.0 / (x * x);
    return exp_of(a * log);
}

template <class T>
using Three = std::array<T, 3>;

/// Terms of the law that several functions need: for each axis the limited stretch, and the limited volume ratio.
template <class T>
struct PrincipalShape {
    Three<Limited<T>> stretch;
    Limited<T> volume;
    Three<T> area;  // derivative of J by each stretch: product of the two other stretches
    T J;
    Three<T> log_stretch;
    T log_volume;

    PrincipalShape(const T& a, const T& b, const T& c)
        : stretch{limited(a, Ogden::least_stretch), limited(b, Ogden::least_stretch), limited(c, Ogden::least_stretch)},
          volume(limited(a * b * c, Ogden::least_volume)),
          area{b * c, c * a, a * b},
          J(a * b * c),
          log_stretch{log_of(stretch[0].value), log_of(stretch[1].value), log_of(stretch[2].value)},
          log_volume(log_of(volume.value)) {}

    /// Quantities of one term of the law for each axis, with the stretch s_i, the exponent a and x_i = s_i / J^(1/3):
    /// - `power`: x_i^a
    /// - `over_exponent`: derivative of the term by log x_i, divided by the modulus 2 mu c_p of the term (ogden.h). It
    ///   is x_i^a / a. If a = 0, it is log x_i, the limit of (x_i^a - 1) / a: numbers equal on all axes, such as -1/a,
    ///   cancel in the stress.
    struct Powers {
        Three<T> power, over_exponent;
    };
    Powers powers(Real exponent) const {
        Powers t;
        const T volume_factor = exp_of((-exponent / 3) * log_volume);
        for (std::size_t i = 0; i < 3; ++i) {
            if (exponent == 0) {
                t.power[i] = T{} + 1.0;
                t.over_exponent[i] = log_stretch[i] - log_volume * (1.0 / 3);
            } else {
                t.power[i] = power_of(stretch[i].value, log_stretch[i], exponent) * volume_factor;
                t.over_exponent[i] = t.power[i] * (1 / exponent);
            }
        }
        return t;
    }
};

/// Calls visit(modulus, exponent) for each term in use, with the modulus 2 mu c [Pa]. The law of Hencky has one term
/// with the exponent 0.
void for_each_term(const MaterialConstants& material, auto&& visit) {
    if (material.model == MaterialModel::hencky) return visit(2 * material.shear_modulus, Real(0));
    for (std::size_t p = 0; p < material.share.size(); ++p)
        if (material.share[p] > 0) visit(2 * material.shear_modulus * material.share[p], material.exponent[p]);
}

/// Derivatives of the energy of shape changes by the stretches [Pa].
template <class T>
Three<T> principal_stress(const MaterialConstants& material, const PrincipalShape<T>& shape) {
    Three<T> W{};
    for_each_term(material, [&](Real modulus, Real exponent) {
        const Three<T> t = shape.powers(exponent).over_exponent;
        const T third = (t[0] + t[1] + t[2]) * (1.0 / 3) * shape.volume.slope;
        for (std::size_t i = 0; i < 3; ++i)
            W[i] = W[i] + modulus * (t[i] * shape.stretch[i].slope - third * shape.area[i]);
    });
    return W;
}

/// Derivative dP/dF due to the energy of shape changes, in principal axes as in Tangent [Pa]. `diagonal`: diagonal
/// entries of Tangent::normal. `off`: its other entries; off[k] is the entry (i, j) of the two axes other than k.
template <class T>
struct PrincipalTangent {
    Three<T> diagonal{}, off{}, flip{}, twist{};
};

template <class T>
PrincipalTangent<T> principal_tangent(const MaterialConstants& material, const PrincipalShape<T>& shape,
                                      const Three<T>& s) {
    constexpr Real close = 1e-4;  // for stretches that differ by less, the quotient below becomes a derivative
    constexpr Real least = 1e-3;  // lower bound of the sum of two stretches; the nearest rotation is not unique at 0
    PrincipalTangent<T> H;
    const T r = shape.volume.slope, change = shape.volume.curvature;
    for_each_term(material, [&](Real modulus, Real exponent) {
        const auto [power, t] = shape.powers(exponent);
        const T sum = t[0] + t[1] + t[2], ninth = (power[0] + power[1] + power[2]) * (1.0 / 9);
        Three<T> B, C, stress, slope;
        for (std::size_t i = 0; i < 3; ++i) {
            const T& A = shape.stretch[i].slope;
            B[i] = r * shape.area[i];
            C[i] = (1.0 / 3) * (power[i] * A);
            stress[i] = t[i] * A;
            slope[i] = power[i] * (A * A) + t[i] * shape.stretch[i].curvature;
        }
        for (std::size_t k = 0; k < 3; ++k) {
            const std::size_t i = (k + 1) % 3, j = (k + 2) % 3;
            H.diagonal[k] = H.diagonal[k] + modulus * (slope[k] - 2.0 * (C[k] * B[k]) + ninth * B[k] * B[k] -
                                                       (1.0 / 3) * (sum * change * shape.area[k] * shape.area[k]));
            H.off[k] = H.off[k] + modulus * (ninth * B[i] * B[j] - (C[i] * B[j] + C[j] * B[i]) -
                                             (1.0 / 3) * (sum * (change * shape.area[i] * shape.area[j] + r * s[k])));
            const T difference = s[i] - s[j], total = s[i] + s[j], pressure = (1.0 / 3) * (sum * r * s[k]);
            const auto apart = (difference > close) | (difference < -close);
            const T quotient =
                apart ? (stress[i] - stress[j]) / (apart ? difference : T{} + 1.0) : 0.5 * (slope[i] + slope[j]);
            H.flip[k] = H.flip[k] + modulus * (quotient + pressure);
            H.twist[k] =
                H.twist[k] + modulus * ((stress[i] + stress[j]) / (total > least ? total : T{} + least) - pressure);
        }
    });
    return H;
}

template <class T>
T larger(const T& a, const T& b) {
    return a > b ? a : b;
}

template <class T>
T smaller(const T& a, const T& b) {
    return a < b ? a : b;
}

/// Upper bound of the largest eigenvalue of a symmetric 3x3 matrix: the smaller of Gershgorin's bound and a bound from
/// the mean and the variance of the eigenvalues. The latter is exact if the two smaller eigenvalues are equal.
template <class T>
T largest_eigenvalue(const Three<T>& diagonal, const Three<T>& off) {
    const T mean = (diagonal[0] + diagonal[1] + diagonal[2]) * (1.0 / 3);
    T square = 2.0 * (off[0] * off[0] + off[1] * off[1] + off[2] * off[2]);
    for (const T& entry : diagonal) square = square + (entry - mean) * (entry - mean);
    Three<T> size, row;
    for (std::size_t k = 0; k < 3; ++k) size[k] = off[k] < 0.0 ? -off[k] : off[k];
    for (std::size_t k = 0; k < 3; ++k) row[k] = diagonal[k] + size[(k + 1) % 3] + size[(k + 2) % 3];
    return smaller(mean + 2.0 * square_root(square * (1.0 / 6)), larger(row[0], larger(row[1], row[2])));
}

template <class T>
T largest_of(const Three<T>& a) {
    return larger(a[0], larger(a[1], a[2]));
}

template <class T>
Three<T> stretches_of(const LaneAxes<T>& axes) {
    return {axes.stretch.x, axes.stretch.y, axes.stretch.z};
}
template <class T>
PrincipalShape<T> shape_of(const LaneAxes<T>& axes) {
    return {axes.stretch.x, axes.stretch.y, axes.stretch.z};
}

/// left diag(x, y, z) right^T with the rotations of `axes`
template <class T>
LaneMat3<T> from_axes(const LaneAxes<T>& axes, const T& x, const T& y, const T& z) {
    const LaneVec3<T> a = x * axes.left.c0, b = y * axes.left.c1, c = z * axes.left.c2;
    const LaneMat3<T>& V = axes.right;
    return {V.c0.x * a + V.c1.x * b + V.c2.x * c, V.c0.y * a + V.c1.y * b + V.c2.y * c,
            V.c0.z * a + V.c1.z * b + V.c2.z * c};
}

constexpr Real rounding = 1 + 1e-6;  // factor that covers the error of principal_tangent() for nearly equal stretches

}  // namespace

template <class T>
LaneMat3<T> Ogden::stress(const MaterialConstants& material, const LaneMat3<T>& F) {
    const LaneAxes<T> axes = principal_axes(F);
    const PrincipalShape<T> shape = shape_of(axes);
    const Three<T> W = principal_stress(material, shape);
    const T pressure = bulk_modulus(material) * (shape.J - 1.0);
    return from_axes(axes, W[0] + pressure * shape.area[0], W[1] + pressure * shape.area[1],
                     W[2] + pressure * shape.area[2]);
}

template <class T>
T Ogden::energy_density(const MaterialConstants& material, const LaneMat3<T>& F) {
    T energy;
    if constexpr (lanes_of<T> == 1) {
        energy = energy_density(material, to_matrix(F));
    } else {
        for (int l = 0; l < static_cast<int>(lanes_of<T>); ++l) energy[l] = energy_density(material, lane_of(F, l));
    }
    return energy;
}

template <class T>
T Ogden::stiffness_bound(const MaterialConstants& material, const LaneMat3<T>& F) {
    const LaneAxes<T> axes = principal_axes(F);
    const PrincipalShape<T> shape = shape_of(axes);
    const Three<T> s = stretches_of(axes);
    PrincipalTangent<T> H = principal_tangent(material, shape, s);
    const Real K = bulk_modulus(material);
    const T pressure = K * (shape.J - 1.0);
    for (std::size_t k = 0; k < 3; ++k) {
        const std::size_t i = (k + 1) % 3, j = (k + 2) % 3;
        H.diagonal[k] = H.diagonal[k] + K * (shape.area[k] * shape.area[k]);
        H.off[k] = H.off[k] + K * (shape.area[i] * shape.area[j]) + pressure * s[k];
        H.flip[k] = H.flip[k] - pressure * s[k];
        H.twist[k] = H.twist[k] + pressure * s[k];
    }
    const T bound = larger(largest_eigenvalue(H.diagonal, H.off), larger(largest_of(H.flip), largest_of(H.twist)));
    return rounding * larger(bound, T{} + material.shear_modulus);
}

template <class T>
Ogden::FrameBound<T> Ogden::frame_bound(const MaterialConstants& material, const LaneMat3<T>& F) {
    const LaneAxes<T> axes = principal_axes(F);
    PrincipalTangent<T> H = principal_tangent(material, shape_of(axes), stretches_of(axes));
    const Real at_rest = 2 * material.shear_modulus, volume = at_rest / 3;
    for (std::size_t k = 0; k < 3; ++k) {
        H.diagonal[k] = H.diagonal[k] + volume;
        H.off[k] = H.off[k] + volume;
    }
    const T even = larger(largest_eigenvalue(H.diagonal, H.off), largest_of(H.flip));
    const T one = T{} + 1.0;
    return {from_axes(axes, one, one, one), rounding * larger(even, T{} + at_rest),
            rounding * larger(largest_of(H.twist), T{}), volume};
}

template <class T>
T Ogden::rough_stiffness_bound(const MaterialConstants& material, const T& square, const T& J) {
    // Bounds on the stretches x of F / J^(1/3), whose product is 1 and whose squares have the sum S:
    // - (x - 1)^2 <= S - 3
    // - 3 (x - 1)^2 <= S - 3 for x < 1
    // - x >= 2/S, because the product of the two other stretches is at most S/2
    const auto regular = J >= least_volume;
    const T volume = regular ? J : T{} + 1.0, log_third = log_of(volume) * (1.0 / 3), cube_root = exp_of(log_third);
    const T S = square / (cube_root * cube_root), excess = larger(S - 3.0, T{});
    const T most = 1.0 + square_root(excess), least = larger(1.0 - square_root(excess * (1.0 / 3)), 2.0 / S);
    const T least_of_F = least * cube_root;
    const T steep = 1.0 / (least_of_F * least_of_F), gentle = 1.0 / (most * most * cube_root * cube_root);
    const T log_most = log_of(most), log_least = log_of(least);
    T bound{};
    for_each_term(material, [&](Real modulus, Real exponent) {
        if (exponent == 0) {
            // The last term is needed because largest_eigenvalue returns up to 4/3 of the eigenvalue if K is small.
            bound = bound + modulus * ((1.0 + larger(log_most, T{} - log_least)) * steep +
                                       larger(steep - 1.0, T{}) * (1.0 / 3));
            return;
        }
        const T up = exp_of(exponent * log_most), down = exp_of(exponent * log_least);
        const T above = larger(up, down) * steep, below = smaller(up, down) * gentle;
        bound = bound + modulus * above + std::abs(modulus / exponent) * (above - below);
    });
    const Real K = bulk_modulus(material);
    const T slope = K * (J - 1.0);
    bound = bound + (K / 3) * (square * square) + (slope < 0.0 ? -slope : slope) * (square * (1.0 / 3) + 1.0) +
            material.shear_modulus;
    return regular & (least_of_F > least_stretch) ? rounding * bound : T{} + infinity;
}

template LaneMat3<Real> Ogden::stress(const MaterialConstants&, const LaneMat3<Real>&);
template LaneMat3<Real4> Ogden::stress(const MaterialConstants&, const LaneMat3<Real4>&);
template LaneMat3<Real8> Ogden::stress(const MaterialConstants&, const LaneMat3<Real8>&);
template Real8 Ogden::energy_density(const MaterialConstants&, const LaneMat3<Real8>&);
template Real Ogden::stiffness_bound(const MaterialConstants&, const LaneMat3<Real>&);
template Real8 Ogden::stiffness_bound(const MaterialConstants&, const LaneMat3<Real8>&);
template Ogden::FrameBound<Real4> Ogden::frame_bound(const MaterialConstants&, const LaneMat3<Real4>&);
template Ogden::FrameBound<Real8> Ogden::frame_bound(const MaterialConstants&, const LaneMat3<Real8>&);
template Real Ogden::rough_stiffness_bound(const MaterialConstants&, const Real&, const Real&);
template Real4 Ogden::rough_stiffness_bound(const MaterialConstants&, const Real4&, const Real4&);
template Real8 Ogden::rough_stiffness_bound(const MaterialConstants&, const Real8&, const Real8&);

Real Ogden::energy_density(const MaterialConstants& material, const Mat3& F) {
    const Vec3 s = Stretches(F).stretch;
    const Real J = F.determinant(), log_volume = std::log(limited(J, least_volume).value);
    Real energy = 0.5 * bulk_modulus(material) * (J - 1) * (J - 1);
    for_each_term(material, [&](Real modulus, Real exponent) {
        for (const Real stretch : s) {
            const Real log = std::log(limited(stretch, least_stretch).value) - log_volume / 3;
            energy += modulus * (exponent == 0 ? log * log / 2 : std::expm1(exponent * log) / (exponent * exponent));
        }
    });
    return energy;
}

Mat3 Ogden::stress(const MaterialConstants& material, const Mat3& F) {
    const Stretches frames(F);
    const Vec3& s = frames.stretch;
    const Vec3 area(s[1] * s[2], s[2] * s[0], s[0] * s[1]);
    const Limited<Real> volume = limited(s.prod(), least_volume);
    Vec3 W = bulk_modulus(material) * (s.prod() - 1) * area;
    for_each_term(material, [&](Real modulus, Real exponent) {
        Vec3 power, slope;
        for (Index i = 0; i < 3; ++i) {
            const Limited<Real> stretch = limited(s[i], least_stretch);
            const Real distorted = stretch.value / std::cbrt(volume.value);
            power[i] = exponent == 0 ? std::log(distorted) : std::pow(distorted, exponent) / exponent;
            slope[i] = stretch.slope;
        }
        W += modulus * (power.cwiseProduct(slope) - power.sum() / 3 * volume.slope * area);
    });
    return frames.left * W.asDiagonal() * frames.right.transpose();
}

Real Ogden::stiffness_bound(const MaterialConstants& material, const Mat3& F) {
    return stiffness_bound(material, from_matrix(F));
}

Tangent Ogden::tangent(const MaterialConstants& material, const Mat3& F) {
    const Stretches frames(F);
    const Vec3& s = frames.stretch;
    const PrincipalShape<Real> shape(s[0], s[1], s[2]);
    const PrincipalTangent<Real> H = principal_tangent(material, shape, {s[0], s[1], s[2]});
    const Real K = bulk_modulus(material), pressure = K * (shape.J - 1);
    const Vec3 area(shape.area[0], shape.area[1], shape.area[2]);
    Mat3 normal = K * area * area.transpose();
    Vec3 flip, twist;
    for (Index k = 0; k < 3; ++k) {
        const Index i = (k + 1) % 3, j = (k + 2) % 3;
        const auto axis = static_cast<std::size_t>(k);
        normal(k, k) += H.diagonal[axis];
        normal(i, j) += H.off[axis] + pressure * s[k];
        normal(j, i) = normal(i, j);
        flip[k] = H.flip[axis] - pressure * s[k];
        twist[k] = H.twist[axis] + pressure * s[k];
    }
    return without_softening(frames, normal, flip, twist);
}

}  // namespace skerry
