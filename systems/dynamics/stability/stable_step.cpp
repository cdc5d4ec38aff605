#include "systems/dynamics/stability/stable_step.h"

#include <algorithm>
#include <array>
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

/// One more than the highest level of a range of blocks.
int levels_of(const ElementInputs& elements, Range blocks) {
    int top = 0;
    if (!elements.schedule.level.empty())
        for (Index b = blocks.begin; b < blocks.end; ++b)
            top = std::max<int>(top, elements.schedule.level[static_cast<std::size_t>(b)]);
    return top + 1;
}

/// Blocks whose stiffness is summed in one piece: they take as long as the bound of one.
constexpr Index blocks_summed = 8;

Index sums_of(Range blocks) {
    return (blocks.size() + blocks_summed - 1) / blocks_summed;
}

/// Takes pieces of a look, from the coarsest level down: an element shares masses with those of its level and of
/// coarser ones alone (element_levels.h). First the sums of a level, then visit(block, bound of omega^2 by lane, level)
/// for each of its blocks. enough(level): bounds below it need not be known.
template <class Enough, class Visit>
void take_pieces(const ElementInputs& elements, Range blocks, int levels, std::span<const Vec3> position,
                 std::span<const Real> mass, std::span<Real> stiffness_sum, std::uint64_t from, std::uint64_t until,
                 Enough&& enough, Visit&& visit) {
    SKERRY_CHECK(stiffness_sum.size() == position.size() && mass.size() == position.size());
    const auto level_of = [&](std::size_t b) {
        return elements.schedule.level.empty() ? 0 : int{elements.schedule.level[b]};
    };
    const Index sums = sums_of(blocks);
    const auto of_level = static_cast<std::uint64_t>(sums + blocks.size());
    // The frame of a corotational element starts from the same lane of the block before it: neighbours turn together.
    const Real8 one = Real8{} + 1.0;
    LaneQuaternion<Real8> q{one, {}, {}, {}};
    for (std::uint64_t piece = from; piece < until; ++piece) {
        const int level = levels - 1 - static_cast<int>(piece / of_level);
        const auto place = static_cast<Index>(piece % of_level);
        const bool bounds = place >= sums;
        const Index first = blocks.begin + (bounds ? place - sums : place * blocks_summed);
        const Index end = bounds ? first + 1 : std::min(first + blocks_summed, blocks.end);
        for (auto b = static_cast<std::size_t>(first); b < static_cast<std::size_t>(end); ++b) {
            if (level_of(b) != level) continue;
            const LaneMat3<Real8> F = deformation_of(elements, b, position);
            if (bounds)
                visit(b, frequency_squared_of(elements, b, F, mass, stiffness_sum, q, enough(level)), level);
            else
                add_stiffness(elements, b, F, stiffness_sum, [](std::size_t) { return true; });
        }
    }
}

void clear_stiffness(const ElementInputs& elements, Range blocks, std::span<Real> stiffness_sum) {
    for (Index b = blocks.begin; b < blocks.end; ++b)
        clear_stiffness(elements, static_cast<std::size_t>(b), stiffness_sum);
}

/// s, of an element whose bound of omega^2 this is.
Real step_of(Real bound, int level) {
    return step_of_level(step_times_frequency / std::sqrt(bound), level);
}

}  // namespace

std::uint64_t pieces_of_look(Range blocks, int levels) {
    return static_cast<std::uint64_t>(levels) * static_cast<std::uint64_t>(sums_of(blocks) + blocks.size());
}

void continue_look(const ElementInputs& elements, Range blocks, int levels, std::span<const Vec3> position,
                   std::span<const Real> mass, std::span<Real> stiffness_sum, std::uint64_t until, StepLook& look) {
    const auto highest = [&](int level) { return look.highest[static_cast<std::size_t>(level)]; };
    const auto note = [&](std::size_t b, const Real8& bound, int level) {
        const auto at = static_cast<std::size_t>(level);
        for (std::size_t l = 0; l < element_lanes; ++l) {
            const Index here = static_cast<Index>(b * element_lanes + l);
            // a shape that is not finite has no stable step
            if (!(bound[l] <= std::numeric_limits<Real>::max()) && look.broken == no_index) look.broken = here;
            if (bound[l] > look.highest[at]) {
                look.highest[at] = bound[l];
                look.element[at] = here;
            }
        }
    };
    take_pieces(elements, blocks, levels, position, mass, stiffness_sum, look.piece, until, highest, note);
    look.piece = until;
}

StableStep result_of(const StepLook& look) {
    if (look.broken != no_index) return {0, look.broken};
    StableStep found{std::numeric_limits<Real>::infinity(), no_index};
    for (int level = element_level_count - 1; level >= 0; --level) {
        const auto at = static_cast<std::size_t>(level);
        if (!(look.highest[at] > 0)) continue;
        if (const Real step = step_of(look.highest[at], level); step < found.step) found = {step, look.element[at]};
    }
    return found;
}

StableStep stable_step(const ElementInputs& elements, Range blocks, std::span<const Vec3> position,
                       std::span<const Real> mass, std::span<Real> stiffness_sum) {
    clear_stiffness(elements, blocks, stiffness_sum);
    const int levels = levels_of(elements, blocks);
    StepLook look;
    continue_look(elements, blocks, levels, position, mass, stiffness_sum, pieces_of_look(blocks, levels), look);
    return result_of(look);
}

void element_steps(const ElementInputs& elements, Range blocks, std::span<const Vec3> position,
                   std::span<const Real> mass, std::span<Real> stiffness_sum, std::span<ElementLane> step) {
    SKERRY_CHECK(step.size() == static_cast<std::size_t>(blocks.size()));
    clear_stiffness(elements, blocks, stiffness_sum);
    const int levels = levels_of(elements, blocks);
    const auto note = [&](std::size_t b, const Real8& bound, int level) {
        for (std::size_t l = 0; l < element_lanes; ++l)
            step[b - static_cast<std::size_t>(blocks.begin)][l] =
                bound[l] > 0 ? step_of(bound[l], level) : std::numeric_limits<Real>::infinity();
    };
    take_pieces(
        elements, blocks, levels, position, mass, stiffness_sum, 0, pieces_of_look(blocks, levels),
        [](int) { return Real(0); }, note);
}

void find_mass_shares(const ElementInputs& elements, Range blocks, std::span<const Vec3> position,
                      std::span<const Real> mass, std::span<Real> stiffness_sum, std::span<ElementLane> mass_share) {
    constexpr int rounds = 4;
    constexpr Real least = 1e-3;  // of the share before: keeps what bounds nothing from giving all away
    std::vector<ElementLane> step(mass_share.size());
    for (int round = 0; round < rounds; ++round) {
        element_steps(elements, blocks, position, mass, stiffness_sum, step);
        Real shortest = std::numeric_limits<Real>::infinity();
        for (const ElementLane& lanes : step)
            for (const Real own : lanes.lane) shortest = std::min(shortest, own);
        if (!(shortest > 0) || shortest == std::numeric_limits<Real>::infinity()) return;
        for (std::size_t b = 0; b < step.size(); ++b)
            for (std::size_t l = 0; l < element_lanes; ++l) mass_share[b][l] *= std::max(least, shortest / step[b][l]);
    }
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
            const MaterialConstants material = elements.material_of(b);
            const BlockNodes nodes = elements.nodes_of(b);
            const KernelReal one = KernelReal{} + 1.0, zero{};
            const LaneMat3<KernelReal> identity{{one, zero, zero}, {zero, one, zero}, {zero, zero, one}};
            Parts<LaneMat3<KernelReal>> stress;
            Parts<KernelReal> volume;
            for (std::size_t part = 0; part < kernel_parts; ++part) {
                stress[part] = Linear::stress(material, identity + deformation_gradient(nodes, part, u));
                volume[part] = load_part<KernelReal>(elements.volume[b], part);
            }
            for_each_force(stress, nodes, volume, [&](Index k, std::size_t part, const LaneVec3<KernelReal>& f) {
                const std::size_t first = part * lanes_of<KernelReal>;
                for (std::size_t l = 0; l < lanes_of<KernelReal>; ++l)
                    next[static_cast<std::size_t>(nodes.node[k][first + l])] -= Vec3(f.x[l], f.y[l], f.z[l]);
            });
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
