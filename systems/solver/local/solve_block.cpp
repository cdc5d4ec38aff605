#include "systems/solver/local/solve_block.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace skerry {
namespace {

/// Impulse of a sliding contact as a function of the ratio s = |u_t| / |r_t| of tangential velocity and impulse, and
/// the derivatives of the impulse with respect to s. The notation is that of docs/methods/friction.md 3.1, 3.2.
struct SlipCurve {
    const LocalBlock& block;
    // `bn`: normal velocity without any impulse [m/s]. `b`: tangential velocity under the normal impulse of a contact
    // without friction, along the principal axes [m/s].
    Real bn, b[2];
    Real mu;

    Real rt[2], rt_length, rn, rt_slope, rn_slope;

    void evaluate(Real s) {
        const Real compliance[2] = {1 / (block.eigenvalue[0] + s), 1 / (block.eigenvalue[1] + s)};
        rt[0] = -b[0] * compliance[0];
        rt[1] = -b[1] * compliance[1];
        const Real pull = block.coupling[0] * rt[0] + block.coupling[1] * rt[1];
        const Real pull_slope =
            -(block.coupling[0] * rt[0] * compliance[0] + block.coupling[1] * rt[1] * compliance[1]);
        rt_length = std::sqrt(rt[0] * rt[0] + rt[1] * rt[1]);
        rt_slope = rt_length > 0 ? -(rt[0] * rt[0] * compliance[0] + rt[1] * rt[1] * compliance[1]) / rt_length : 0;
        rn = -(bn + pull) * block.inverse_normal;
        rn_slope = -pull_slope * block.inverse_normal;
    }
    bool inside_cone() const { return rt_length <= mu * rn; }
    bool on_cone() const {
        const Real limit = mu * rn;
        return rn > 0 && std::abs(rt_length - limit) <= 8 * std::numeric_limits<Real>::epsilon() * limit;
    }
    /// Newton step in s for the root of the function 1/|r_t| - 1/(mu r_n), which is nearly linear in s. The step needs
    /// r_n > 0.
    Real newton_step() const {
        const Real limit = mu * rn;
        const Real value = 1 / rt_length - 1 / limit;
        const Real slope = -rt_slope / (rt_length * rt_length) + mu * rn_slope / (limit * limit);
        return -value / slope;
    }
};

/// Finds the s > 0 at which the impulse lies on the friction cone, by Newton's method with bisection in a bracket.
Real find_slip_safely(SlipCurve& curve) {
    const LocalBlock& block = curve.block;
    const Real b_length = std::hypot(curve.b[0], curve.b[1]);
    const Real coupling_length = std::hypot(block.coupling[0], block.coupling[1]);
    const Real smallest = std::min(block.eigenvalue[0], block.eigenvalue[1]);
    Real low = 0;
    Real high =
        b_length * (1 + curve.mu * coupling_length / block.normal) * block.normal / (curve.mu * -curve.bn) - smallest;
    high = std::max(high, smallest);
    for (curve.evaluate(high); !curve.inside_cone() && high < std::numeric_limits<Real>::max() / 4;
         curve.evaluate(high))
        high *= 2;
    Real s = 0;
    curve.evaluate(s);
    constexpr int iteration_limit = 100;  // upper limit; pure bisection needs about 60 iterations
    for (int iteration = 0; iteration < iteration_limit; ++iteration) {
        if (curve.on_cone()) break;
        (curve.inside_cone() ? high : low) = s;
        if (!(high - low > std::numeric_limits<Real>::epsilon() * high)) break;
        Real next = 0.5 * (low + high);
        if (curve.rn > 0) {
            const Real newton = s + curve.newton_step();
            if (newton > low && newton < high) next = newton;
        }
        s = next;
        curve.evaluate(s);
    }
    return s;
}

/// Finds s by Newton's method, started from the last solution; one or two steps are usual. If there are several roots,
/// any root with r_n > 0 is a solution. If Newton's method does not converge quickly, find_slip_safely takes over.
Real find_slip(SlipCurve& curve, Real start) {
    Real s = start;
    constexpr int fast_limit = 6;  // upper limit of the Newton iterations, three times the usual number
    for (int iteration = 0; iteration < fast_limit && s > 0; ++iteration) {
        curve.evaluate(s);
        if (!(curve.rn > 0)) break;
        if (curve.on_cone()) return s;
        const Real step = curve.newton_step();
        s += step;
        if (std::abs(step) <= 4 * std::numeric_limits<Real>::epsilon() * s) return s;  // converged to rounding
    }
    return find_slip_safely(curve);
}

}  // namespace

LocalBlock prepare_block(const Mat3& matrix) {
    LocalBlock block;
    block.normal = matrix(0, 0);
    block.cosine = 1;
    block.sine = 0;
    block.slip = 0;
    if (!(block.normal > 0)) {
        block.inverse_normal = 0;
        block.coupling[0] = block.coupling[1] = 0;
        block.eigenvalue[0] = block.eigenvalue[1] = 1;
        return block;
    }
    block.inverse_normal = 1 / block.normal;
    const Real w1 = 0.5 * (matrix(0, 1) + matrix(1, 0)), w2 = 0.5 * (matrix(0, 2) + matrix(2, 0));
    const Real a = matrix(1, 1) - w1 * w1 / block.normal;
    const Real c = matrix(2, 2) - w2 * w2 / block.normal;
    const Real d = 0.5 * (matrix(1, 2) + matrix(2, 1)) - w1 * w2 / block.normal;
    // One Jacobi rotation diagonalises the tangential Schur complement [[a, d], [d, c]].
    if (d != 0) {
        const Real theta = (c - a) / (2 * d);
        const Real tangent = std::copysign(1 / (std::abs(theta) + std::sqrt(theta * theta + 1)), theta);
        block.cosine = 1 / std::sqrt(tangent * tangent + 1);
        block.sine = tangent * block.cosine;
        block.eigenvalue[0] = a - tangent * d;
        block.eigenvalue[1] = c + tangent * d;
    } else {
        block.eigenvalue[0] = a;
        block.eigenvalue[1] = c;
    }
    // SlipCurve divides by the eigenvalues. Rounding errors can make a zero eigenvalue negative, so each eigenvalue is
    // raised to at least a small positive number.
    constexpr Real rank_rounding = 1e-14;  // smallest eigenvalue as a fraction of the trace
    const Real smallest = rank_rounding * (block.normal + matrix(1, 1) + matrix(2, 2));
    for (Real& eigenvalue : block.eigenvalue) eigenvalue = std::max(eigenvalue, smallest);
    block.coupling[0] = block.cosine * w1 - block.sine * w2;
    block.coupling[1] = block.sine * w1 + block.cosine * w2;
    return block;
}

Vec3 solve_block(LocalBlock& block, const Vec3& b, Real mu) {
    if (b[0] >= 0 || block.inverse_normal == 0) return Vec3::Zero();
    const Real pressed = -b[0] * block.inverse_normal;  // normal impulse without friction [N s]
    if (mu == 0) return {pressed, 0, 0};
    SlipCurve curve{block,
                    b[0],
                    {block.cosine * b[1] - block.sine * b[2] + block.coupling[0] * pressed,
                     block.sine * b[1] + block.cosine * b[2] + block.coupling[1] * pressed},
                    mu,
                    {},
                    0,
                    0,
                    0,
                    0};
    curve.evaluate(0);
    Real shrink = 1;
    if (!curve.inside_cone()) {
        block.slip = find_slip(curve, block.slip);
        shrink = curve.mu * curve.rn / curve.rt_length;  // moves the impulse exactly onto the cone
    }
    const Real r1 = shrink * curve.rt[0], r2 = shrink * curve.rt[1];
    return {curve.rn, block.cosine * r1 + block.sine * r2, -block.sine * r1 + block.cosine * r2};
}

}  // namespace skerry
