#include "systems/dynamics/clusters/find_implicit_elements.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "systems/dynamics/clusters/build_clusters.h"
#include "systems/dynamics/clusters/implicit_elements.h"
#include "systems/dynamics/elements/element_block.h"
#include "systems/dynamics/stability/stiffness_share.h"

namespace skerry {

namespace {

/// Calls visit(block, lane) for every element of the given blocks.
template <class Visit>
void for_each_element(const ElementInputs& elements, Range blocks, Visit&& visit) {
    for (auto b = static_cast<std::size_t>(blocks.begin); b < static_cast<std::size_t>(blocks.end); ++b)
        for (std::size_t l = 0; l < element_lanes; ++l)
            if (elements.volume[b][l] > 0) visit(b, l);
}

/// Rows of NodeTable of the nodes of all elements in the given blocks, ascending.
std::vector<Index> nodes_of(const ElementInputs& elements, Range blocks) {
    Index last = 0, first = std::numeric_limits<Index>::max();
    const auto for_each_node = [&](auto&& visit) {
        for_each_element(elements, blocks, [&](std::size_t b, std::size_t l) {
            const BlockNodes block_nodes = elements.nodes_of(b);
            for (Index k = 0; k < block_nodes.count; ++k) visit(block_nodes.node[k][l]);
        });
    };
    for_each_node([&](Index n) {
        first = std::min(first, n);
        last = std::max(last, n);
    });
    std::vector<std::uint8_t> is_used(static_cast<std::size_t>(std::max(last - first + 1, Index(0))));
    for_each_node([&](Index n) { is_used[static_cast<std::size_t>(n - first)] = 1; });
    std::vector<Index> nodes;
    for (std::size_t n = 0; n < is_used.size(); ++n)
        if (is_used[n]) nodes.push_back(first + static_cast<Index>(n));
    return nodes;
}

/// Least principal moment of inertia of the given nodes of a body about their centre of mass [kg m^2].
Real least_moment(std::span<const Index> nodes, std::span<const Vec3> position, std::span<const Real> mass) {
    Real total = 0;
    Vec3 center = Vec3::Zero();
    for (const Index n : nodes) {
        total += mass[static_cast<std::size_t>(n)];
        center += mass[static_cast<std::size_t>(n)] * position[static_cast<std::size_t>(n)];
    }
    center /= total;
    Mat3 second = Mat3::Zero();
    for (const Index n : nodes) {
        const Vec3 x = position[static_cast<std::size_t>(n)] - center;
        second += mass[static_cast<std::size_t>(n)] * x * x.transpose();
    }
    return least_moment_of(second);
}

/// Moment of inertia that an implicit element adds in a rigid rotation about any axis [kg m^2]. It is 2 beta c V, with
/// the assumed modulus c, the volume V, and beta = inertia_factor(step). The reason: the velocity field w x r of the
/// angular velocity w adds the kinetic energy beta c V |grad(w x r)|^2 / 2 = beta c V |w|^2.
Real added_moment(Real step, Real modulus, Real volume) {
    return 2 * inertia_factor(step) * modulus * volume;
}

constexpr Real max_volume_fraction = 0.75;  // largest fraction of the volume of a body that may be implicit

}  // namespace

ImplicitSearch::ImplicitSearch(const ElementInputs& elements, Range blocks, std::span<const Vec3> position,
                               std::span<const Real> mass, std::span<Real> stiffness_sum, const ImplicitOutputs& out,
                               const ElementBounds& bounds)
    : elements_(elements),
      blocks_(blocks),
      position_(position),
      mass_(mass),
      stiffness_sum_(stiffness_sum),
      out_(out),
      bounds_(bounds),
      nodes_(nodes_of(elements, blocks)),
      least_moment_(least_moment(nodes_, position, mass)),
      frequency_(out.mass_share.size()) {
    if (!nodes_.empty()) first_node_ = nodes_.front();
    bounds_.lone_frequencies(elements, blocks, position, mass, frequency_);
}

void ImplicitSearch::prepare() {
    const std::size_t rows = frequency_.size(),
                      count = nodes_.empty() ? 0 : static_cast<std::size_t>(nodes_.back() - first_node_) + 1;
    marks_.resize(count);  // indexed by row of NodeTable minus first_node_; some rows may be unused
    sum_.resize(count);
    ratio_.resize(count);
    for (std::vector<ElementLane>* column :
         {&stiffness_, &weight_per_share_, &step_, &measured_step_, &measured_trace_})
        column->resize(rows);
    list_incidences();
    bounds_.stiffnesses(elements_, blocks_, position_, stiffness_);
    for (std::size_t row = 0; row < rows; ++row) {
        const std::size_t b = row + static_cast<std::size_t>(blocks_.begin);
        store(stiffness_weight(elements_, b, deformation_of(elements_, b, position_)), weight_per_share_[row]);
        for (std::size_t l = 0; l < element_lanes; ++l)
            if (out_.mass_share[row][l] > 0) weight_per_share_[row][l] /= out_.mass_share[row][l];
    }
}

Real ImplicitSearch::needed_fraction(std::size_t b, std::size_t l, Real step) const {
    return frequency_[row(b)][l] * step * step / (step_times_frequency * step_times_frequency);
}

void ImplicitSearch::list_incidences() {
    std::size_t max_incidences = 0;
    for (Index b = blocks_.begin; b < blocks_.end; ++b)
        max_incidences +=
            element_lanes * static_cast<std::size_t>(elements_.nodes_of(static_cast<std::size_t>(b)).count);
    incidences_.reserve(max_incidences);
    for (auto b = static_cast<std::size_t>(blocks_.begin); b < static_cast<std::size_t>(blocks_.end); ++b) {
        const BlockNodes nodes = elements_.nodes_of(b);
        for (Index k = 0; k < nodes.count; ++k)
            for (std::size_t l = 0; l < element_lanes; ++l) {
                const Real x = nodes.gradient[k][0][l], y = nodes.gradient[k][1][l], z = nodes.gradient[k][2][l];
                const Real size = x * x + y * y + z * z;
                if (size > 0)
                    incidences_.push_back(
                        {nodes.node[k][l] - first_node_, static_cast<Index>(row(b) * element_lanes + l), size});
            }
    }
}

void ImplicitSearch::find_trace(std::vector<ElementLane>& trace) {
    for (std::size_t n = 0; n < sum_.size(); ++n) {
        const Real mass = mass_[n + static_cast<std::size_t>(first_node_)];
        ratio_[n] = mass > 0 ? sum_[n] / mass : 0;
    }
    std::ranges::fill(trace, ElementLane{});
    for (const Incidence& incidence : incidences_)
        lane_value(trace, incidence.element) += ratio_[static_cast<std::size_t>(incidence.node)];
    for (std::size_t row = 0; row < trace.size(); ++row)
        for (std::size_t l = 0; l < element_lanes; ++l) {
            const Real share = out_.mass_share[row][l];
            trace[row][l] = share > 0 && trace[row][l] > 0 ? trace[row][l] / share : 1;
        }
}

void ImplicitSearch::measure() {
    bounds_.steps(elements_, blocks_, position_, mass_, stiffness_sum_, step_);
    measured_step_ = step_;
    for (const Index n : nodes_)
        sum_[static_cast<std::size_t>(n - first_node_)] = stiffness_sum_[static_cast<std::size_t>(n)];
    find_trace(measured_trace_);
    step_is_rigorous_ = true;
}

void ImplicitSearch::estimate() {
    weight_.resize(weight_per_share_.size());
    for (std::size_t row = 0; row < weight_per_share_.size(); ++row)
        for (std::size_t l = 0; l < element_lanes; ++l)
            weight_[row][l] = out_.mass_share[row][l] * weight_per_share_[row][l];
    std::ranges::fill(sum_, Real(0));
    for (const Incidence& incidence : incidences_)
        sum_[static_cast<std::size_t>(incidence.node)] += lane_value(weight_, incidence.element) * incidence.size;
    present_trace_.resize(measured_trace_.size());
    find_trace(present_trace_);
    for (std::size_t row = 0; row < step_.size(); ++row)
        for (std::size_t l = 0; l < element_lanes; ++l)
            step_[row][l] = measured_step_[row][l] * std::sqrt(measured_trace_[row][l] / present_trace_[row][l]);
    step_is_rigorous_ = false;
}

void ImplicitSearch::mark(std::size_t b, std::size_t l, std::uint8_t bits) {
    const BlockNodes nodes = elements_.nodes_of(b);
    for (Index k = 0; k < nodes.count; ++k) marks_[static_cast<std::size_t>(nodes.node[k][l] - first_node_)] |= bits;
}

std::uint8_t ImplicitSearch::marks_of(std::size_t b, std::size_t l) const {
    const BlockNodes nodes = elements_.nodes_of(b);
    std::uint8_t any = 0, all = 0xff;
    for (Index k = 0; k < nodes.count; ++k) {
        const std::uint8_t marks = marks_[static_cast<std::size_t>(nodes.node[k][l] - first_node_)];
        any |= marks;
        all &= marks;
    }
    return static_cast<std::uint8_t>((any & near_unstable) | (all & near_implicit));
}

void ImplicitSearch::make_unstable_implicit(Real step) {
    constexpr Real reduction = 0.7;
    std::ranges::fill(marks_, std::uint8_t(0));
    for_each_element(elements_, blocks_, [&](std::size_t b, std::size_t l) {
        if (share(b, l) == 0)
            mark(b, l, near_implicit);
        else if (step_[row(b)][l] < step)
            mark(b, l, near_unstable);
    });
    bool any_added = false;
    for_each_element(elements_, blocks_, [&](std::size_t b, std::size_t l) {
        if (share(b, l) == 0) return;
        const std::uint8_t marks = marks_of(b, l);
        if (!(marks & near_unstable)) return;
        if (needed_fraction(b, l, step) < min_needed_fraction_ && !(marks & near_implicit)) return;
        share(b, l) = 0;
        any_added = true;
    });
    if (!any_added) min_needed_fraction_ *= reduction;
}

ImplicitShare ImplicitSearch::add_implicit(const ImplicitGoal& goal) {
    Real volume = 0, implicit_volume = 0, added = 0;  // volumes [m^3]; moment of inertia [kg m^2]
    for_each_element(elements_, blocks_, [&](std::size_t b, std::size_t l) {
        volume += elements_.volume[b][l];
        if (share(b, l) != 0) return;
        implicit_volume += elements_.volume[b][l];
        Real& modulus = out_.modulus[row(b)][l];
        modulus = goal.stiffness_ratio * stiffness_[row(b)][l];
        added += added_moment(goal.step, modulus, elements_.volume[b][l]);
    });
    ImplicitShare result{.moment = added > 0 ? added / least_moment_ : 0,
                         .too_many = implicit_volume > max_volume_fraction * volume};
    if (goal.max_nodes > 0 && !result.too_many)
        result.too_many = cluster_sizes(elements_, blocks_, out_.modulus, goal.inverse_mass).largest > goal.max_nodes;
    return result;
}

Real ImplicitSearch::estimate_volume(Real stable) const {
    struct Demand {
        Real mass, volume;  // mass that makes an element stable [kg], and its volume [m^3]
    };
    std::vector<Demand> demands;
    Demand sum{0, 0};
    for_each_element(elements_, blocks_, [&](std::size_t b, std::size_t l) {
        const BlockNodes nodes = elements_.nodes_of(b);
        Real mass = 0;
        for (Index k = 0; k < nodes.count_in_lane(l); ++k) mass += mass_[static_cast<std::size_t>(nodes.node[k][l])];
        demands.push_back({needed_fraction(b, l, stable) * mass, elements_.volume[b][l]});
        sum.mass += demands.back().mass;
        sum.volume += demands.back().volume;
    });
    Real missing_mass = sum.mass, implicit = 0;  // lacking mass [kg]; volume [m^3]
    for (const Index n : nodes_) missing_mass -= mass_[static_cast<std::size_t>(n)];
    if (!(missing_mass > 0)) return 0;
    // The elements that need the most mass for their volume become implicit first.
    std::ranges::sort(demands, [](const Demand& a, const Demand& b) { return a.mass * b.volume > b.mass * a.volume; });
    for (std::size_t i = 0; i < demands.size() && missing_mass > 0; ++i) {
        missing_mass -= demands[i].mass;
        implicit += demands[i].volume;
    }
    return implicit / sum.volume;
}

ImplicitShare ImplicitSearch::find(const ImplicitGoal& goal) {
    // Every round changes the mass shares. Every fourth round also makes elements implicit; the other rounds let the
    // mass shares adapt to this. Most rounds only estimate the stable steps. The rigorous bound is computed
    // - in the rounds 1, 25, 49 and so on,
    // - after an estimate by which all elements are stable, to confirm this estimate.
    constexpr int rounds_of_sharing = 4;
    constexpr int rounds_of_estimates = 24;
    // Largest factor by which a mass share may change in one round. Without this limit, an element that stays unstable
    // would take the masses of its neighbours.
    constexpr Real max_change = 4;
    start_mass_shares(elements_, blocks_, out_.mass_share);
    if (step_.empty()) prepare();
    std::ranges::fill(out_.modulus, ElementLane{});
    min_needed_fraction_ = 1;
    for_each_element(elements_, blocks_, [&](std::size_t b, std::size_t l) {
        // An element that would be unstable even with the full masses of its nodes gets no mass share, which makes it
        // implicit.
        if (needed_fraction(b, l, goal.stable) > 1) share(b, l) = 0;
    });
    ImplicitShare found = add_implicit(goal);
    bool all_stable = false;
    for (int round = 1;; ++round) {
        // Implicit elements stay implicit, so later rounds cannot reduce their volume, moment of inertia or clusters.
        if (found.too_many || !(found.moment <= goal.max_moment)) return found;
        if (round % rounds_of_estimates == 1 || all_stable)
            measure();
        else
            estimate();
        Real shortest = infinity;  // s
        for_each_element(elements_, blocks_,
                         [&](std::size_t b, std::size_t l) { shortest = std::min(shortest, step_[row(b)][l]); });
        all_stable = !(shortest < goal.stable);
        if (all_stable && step_is_rigorous_) break;
        if (all_stable) continue;  // the next round confirms the estimate by the rigorous bound
        if (round % rounds_of_sharing == 0) {
            make_unstable_implicit(goal.stable);
            found = add_implicit(goal);
        }
        for_each_element(elements_, blocks_, [&](std::size_t b, std::size_t l) {
            share(b, l) *= std::clamp(goal.stable / step_[row(b)][l], 1 / max_change, max_change);
        });
    }
    return found;
}

ImplicitShare add_implicit_elements(const ElementInputs& elements, Range blocks, std::span<const Vec3> position,
                                    std::span<const Real> mass, const ImplicitGoal& goal, std::span<Real> stiffness_sum,
                                    const ImplicitOutputs& out, const ElementBounds& bounds) {
    const auto first = static_cast<std::size_t>(blocks.begin);
    std::vector<ElementLane> step(out.mass_share.size());
    // The mass share of an element that becomes implicit passes to explicit elements, which changes their stable steps.
    // So the loop runs until no further element becomes implicit.
    for (bool any_added = true; any_added;) {
        bounds.steps(elements, blocks, position, mass, stiffness_sum, step);
        any_added = false;
        Real volume = 0, implicit = 0;  // m^3
        for_each_element(elements, blocks, [&](std::size_t b, std::size_t l) {
            Real& share = out.mass_share[b - first][l];
            if (step[b - first][l] < goal.stable) {
                share = 0;
                any_added = true;
            }
            volume += elements.volume[b][l];
            if (share == 0) implicit += elements.volume[b][l];
        });
        if (implicit > max_volume_fraction * volume) return {.too_many = true};
    }
    Real added = 0;
    LaneQuaternion<Real8> q{Real8{} + 1.0, {}, {}, {}};
    for (auto b = first; b < static_cast<std::size_t>(blocks.end); ++b) {
        const Real8 stiffness = stiffness_of(elements, b, deformation_of(elements, b, position), q);
        for (std::size_t l = 0; l < element_lanes; ++l) {
            if (!(elements.volume[b][l] > 0) || out.mass_share[b - first][l] != 0) continue;
            Real& modulus = out.modulus[b - first][l];
            if (!(modulus > stiffness[l])) modulus = goal.stiffness_ratio * stiffness[l];
            added += added_moment(goal.step, modulus, elements.volume[b][l]);
        }
    }
    return {.moment = added > 0 ? added / least_moment(nodes_of(elements, blocks), position, mass) : 0};
}

}  // namespace skerry
