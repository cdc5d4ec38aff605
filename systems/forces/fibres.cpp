#include "systems/forces/fibres.h"

#include <algorithm>
#include <cmath>

#include "jobs/parallel_for.h"

namespace skerry {

namespace {

/// Calls visit(row, t) for each tetrahedron t of each family of fibres, in order.
void for_each_tetrahedron(const FibreInputs& fibres, auto&& visit) {
    for (std::size_t row = 0; row < fibres.size(); ++row)
        for (auto t = static_cast<std::size_t>(fibres.tetrahedra[row].begin);
             t < static_cast<std::size_t>(fibres.tetrahedra[row].end); ++t)
            visit(row, t);
}

std::span<const TimeKey> keys_of_tension(const FibreInputs& fibres, std::size_t row) {
    return rows_of(fibres.key, fibres.tension_keys[row]);
}

Real free_part(const FreeNodes& free, std::size_t n) {
    return free.contain(n) ? 1 : 0;
}

}  // namespace

Real FibreLaw::energy(Real square) const {
    const Real strain = std::max(square - 1, Real{0});
    if (exponent == 0) return stiffness / 2 * strain * strain;
    return stiffness / (2 * exponent) * std::expm1(exponent * strain * strain);
}

FibrePull FibreLaw::pull(const Vec3& y, Real tension) const {
    const Real square = y.squaredNorm(), strain = std::max(square - 1, Real{0});
    FibrePull pull;
    pull.passive = 2 * stiffness * strain * std::exp(exponent * strain * strain) * y;
    pull.whole = pull.passive + tension / std::max(std::sqrt(square), least_stretch) * y;
    return pull;
}

Real FibreLaw::stiffness_bound(const Vec3& y, Real tension) const {
    const Real square = y.squaredNorm(), strain = std::max(square - 1, Real{0});
    const Real factor = stiffness * std::exp(exponent * strain * strain);
    // Derivative of the stress vector by y:
    //     2 factor strain I + 4 factor (1 + 2 exponent strain^2) y y^T + (tension/|y|) (I - y y^T/|y|^2)
    // The second term acts only along y, the third only across it.
    // For slack fibres `square` is taken as 1, because their stiffness jumps as soon as they are stretched.
    const Real along = 4 * factor * (1 + 2 * exponent * strain * strain) * std::max(square, Real{1});
    return 2 * factor * strain + std::max(along, tension / std::max(std::sqrt(square), least_stretch));
}

bool add_fibre_forces(Executor& executor, const FibreInputs& fibres, const ForceIntervals& intervals,
                      std::span<FibrePull> next, std::span<Vec3> applied_force) {
    constexpr std::size_t tetrahedra_per_block = 512;
    for (std::size_t row = 0; row < fibres.size(); ++row) {
        const bool implicit = fibres.body_implicit[static_cast<std::size_t>(fibres.fibre_body[row])].size() > 0;
        const std::span<const TimeKey> keys = keys_of_tension(fibres, row);
        const Real tension = implicit ? mean_value(keys, intervals.begin_implicit, intervals.length_implicit)
                                      : mean_value(keys, intervals.begin, intervals.length);
        const FibreLaw law = fibres.law(row);
        const auto first = static_cast<std::size_t>(fibres.tetrahedra[row].begin);
        parallel_for(executor, static_cast<std::size_t>(fibres.tetrahedra[row].size()), tetrahedra_per_block,
                     [&](std::size_t begin, std::size_t end) {
                         for (std::size_t t = first + begin; t < first + end; ++t)
                             next[t] = law.pull(fibres.stretched(row, t), tension);
                     });
    }
    for_each_tetrahedron(fibres, [&](std::size_t row, std::size_t t) {
        const Vec3 pull = -fibres.volume[t] * next[t].whole;
        Vec3 others = Vec3::Zero();
        for (std::size_t c = 1; c < 4; ++c) {
            const Vec3 force = fibres.slope[t][c] * pull;
            applied_force[fibres.node_of(row, t, c)] += force;
            others += force;
        }
        applied_force[fibres.node_of(row, t, 0)] -= others;
    });
    return !next.empty();
}

bool mark_activated(const FibreInputs& fibres, Real t, Real h, std::span<std::uint8_t> marked) {
    bool any = false;
    for (std::size_t row = 0; row < fibres.size(); ++row) {
        if (!changes(keys_of_tension(fibres, row), t, h)) continue;
        any = true;
        if (!marked.empty()) marked[static_cast<std::size_t>(fibres.fibre_body[row])] = 1;
    }
    return any;
}

Real measure_fibres(const FibreInputs& fibres, const FibreWorkInputs& step, Real h, Real lag) {
    const auto during = [&](std::size_t n) -> Vec3 {
        const Vec3& next = step.velocity_next[n];
        return lag == 0 && step.free.contain(n) ? Vec3((fibres.velocity[n] + next) / 2) : next;
    };
    const auto before = [&](std::size_t n) -> Vec3 { return free_part(step.free, n) * fibres.velocity[n]; };
    Real work = 0;
    for_each_tetrahedron(fibres, [&](std::size_t row, std::size_t t) {
        if (fibres.ghosts.contain(fibres.fibre_body[row])) return;
        const Vec3& passive = step.next[t].passive;
        Real density = h * passive.dot(fibres.along(row, t, during));
        if (lag != 0) density += lag * (passive - step.passive_before[t]).dot(fibres.along(row, t, before));
        work -= fibres.volume[t] * density;
    });
    return work;
}

Real fibre_energy(const FibreInputs& fibres, const FibreWorkInputs& last, Real lag) {
    const auto velocity = [&](std::size_t n) -> Vec3 { return free_part(last.free, n) * fibres.velocity[n]; };
    Real energy = 0;
    for_each_tetrahedron(fibres, [&](std::size_t row, std::size_t t) {
        if (fibres.ghosts.contain(fibres.fibre_body[row])) return;
        const Vec3 y = fibres.stretched(row, t);
        const FibreLaw law = fibres.law(row);
        Real density = law.energy(y.squaredNorm());
        if (lag != 0)
            density -= lag * (law.pull(y, 0).passive - last.passive_before[t]).dot(fibres.along(row, t, velocity));
        energy += fibres.volume[t] * density;
    });
    return energy;
}

bool keep_fibre_stress(std::span<const FibrePull> next, std::span<Vec3> passive) {
    for (std::size_t t = 0; t < next.size(); ++t) passive[t] = next[t].passive;
    return !next.empty();
}

}  // namespace skerry
