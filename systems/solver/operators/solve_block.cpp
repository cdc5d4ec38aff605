#include "systems/solver/operators/solve_block.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace skerry {
namespace {

/// The letters of methods.md 2.3: impulse as a function of s = |u_t| / |r_t|, and its derivative.
struct SlipCurve {
    const LocalBlock& block;
    Real bn, b[2];  // m/s; tangents after elimination, along the principal axes
    Real mu;

    Real rt[2], rt_length, rn, rt_slope, rn_slope;

    void evaluate(Real s) {
        Real pull = 0, pull_slope = 0, squared = 0, weighted = 0;
        for (int k = 0; k < 2; ++k) {
            const Real stiffness = block.eigenvalue[k] + s;
            rt[k] = -b[k] / stiffness;
            pull += block.coupling[k] * rt[k];
            pull_slope -= block.coupling[k] * rt[k] / stiffness;
            squared += rt[k] * rt[k];
            weighted += rt[k] * rt[k] / stiffness;
        }
        rt_length = std::sqrt(squared);
        rt_slope = rt_length > 0 ? -weighted / rt_length : 0;
        rn = -(bn + pull) / block.normal;
        rn_slope = -pull_slope / block.normal;
    }
    bool inside_cone() const { return rt_length <= mu * rn; }
};

/// The s > 0 at which the impulse lies on the cone: Newton on 1/|rt| - 1/(mu rn), nearly linear in s, kept inside a bracket.
void find_slip(SlipCurve& curve) {
    const LocalBlock& block = curve.block;
    const Real b_length = std::hypot(curve.b[0], curve.b[1]);
    const Real coupling_length = std::hypot(block.coupling[0], block.coupling[1]);
    const Real smallest = std::min(block.eigenvalue[0], block.eigenvalue[1]);
    Real low = 0;
    Real high = b_length * (1 + curve.mu * coupling_length / block.normal) * block.normal / (curve.mu * -curve.bn) - smallest;
    high = std::max(high, smallest);
    for (curve.evaluate(high); !curve.inside_cone() && high < std::numeric_limits<Real>::max() / 4; curve.evaluate(high)) high *= 2;
    Real s = 0;
    curve.evaluate(s);
    constexpr int iteration_limit = 100;  // bisection alone needs about 60
    for (int iteration = 0; iteration < iteration_limit; ++iteration) {
        const bool usable = curve.rn > 0;
        const Real limit = curve.mu * curve.rn;
        if (usable && std::abs(curve.rt_length - limit) <= 4 * std::numeric_limits<Real>::epsilon() * limit) return;
        (curve.inside_cone() ? high : low) = s;
        if (!(high - low > std::numeric_limits<Real>::epsilon() * high)) return;
        Real next = 0.5 * (low + high);
        if (usable) {
            const Real value = 1 / curve.rt_length - 1 / limit;
            const Real slope = -curve.rt_slope / (curve.rt_length * curve.rt_length) + curve.mu * curve.rn_slope / (limit * limit);
            const Real newton = s - value / slope;
            if (newton > low && newton < high) next = newton;
        }
        s = next;
        curve.evaluate(s);
    }
}

}  // namespace

LocalBlock prepare_block(const Mat3& matrix) {
    LocalBlock block;
    block.matrix = 0.5 * (matrix + matrix.transpose());
    block.normal = block.matrix(0, 0);
    block.cosine = 1;
    block.sine = 0;
    if (!(block.normal > 0)) {
        block.coupling[0] = block.coupling[1] = 0;
        block.eigenvalue[0] = block.eigenvalue[1] = 1;
        return block;
    }
    const Real w1 = block.matrix(0, 1), w2 = block.matrix(0, 2);
    const Real a = block.matrix(1, 1) - w1 * w1 / block.normal;
    const Real c = block.matrix(2, 2) - w2 * w2 / block.normal;
    const Real d = block.matrix(1, 2) - w1 * w2 / block.normal;
    // one Jacobi rotation
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
    // a rank-deficient block leaves rounding here, of either sign
    const Real smallest = 1e-14 * (block.normal + block.matrix(1, 1) + block.matrix(2, 2));
    for (Real& eigenvalue : block.eigenvalue) eigenvalue = std::max(eigenvalue, smallest);
    block.coupling[0] = block.cosine * w1 - block.sine * w2;
    block.coupling[1] = block.sine * w1 + block.cosine * w2;
    return block;
}

Vec3 solve_block(const LocalBlock& block, const Vec3& b, Real mu) {
    if (b[0] >= 0 || !(block.normal > 0)) return Vec3::Zero();
    if (mu == 0) return {-b[0] / block.normal, 0, 0};
    const Real b1 = b[1] - block.matrix(0, 1) * b[0] / block.normal;
    const Real b2 = b[2] - block.matrix(0, 2) * b[0] / block.normal;
    SlipCurve curve{block, b[0], {block.cosine * b1 - block.sine * b2, block.sine * b1 + block.cosine * b2}, mu, {}, 0, 0, 0, 0};
    curve.evaluate(0);
    Real shrink = 1;
    if (!curve.inside_cone()) {
        find_slip(curve);
        shrink = curve.mu * curve.rn / curve.rt_length;  // onto the cone to the last bit
    }
    const Real r1 = shrink * curve.rt[0], r2 = shrink * curve.rt[1];
    return {curve.rn, block.cosine * r1 + block.sine * r2, -block.sine * r1 + block.cosine * r2};
}

}  // namespace skerry
