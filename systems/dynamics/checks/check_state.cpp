#include "systems/dynamics/checks/check_state.h"

#include <atomic>
#include <cmath>
#include <limits>

#include "components/check.h"
#include "jobs/parallel_for.h"
#include "systems/dynamics/elements/element_block.h"
#include "systems/dynamics/stability/largest_length.h"

namespace skerry {

namespace {

constexpr std::size_t node_blocks_per_job = 8;
constexpr std::size_t element_blocks_per_job = 256;

Vec3 motion(const CheckInputs& state, std::size_t node) {
    return state.push_out.empty() ? state.velocity_next[node] : Vec3(state.velocity_next[node] + state.push_out[node]);
}

/// Of a block, in a frame that moves with `frame` (m/s). Not a number when any node's velocity is not finite, or so
/// large that its square is not.
Real max_speed_squared(const CheckInputs& state, std::size_t block, const Vec3& frame) {
    const auto begin = static_cast<std::size_t>(state.block_begin[block]);
    const std::size_t count = static_cast<std::size_t>(state.block_end[block]) - begin;
    if (count == 0) return 0;
    const Real* v = state.velocity_next[begin].data();
    const Real* p = state.push_out.empty() ? nullptr : state.push_out[begin].data();
    const Real highest = p == nullptr ? largest_squared_length(
                                            count, [&](std::size_t i) { return v[i]; }, frame)
                                      : largest_squared_length(
                                            count, [&](std::size_t i) { return v[i] + p[i]; }, frame);
    return highest <= std::numeric_limits<Real>::max() ? highest : std::numeric_limits<Real>::quiet_NaN();
}

Index first_not_finite(const CheckInputs& state, Range blocks) {
    for (Index b = blocks.begin; b < blocks.end; ++b)
        for (Index n = state.block_begin[static_cast<std::size_t>(b)]; n < state.block_end[static_cast<std::size_t>(b)];
             ++n)
            if (!(motion(state, static_cast<std::size_t>(n)).squaredNorm() <= std::numeric_limits<Real>::max()))
                return n;
    return no_index;
}

/// Whether any row of `count` has a value above a limit. The answer does not depend on the order in which the blocks
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
    Real rate_squared = 0;  // 1/s^2: |F'|^2
    Index node = no_index;
    Index element = no_index;  // row: lane of a block

    void look_at(const Fastest& other) {
        if (other.rate_squared > rate_squared) *this = other;
    }
};

/// Columns: corners 1 to 3 less corner 0.
LaneMat3<Real8> parting_of(const CheckInputs& state, std::size_t block) {
    const LaneMat3<Real8> parting = edges(state.tetrahedron_node[block], state.velocity_next);
    return state.push_out.empty() ? parting : parting + edges(state.tetrahedron_node[block], state.push_out);
}

Real8 leeway_of(const CheckInputs& state, std::size_t block) {
    return state.tetrahedron_leeway.empty() ? Real8{} + 1.0 : load(state.tetrahedron_leeway[block]);
}

/// |F'|^2 over the square of the leeway, F' = [v_k - v_0] [X_k - X_0]^-1, of each element of a block; 0 in a lane that
/// is left over.
Real8 rate_squared_of(const CheckInputs& state, std::size_t block, const LaneMat3<Real8>& parting) {
    const LaneMat3<Real8> rest = edges(state.tetrahedron_node[block], state.rest_position), cof = cofactor(rest);
    const Real8 det = dot(rest.c0, cof.c0);
    const auto column = [&](const Real8& a, const Real8& b, const Real8& c) {
        return a * parting.c0 + b * parting.c1 + c * parting.c2;
    };
    const LaneVec3<Real8> x = column(cof.c0.x, cof.c1.x, cof.c2.x), y = column(cof.c0.y, cof.c1.y, cof.c2.y),
                          z = column(cof.c0.z, cof.c1.z, cof.c2.z);
    const Real8 scaled = dot(x, x) + dot(y, y) + dot(z, z);
    const Real8 allowed = det * leeway_of(state, block);
    return det > 0.0 ? scaled / (allowed * allowed) : Real8{};
}

/// Whether any element of a block deforms faster than `rate` (1/s): all side by side, and nothing is said of which. In
/// most corners do not even part by that times the altitude.
bool any_deforms_faster(const CheckInputs& state, std::size_t block, Real rate) {
    const LaneMat3<Real8> parting = parting_of(state, block);
    const Real8 first = dot(parting.c0, parting.c0), second = dot(parting.c1, parting.c1),
                third = dot(parting.c2, parting.c2);
    const Real8 limit = rate * load(state.tetrahedron_altitude[block]) * leeway_of(state, block),
                limit_squared = limit * limit;
    if (all((first <= limit_squared) & (second <= limit_squared) & (third <= limit_squared))) return false;
    return !all(rate_squared_of(state, block, parting) <= rate * rate);
}

/// The element of a block that deforms fastest, and its corner that parts fastest from corner 0.
Fastest fastest_element(const CheckInputs& state, std::size_t block) {
    const Real8 rate_squared = rate_squared_of(state, block, parting_of(state, block));
    Fastest fastest;
    for (std::size_t l = 0; l < element_lanes; ++l) {
        if (!(rate_squared[l] > fastest.rate_squared)) continue;
        fastest = {rate_squared[l], no_index, static_cast<Index>(block * element_lanes + l)};
        const Vec3 base = motion(state, static_cast<std::size_t>(state.tetrahedron_node[block][0][l]));
        Real most = -1;
        for (std::size_t a = 1; a < 4; ++a) {
            const Index node = state.tetrahedron_node[block][a][l];
            const Real parting = (motion(state, static_cast<std::size_t>(node)) - base).squaredNorm();
            if (parting > most) fastest.node = node;
            most = std::max(most, parting);
        }
    }
    return fastest;
}

/// Whether F of any element of a block changes faster than `rate` (1/s), implicit ones by their leeway.
bool any_element_deforms_faster(const CheckInputs& state, std::size_t block, Real rate) {
    const auto first = static_cast<std::size_t>(state.element_first[block]);
    const BlockNodes nodes{&state.element_node[first], &state.element_gradient[first], state.element_count[block]};
    LaneMat3<Real8> change = deformation_gradient(nodes, state.velocity_next);
    if (!state.push_out.empty()) change = change + deformation_gradient(nodes, state.push_out);
    const Real8 leeway = load(state.element_implicit_modulus[block]) > 0.0 ? Real8{} + implicit_leeway : Real8{} + 1.0;
    const Real8 limit = rate * leeway;
    return !all(inner_product(change, change) <= limit * limit);
}

/// Relative to the mean velocity of the body: a coarser measure, for a body whose elements are not given.
Fastest fastest_from_mean(const CheckInputs& state, Range blocks, Real altitude) {
    Vec3 sum = Vec3::Zero();
    const std::size_t begin = static_cast<std::size_t>(state.block_begin[static_cast<std::size_t>(blocks.begin)]);
    const std::size_t end = static_cast<std::size_t>(state.block_end[static_cast<std::size_t>(blocks.end - 1)]);
    for (std::size_t n = begin; n < end; ++n) sum += motion(state, n);
    const Vec3 mean = sum / static_cast<Real>(end - begin);
    Fastest fastest;
    for (std::size_t n = begin; n < end; ++n)
        fastest.look_at(
            {(motion(state, n) - mean).squaredNorm() / (altitude * altitude), static_cast<Index>(n), no_index});
    return fastest;
}

/// The element of a body that deforms fastest, when faster than `rate` (1/s), and a node of it; else none. Tests from
/// cheap to dear, each asked only where the one before fails; corners that part by less than the altitude in all three
/// directions pass though F may change by up to three times the limit.
Fastest too_fast_node(Executor& executor, const CheckInputs& state, std::size_t body, Real max_speed, Real rate) {
    const Real altitude = state.body_min_altitude[body], limit_squared = rate * altitude * rate * altitude;
    if (!(4 * max_speed * max_speed > limit_squared)) return {};  // two nodes part at most at twice the highest speed
    const Range blocks = state.body_node_blocks[body];
    const Vec3 first =
        motion(state, static_cast<std::size_t>(state.block_begin[static_cast<std::size_t>(blocks.begin)]));
    const bool parting =
        any_exceeds(executor, static_cast<std::size_t>(blocks.size()), node_blocks_per_job, [&](std::size_t row) {
            const std::size_t b = static_cast<std::size_t>(blocks.begin) + row;
            for (std::size_t n = static_cast<std::size_t>(state.block_begin[b]);
                 n < static_cast<std::size_t>(state.block_end[b]); ++n)
                if (4 * (motion(state, n) - first).squaredNorm() > limit_squared) return true;
            return false;
        });
    if (!parting) return {};
    Fastest fastest;
    if (state.body_blocks.empty()) {
        fastest = fastest_from_mean(state, blocks, altitude);
    } else {
        const Range elements = state.body_blocks[body];
        const std::size_t begin = static_cast<std::size_t>(elements.begin),
                          count = static_cast<std::size_t>(elements.size());
        if (!any_exceeds(executor, count, element_blocks_per_job,
                         [&](std::size_t row) { return any_deforms_faster(state, begin + row, rate); }))
            return {};
        if (!state.body_element_blocks.empty()) {
            const Range of_body = state.body_element_blocks[body];
            const auto first_block = static_cast<std::size_t>(of_body.begin);
            if (!any_exceeds(
                    executor, static_cast<std::size_t>(of_body.size()), element_blocks_per_job,
                    [&](std::size_t row) { return any_element_deforms_faster(state, first_block + row, rate); }))
                return {};
        }
        for (std::size_t row = 0; row < count; ++row) fastest.look_at(fastest_element(state, begin + row));
    }
    return fastest.rate_squared > rate * rate ? fastest : Fastest{};
}

}  // namespace

StepVerdict check_state(Executor& executor, const CheckInputs& state, Real h, Real max_strain_step,
                        const SpeedOutputs& speed) {
    const std::size_t body_count = state.body_node_blocks.size();
    SKERRY_CHECK(speed.block_squared.size() == state.block_begin.size() && speed.body.size() == body_count);
    SKERRY_CHECK(speed.block_frame_squared.size() == state.block_begin.size() && speed.body_frame.size() == body_count);
    parallel_for(executor, state.block_begin.size(), node_blocks_per_job, [&](std::size_t begin, std::size_t end) {
        for (std::size_t b = begin; b < end; ++b) {
            speed.block_squared[b] = speed.block_frame_squared[b] = max_speed_squared(state, b, Vec3::Zero());
            if (state.body_frame.empty()) continue;
            const Vec3& frame = state.body_frame[static_cast<std::size_t>(state.block_body[b])].velocity;
            if (!frame.isZero(0)) speed.block_frame_squared[b] = max_speed_squared(state, b, frame);
        }
    });
    const auto greatest = [](std::span<const Real> squared) {
        Real highest = 0;
        bool finite = true;
        for (const Real of_block : squared) {
            finite &= of_block >= 0;
            if (of_block > highest) highest = of_block;
        }
        return finite ? std::sqrt(highest) : std::numeric_limits<Real>::quiet_NaN();
    };
    StepVerdict verdict;
    for (std::size_t body = 0; body < body_count; ++body) {
        const Range blocks = state.body_node_blocks[body];
        const auto first = static_cast<std::size_t>(blocks.begin), count = static_cast<std::size_t>(blocks.size());
        speed.body[body] = greatest(speed.block_squared.subspan(first, count));
        speed.body_frame[body] = greatest(speed.block_frame_squared.subspan(first, count));
        if (verdict.fault != StepFault::none) continue;  // the first fault counts, but every speed is written
        const Real altitude = state.body_min_altitude[body];
        if (std::isnan(speed.body[body])) {
            verdict = {StepFault::not_finite, static_cast<Index>(body), first_not_finite(state, blocks), 0};
        } else if (altitude > 0 && blocks.size() > 0) {
            const Fastest fastest = too_fast_node(executor, state, body, speed.body_frame[body], max_strain_step / h);
            if (fastest.node != no_index)
                verdict = {StepFault::too_fast, static_cast<Index>(body), fastest.node,
                           std::sqrt(fastest.rate_squared) * h, fastest.element};
        }
    }
    return verdict;
}

StepVerdict check_distance(std::span<const Vec3> position, std::span<const Range> body_nodes,
                           std::span<const Real> body_mean_edge) {
    for (std::size_t body = 0; body < body_nodes.size(); ++body) {
        if (body_nodes[body].size() == 0 || !(body_mean_edge[body] > 0)) continue;
        const Real distance = position[static_cast<std::size_t>(body_nodes[body].begin)].cwiseAbs().maxCoeff();
        const Real spacing = std::numeric_limits<Real>::epsilon() * distance;
        if (spacing > coarsest_place * body_mean_edge[body])
            return {StepFault::too_far, static_cast<Index>(body), no_index, spacing / body_mean_edge[body]};
    }
    return {};
}

}  // namespace skerry
