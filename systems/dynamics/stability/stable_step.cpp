#include "systems/dynamics/stability/stable_step.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <vector>

#include "components/check.h"
#include "systems/dynamics/elements/element_block.h"
#include "systems/dynamics/stability/element_levels.h"
#include "systems/dynamics/stability/stiffness_share.h"
#include "systems/material/linear.h"

namespace skerry {

namespace {

/// The highest level of a range of blocks.
int top_level(const ElementInputs& elements, std::size_t first, std::size_t end) {
    int top = 0;
    if (!elements.schedule.level.empty())
        for (std::size_t b = first; b < end; ++b) top = std::max<int>(top, elements.schedule.level[b]);
    return top;
}

}  // namespace

StableStep stable_step(const ElementInputs& elements, Range blocks, std::span<const Vec3> position,
                       std::span<const Real> mass, std::span<Real> stiffness_sum) {
    SKERRY_CHECK(stiffness_sum.size() == position.size() && mass.size() == position.size());
    const std::size_t first = static_cast<std::size_t>(blocks.begin), end = static_cast<std::size_t>(blocks.end);
    const auto sum_at = [&](std::size_t b, std::size_t a, std::size_t l) -> Real& {
        return stiffness_sum[static_cast<std::size_t>(elements.node[b][a][l])];
    };
    const auto level_of = [&](std::size_t b) {
        return elements.schedule.level.empty() ? 0 : int{elements.schedule.level[b]};
    };
    for (std::size_t b = first; b < end; ++b)
        for (std::size_t a = 0; a < 4; ++a)
            for (std::size_t l = 0; l < element_lanes; ++l) sum_at(b, a, l) = 0;

    StableStep found{std::numeric_limits<Real>::infinity(), no_index};
    // The frame of a corotational element starts from the same lane of the block before it: neighbours turn together.
    const Real8 one = Real8{} + 1.0;
    LaneQuaternion<Real8> q{one, {}, {}, {}};
    // From the coarsest level down: an element shares masses with those of its level and of coarser ones alone
    // (element_levels.h).
    for (int level = top_level(elements, first, end); level >= 0; --level) {
        for (std::size_t b = first; b < end; ++b) {
            if (level_of(b) != level) continue;
            const std::array<Real8, 4> stiffness = corner_stiffness(elements, b, deformation_of(elements, b, position));
            for (std::size_t a = 0; a < 4; ++a)
                for (std::size_t l = 0; l < element_lanes; ++l) sum_at(b, a, l) += stiffness[a][l];
        }
        Real highest = 0;
        Index element = no_index;
        for (std::size_t b = first; b < end; ++b) {
            if (level_of(b) != level) continue;
            const Real8 bound =
                frequency_squared_of(elements, b, deformation_of(elements, b, position), mass, stiffness_sum, q);
            for (std::size_t l = 0; l < element_lanes; ++l) {
                const Index here = static_cast<Index>(b * element_lanes + l);
                // a shape that is not finite has no stable step
                if (!(bound[l] <= std::numeric_limits<Real>::max())) return {0, here};
                if (bound[l] > highest) {
                    highest = bound[l];
                    element = here;
                }
            }
        }
        if (element == no_index) continue;
        const Real step = step_of_level(step_times_frequency / std::sqrt(highest), level);
        if (step < found.step) found = {step, element};
    }
    return found;
}

Real estimate_max_frequency_squared(const ElementInputs& elements, Range blocks, std::span<const Vec3> position,
                                    std::span<const Real> inverse_mass, int iterations) {
    std::vector<Vec3> u(position.size()), next(position.size());
    // A start that no symmetry of the mesh makes orthogonal to the mode looked for.
    for (std::size_t n = 0; n < u.size(); ++n)
        u[n] = Vec3(std::sin(12.9898 * static_cast<Real>(n + 1)), std::sin(78.233 * static_cast<Real>(n + 1)),
                    std::sin(37.719 * static_cast<Real>(n + 1)));
    Real estimate = 0;
    for (int i = 0; i < iterations; ++i) {
        // Rayleigh quotient of M^-1/2 K M^-1/2 at w = M^1/2 u, and u <- M^-1 K u.
        for (Vec3& x : next) x.setZero();
        for (std::size_t b = static_cast<std::size_t>(blocks.begin); b < static_cast<std::size_t>(blocks.end); ++b) {
            MaterialConstants material = elements.constants[static_cast<std::size_t>(elements.material[b])];
            const Real8 one = Real8{} + 1.0, zero{};
            const LaneMat3<Real8> identity{{one, zero, zero}, {zero, one, zero}, {zero, zero, one}};
            const LaneMat3<Real8> F =
                identity + deformation_gradient(edges(elements.node[b], u), elements.inverse_rest[b]);
            ElementForces force;
            spread_forces(Linear::stress(material, F), elements.inverse_rest[b], load(elements.volume[b]), force);
            for (std::size_t l = 0; l < element_lanes; ++l)
                for (std::size_t a = 0; a < 4; ++a)
                    next[static_cast<std::size_t>(elements.node[b][a][l])] -= force[l][a];
        }
        Real energy = 0, size = 0, largest = 0;
        for (std::size_t n = 0; n < u.size(); ++n) {
            if (!(inverse_mass[n] > 0)) {
                next[n].setZero();
                u[n].setZero();
                continue;
            }
            energy += u[n].dot(next[n]);
            size += u[n].squaredNorm() / inverse_mass[n];
            next[n] *= inverse_mass[n];
            largest = std::max(largest, next[n].cwiseAbs().maxCoeff());
        }
        if (!(largest > 0)) return 0;
        estimate = energy / size;
        for (std::size_t n = 0; n < u.size(); ++n) u[n] = next[n] / largest;
    }
    return estimate;
}

}  // namespace skerry
