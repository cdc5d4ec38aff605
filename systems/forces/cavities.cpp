#include "systems/forces/cavities.h"

#include <Eigen/Dense>
#include <cmath>
#include <limits>

#include "jobs/parallel_for.h"
#include "jobs/reduce.h"

namespace skerry {

namespace {

constexpr std::size_t faces_per_part = 1024;

/// Twice the area vector of a triangle [m^2].
Vec3 cross_of_edges(const Mat3& x) {
    return (x.col(1) - x.col(0)).cross(x.col(2) - x.col(0));
}

}  // namespace

Vec3 area_of(const Mat3& corners) {
    return cross_of_edges(corners) / 2;
}

Real longest_edge(const Mat3& corners) {
    return std::max({(corners.col(1) - corners.col(0)).norm(), (corners.col(2) - corners.col(1)).norm(),
                     (corners.col(0) - corners.col(2)).norm()});
}

Mat3 CavityInputs::corners_now(std::size_t c, std::size_t f) const {
    const Index first = body_nodes[static_cast<std::size_t>(body[c])].begin;
    Mat3 x;
    for (int k = 0; k < 3; ++k)
        x.col(k) = position[static_cast<std::size_t>(first + face[f][static_cast<std::size_t>(k)])];
    return x;
}

Real CavityInputs::volume_part(std::size_t c, std::size_t f) const {
    const Mat3 x = corners_now(c, f);
    if (closed[c]) {
        const Index first = body_nodes[static_cast<std::size_t>(body[c])].begin;
        const auto origin = static_cast<std::size_t>(first + face[static_cast<std::size_t>(faces[c].begin)].front());
        return -(x.col(0) - position[origin]).dot(cross_of_edges(x)) / 6;
    }
    // Swept volume: time integral of the area vector times the mean velocity of the corners. The corners are assumed to
    // move along straight lines at constant velocity, so the area vector is quadratic in time, and Simpson's rule is
    // exact.
    const Mat3& before = corners[f];
    const Vec3 area = (area_of(before) + 4 * area_of((before + x) / 2) + area_of(x)) / 6;
    return -area.dot((x - before).rowwise().mean());
}

Real CavityInputs::volume(std::size_t c) const {
    Real sum = closed[c] ? 0 : open_volume[c];
    for (auto f = static_cast<std::size_t>(faces[c].begin); f < static_cast<std::size_t>(faces[c].end); ++f)
        sum += volume_part(c, f);
    return sum;
}

CavityFilling CavityInputs::filling(std::size_t c, Real t, Real volume_then) const {
    return {law[c], fluid[c], law[c] == CavityLaw::gas ? mass[c] : value_at(keys_of(c), t), volume_then};
}

Real filling_stiffness(CavityLaw law, const CavityFluid& fluid, Real pressure, Real volume) {
    if (law == CavityLaw::pressure) return 0;
    return (law == CavityLaw::gas ? fluid.exponent * (pressure + fluid.ambient) : fluid.bulk_modulus) / volume;
}

Real mass_of_gas(const CavityFluid& fluid, Real pressure, Real volume) {
    return fluid.density * volume * std::pow((pressure + fluid.ambient) / fluid.ambient, 1 / fluid.exponent);
}

Real CavityFilling::pressure() const {
    if (law == CavityLaw::pressure) return amount;
    if (!(volume > 0)) return std::numeric_limits<Real>::quiet_NaN();
    if (law == CavityLaw::gas) return fluid.ambient * (std::pow(amount / (fluid.density * volume), fluid.exponent) - 1);
    // The liquid is assumed to boil at zero absolute pressure, so its pressure above ambient is never below -ambient.
    return std::max(fluid.bulk_modulus * std::log(amount / volume), -fluid.ambient);
}

Real CavityFilling::pressure_per_mass() const {
    const Real at_ambient = fluid.density * volume;
    return fluid.exponent * fluid.ambient / at_ambient * std::pow(amount / at_ambient, fluid.exponent - 1);
}

Real CavityFilling::energy() const {
    if (law == CavityLaw::pressure) return 0;
    const Real p = pressure();
    if (law == CavityLaw::gas) {
        const Real free = amount / fluid.density;  // volume of the gas at ambient pressure [m^3]
        if (free == 0) return fluid.ambient * volume;
        const Real outer = fluid.ambient * (volume - free);
        if (fluid.exponent == 1) return outer - fluid.ambient * free * std::log(volume / free);
        return outer + ((p + fluid.ambient) * volume - fluid.ambient * free) / (fluid.exponent - 1);
    }
    // Volume above which the liquid boils [m^3].
    const Real most = amount * std::exp(fluid.ambient / fluid.bulk_modulus), v = std::min(volume, most);
    const Real excess = amount / v - 1;  // tiny for a stiff liquid, so log1p() avoids cancellation
    return fluid.bulk_modulus * v * (excess - std::log1p(excess)) + fluid.ambient * (volume - v);
}

bool add_cavity_forces(Executor& executor, const CavityInputs& cavities, Real now, Real lag, Real kick,
                       const CavityOutputs& out) {
    Column<Vec3>& area = out.area;
    if (area.size() != cavities.face.size()) area.resize(cavities.face.size());
    for (std::size_t c = 0; c < cavities.size(); ++c) {
        const auto begin = static_cast<std::size_t>(cavities.faces[c].begin);
        const Real sum = reduce(
            executor, static_cast<std::size_t>(cavities.faces[c].size()), faces_per_part, out.swept_parts, Real(0),
            [&](std::size_t first, std::size_t last) {
                Real part = 0;
                for (std::size_t f = begin + first; f < begin + last; ++f) {
                    area[f] = area_of(cavities.corners_now(c, f));
                    part += cavities.volume_part(c, f);
                }
                return part;
            },
            [](Real a, Real b) { return a + b; });
        out.volume_now[c] = cavities.closed[c] ? sum : cavities.open_volume[c] + sum;
        CavityFilling filling = cavities.filling(c, now, out.volume_now[c]);
        if (filling.law == CavityLaw::pressure) filling.amount = mean_value(cavities.keys_of(c), now - lag, kick);
        const Real third = -filling.pressure() / 3;
        const Index first = cavities.body_nodes[static_cast<std::size_t>(cavities.body[c])].begin;
        for (auto f = begin; f < static_cast<std::size_t>(cavities.faces[c].end); ++f)
            for (const Index n : cavities.face[f])
                out.applied_force[static_cast<std::size_t>(first + n)] += third * area[f];
    }
    return cavities.size() > 0;
}

namespace {

/// State of the gas at one end of a pipe. The end is in a cavity or in a reservoir of prescribed pressure.
struct PipeEnd {
    Real pressure;       // above ambient [Pa]
    Real per_mass;       // derivative of the pressure by the mass [Pa/kg]; 0 for a reservoir
    std::size_t cavity;  // row of CavityTable
    bool is_cavity;
};

/// Power of a pressure of 1 Pa on the faces of a cavity [W/Pa]. area(f): area vector of face f [m^2]. velocity(n):
/// velocity of node n [m/s].
Real power_per_pressure(const CavityInputs& cavities, std::size_t c, auto&& area, auto&& velocity) {
    const Index first = cavities.body_nodes[static_cast<std::size_t>(cavities.body[c])].begin;
    Real sum = 0;
    for (auto f = static_cast<std::size_t>(cavities.faces[c].begin);
         f < static_cast<std::size_t>(cavities.faces[c].end); ++f) {
        Vec3 of_corners = Vec3::Zero();
        for (const Index n : cavities.face[f]) of_corners += velocity(static_cast<std::size_t>(first + n));
        sum -= area(f).dot(of_corners) / 3;
    }
    return sum;
}

/// Velocity of a node now, or 0 if the node is held.
auto free_velocity(const CavityWorkInputs& step) {
    return [&step](std::size_t n) -> Vec3 { return step.free.contain(n) ? step.velocity[n] : Vec3(Vec3::Zero()); };
}

/// True if this rank counts the energy of the cavity.
bool has_energy(const CavityInputs& cavities, const CavityWorkInputs& step, std::size_t c) {
    return cavities.law[c] != CavityLaw::pressure && !step.ghosts.contain(cavities.body[c]);
}

std::size_t row_of_slot(const HandleMap<CavityHandle>& map, std::uint32_t slot) {
    return static_cast<std::size_t>(map.row(map.handle_of_slot(slot)));
}

PipeEnd end_at(const CavityInputs& cavities, std::size_t c, std::span<const Real> mass, Real volume) {
    const CavityFilling gas{CavityLaw::gas, cavities.fluid[c], mass[c], volume};
    return {gas.pressure(), gas.pressure_per_mass(), c, true};
}

/// Mass that flows from the first to the second end in the time `h` [kg]. The mass flow is conductance times pressure
/// difference. The result is exact if both pressures are linear in mass: the difference then decays exponentially.
Real flow_between(const PipeEnd& first, const PipeEnd& second, Real conductance, Real h) {
    const Real decay = conductance * (first.per_mass + second.per_mass) * h;
    const Real share = decay > 0 ? -std::expm1(-decay) / decay : Real(1);
    return conductance * (first.pressure - second.pressure) * h * share;
}

}  // namespace

Real store_cavities(const CavityInputs& cavities, const PipeInputs& pipes, const HandleMap<CavityHandle>& cavity_map,
                    const CavityWorkInputs& step, Real t, Real h, const CavityMemory& out) {
    const std::span<const Real> volume_now = step.volume_now;
    Real added = 0;  // energy added to the fillings [J]
    const auto change = [&](std::size_t c, CavityFilling filling, Real amount) {
        if (amount == filling.amount || !has_energy(cavities, step, c)) return;
        // Mean of the values for the volumes before and after the step.
        for (const Real volume : {volume_now[c], cavities.volume(c)}) {
            filling.volume = volume;
            CavityFilling changed = filling;
            changed.amount = amount;
            added += (changed.energy() - filling.energy()) / 2;
        }
    };
    const auto set_mass = [&](std::size_t c, Real mass) {
        change(c, cavities.filling(c, t, volume_now[c]), mass);
        out.mass[c] = mass;
    };
    for (std::size_t c = 0; c < cavities.size(); ++c) {
        const CavityLaw law = cavities.law[c];
        const CavityFilling filling = cavities.filling(c, t, volume_now[c]);
        out.pressure_now[c] = filling.pressure();
        if (law == CavityLaw::pressure) continue;
        out.power[c] =
            out.pressure_now[c] * power_per_pressure(
                                      cavities, c, [&](std::size_t f) { return step.area[f]; }, free_velocity(step));
        if (law == CavityLaw::gas)
            set_mass(c, std::max(out.mass[c] + h * mean_value(cavities.keys_of(c), t, h), Real(0)));
        if (law == CavityLaw::liquid) change(c, filling, value_at(cavities.keys_of(c), t + h));
        if (cavities.closed[c]) continue;
        out.volume[c] = cavities.volume(c);
        for (auto f = static_cast<std::size_t>(cavities.faces[c].begin);
             f < static_cast<std::size_t>(cavities.faces[c].end); ++f)
            out.corners[f] = cavities.corners_now(c, f);
    }
    for (std::size_t p = 0; p < pipes.size(); ++p) {
        const std::size_t a = row_of_slot(cavity_map, pipes.first[p]), b = row_of_slot(cavity_map, pipes.second[p]);
        const bool to_reservoir = pipes.keys[p].size() > 0;
        const PipeEnd first = end_at(cavities, a, out.mass, volume_now[a]),
                      second = to_reservoir ? PipeEnd{mean_value(pipes.keys_of(p), t, h), 0, b, false}
                                            : end_at(cavities, b, out.mass, volume_now[b]);
        const Real moved = flow_between(first, second, pipes.conductance[p], h);
        out.flow[p] = moved / h;
        set_mass(a, out.mass[a] - moved);
        if (!to_reservoir) set_mass(b, out.mass[b] + moved);
    }
    return added;
}

Real measure_cavities(const CavityInputs& cavities, const CavityWorkInputs& step, Real t, Real h, Real lag) {
    const auto area = [&](std::size_t f) { return step.area[f]; };
    const auto during = [&](std::size_t n) -> Vec3 {
        const Vec3& next = step.velocity_next[n];
        return lag == 0 && step.free.contain(n) ? Vec3((step.velocity[n] + next) / 2) : next;
    };
    Real work = 0;
    for (std::size_t c = 0; c < cavities.size(); ++c) {
        if (!has_energy(cavities, step, c)) continue;
        const Real p = cavities.filling(c, t, step.volume_now[c]).pressure();
        work += h * p * power_per_pressure(cavities, c, area, during);
        if (lag != 0) work += lag * (p * power_per_pressure(cavities, c, area, free_velocity(step)) - step.power[c]);
    }
    return work;
}

Real cavity_energy(const CavityInputs& cavities, const CavityWorkInputs& last, Real t, Real lag) {
    Real sum = 0;
    for (std::size_t c = 0; c < cavities.size(); ++c) {
        if (!has_energy(cavities, last, c)) continue;
        const CavityFilling filling = cavities.filling(c, t, cavities.volume(c));
        sum += filling.energy();
        if (lag == 0) continue;
        const auto area = [&](std::size_t f) { return area_of(cavities.corners_now(c, f)); };
        sum += lag * (filling.pressure() * power_per_pressure(cavities, c, area, free_velocity(last)) - last.power[c]);
    }
    return sum;
}

bool mark_filled(const CavityInputs& cavities, const PipeInputs& pipes, const HandleMap<CavityHandle>& cavity_map,
                 Real t, Real h, std::span<std::uint8_t> marked) {
    // If the pressures at both ends of a pipe differ by at most this fraction of the sum of both absolute pressures,
    // the flow keeps no bodies awake.
    constexpr Real still_share = 1e-9;
    bool any = false;
    const auto mark = [&](Index body) {
        any = true;
        if (!marked.empty() && body != no_index) marked[static_cast<std::size_t>(body)] = 1;
    };
    for (std::size_t c = 0; c < cavities.size(); ++c) {
        const std::span<const TimeKey> keys = cavities.keys_of(c);
        if (changes(keys, t, h) || (cavities.law[c] == CavityLaw::gas && value_at(keys, t) != 0))
            mark(cavities.body[c]);
    }
    for (std::size_t p = 0; p < pipes.size(); ++p) {
        const std::size_t a = row_of_slot(cavity_map, pipes.first[p]), b = row_of_slot(cavity_map, pipes.second[p]);
        const auto pressure = [&](std::size_t c) {
            return end_at(cavities, c, cavities.mass, cavities.volume(c)).pressure;
        };
        const bool to_reservoir = pipes.keys[p].size() > 0;
        const Real first = pressure(a), second = to_reservoir ? value_at(pipes.keys_of(p), t) : pressure(b);
        const Real size = first + second + 2 * cavities.fluid[a].ambient;
        if (!(pipes.conductance[p] > 0)) continue;
        if (!(std::abs(first - second) > still_share * size) && !(to_reservoir && changes(pipes.keys_of(p), t, h)))
            continue;
        mark(pipes.first_body[p]);
        mark(pipes.second_body[p]);
    }
    return any;
}

}  // namespace skerry
