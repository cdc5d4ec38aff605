#include "systems/dynamics/checks/check_state.h"

#include <algorithm>
#include <array>
#include <atomic>
#include <cmath>
#include <limits>

#include "components/check.h"
#include "jobs/parallel_for.h"
#include "systems/dynamics/elements/element_block.h"
#include "systems/dynamics/stability/largest_length.h"

namespace skerry {

namespace {

constexpr std::size_t node_blocks_per_job = 8, checked_bodies_per_job = 128;
constexpr std::size_t element_blocks_per_job = 256;

Vec3 motion(const CheckInputs& state, std::size_t node) {
    return state.push_out.empty() ? state.velocity_next[node] : Vec3(state.velocity_next[node] + state.push_out[node]);
}

/// Greatest squared node speeds of a node block [m^2/s^2], in the world and relative to the velocity `frame`. An entry
/// is NaN if the velocity of a node is not finite or its square overflows.
std::array<Real, 2> max_speeds_squared(const CheckInputs& state, std::size_t block, const Vec3& frame) {
    const auto begin = static_cast<std::size_t>(state.block_begin[block]);
    const std::size_t count = static_cast<std::size_t>(state.block_end[block]) - begin;
    if (count == 0) return {0, 0};
    const Real* const v = state.velocity_next[begin].data();
    const Real* const p = state.push_out.empty() ? nullptr : state.push_out[begin].data();
    const auto free = [v](std::size_t i) { return v[i]; };
    const auto pushed = [v, p](std::size_t i) { return v[i] + p[i]; };
    std::array<Real, 2> highest{};
    if (!frame.isZero(0)) {
        highest =
            p == nullptr ? largest_squared_lengths(count, free, frame) : largest_squared_lengths(count, pushed, frame);
    } else {
        highest[0] = p == nullptr ? largest_squared_length(count, free) : largest_squared_length(count, pushed);
        highest[1] = highest[0];
    }
    for (Real& squared : highest)
        if (!(squared <= std::numeric_limits<Real>::max())) squared = std::numeric_limits<Real>::quiet_NaN();
    return highest;
}

Index first_not_finite(const CheckInputs& state, Range blocks) {
    for (Index b = blocks.begin; b < blocks.end; ++b)
        for (Index n = state.block_begin[static_cast<std::size_t>(b)]; n < state.block_end[static_cast<std::size_t>(b)];
             ++n)
            if (!(motion(state, static_cast<std::size_t>(n)).squaredNorm() <= std::numeric_limits<Real>::max()))
                return n;
    return no_index;
}

Real highest_lane(const Real8& lanes) {
    Real highest = lanes[0];
    for (std::size_t l = 1; l < element_lanes; ++l) highest = std::max(highest, lanes[l]);
    return highest;
}

/// Greatest of the numbers value(0) to value(count - 1), or 0 if all are negative. The result does not depend on the
/// order in which the jobs run.
template <class Value>
Real highest_of(Executor& executor, std::size_t count, std::size_t rows_per_job, Value&& value) {
    std::atomic<Real> highest{0};
    parallel_for(executor, count, rows_per_job, [&](std::size_t begin, std::size_t end) {
        Real here = 0;
        for (std::size_t row = begin; row < end; ++row) here = std::max(here, value(row));
        Real known = highest.load();
        while (here > known && !highest.compare_exchange_weak(known, here)) {
        }
    });
    return highest.load();
}

/// True if exceeds(row) is true for any row below `count`. The result does not depend on the order in which the jobs
/// run.
template <class Exceeds>
bool any_exceeds(Executor& executor, std::size_t count, std::size_t rows_per_job, Exceeds&& exceeds) {
    std::atomic<bool> found{false};
    parallel_for(executor, count, rows_per_job, [&](std::size_t begin, std::size_t end) {
        for (std::size_t row = begin; row < end && !found.load(std::memory_order_relaxed); ++row)
            if (exceeds(row)) found.store(true, std::memory_order_relaxed);
    });
    return found.load();
}

struct Fastest {
    Real rate_squared = 0;  // squared deformation rate / squared leeway (factor on max_strain_step) [1/s^2]
    Index node = no_index;
    Index element = no_index;  // tetrahedron t: lane t % 8 of block t / 8

    void take_faster(const Fastest& other) {
        if (other.rate_squared > rate_squared) *this = other;
    }
};

/// Velocity differences of each tetrahedron of a block, as columns: velocities of corners 1 to 3 minus the velocity of
/// corner 0 [m/s].
LaneMat3<Real8> velocity_differences(const CheckInputs& state, std::size_t block) {
    const LaneMat3<Real8> difference = edges(state.tetrahedron_node[block], state.velocity_next);
    return state.push_out.empty() ? difference : difference + edges(state.tetrahedron_node[block], state.push_out);
}

/// Squared length of the longest column in each lane [m^2/s^2].
Real8 longest_column(const LaneMat3<Real8>& difference) {
    const Real8 first = dot(difference.c0, difference.c0), second = dot(difference.c1, difference.c1),
                third = dot(difference.c2, difference.c2);
    const Real8 longer = first < second ? second : first;
    return longer < third ? third : longer;
}

Real8 leeway_of(const CheckInputs& state, std::size_t block) {
    return state.tetrahedron_leeway.empty() ? Real8{} + 1.0 : load(state.tetrahedron_leeway[block]);
}

/// Squared rate |F'|^2 of the deformation gradient F of each tetrahedron of a block, divided by the squared leeway (a
/// factor on the allowed change of F) [1/s^2]; 0 in an unused lane. With the velocities v and rest positions X of the
/// corners, F' = [v_k - v_0] [X_k - X_0]^-1.
Real8 rate_squared_of(const CheckInputs& state, std::size_t block, const LaneMat3<Real8>& difference) {
    const LaneMat3<Real8> rest = edges(state.tetrahedron_node[block], state.rest_position), cof = cofactor(rest);
    const Real8 det = dot(rest.c0, cof.c0);
    const auto column = [&](const Real8& a, const Real8& b, const Real8& c) {
        return a * difference.c0 + b * difference.c1 + c * difference.c2;
    };
    const LaneVec3<Real8> x = column(cof.c0.x, cof.c1.x, cof.c2.x), y = column(cof.c0.y, cof.c1.y, cof.c2.y),
                          z = column(cof.c0.z, cof.c1.z, cof.c2.z);
    const Real8 scaled = dot(x, x) + dot(y, y) + dot(z, z);
    const Real8 allowed = det * leeway_of(state, block);
    return det > 0.0 ? scaled / (allowed * allowed) : Real8{};
}

/// Squared deformation rates of the tetrahedra of a block, divided by the squared leeways (factors on the allowed
/// change of the deformation gradient F) [1/s^2]. If no tetrahedron exceeds `rate` [1/s], as in most blocks, all lanes
/// may be 0. `max_relative_speed`: upper bound on the relative speed of two nodes of the body [m/s].
///
/// The deformation rate is the smaller of two values:
/// - the norm |F'| of the rate of F,
/// - the greatest speed of a corner relative to corner 0, divided by the smallest altitude (cheap to compute).
Real8 squared_deformation_rate(const CheckInputs& state, std::size_t block, Real rate, Real max_relative_speed) {
    const Real8 reach = load(state.tetrahedron_altitude[block]) * leeway_of(state, block),
                reach_squared = reach * reach;
    if (all(Real8{} + max_relative_speed * max_relative_speed <= rate * rate * reach_squared)) return Real8{};
    const LaneMat3<Real8> difference = velocity_differences(state, block);
    const Real8 widest = longest_column(difference);
    if (all(widest <= rate * rate * reach_squared)) return Real8{};
    const Real8 corner_rate = reach > 0.0 ? widest / reach_squared : Real8{},
                gradient_rate = rate_squared_of(state, block, difference);
    return corner_rate < gradient_rate ? corner_rate : gradient_rate;
}

/// Returns the greatest squared deformation rate of the tetrahedra of a block if it exceeds the square of `rate`, else
/// 0 [1/s^2]. Marks the corners of all tetrahedra whose deformation rate exceeds `rate`.
Real check_tetrahedra(const CheckInputs& state, std::size_t block, Real rate, Real max_relative_speed,
                      std::span<std::uint8_t> beside_fast) {
    const Real8 squared = squared_deformation_rate(state, block, rate, max_relative_speed);
    if (all(squared <= rate * rate)) return 0;
    for (std::size_t l = 0; l < element_lanes; ++l) {
        if (!(squared[l] > rate * rate)) continue;
        for (std::size_t a = 0; a < 4; ++a) {
            std::uint8_t& flag = beside_fast[static_cast<std::size_t>(state.tetrahedron_node[block][a][l])];
            std::atomic_ref<std::uint8_t>(flag).store(1, std::memory_order_relaxed);
        }
    }
    return highest_lane(squared);
}

/// Finds the tetrahedron of a block that deforms fastest, and the corner that moves fastest relative to corner 0 of
/// this tetrahedron.
Fastest fastest_tetrahedron(const CheckInputs& state, std::size_t block) {
    const Real8 rate_squared = rate_squared_of(state, block, velocity_differences(state, block));
    Fastest fastest;
    for (std::size_t l = 0; l < element_lanes; ++l) {
        if (!(rate_squared[l] > fastest.rate_squared)) continue;
        fastest = {rate_squared[l], no_index, static_cast<Index>(block * element_lanes + l)};
        const Vec3 base = motion(state, static_cast<std::size_t>(state.tetrahedron_node[block][0][l]));
        Real largest = -1;
        for (std::size_t a = 1; a < 4; ++a) {
            const Index node = state.tetrahedron_node[block][a][l];
            const Real difference = (motion(state, static_cast<std::size_t>(node)) - base).squaredNorm();
            if (difference > largest) fastest.node = node;
            largest = std::max(largest, difference);
        }
    }
    return fastest;
}

/// Greatest |F'|^2 of the elements of a block, divided by their squared leeways (factors on the allowed change of F)
/// [1/s^2]. F' is the rate of the deformation gradient F. Returns 0 in two cases:
/// - The elements are inversion barriers.
/// - No node of the block is marked in `beside_fast`. Marked nodes are the corners of fast tetrahedra, so all
///   tetrahedra of the block are slow.
Real check_elements(const CheckInputs& state, std::size_t block, std::span<const std::uint8_t> beside_fast) {
    // the limit applies to means of F over tetrahedra, but F of an inversion barrier is F of one tetrahedron
    if (!state.element_part.empty() && state.element_part[block] == ElementPart::guard) return 0;
    const auto first = static_cast<std::size_t>(state.element_first[block]);
    const Index count = state.element_count[block];
    // Nonzero if a node of the block is marked in `beside_fast`. Marks are tested first, because computing the
    // gradients takes more than half of the time of a block.
    unsigned marked = 0;
    for (Index k = 0; k < count; ++k)
        for (const Index n : state.element_node[first + static_cast<std::size_t>(k)].lane)
            marked |= beside_fast[static_cast<std::size_t>(n)];
    if (marked == 0) return 0;
    const BlockNodes nodes{&state.element_node[first], &state.element_gradient[first], count};
    LaneMat3<Real8> change = deformation_gradient(nodes, state.velocity_next);
    if (!state.push_out.empty()) change = change + deformation_gradient(nodes, state.push_out);
    const Real8 leeway = load(state.element_implicit_modulus[block]) > 0.0 ? Real8{} + implicit_leeway : Real8{} + 1.0;
    return highest_lane(inner_product(change, change) / (leeway * leeway));
}

/// Finds the node that is fastest relative to the mean velocity of the body. This speed is a less accurate test than
/// deformation rates. It is used for bodies without a list of tetrahedra.
Fastest fastest_from_mean(const CheckInputs& state, Range blocks, Real altitude) {
    Vec3 sum = Vec3::Zero();
    const std::size_t begin = static_cast<std::size_t>(state.block_begin[static_cast<std::size_t>(blocks.begin)]);
    const std::size_t end = static_cast<std::size_t>(state.block_end[static_cast<std::size_t>(blocks.end - 1)]);
    for (std::size_t n = begin; n < end; ++n) sum += motion(state, n);
    const Vec3 mean = sum / static_cast<Real>(end - begin);
    Fastest fastest;
    for (std::size_t n = begin; n < end; ++n)
        fastest.take_faster(
            {(motion(state, n) - mean).squaredNorm() / (altitude * altitude), static_cast<Index>(n), no_index});
    return fastest;
}

/// True if the tetrahedron with the smallest altitude could deform faster than `rate` [1/s]. Two nodes separate at most
/// twice as fast as the fastest node moves relative to the first node of the body; hence the factor 4 between squares.
bool may_deform_faster(Executor& executor, const CheckInputs& state, std::size_t body, Real rate) {
    const Real altitude = state.body_min_altitude[body], limit_squared = rate * altitude * rate * altitude;
    const Range blocks = state.body_node_blocks[body];
    const Vec3 first =
        motion(state, static_cast<std::size_t>(state.block_begin[static_cast<std::size_t>(blocks.begin)]));
    return any_exceeds(executor, static_cast<std::size_t>(blocks.size()), node_blocks_per_job, [&](std::size_t row) {
        const std::size_t b = static_cast<std::size_t>(blocks.begin) + row;
        for (std::size_t n = static_cast<std::size_t>(state.block_begin[b]);
             n < static_cast<std::size_t>(state.block_end[b]); ++n)
            if (4 * (motion(state, n) - first).squaredNorm() > limit_squared) return true;
        return false;
    });
}

/// Deformation rate of the fastest element of a body if the rate exceeds `rate`, else 0 [1/s]. Cheap tests come first.
/// An element is tested only beside tetrahedra that exceed `rate`, because its F is a mean over tetrahedra.
/// `max_relative_speed`: upper bound on the relative speed of two nodes of the body [m/s].
Real deformation_rate(Executor& executor, const CheckInputs& state, std::size_t body, Real rate,
                      Real max_relative_speed, std::span<std::uint8_t> beside_fast) {
    if (!may_deform_faster(executor, state, body, rate)) return 0;
    const auto rate_above = [&](Real squared) { return squared > rate * rate ? std::sqrt(squared) : 0; };
    const Range blocks = state.body_node_blocks[body];
    if (state.body_blocks.empty())
        return rate_above(fastest_from_mean(state, blocks, state.body_min_altitude[body]).rate_squared);
    if (!state.body_element_blocks.empty())
        std::fill(beside_fast.begin() + state.block_begin[static_cast<std::size_t>(blocks.begin)],
                  beside_fast.begin() + state.block_end[static_cast<std::size_t>(blocks.end - 1)], std::uint8_t{0});
    const auto highest_in = [&](Range rows, auto&& block_rate) {
        const auto begin = static_cast<std::size_t>(rows.begin);
        return highest_of(executor, static_cast<std::size_t>(rows.size()), element_blocks_per_job,
                          [&](std::size_t row) { return block_rate(begin + row); });
    };
    const Real tetrahedra_squared = highest_in(state.body_blocks[body], [&](std::size_t block) {
        return check_tetrahedra(state, block, rate, max_relative_speed, beside_fast);
    });
    if (state.body_element_blocks.empty() || tetrahedra_squared == 0) return rate_above(tetrahedra_squared);
    const Real elements_squared = highest_in(
        state.body_element_blocks[body], [&](std::size_t block) { return check_elements(state, block, beside_fast); });
    return rate_above(std::min(tetrahedra_squared, elements_squared));
}

/// Finds the tetrahedron and the node to report for a body that deforms too fast: the tetrahedron with the highest
/// deformation rate, or the first such tetrahedron if several have equal rates.
Fastest fastest_of(const CheckInputs& state, std::size_t body) {
    if (state.body_blocks.empty())
        return fastest_from_mean(state, state.body_node_blocks[body], state.body_min_altitude[body]);
    Fastest fastest;
    const Range tetrahedra = state.body_blocks[body];
    for (Index block = tetrahedra.begin; block < tetrahedra.end; ++block)
        fastest.take_faster(fastest_tetrahedron(state, static_cast<std::size_t>(block)));
    return fastest;
}

}  // namespace

StepVerdict check_state(Executor& executor, const CheckInputs& state, Real h, Real longest, Real max_strain_step,
                        const SpeedOutputs& speed, Column<std::uint8_t>& beside_fast) {
    const std::size_t body_count = state.body_node_blocks.size();
    SKERRY_CHECK(speed.block_squared.size() == state.block_begin.size() && speed.body.size() == body_count);
    SKERRY_CHECK(speed.block_frame_squared.size() == state.block_begin.size() && speed.body_frame.size() == body_count);
    parallel_for(executor, state.block_begin.size(), node_blocks_per_job, [&](std::size_t begin, std::size_t end) {
        for (std::size_t b = begin; b < end; ++b) {
            const auto body = static_cast<std::size_t>(state.block_body[b]);
            const std::array<Real, 2> squared = max_speeds_squared(
                state, b, state.body_frame.empty() ? Vec3(Vec3::Zero()) : state.body_frame[body].velocity);
            speed.block_squared[b] = squared[0];
            speed.block_frame_squared[b] = squared[1];
        }
    });
    const auto greatest = [](std::span<const Real> squared) {
        Real highest = 0;
        bool finite = true;
        for (const Real block_speed : squared) {
            finite &= block_speed >= 0;
            if (block_speed > highest) highest = block_speed;
        }
        return finite ? std::sqrt(highest) : std::numeric_limits<Real>::quiet_NaN();
    };
    StepVerdict verdict;
    beside_fast.resize(state.velocity_next.size());
    const Real tested_rate = max_strain_step / std::max(h, longest);
    // The relative speed of two nodes is at most twice the highest node speed in the frame of the body.
    const auto may_be_fast = [&](std::size_t body) {
        const Real altitude = state.body_min_altitude[body];
        return altitude > 0 && !state.ghosts.contain(static_cast<Index>(body)) &&
               2 * speed.body_frame[body] > tested_rate * altitude;
    };
    std::atomic<bool> any_suspect{false};
    parallel_for(executor, body_count, checked_bodies_per_job, [&](std::size_t begin, std::size_t end) {
        bool any = false;
        for (std::size_t body = begin; body < end; ++body) {
            const Range blocks = state.body_node_blocks[body];
            const auto first = static_cast<std::size_t>(blocks.begin), count = static_cast<std::size_t>(blocks.size());
            speed.body[body] = greatest(speed.block_squared.subspan(first, count));
            speed.body_frame[body] = greatest(speed.block_frame_squared.subspan(first, count));
            any |= std::isnan(speed.body[body]) || may_be_fast(body);
        }
        if (any) any_suspect.store(true, std::memory_order_relaxed);
    });
    if (!any_suspect.load()) return verdict;
    for (std::size_t body = 0; body < body_count; ++body) {
        const Range blocks = state.body_node_blocks[body];
        if (std::isnan(speed.body[body])) {
            if (verdict.fault == StepFault::none)
                verdict = {StepFault::not_finite, static_cast<Index>(body), first_not_finite(state, blocks), 0};
            if (verdict.fault == StepFault::not_finite) break;
            continue;
        }
        if (!may_be_fast(body) || blocks.size() == 0) continue;
        constexpr Real rounding = 1e-6;
        const Real rate =
            deformation_rate(executor, state, body, tested_rate, (2 + rounding) * speed.body_frame[body], beside_fast);
        if (rate > verdict.fastest.rate) verdict.fastest = {rate, static_cast<Index>(body)};
        // only the first fault of the step is reported
        if (!(rate > max_strain_step / h) || verdict.fault != StepFault::none) continue;
        const Fastest fastest = fastest_of(state, body);
        verdict.fault = StepFault::too_fast;
        verdict.body = static_cast<Index>(body);
        verdict.node = fastest.node;
        verdict.value = std::sqrt(fastest.rate_squared) * h;
        verdict.tetrahedron = fastest.element;
    }
    return verdict;
}

StrainRate strain_rate(Executor& executor, const CheckInputs& state, Real rate, Column<std::uint8_t>& beside_fast) {
    beside_fast.resize(state.velocity_next.size());
    StrainRate fastest;
    for (std::size_t body = 0; body < state.body_node_blocks.size(); ++body) {
        if (!(state.body_min_altitude[body] > 0) || state.body_node_blocks[body].size() == 0 ||
            state.ghosts.contain(static_cast<Index>(body)))
            continue;
        const Real body_rate = deformation_rate(executor, state, body, rate, infinity, beside_fast);
        if (body_rate > fastest.rate) fastest = {body_rate, static_cast<Index>(body)};
    }
    return fastest;
}

StepVerdict check_distance(Executor& executor, std::span<const Vec3> position, std::span<const Range> body_nodes,
                           std::span<const Real> body_mean_edge) {
    const auto spacing = [&](std::size_t body) {
        const Real distance = position[static_cast<std::size_t>(body_nodes[body].begin)].cwiseAbs().maxCoeff();
        return std::numeric_limits<Real>::epsilon() * distance;
    };
    const auto is_too_far = [&](std::size_t body) {
        return body_nodes[body].size() > 0 && body_mean_edge[body] > 0 &&
               spacing(body) > coarsest_spacing * body_mean_edge[body];
    };
    if (!any_exceeds(executor, body_nodes.size(), checked_bodies_per_job, is_too_far)) return {};
    std::size_t body = 0;
    while (!is_too_far(body)) ++body;
    return {StepFault::too_far, static_cast<Index>(body), no_index, spacing(body) / body_mean_edge[body]};
}

}  // namespace skerry
