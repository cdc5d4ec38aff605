#include "systems/dynamics/stability/stable_step.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <limits>
#include <optional>
#include <vector>

#include "components/check.h"
#include "jobs/parallel_for.h"
#include "systems/dynamics/elements/element_block.h"
#include "systems/dynamics/stability/stiffness_share.h"
#include "systems/dynamics/stability/without_guards.h"
#include "systems/material/extract_rotation.h"

namespace skerry {

namespace {

/// Number of blocks in one piece of the stiffness sum. Their sum takes as long as the bound of one block, so all pieces
/// take about the same time.
constexpr Index blocks_summed = 8;

Index sums_of(Range blocks) {
    return (blocks.size() + blocks_summed - 1) / blocks_summed;
}

/// Kinds of work in a piece of a stable-step check: sums of stiffness over elements, bounds with frame masses
/// (frame_masses.h), and bounds with mass forms or mass shares. A body with frame masses is bounded with these first.
enum class PieceWork : std::uint8_t { sum, bound_in_frame, bound };

/// Consecutive pieces of a stable-step check that do not wait for each other: sums, or bounds for one *wave* of blocks.
/// Waves contain 1, 1, 2, 4, 8... blocks. In a fast test most blocks of a wave stay below the greatest bound of the
/// earlier waves, and need no exact bound.
struct PieceRun {
    PieceWork work;
    bool opens_wave;
    Range blocks;
    std::uint64_t end;  // number of the piece after the last one
};

/// Run of pieces of the same work, from piece `from` on. It ends before piece `until`, or earlier where the work or the
/// wave changes.
PieceRun run_from(Range blocks, bool framed, std::uint64_t from, std::uint64_t until) {
    const Index sums = sums_of(blocks);
    const auto piece = static_cast<Index>(from);
    const auto number_up_to = [&](Index pieces) {
        return static_cast<Index>(std::min<std::uint64_t>(until - from, pieces));
    };
    if (piece < sums) {
        const Index count = number_up_to(sums - piece);
        const Index first = blocks.begin + piece * blocks_summed;
        return {PieceWork::sum, false, {first, std::min(first + count * blocks_summed, blocks.end)}, from + count};
    }
    const bool in_frame = framed && piece - sums < blocks.size();
    const Index bound = (piece - sums) % blocks.size();
    const auto wave = static_cast<Index>(std::bit_floor(static_cast<std::uint64_t>(bound)));
    const Index wave_end = std::min(bound == 0 ? 1 : 2 * wave, blocks.size());
    const Index count = number_up_to(wave_end - bound);
    const Index first = blocks.begin + bound;
    return {
        in_frame ? PieceWork::bound_in_frame : PieceWork::bound, bound == wave, {first, first + count}, from + count};
}

/// Computes the pieces of a stable-step check.
struct Pieces {
    const ElementInputs& elements;
    std::span<const Vec3> position;
    std::span<const Real> mass;
    std::span<Real> stiffness_sum;

    static void for_each_block(Range blocks, auto&& visit) {
        for (auto b = static_cast<std::size_t>(blocks.begin); b < static_cast<std::size_t>(blocks.end); ++b) visit(b);
    }
    void sum(const PieceRun& run, StepEvaluation& check) const {
        if (frame_bound(elements, run.blocks) > 0)
            for_each_block(run.blocks, [&](std::size_t b) { add_deformation(b, check.deformation); });
        for_each_block(run.blocks, [&](std::size_t b) {
            if (has_mass_form(elements, b)) return;
            add_stiffness(elements, b, deformation_of(elements, b, position), stiffness_sum,
                          [](std::size_t) { return true; });
        });
    }
    void add_deformation(std::size_t b, std::array<Real, 9>& sum) const {
        const LaneMat3<Real8> F = deformation_of(elements, b, position);
        const Real8 entry[9] = {F.c0.x, F.c0.y, F.c0.z, F.c1.x, F.c1.y, F.c1.z, F.c2.x, F.c2.y, F.c2.z};
        for (std::size_t i = 0; i < 9; ++i)
            for (std::size_t l = 0; l < element_lanes; ++l) sum[i] += elements.volume[b][l] * entry[i][l];
    }
    /// Calls visit(block, bound) for each block, where `bound` is the upper bound of omega^2 by lane. The bounds use
    /// frame masses in the rotation of the body. Bounds below `threshold` [1/s^2] may be given as `threshold`.
    void bound_in_frame(Range blocks, const Mat3& rotation, Real threshold, auto&& visit) const {
        LaneQuaternion<Real8> q{Real8{} + 1.0, {}, {}, {}};
        for_each_block(blocks, [&](std::size_t b) {
            visit(b, frequency_squared_in_frame(elements, b, deformation_of(elements, b, position), rotation, q,
                                                threshold));
        });
    }
    /// Calls visit(block, bound) for each block, where `bound` is the upper bound of omega^2 by lane. Bounds below
    /// `threshold` [1/s^2] may be given as `threshold`.
    void bound(Range blocks, Real threshold, auto&& visit) const {
        // The search for the frame of a corotational element starts from the frame in the same lane of the block
        // before, since neighbours rotate alike.
        LaneQuaternion<Real8> q{Real8{} + 1.0, {}, {}, {}};
        for_each_block(blocks, [&](std::size_t b) {
            const LaneMat3<Real8> F = deformation_of(elements, b, position);
            visit(b, has_mass_form(elements, b)
                         ? frequency_squared_by_form(elements, b, F, q, threshold)
                         : frequency_squared_of(elements, b, F, mass, stiffness_sum, q, threshold));
        });
    }
};

/// Greatest bound of omega^2 found so far, and the element that has this bound.
struct Greatest {
    Real& bound;  // [1/s^2]
    Index& element;
};
Greatest greatest_of(StepEvaluation& check, const PieceRun& run) {
    if (run.work == PieceWork::bound_in_frame) return {check.in_frame, check.element_in_frame};
    return {check.highest, check.element};
}

/// Updates the greatest bound of omega^2 with the bounds of a block.
void record_bound(std::size_t block, const Real8& bound, Greatest greatest, StepEvaluation& check) {
    for (std::size_t l = 0; l < element_lanes; ++l) {
        const Index element = static_cast<Index>(block * element_lanes + l);
        // a shape that is not finite has no stable step
        if (!(bound[l] <= std::numeric_limits<Real>::max()) && check.broken == no_index) check.broken = element;
        if (bound[l] > greatest.bound) {
            greatest.bound = bound[l];
            greatest.element = element;
        }
    }
}

/// Rotation nearest to the mean deformation gradient of a body.
Mat3 mean_rotation(const std::array<Real, 9>& deformation) {
    const std::array<Real, 4> turn = nearest_rotation(Mat3(deformation.data()), {1, 0, 0, 0});
    return Eigen::Quaternion<Real>(turn[0], turn[1], turn[2], turn[3]).toRotationMatrix();
}

/// If the bound with frame masses is at most this multiple of its value at rest, the bounds with mass forms and mass
/// shares are not computed. They would hardly be sharper.
constexpr Real sharp_in_frame = 1.25;

/// Continues a stable-step check until its first `until` pieces are done. in_chunks(run, body) must divide the blocks
/// of the run into chunks, and call body(begin, end, StepEvaluation of the chunk) for each chunk.
template <class InChunks>
void run_pieces(const Pieces& pieces, Range blocks, std::uint64_t until, StepEvaluation& check, InChunks&& in_chunks) {
    SKERRY_CHECK(pieces.stiffness_sum.size() == pieces.position.size());
    SKERRY_CHECK(pieces.mass.size() == pieces.position.size());
    const Real at_rest = frame_bound(pieces.elements, blocks);
    std::optional<Mat3> rotation;  // rotation of the body; computed once for all waves of this call
    while (check.piece < until) {
        const PieceRun run = run_from(blocks, at_rest > 0, check.piece, until);
        if (run.opens_wave) check.known = greatest_of(check, run).bound;
        if (run.work == PieceWork::sum) {
            pieces.sum(run, check);
        } else if (run.work == PieceWork::bound_in_frame || !(check.in_frame > 0) ||
                   check.in_frame > sharp_in_frame * at_rest) {
            if (run.work == PieceWork::bound_in_frame && !rotation) rotation = mean_rotation(check.deformation);
            in_chunks(run, [&](Index begin, Index end, StepEvaluation& found) {
                const Range chunk{run.blocks.begin + begin, run.blocks.begin + end};
                const auto record = [&](std::size_t b, const Real8& bound) {
                    record_bound(b, bound, greatest_of(found, run), found);
                };
                if (run.work == PieceWork::bound_in_frame)
                    pieces.bound_in_frame(chunk, *rotation, check.known, record);
                else
                    pieces.bound(chunk, check.known, record);
            });
        }
        check.piece = run.end;
    }
}

void clear_stiffness(const ElementInputs& elements, Range blocks, std::span<Real> stiffness_sum) {
    for (Index b = blocks.begin; b < blocks.end; ++b)
        clear_stiffness(elements, static_cast<std::size_t>(b), stiffness_sum);
}

/// Stable step of an element with the given bound of omega^2 [s].
Real step_of(Real bound) {
    return step_times_frequency / std::sqrt(bound);
}

}  // namespace

std::uint64_t pieces_of_check(const ElementInputs& elements, Range blocks) {
    blocks = without_guards(elements, blocks);
    const Index passes = frame_bound(elements, blocks) > 0 ? 2 : 1;
    return static_cast<std::uint64_t>(sums_of(blocks) + passes * blocks.size());
}

void continue_check(Executor& executor, const ElementInputs& elements, Range blocks, std::span<const Vec3> position,
                    std::span<const Real> mass, std::span<Real> stiffness_sum, std::uint64_t until,
                    StepEvaluation& check) {
    // `least`: lower limit on the number of blocks in a chunk, some 20 us of work. `max_chunks`: upper limit on the
    // number of chunks, whose results are stored on the stack.
    constexpr Index least = 8, max_chunks = 64;
    const auto in_chunks = [&](const PieceRun& run, auto&& body) {
        const Index count = run.blocks.size();
        const Index size = std::max(least, (count + max_chunks - 1) / max_chunks);
        if (count <= size) {
            body(0, count, check);
            return;
        }
        std::array<StepEvaluation, static_cast<std::size_t>(max_chunks)> part;
        parallel_for(executor, static_cast<std::size_t>(count), static_cast<std::size_t>(size),
                     [&](std::size_t begin, std::size_t end) {
                         StepEvaluation& own = part[begin / static_cast<std::size_t>(size)];
                         body(static_cast<Index>(begin), static_cast<Index>(end), own);
                     });
        for (Index c = 0; c * size < count; ++c) {
            StepEvaluation& own = part[static_cast<std::size_t>(c)];
            if (check.broken == no_index) check.broken = own.broken;
            const Greatest greatest = greatest_of(check, run), here = greatest_of(own, run);
            if (!(here.bound > greatest.bound)) continue;
            greatest.bound = here.bound;
            greatest.element = here.element;
        }
    };
    run_pieces({elements, position, mass, stiffness_sum}, without_guards(elements, blocks), until, check, in_chunks);
}

StableStep result_of(const StepEvaluation& check) {
    if (check.broken != no_index) return {0, check.broken};
    StableStep found{infinity, no_index};
    if (check.highest > 0) found = {step_of(check.highest), check.element};
    if (!(check.in_frame > 0)) return found;
    // Both bounds of the body are valid if both were computed. The longer step is taken.
    const Real step = step_of(check.in_frame);
    if (!(check.highest > 0) || step > found.step) found = {step, check.element_in_frame};
    return found;
}

StableStep stable_step(const ElementInputs& elements, Range blocks, std::span<const Vec3> position,
                       std::span<const Real> mass, std::span<Real> stiffness_sum) {
    clear_stiffness(elements, blocks, stiffness_sum);
    StepEvaluation check;
    run_pieces({elements, position, mass, stiffness_sum}, without_guards(elements, blocks),
               pieces_of_check(elements, blocks), check,
               [&](const PieceRun& run, auto&& body) { body(0, run.blocks.size(), check); });
    return result_of(check);
}

void element_steps(const ElementInputs& elements, Range blocks, std::span<const Vec3> position,
                   std::span<const Real> mass, std::span<Real> stiffness_sum, std::span<ElementLane> step) {
    SKERRY_CHECK(step.size() == static_cast<std::size_t>(blocks.size()));
    clear_stiffness(elements, blocks, stiffness_sum);
    ElementInputs by_shares = elements;
    by_shares.mass_form = {};
    by_shares.frame_bound = {};
    const Pieces pieces{by_shares, position, mass, stiffness_sum};
    const Range element_blocks = without_guards(elements, blocks);
    for (ElementLane& lanes : step.subspan(static_cast<std::size_t>(element_blocks.size())))
        std::ranges::fill(lanes.lane, infinity);
    const std::uint64_t count = pieces_of_check(by_shares, element_blocks);
    StepEvaluation check;
    for (std::uint64_t piece = 0; piece < count;) {
        const PieceRun run = run_from(element_blocks, false, piece, count);
        piece = run.end;
        if (run.work == PieceWork::sum) {
            pieces.sum(run, check);
            continue;
        }
        pieces.bound(run.blocks, 0, [&](std::size_t b, const Real8& bound) {
            for (std::size_t l = 0; l < element_lanes; ++l)
                step[b - static_cast<std::size_t>(blocks.begin)][l] = bound[l] > 0 ? step_of(bound[l]) : infinity;
        });
    }
}

void lone_frequencies(const ElementInputs& elements, Range blocks, std::span<const Vec3> position,
                      std::span<const Real> mass, std::span<ElementLane> frequency_squared) {
    LaneQuaternion<Real8> q{Real8{} + 1.0, {}, {}, {}};
    for (std::size_t row = 0; row < frequency_squared.size(); ++row) {
        const std::size_t b = row + static_cast<std::size_t>(blocks.begin);
        store(frequency_squared_of(elements, b, deformation_of(elements, b, position), mass, {}, q),
              frequency_squared[row]);
    }
}

void element_stiffnesses(const ElementInputs& elements, Range blocks, std::span<const Vec3> position,
                         std::span<ElementLane> stiffness) {
    LaneQuaternion<Real8> q{Real8{} + 1.0, {}, {}, {}};
    for (std::size_t row = 0; row < stiffness.size(); ++row) {
        const std::size_t b = row + static_cast<std::size_t>(blocks.begin);
        store(stiffness_of(elements, b, deformation_of(elements, b, position), q), stiffness[row]);
    }
}

void find_mass_shares(const ElementInputs& elements, Range blocks, std::span<const Vec3> position,
                      std::span<const Real> mass, std::span<Real> stiffness_sum, std::span<ElementLane> mass_share) {
    constexpr int rounds = 4;
    // Lower limit on the factor by which a mass share changes in a round, so that all elements keep some mass.
    constexpr Real least = 1e-3;
    std::vector<ElementLane> step(mass_share.size());
    for (int round = 0; round < rounds; ++round) {
        element_steps(elements, blocks, position, mass, stiffness_sum, step);
        Real shortest = infinity;
        for (const ElementLane& lanes : step)
            for (const Real own : lanes.lane) shortest = std::min(shortest, own);
        if (!(shortest > 0) || shortest == infinity) return;
        for (std::size_t b = 0; b < step.size(); ++b)
            for (std::size_t l = 0; l < element_lanes; ++l) mass_share[b][l] *= std::max(least, shortest / step[b][l]);
    }
}

}  // namespace skerry
