#include "systems/solver/regions/cable_rows.h"

#include <algorithm>

#include "systems/solver/local/rigid_part.h"

namespace skerry {
namespace {

const CableBlock& block_of(const RegionStage& stage, Index cable) {
    return stage.inputs.cables.block[static_cast<std::size_t>(cable)];
}

CableLaw& law_of(const RegionStage& stage, Index cable) {
    return stage.memory.cable_law[static_cast<std::size_t>(cable)];
}

/// Writes the mobility matrix (CableLaw::mobility), which maps impulses to velocity changes.
/// - Cable: it maps the impulses of the tensions of all segments to the speeds at which they shorten the segments.
/// - Tie, which the solver treats like a cable: the matrix is 3x3. It maps the impulse on each point to the change of
///   the sum of the velocities of its points.
void find_mobility(const CableLaw& law, const BodyMemory& memory, const ThroughGroups& traversal,
                   std::span<Real> mobility) {
    const std::size_t count = law.segments(), first = static_cast<std::size_t>(law.first),
                      points = static_cast<std::size_t>(law.points);
    std::ranges::fill(mobility, Real(0));
    // An impulse at point b changes the velocity of point a by `block` times this impulse. Point p ends segment p - 1
    // and begins segment p, so its velocity lengthens segment p - 1 and shortens segment p.
    const auto for_each_segment = [&](std::size_t point, auto&& visit) {
        if (point > 0) visit(point - 1, Real(1));
        if (point < count) visit(point, Real(-1));
    };
    for (std::size_t a = 0; a < points; ++a)
        for (std::size_t b = 0; b < points; ++b) {
            const Mat3 block = traversal.coupling(memory.contact[first + a], memory.contact[first + b]) +
                               rigid_coupling(memory.part[first + a], memory.part[first + b]);
            if (law.is_tie) {
                Eigen::Map<Mat3>(mobility.data()) += block;
                continue;
            }
            for_each_segment(a, [&](std::size_t row, Real row_sign) {
                for_each_segment(b, [&](std::size_t column, Real column_sign) {
                    mobility[row * count + column] +=
                        row_sign * column_sign * law.direction[row].dot(block * law.direction[column]);
                });
            });
        }
}

void add_to_sums(const CableLaw& law, LoadSums& sums) {
    if (law.is_tie) {
        sums.moving += law.squared_residual();
    } else {
        const Real mobility = law.far_mobility[0];
        if (!(mobility > 0)) return;
        Real rate = 0;
        for (const Real segment_rate : law.rate) rate += segment_rate;
        sums.moving += rate * rate / mobility;
    }
    const Real squared_residual = law.squared_residual();
    if (squared_residual == 0) return;
    sums.separating = false;
    sums.squared_residual += squared_residual;
}

}  // namespace

void load_cable(const RegionStage& stage, Index cable, const BodyMemory& memory, const ThroughGroups& traversal,
                Index first, LoadSums& sums) {
    RegionMemory& data = stage.memory;
    const CableBlock& block = block_of(stage, cable);
    const auto points = static_cast<std::size_t>(block.points.size()),
               count = static_cast<std::size_t>(block.impulses()), begin = static_cast<std::size_t>(block.points.begin),
               all = stage.inputs.cables.stencil.size();
    const auto numbers = [&](std::size_t copy) { return data.cable_numbers.span().subspan(copy * all + begin, count); };
    const std::span<Real> mobility =
        data.cable_mobility.span().subspan(static_cast<std::size_t>(block.mobility), count * count);
    CableLaw& law = law_of(stage, cable);
    law = {.first = first,
           .moving = first,
           .points = block.points.size(),
           .is_tie = block.is_tie,
           .by_length = block.by_length,
           .prescribed = block.prescribed,
           .direction = stage.inputs.cables.direction.subspan(begin, count),
           .most_ratio = stage.inputs.cables.most_ratio.subspan(begin, count),
           .mobility = mobility,
           .far_mobility = numbers(0),
           .impulse = numbers(1),
           .rate = numbers(2),
           .before = numbers(3),
           .previous = numbers(4)};
    const Index last = first + law.points - 1;
    while (law.moving < last && memory.contact[static_cast<std::size_t>(law.moving)].inverse_diagonal == 0)
        ++law.moving;
    find_mobility(law, memory, traversal, mobility);
    if (!law.is_tie) law.prepare();
    std::ranges::fill(law.impulse, Real(0));
    const auto velocity = [&](std::size_t p) {
        const std::size_t i = static_cast<std::size_t>(first) + p;
        const Vec4* const rows = memory.velocity.data();
        return Vec3(
            (memory.contact[i].offset +
             add_rigid_velocities(memory.part[i], rows, add_node_velocities(memory.contact[i], rows, Vec4::Zero())))
                .head<3>());
    };
    if (law.is_tie) {
        Vec3 sum = Vec3::Zero();
        for (std::size_t p = 0; p < points; ++p) sum += velocity(p);
        Eigen::Map<Vec3>(law.rate.data()) = sum;
    } else {
        for (std::size_t s = 0; s < count; ++s) law.rate[s] = law.direction[s].dot(velocity(s + 1) - velocity(s));
    }
    add_to_sums(law, sums);
}

void take_cable_impulses(const RegionStage& stage, Index cable, const BodyMemory& memory) {
    const CableLaw& law = law_of(stage, cable);
    const std::span<const Real> last = rows_of(stage.out.cable_impulse, block_of(stage, cable).points);
    for (std::size_t p = 0; p < last.size(); ++p)
        memory.impulse[static_cast<std::size_t>(law.first) + p] = padded(law.at_point(last, p));
}

void write_cable(const RegionStage& stage, Index cable, const BodyMemory& memory) {
    const CableLaw& law = law_of(stage, cable);
    const Range points = block_of(stage, cable).points;
    law.read(memory.impulse.subspan(static_cast<std::size_t>(law.first)), law.impulse);
    if (law.is_tie) {  // take_tie_rows() computes the work of the tie
        std::ranges::copy(law.impulse, rows_of(stage.out.cable_impulse, points).begin());
        return;
    }
    // Rounding can make the tension of a slack segment negative.
    for (Real& impulse : law.impulse) impulse = std::max(Real(0), impulse);
    std::ranges::copy(law.impulse, rows_of(stage.out.cable_impulse, points).begin());
    Real work = 0, loss = 0;
    Vec3 sum = Vec3::Zero();
    Real drawn = 0;             // speed at which the cable slides past point p towards point 0 [m/s]
    Vec3 after = Vec3::Zero();  // mean velocity of point p + 1 in the step [m/s]
    for (Index p = points.size(); p-- > 0;) {
        const Vec3 impulse = memory.impulse[static_cast<std::size_t>(law.first + p)].head<3>();
        Vec3 velocity = stage.inputs.cables.velocity[static_cast<std::size_t>(points.begin + p)];
        const Stencil& stencil = stage.inputs.cables.stencil[static_cast<std::size_t>(points.begin + p)];
        for (std::size_t a = 0; a < 4; ++a) {
            const auto node = static_cast<std::size_t>(stencil.node[a]);
            if (stencil.weight[a] == 0) continue;
            const Vec3 part = stencil.weight[a] / 2 * (stage.inputs.velocity[node] + stage.out.velocity_next[node]);
            velocity += part;
            if (!(stage.inputs.inverse_mass[node] > 0)) continue;
            sum += stencil.weight[a] * impulse;
            work += impulse.dot(part);
        }
        const auto s = static_cast<std::size_t>(p);
        if (s < law.segments()) drawn -= law.direction[s].dot(after - velocity);
        if (s > 0 && s < law.segments()) loss += (law.impulse[s - 1] - law.impulse[s]) * drawn;
        after = velocity;
    }
    stage.out.cable_work[static_cast<std::size_t>(cable)] = work;
    stage.out.cable_loss[static_cast<std::size_t>(cable)] = loss;
    stage.out.cable_sum[static_cast<std::size_t>(cable)] = sum;
}

}  // namespace skerry
