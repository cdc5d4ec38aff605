// Friction laws as projections of a contact's impulse (docs/methods/friction.md 2). `normal` is a unit vector, `mu`
// holds the coefficients of friction. Type V is a world vector of size 3, or of size 4 with a last entry of zero.
// Equations of Lazarevych et al. (2010): see docs/methods/contact.md 5.
#pragma once

#include <algorithm>
#include <cmath>

#include "components/options.h"
#include "components/types.h"
#include "systems/contact/tangent_frame.h"

namespace skerry {

/// A world vector padded to a vector register. The last entry is zero.
using Vec4 = Eigen::Matrix<Real, 4, 1>;

inline Vec4 padded(const Vec3& v) {
    return {v.x(), v.y(), v.z(), 0};
}
inline Vec3 shortened(const Vec3& v) {
    return v;
}
inline Vec3 shortened(const Vec4& v) {
    return v.head<3>();
}

/// Static and dynamic friction coefficients. An impulse inside the static cone sticks. An impulse outside of it slides
/// with the dynamic coefficient.
///
/// An infinite `slide` marks a tie, an equation whose impulse may also pull. A tie stops the velocity along the normal
/// if `stick` is zero, and the whole velocity if `stick` is infinite.
struct FrictionLimits {
    Real stick, slide;

    bool ties() const { return slide == infinity; }
};

/// Impulse of a tie, where `z` is the impulse that would stop the velocity in all directions.
template <class V>
inline V project_tie(const V& z, const V& normal, FrictionLimits mu) {
    return mu.stick == 0 ? V(normal.dot(z) * normal) : z;
}

/// Impulse of one contact by Coulomb's law, for isotropic mobility (docs/methods/friction.md 2.1). `z` is the impulse
/// that would stop the contact. The result is zero if `z` pulls; otherwise the tangential part of `z` is scaled down to
/// the friction limit. NaN inputs give NaN.
template <class V>
inline V project_coulomb(const V& z, const V& normal, FrictionLimits mu) {
    const Real along = normal.dot(z);
    if (along <= 0) return mu.ties() ? project_tie(z, normal, mu) : V(V::Zero());
    const V pressed = along * normal;
    if (mu.stick == 0) return pressed;
    const V tangential = z - pressed;
    const Real length_squared = tangential.dot(tangential);
    const Real limit = mu.stick * along;
    if (length_squared <= limit * limit) return z;
    return pressed + (mu.slide * along / std::sqrt(length_squared)) * tangential;
}

/// Version of project_coulomb for the friction pyramid (eq. 6 of Lazarevych et al. (2010)). Each tangential component
/// is clamped separately.
template <class V>
inline V project_pyramid(const V& z, const V& normal, FrictionLimits mu) {
    const Real along = normal.dot(z);
    if (along <= 0) return mu.ties() ? project_tie(z, normal, mu) : V(V::Zero());
    V result = along * normal;
    if (mu.stick == 0) return result;
    const TangentFrame frame = tangent_frame(shortened(normal));
    for (const Vec3& tangent : {frame.first, frame.second}) {
        Real part = shortened(z).dot(tangent);
        if (!(std::abs(part) <= mu.stick * along)) part = std::clamp(part, -mu.slide * along, mu.slide * along);
        result.template head<3>() += part * tangent;
    }
    return result;
}

/// Euclidean projection of z onto the cone |z_t| <= mu z_n, for the error measures (P_K of docs/methods/friction.md
/// 2.5). gnu::flatten keeps vectors in registers: without it, gcc would call functions of Eigen for single operations.
template <class V>
[[gnu::flatten]] inline V project_onto_cone(const V& z, const V& normal, Real mu) {
    const Real along = normal.dot(z);
    const V tangential = z - along * normal;
    const Real length = tangential.norm();
    // The test of the polar cone comes first, so that a negative normal impulse without tangential part is projected to
    // zero. If mu is zero, such an impulse passes the test of the cone, too.
    if (mu * length <= -along) return V::Zero();
    if (length <= mu * along) return z;
    const Real nearest = (along + mu * length) / (1 + mu * mu);
    if (length == 0) return nearest * normal;
    return nearest * normal + (mu * nearest / length) * tangential;
}

template <class V>
inline V project_friction(const V& z, const V& normal, FrictionLimits mu, Friction friction) {
    return friction == Friction::cone ? project_coulomb(z, normal, mu) : project_pyramid(z, normal, mu);
}

/// W(lambda) of equation (19) of Lazarevych et al. (2010): the part of the residual along which the impulse may move
/// without violating its limits (docs/methods/contact.md 5.6). A zero impulse can only grow. An impulse at the friction
/// limit cannot move outwards.
template <class V>
inline V feasible_direction(const V& residual, const V& impulse, const V& normal, FrictionLimits mu,
                            Friction friction) {
    const Real along = normal.dot(impulse);
    const Real growth = normal.dot(residual);
    if (mu.ties()) return project_tie(residual, normal, mu);
    if (along <= 0) return std::max(Real(0), growth) * normal;
    if (mu.stick == 0) return growth * normal;
    // Relative distance from the cone surface below which a projected impulse counts as lying on it.
    constexpr Real rounding = 1e-9;
    const Real limit = mu.slide * along * (1 - rounding);
    if (friction != Friction::pyramid) {
        const V tangential = impulse - along * normal;
        const Real length = tangential.norm();
        if (length < limit || length == 0) return residual;
        const V outward = tangential / length;
        return residual - std::max(Real(0), outward.dot(residual)) * outward;
    }
    V result = residual;
    const TangentFrame frame = tangent_frame(shortened(normal));
    for (const Vec3& tangent : {frame.first, frame.second}) {
        const Real part = shortened(impulse).dot(tangent);
        const Real push = shortened(residual).dot(tangent);
        if (std::abs(part) >= limit && part * push >= 0) result.template head<3>() -= push * tangent;
    }
    return result;
}

}  // namespace skerry
