#include "systems/solver/methods/solve_frictionless.h"

#include "systems/solver/methods/ags.h"

namespace skerry {
namespace {

class NormalRows {
public:
    NormalRows(const LumpedOperator::Memory& region, const FrictionlessMemory& memory) : region_(region), memory_(memory) {
        for (std::size_t i = 0; i < region.contact.size(); ++i) memory.impulse[i] = region.contact[i].normal.dot(region.impulse[i]);
        std::ranges::copy(memory.impulse, memory.previous.begin());
        std::ranges::copy(region.velocity, region.scratch.begin());
    }

    SweepChange sweep(Real relaxation) {
        SweepChange sum{0, 0};
        for (std::size_t i = 0; i < region_.contact.size(); ++i) {
            const LumpedContact& contact = region_.contact[i];
            const Real next = wanted(i, relaxation), change = next - memory_.impulse[i];
            if (change == 0) continue;
            apply_impulse(contact, change * contact.normal, region_.velocity.data());
            memory_.impulse[i] = next;
            sum.size += contact.diagonal * change * change;
            sum.against -= contact.diagonal * change * (next - memory_.previous[i]);
        }
        return sum;
    }

    /// sqrt(sum D F^2), e_nat times its scale.
    Real error() const {
        Real sum = 0;
        for (std::size_t i = 0; i < region_.contact.size(); ++i) {
            const Real rest = memory_.impulse[i] - wanted(i, 1);
            sum += region_.contact[i].diagonal * rest * rest;
        }
        return std::sqrt(sum);
    }

    void extrapolate(Real factor) {
        const auto move = [factor](auto present, auto previous) {
            for (std::size_t i = 0; i < present.size(); ++i) {
                const auto now = present[i];
                present[i] = now + factor * (now - previous[i]);
                previous[i] = now;
            }
        };
        move(memory_.impulse, memory_.previous);
        move(region_.velocity, region_.scratch);  // velocities are affine in the impulses
    }

    /// Velocities again from the impulses, so that the rounding of the extrapolations does not add up.
    void refresh() {
        refresh(memory_.impulse, region_.velocity);
        refresh(memory_.previous, region_.scratch);
    }

    /// Into the region's impulses, where the best stay.
    void keep() {
        for (std::size_t i = 0; i < region_.contact.size(); ++i) region_.impulse[i] = memory_.impulse[i] * region_.contact[i].normal;
    }
    /// Velocities of the impulses that were kept.
    void restore() {
        for (std::size_t i = 0; i < region_.contact.size(); ++i) memory_.impulse[i] = region_.contact[i].normal.dot(region_.impulse[i]);
        refresh(memory_.impulse, region_.velocity);
    }

private:
    Real wanted(std::size_t i, Real relaxation) const {
        const LumpedContact& contact = region_.contact[i];
        const Real approach = contact.normal.dot(contact_velocity(contact, region_.velocity.data()));
        const Real next = memory_.impulse[i] - relaxation * contact.inverse_diagonal * approach;
        return next <= 0 ? 0 : next;  // asked this way round, not-a-number stays
    }
    void refresh(std::span<const Real> impulse, std::span<Vec4> velocity) const {
        for (std::size_t n = 0; n < region_.node.size(); ++n) velocity[n] = padded(region_.free_velocity[region_.node[n]]);
        for (std::size_t i = 0; i < region_.contact.size(); ++i)
            apply_impulse(region_.contact[i], impulse[i] * region_.contact[i].normal, velocity.data());
    }

    const LumpedOperator::Memory& region_;
    const FrictionlessMemory& memory_;
};

}  // namespace

SolveResult solve_frictionless(const LumpedOperator::Memory& region, Real scale, const SolveLimits& limits,
                               const FrictionlessMemory& memory) {
    constexpr Real guard = 2, infinite = std::numeric_limits<Real>::infinity();  // as in solve_ags
    constexpr Index refresh_interval = 64;
    NormalRows rows(region, memory);
    Watchdog watchdog;
    Real momentum = 1, smallest_change = infinite, best = infinite;
    Index check = 1;
    for (Index iteration = 1; iteration <= limits.max_iterations; ++iteration) {
        const SweepChange change = rows.sweep(watchdog.relaxation() * limits.relaxation);
        const bool due = iteration >= check || iteration == limits.max_iterations;
        if (due || change.size <= limits.tolerance * limits.tolerance * scale * scale) {
            const Real size = rows.error(), error = size == 0 ? 0 : size / scale;
            if (error < best || !std::isfinite(error)) rows.keep();
            if (error <= limits.tolerance) return {iteration, error, true};
            if (!std::isfinite(error)) return {iteration, error, false};
            best = std::min(best, error);
            if (iteration >= check) check = next_check(iteration);
        }
        const Real next_momentum = (1 + std::sqrt(1 + 4 * momentum * momentum)) / 2;
        Real extrapolation = (momentum - 1) / next_momentum;
        momentum = next_momentum;
        smallest_change = std::min(smallest_change, change.size);
        const bool was_plain = watchdog.plain();
        watchdog.observe(iteration, change.size);
        if (was_plain || watchdog.plain() || change.against > 0 || change.size > guard * smallest_change) {
            momentum = 1;
            extrapolation = 0;
            smallest_change = change.size;
        }
        if (iteration % refresh_interval == 0) rows.refresh();
        rows.extrapolate(extrapolation);
    }
    rows.restore();
    return {limits.max_iterations, best, false};
}

}  // namespace skerry
