// Bounds the stiffness K of a body that is strained in few places (docs/methods/stable_step.md 2.5). Element e has the
// mass form M_e, the stiffness K_e <= w_e M_e and the bound w_e on its omega^2. M is the mass of the nodes, and (x)^+
// is x if positive, else 0. Any number `base` gives an excess matrix E with
//     E = sum (w_e - base)^+ M_e ,     K <= base sum M_e + E <= base M + E .
// E is below M times max_i ( sum_j |E_ij| d_j )/( m_i d_i ) for any positive weights d_i of the nodes i with masses m_i
// (Collatz 1942). Entries of E are scalars, since mass forms are the same for x, y and z.
#include "systems/dynamics/stability/strained_step.h"

#include <algorithm>
#include <cmath>

#include "components/check.h"
#include "systems/dynamics/elements/element_block.h"
#include "systems/dynamics/stability/mass_search.h"
#include "systems/dynamics/stability/stiffness_share.h"

namespace skerry {

namespace {

// Ratio of the base of the bound to the omega^2 for which the step `goal.longest` is stable. With this ratio most
// elements of a strained body are below the base, and thus have no excess.
constexpr Real base_factor = 1.1;
// Number of rounds of the iteration for the node weights d. After many rounds the ratio of the row sum to the mass
// times d would be equal at all nodes.
constexpr int rounds = 4;
// The omega^2 of an element is searched up to 10^ranges times the base. If it is greater, it counts as infinite.
constexpr int ranges = 3;

/// Parts of the work memory. `excess`: excess of omega^2 of each element over the base [1/s^2]. `weight`: weight d_i of
/// each node i. `row`: row sum of the excess matrix E for each node, sum_j |E_ij| d_j.
struct Memory {
    std::span<Real> excess, weight, row;

    Memory(std::span<Real> storage, Range nodes, Range blocks) {
        const auto node_count = static_cast<std::size_t>(nodes.size());
        excess = storage.first(element_lanes * static_cast<std::size_t>(blocks.size()));
        weight = storage.subspan(excess.size(), node_count);
        row = storage.subspan(excess.size() + node_count, node_count);
    }
};

/// Finds the excess of omega^2 of each element over the base [1/s^2]. `stable`: step during which springs relax [s].
/// Returns true if any element has an excess.
bool find_excess(const ElementInputs& elements, Range blocks, std::span<const Vec3> position, Real base, Real stable,
                 std::span<Real> excess) {
    LaneQuaternion<Real8> q{Real8{} + 1.0, {}, {}, {}};
    bool any = false;
    for (std::size_t i = 0; i < static_cast<std::size_t>(blocks.size()); ++i) {
        const std::size_t b = static_cast<std::size_t>(blocks.begin) + i;
        const LaneMat3<Real8> F = deformation_of(elements, b, position);
        Real tested_bound = base;
        bool out_of_range = true;  // true if an element needs more than ten times `tested_bound`
        for (int range = 0; range < ranges && out_of_range; ++range, tested_bound *= 10) {
            const Real8 needed = stepped_by_form(elements, b, F, q, tested_bound, stable);
            out_of_range = false;
            for (std::size_t l = 0; l < element_lanes; ++l) {
                Real& more = excess[element_lanes * i + l];
                if (range > 0 && !std::isinf(more)) continue;
                more = elements.volume[b][l] > 0 && !(needed[l] <= base) ? needed[l] - base : 0;
                out_of_range |= std::isinf(more);
                any |= !(more <= 0);
            }
        }
    }
    return any;
}

LaneVec3<Real8> multiply(const LaneSymmetric<Real8>& s, const LaneVec3<Real8>& x) {
    return {s.xx * x.x + s.xy * x.y + s.zx * x.z, s.xy * x.x + s.yy * x.y + s.yz * x.z,
            s.zx * x.x + s.yz * x.y + s.zz * x.z};
}

/// Adds the elements of a block to the row sums of the excess matrix E: row[i] += sum_j |E_ij| d_j over the nodes i and
/// j of each element, with node weights d. `excess`: factors on the mass forms. Lanes with the excess 0 are left out,
/// because the mass form of an unused lane is infinite.
void add_rows(const BlockNodes& nodes, const Real8& excess, const LaneSymmetric<Real8>& mass_form, Index first_node,
              std::span<const Real> weight, std::span<Real> row) {
    const LaneSymmetric<Real8> form = excess * mass_form;
    for (Index k = 0; k < nodes.count; ++k) {
        const LaneVec3<Real8> moved = multiply(form, load_gradient(nodes.gradient[k]));
        Real8 sum{};
        for (Index j = 0; j < nodes.count; ++j) {
            Real8 node_weight;
            for (std::size_t l = 0; l < element_lanes; ++l)
                node_weight[l] = weight[static_cast<std::size_t>(nodes.node[j][l] - first_node)];
            const Real8 entry = dot(moved, load_gradient(nodes.gradient[j]));
            sum += (entry < 0.0 ? -entry : entry) * node_weight;
        }
        for (std::size_t l = 0; l < element_lanes; ++l)
            if (excess[l] != 0) row[static_cast<std::size_t>(nodes.node[k][l] - first_node)] += sum[l];
    }
}

}  // namespace

std::size_t strained_step_memory(Range nodes, Range blocks) {
    return element_lanes * static_cast<std::size_t>(blocks.size()) + 2 * static_cast<std::size_t>(nodes.size());
}

Real strained_step(const ElementInputs& elements, Range blocks, Range nodes, std::span<const Vec3> position,
                   std::span<const Real> mass, const StableStepGoal& goal, std::span<Real> memory) {
    SKERRY_CHECK(memory.size() >= strained_step_memory(nodes, blocks));
    const Memory parts(memory, nodes, blocks);
    const Real base = base_factor * step_times_frequency * step_times_frequency / (goal.longest * goal.longest);
    if (!find_excess(elements, blocks, position, base, goal.stable, parts.excess))
        return step_times_frequency / std::sqrt(base);
    const std::span<const Real> node_mass =
        mass.subspan(static_cast<std::size_t>(nodes.begin), static_cast<std::size_t>(nodes.size()));
    // Nodes without mass never move and get the weight 0.
    for (std::size_t n = 0; n < node_mass.size(); ++n) parts.weight[n] = node_mass[n] > 0 ? 1 : 0;
    Real least = infinity;  // lowest number found so far for which E <= least M, as at the top of the file [1/s^2]
    for (int round = 0; round < rounds; ++round) {
        std::ranges::fill(parts.row, Real(0));
        for (std::size_t i = 0; i < static_cast<std::size_t>(blocks.size()); ++i) {
            const Real* const excess = &parts.excess[element_lanes * i];
            if (std::all_of(excess, excess + element_lanes, [](Real more) { return more == 0; })) continue;
            const std::size_t b = static_cast<std::size_t>(blocks.begin) + i;
            Real8 more;
            for (std::size_t l = 0; l < element_lanes; ++l) more[l] = excess[l];
            add_rows(elements.nodes_of(b), more, inverse_of(load_form(elements.mass_form[b])), nodes.begin,
                     parts.weight, parts.row);
        }
        Real bound = 0;
        for (std::size_t n = 0; n < node_mass.size(); ++n) {
            if (!(parts.weight[n] > 0)) continue;
            const Real ratio = parts.row[n] / (node_mass[n] * parts.weight[n]);
            if (!(ratio <= bound) && !std::isnan(bound)) bound = ratio;  // a NaN is kept
            parts.row[n] = ratio;
        }
        least = std::min(least, bound);
        if (!(bound > 0) || !std::isfinite(bound)) break;
        // Multiplies each node weight d by sqrt(r / r_max), at least by 1e-3 so that it stays positive. r is the row
        // sum divided by (mass times d), r_max the greatest r. Nodes at which the entries of E are small need only a
        // small weight.
        for (std::size_t n = 0; n < node_mass.size(); ++n)
            parts.weight[n] *= std::sqrt(std::max(parts.row[n] / bound, Real(1e-6)));
    }
    return step_times_frequency / std::sqrt(base + least);
}

}  // namespace skerry
