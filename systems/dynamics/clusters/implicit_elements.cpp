#include "systems/dynamics/clusters/implicit_elements.h"

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>
#include <vector>

#include "systems/dynamics/elements/element_block.h"
#include "systems/dynamics/stability/stable_step.h"
#include "systems/dynamics/stability/stiffness_share.h"

namespace skerry {

namespace {

LaneQuaternion<Real8> no_turn() {
    const Real8 one = Real8{} + 1.0, zero{};
    return {one, zero, zero, zero};
}

/// Calls visit(block, lane) for every element of the range.
template <class Visit>
void for_each_element(const ElementInputs& elements, Range blocks, Visit&& visit) {
    for (auto b = static_cast<std::size_t>(blocks.begin); b < static_cast<std::size_t>(blocks.end); ++b)
        for (std::size_t l = 0; l < element_lanes; ++l)
            if (elements.volume[b][l] > 0) visit(b, l);
}

/// kg m^2, the least moment of inertia of the nodes that the elements have.
Real least_moment(const ElementInputs& elements, Range blocks, std::span<const Vec3> position,
                  std::span<const Real> mass) {
    std::vector<Index> nodes;
    for_each_element(elements, blocks, [&](std::size_t b, std::size_t l) {
        const BlockNodes of = elements.nodes_of(b);
        for (Index k = 0; k < of.count; ++k) nodes.push_back(of.node[k][l]);
    });
    std::ranges::sort(nodes);
    nodes.erase(std::unique(nodes.begin(), nodes.end()), nodes.end());
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
    const Vec3 spread = Eigen::SelfAdjointEigenSolver<Mat3>(second, Eigen::EigenvaluesOnly).eigenvalues();
    return spread[0] + spread[1];
}

/// Steps that the elements of a body stand in one shape, while their masses are shared this way and that. The bound is
/// 9x9 matrices; how it changes with the masses follows that of the trace of sum_k g_k g_k^T / m_k closely, which is
/// one product a node.
class SharedSteps {
public:
    SharedSteps(const ElementInputs& elements, Range blocks, std::span<const Vec3> position, std::span<const Real> mass,
                std::span<Real> stiffness_sum)
        : elements_(elements),
          blocks_(blocks),
          position_(position),
          mass_(mass),
          stiffness_sum_(stiffness_sum),
          step_(static_cast<std::size_t>(blocks.size())),
          measured_(step_.size()),
          trace_(step_.size()),
          unit_(step_.size()) {}

    Real of(std::size_t b, std::size_t l) const { return step_[row(b)][l]; }
    bool is_exact() const { return exact_; }

    /// By the bound.
    void measure() {
        element_steps(elements_, blocks_, position_, mass_, stiffness_sum_, step_);
        measured_ = step_;
        for_each_block([&](std::size_t b) {
            trace_[row(b)] = trace_of(b);
            if (!unit_known_) unit_[row(b)] = unit_weight(b);
        });
        unit_known_ = exact_ = true;
    }
    /// From what was measured last.
    void estimate() {
        for_each_block([&](std::size_t b) { clear_stiffness(elements_, b, stiffness_sum_); });
        for_each_block([&](std::size_t b) { add_stiffness_of(b); });
        for_each_block([&](std::size_t b) {
            const ElementLane trace = trace_of(b);
            for (std::size_t l = 0; l < element_lanes; ++l)
                step_[row(b)][l] = measured_[row(b)][l] * std::sqrt(trace_[row(b)][l] / trace[l]);
        });
        exact_ = false;
    }

private:
    std::size_t row(std::size_t b) const { return b - static_cast<std::size_t>(blocks_.begin); }
    template <class Visit>
    void for_each_block(Visit&& visit) const {
        for (auto b = static_cast<std::size_t>(blocks_.begin); b < static_cast<std::size_t>(blocks_.end); ++b) visit(b);
    }
    /// What elements weigh (stiffness_weight), over their shares.
    ElementLane unit_weight(std::size_t b) const {
        ElementLane unit;
        store(stiffness_weight(elements_, b, deformation_of(elements_, b, position_)), unit);
        for (std::size_t l = 0; l < element_lanes; ++l) {
            const Real share = elements_.mass_share[b][l];
            unit[l] = share > 0 ? unit[l] / share : 0;
        }
        return unit;
    }
    void add_stiffness_of(std::size_t b) {
        const BlockNodes nodes = elements_.nodes_of(b);
        const Real8 weight = load(elements_.mass_share[b]) * load(unit_[row(b)]);
        for (Index k = 0; k < nodes.count; ++k) {
            const LaneVec3<Real8> g = load_gradient(nodes.gradient[k]);
            const Real8 stiffness = weight * dot(g, g);
            for (std::size_t l = 0; l < element_lanes; ++l)
                stiffness_sum_[static_cast<std::size_t>(nodes.node[k][l])] += stiffness[l];
        }
    }
    /// Of elements that share masses, but for a factor that stays what it is while the shape does.
    ElementLane trace_of(std::size_t b) const {
        const BlockNodes nodes = elements_.nodes_of(b);
        ElementLane sum{};
        for (Index k = 0; k < nodes.count; ++k) {
            const LaneVec3<Real8> g = load_gradient(nodes.gradient[k]);
            const Real8 size = dot(g, g);
            for (std::size_t l = 0; l < element_lanes; ++l) {
                const auto n = static_cast<std::size_t>(nodes.node[k][l]);
                if (size[l] > 0 && mass_[n] > 0) sum[l] += stiffness_sum_[n] / mass_[n];
            }
        }
        for (std::size_t l = 0; l < element_lanes; ++l) {
            const Real share = elements_.mass_share[b][l];
            sum[l] = share > 0 && sum[l] > 0 ? sum[l] / share : 1;
        }
        return sum;
    }

    const ElementInputs& elements_;
    Range blocks_;
    std::span<const Vec3> position_;
    std::span<const Real> mass_;
    std::span<Real> stiffness_sum_;
    std::vector<ElementLane> step_, measured_, trace_, unit_;  // by block
    bool exact_ = false, unit_known_ = false;
};

/// Which nodes of a body some of its elements have.
class NodeMarks {
public:
    NodeMarks(const ElementInputs& elements, Range blocks) : elements_(elements) {
        Index last = 0;
        first_ = std::numeric_limits<Index>::max();
        for_each_element(elements, blocks, [&](std::size_t b, std::size_t l) {
            const BlockNodes nodes = elements.nodes_of(b);
            for (Index k = 0; k < nodes.count; ++k) {
                first_ = std::min(first_, nodes.node[k][l]);
                last = std::max(last, nodes.node[k][l]);
            }
        });
        marked_.resize(static_cast<std::size_t>(std::max(last - first_ + 1, Index(0))));
    }

    void clear() { std::ranges::fill(marked_, std::uint8_t(0)); }
    void mark(std::size_t b, std::size_t l) {
        for_each_node(b, l, [&](std::uint8_t& of) { of = 1; });
    }
    bool any(std::size_t b, std::size_t l) { return count(b, l) > 0; }
    bool all(std::size_t b, std::size_t l) { return count(b, l) == elements_.nodes_of(b).count; }

private:
    template <class Visit>
    void for_each_node(std::size_t b, std::size_t l, Visit&& visit) {
        const BlockNodes nodes = elements_.nodes_of(b);
        for (Index k = 0; k < nodes.count; ++k) visit(marked_[static_cast<std::size_t>(nodes.node[k][l] - first_)]);
    }
    Index count(std::size_t b, std::size_t l) {
        Index sum = 0;
        for_each_node(b, l, [&](std::uint8_t of) { sum += of; });
        return sum;
    }

    const ElementInputs& elements_;
    Index first_;
    std::vector<std::uint8_t> marked_;  // from first_ on
};

/// The explicit elements that are given up so that those beside them stand the step: the neediest first.
class GivingUp {
public:
    GivingUp(const ElementInputs& elements, Range blocks, std::span<const Vec3> position, std::span<const Real> mass,
             Real step, std::span<ElementLane> share)
        : elements_(elements),
          blocks_(blocks),
          step_(step),
          share_(share),
          need_(share.size()),
          starved_(elements, blocks),
          implicit_(elements, blocks) {
        LaneQuaternion<Real8> q = no_turn();
        for (std::size_t row = 0; row < need_.size(); ++row) {
            const std::size_t b = row + static_cast<std::size_t>(blocks.begin);
            const Real8 bound = frequency_squared_of(elements, b, deformation_of(elements, b, position), mass, {}, q);
            for (std::size_t l = 0; l < element_lanes; ++l) {
                need_[row][l] = bound[l] * step * step / (step_times_frequency * step_times_frequency);
                if (need_[row][l] > 1) share_[row][l] = 0;  // not with all the mass of its nodes to itself
            }
        }
    }

    /// Beside elements that do not stand the step: those that need the most, and those that have no node outside of
    /// clusters, which cost nothing. Asks for less where that is none.
    void give_up(const SharedSteps& own) {
        constexpr Real less = 0.7;
        starved_.clear();
        implicit_.clear();
        for_each_element(elements_, blocks_, [&](std::size_t b, std::size_t l) {
            if (share(b, l) == 0)
                implicit_.mark(b, l);
            else if (own.of(b, l) < step_)
                starved_.mark(b, l);
        });
        bool gave_up = false;
        for_each_element(elements_, blocks_, [&](std::size_t b, std::size_t l) {
            if (share(b, l) == 0 || !starved_.any(b, l)) return;
            if (need_[row(b)][l] < least_need_ && !implicit_.all(b, l)) return;
            share(b, l) = 0;
            gave_up = true;
        });
        if (!gave_up) least_need_ *= less;
    }

private:
    std::size_t row(std::size_t b) const { return b - static_cast<std::size_t>(blocks_.begin); }
    Real& share(std::size_t b, std::size_t l) { return share_[row(b)][l]; }

    const ElementInputs& elements_;
    Range blocks_;
    Real step_;
    std::span<ElementLane> share_;
    std::vector<ElementLane> need_;  // part of the masses of its nodes with which an element stands the step
    Real least_need_ = 1;
    NodeMarks starved_, implicit_;
};

}  // namespace

ImplicitShare find_implicit_elements(const ElementInputs& elements, Range blocks, std::span<const Vec3> position,
                                     std::span<const Real> mass, Real step, Real headroom, ImplicitSearch search,
                                     std::span<Real> stiffness_sum, const ImplicitOutputs& out) {
    constexpr int rounds_of_sharing = 4;  // between two rounds that give elements up
    constexpr int rounds_of_estimates = 24;
    constexpr Real most_change = 4;     // of a share in a round: what is hopeless is not to starve its neighbours
    constexpr Real most_volume = 0.75;  // given up
    const bool anew = search == ImplicitSearch::anew;
    const auto first = static_cast<std::size_t>(blocks.begin);
    const auto share = [&](std::size_t b, std::size_t l) -> Real& { return out.mass_share[b - first][l]; };
    SharedSteps own(elements, blocks, position, mass, stiffness_sum);
    std::optional<GivingUp> by_need;
    if (anew) {
        start_mass_shares(elements, blocks, out.mass_share);
        std::ranges::fill(out.modulus, ElementLane{});
        by_need.emplace(elements, blocks, position, mass, step, out.mass_share);
    }
    bool found_enough = false;
    for (int round = 1;; ++round) {
        if (!anew || round % rounds_of_estimates == 1 || found_enough)
            own.measure();
        else
            own.estimate();
        Real shortest = std::numeric_limits<Real>::infinity(), volume = 0, given_up = 0;  // s, m^3
        for_each_element(elements, blocks, [&](std::size_t b, std::size_t l) {
            shortest = std::min(shortest, own.of(b, l));
            volume += elements.volume[b][l];
            if (share(b, l) == 0) given_up += elements.volume[b][l];
        });
        if (given_up > most_volume * volume) return {.too_many = true};
        found_enough = !(shortest < step);
        if (found_enough && own.is_exact()) break;
        if (found_enough) continue;  // says the estimate
        if (anew && round % rounds_of_sharing == 0) by_need->give_up(own);
        for_each_element(elements, blocks, [&](std::size_t b, std::size_t l) {
            Real& of_element = share(b, l);
            if (anew)
                of_element *= std::clamp(step / own.of(b, l), 1 / most_change, most_change);
            else if (own.of(b, l) < step)
                of_element = 0;
        });
    }
    // implicit elements, and what they add to a rigid turn: beta c V |omega x|^2 <= beta c V omega^2 for each axis
    Real added = 0;
    LaneQuaternion<Real8> q = no_turn();
    for (auto b = first; b < static_cast<std::size_t>(blocks.end); ++b) {
        const Real8 stiffness = stiffness_of(elements, b, deformation_of(elements, b, position), q);
        for (std::size_t l = 0; l < element_lanes; ++l) {
            if (!(elements.volume[b][l] > 0) || share(b, l) != 0) continue;
            Real& modulus = out.modulus[b - first][l];
            if (!(modulus > stiffness[l])) modulus = headroom * stiffness[l];
            added += 2 * inertia_of_stiffness(step) * out.modulus[b - first][l] * elements.volume[b][l];
        }
    }
    if (added == 0) return {};
    return {.moment = added / least_moment(elements, blocks, position, mass)};
}

void find_leeway(const Ragged<Index>& tetrahedra, std::span<const ElementLane> modulus, Real of_implicit,
                 std::span<ElementLane> leeway) {
    std::ranges::fill(leeway, ElementLane{{1, 1, 1, 1, 1, 1, 1, 1}});
    for (std::size_t e = 0; e < tetrahedra.size(); ++e) {
        if (!(modulus[e / element_lanes][e % element_lanes] > 0)) continue;
        for (const Index t : tetrahedra[e]) {
            const auto at = static_cast<std::size_t>(t);
            leeway[at / element_lanes][at % element_lanes] = of_implicit;
        }
    }
}

void find_viscous_times(std::span<const ElementLane> modulus, Real step, std::span<Real> viscous_time) {
    constexpr Real of_step = 0.1;  // omega h stays below sqrt(4 - 2 * 1.8^2 * 0.1), which is more than 1.8
    for (std::size_t b = 0; b < modulus.size(); ++b)
        viscous_time[b] = std::ranges::any_of(modulus[b].lane, [](Real of) { return of > 0; }) ? of_step * step : 0;
}

Real worst_stiffening(const ElementInputs& elements, Range blocks, std::span<const Vec3> position,
                      std::span<const ElementLane> modulus) {
    Real worst = 0;
    LaneQuaternion<Real8> q = no_turn();
    for (auto b = static_cast<std::size_t>(blocks.begin); b < static_cast<std::size_t>(blocks.end); ++b) {
        const ElementLane& taken = modulus[b - static_cast<std::size_t>(blocks.begin)];
        if (std::none_of(taken.lane, taken.lane + element_lanes, [](Real m) { return m > 0; })) continue;
        const Real8 stiffness = stiffness_of(elements, b, deformation_of(elements, b, position), q);
        for (std::size_t l = 0; l < element_lanes; ++l)
            if (taken[l] > 0) worst = std::max(worst, stiffness[l] / taken[l]);
    }
    return worst;
}

Real added_energy(const ElementInputs& elements, Range blocks, std::span<const ElementLane> modulus, Real step,
                  std::span<const Vec3> velocity) {
    Real energy = 0;
    for (auto b = static_cast<std::size_t>(blocks.begin); b < static_cast<std::size_t>(blocks.end); ++b) {
        const ElementLane& taken = modulus[b - static_cast<std::size_t>(blocks.begin)];
        const LaneMat3<Real8> rate = deformation_gradient(elements.nodes_of(b), velocity);
        const Real8 square = inner_product(rate, rate);
        for (std::size_t l = 0; l < element_lanes; ++l) energy += taken[l] * elements.volume[b][l] * square[l];
    }
    return inertia_of_stiffness(step) * energy / 2;
}

}  // namespace skerry
