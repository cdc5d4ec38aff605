#include "systems/solver/operators/contact_runs.h"

#include <algorithm>

namespace skerry {

namespace {

/// out += sum of columns times factors. Adding six columns at once reduces the reads and writes of `out`.
void add_columns(std::span<const Real* const> column, std::span<const Real> factor, std::span<Real> out) {
    constexpr std::size_t at_once = 6;
    std::size_t c = 0;
    for (; c + at_once <= column.size(); c += at_once) {
        const Real *const a0 = column[c], *const a1 = column[c + 1], *const a2 = column[c + 2],
                          *const a3 = column[c + 3], *const a4 = column[c + 4], *const a5 = column[c + 5];
        const Real f0 = factor[c], f1 = factor[c + 1], f2 = factor[c + 2], f3 = factor[c + 3], f4 = factor[c + 4],
                   f5 = factor[c + 5];
        Real* const to = out.data();
#pragma omp simd
        for (std::size_t k = 0; k < out.size(); ++k)
            to[k] += ((a0[k] * f0 + a1[k] * f1) + (a2[k] * f2 + a3[k] * f3)) + (a4[k] * f4 + a5[k] * f5);
    }
    for (; c < column.size(); ++c) {
        const Real* const a = column[c];
        const Real f = factor[c];
        Real* const to = out.data();
#pragma omp simd
        for (std::size_t k = 0; k < out.size(); ++k) to[k] += a[k] * f;
    }
}

Vec4 node_velocity(const Mat3& turn, std::span<const Real> in_frame, std::size_t node) {
    const Vec3 velocity(in_frame[3 * node], in_frame[3 * node + 1], in_frame[3 * node + 2]);
    return padded(turn * velocity);
}

}  // namespace

void SpreadImpulses::add(const ImplicitCoupling& coupling, std::size_t body, Index touched_index, const Vec4& impulse) {
    if (impulse.isZero(0)) return;
    const Vec3 in_frame = coupling.impulse_turn[body] * impulse.head<3>();
    const std::size_t numbers = coupling.numbers(body);
    const Real* const columns = coupling.columns(body, touched_index).data();
    for (std::size_t c = 0; c < 3; ++c) {
        column_.push_back(columns + c * numbers);
        factor_.push_back(in_frame[static_cast<Index>(c)]);
    }
}

std::span<const Real> SpreadImpulses::velocities(std::size_t numbers) {
    sum_.assign(numbers, 0);
    add_columns(column_, factor_, sum_);
    return sum_;
}

void ContactRuns::list(std::span<const LumpedContact> contact, const ThroughGroups& traversal, std::size_t rows,
                       std::size_t most_nodes) {
    run_.clear();
    patch_.clear();
    node_.clear();
    block_.clear();
    moved_ = 0;
    moved_nodes_.resize(contact.size());
    node_index_.assign(rows, no_index);
    const auto count = static_cast<Index>(contact.size());
    for (Index begin = 0, end = 0; begin < count; begin = end) {
        const std::size_t first = node_.size();
        for (; end < count; ++end) {
            const LumpedContact& lumped = contact[static_cast<std::size_t>(end)];
            const std::size_t before = node_.size();
            for (std::size_t a = 0; a < static_cast<std::size_t>(lumped.node_count); ++a) {
                Index& entry = node_index_[static_cast<std::size_t>(lumped.node[a])];
                const auto e = static_cast<std::size_t>(entry);
                const bool listed = entry != no_index && e >= first && e < node_.size() && node_[e] == lumped.node[a];
                if (listed || traversal.touched_index(lumped.node[a]) == no_index) continue;
                entry = static_cast<Index>(node_.size());
                node_.push_back(lumped.node[a]);
            }
            if (node_.size() - first > most_nodes && end > begin) {
                node_.resize(before);
                break;
            }
        }
        Run run{begin, end, patch_.size(), patch_.size()};
        list_patches(contact, traversal, first, run);
        run_.push_back(run);
    }
    pending_.assign(node_.size(), Vec4::Zero());
}

void ContactRuns::list_patches(std::span<const LumpedContact> contact, const ThroughGroups& traversal,
                               std::size_t first_node, Run& run) {
    std::sort(node_.begin() + static_cast<std::ptrdiff_t>(first_node), node_.end());
    // Sorting by rows of the region groups the nodes by body, because the nodes of a body that have contacts are
    // consecutive rows.
    for (std::size_t begin = first_node; begin < node_.size();) {
        const std::size_t body = traversal.body_of(node_[begin]);
        std::size_t end = begin;
        for (; end < node_.size() && traversal.body_of(node_[end]) == body; ++end)
            node_index_[static_cast<std::size_t>(node_[end])] = static_cast<Index>(end);
        patch_.push_back(
            {begin, end - begin, block_.size(), body, node_[begin] - traversal.touched_index(node_[begin])});
        add_blocks(traversal, patch_.back());
        begin = end;
    }
    run.last_patch = patch_.size();
    for (Index i = run.begin; i < run.end; ++i) {
        const auto at = static_cast<std::size_t>(i);
        const LumpedContact& lumped = contact[at];
        for (std::size_t a = 0; a < static_cast<std::size_t>(lumped.node_count); ++a) {
            MovedNodes& target = moved_nodes_[at][a];
            target.count = 0;
            if (traversal.touched_index(lumped.node[a]) == no_index) continue;
            const auto self = static_cast<std::size_t>(node_index_[static_cast<std::size_t>(lumped.node[a])]);
            std::size_t p = run.first_patch;
            while (self >= patch_[p].first + patch_[p].count) ++p;
            const Patch& patch = patch_[p];
            target = {patch.first, patch.count, self, patch.first_block + (self - patch.first) * patch.count};
            moved_ += static_cast<Real>(patch.count);
        }
    }
}

void ContactRuns::add_blocks(const ThroughGroups& traversal, const Patch& patch) {
    const std::span<const Index> node = std::span<const Index>(node_).subspan(patch.first, patch.count);
    for (const Index from : node)
        for (const Index to : node) {
            PaddedMat3 block;
            block << traversal.deforming().block(patch.body, to - patch.first_row, from - patch.first_row),
                Eigen::RowVector3d::Zero();
            block_.push_back(block);
        }
    const std::size_t touched = traversal.deforming().nodes[patch.body].size();
    if (patch.count < touched) moved_ += static_cast<Real>(patch.count * touched);
}

void ContactRuns::apply(std::size_t i, const LumpedContact& contact, const ThroughGroups& traversal,
                        const Vec4& impulse, Vec4* velocity) {
    for (std::size_t a = 0; a < static_cast<std::size_t>(contact.node_count); ++a) {
        const MovedNodes& target = moved_nodes_[i][a];
        if (target.count == 0) {
            traversal.apply_to_node(contact, a, impulse, velocity);
            continue;
        }
        const Vec4 weighted = contact.weight[a] * impulse;
        pending_[target.self] += weighted;
        const Index* const node = node_.data() + target.first;
        const PaddedMat3* const block = block_.data() + target.row;
        for (std::size_t k = 0; k < target.count; ++k) velocity[node[k]].noalias() += block[k] * weighted.head<3>();
    }
}

void ContactRuns::spread(const Run& run, const ThroughGroups& traversal, Vec4* velocity) {
    const ImplicitCoupling& coupling = traversal.deforming();
    for (std::size_t p = run.first_patch; p < run.last_patch; ++p) {
        const Patch& patch = patch_[p];
        const std::size_t touched = coupling.nodes[patch.body].size();
        const std::span<Vec4> pending = std::span<Vec4>(pending_).subspan(patch.first, patch.count);
        impulses_.start();
        if (patch.count < touched)
            for (std::size_t k = 0; k < patch.count; ++k)
                impulses_.add(coupling, patch.body, node_[patch.first + k] - patch.first_row, pending[k]);
        std::ranges::fill(pending, Vec4::Zero());
        if (impulses_.empty()) continue;
        const std::span<const Real> moved = impulses_.velocities(3 * touched);
        // Skip the nodes of the run, whose velocities are up to date.
        std::size_t next = patch.first;
        for (std::size_t k = 0; k < touched; ++k) {
            const Index row = patch.first_row + static_cast<Index>(k);
            if (next < patch.first + patch.count && node_[next] == row)
                ++next;
            else
                velocity[row] += node_velocity(coupling.turn[patch.body], moved, k);
        }
    }
}

void ContactRuns::spread_sums(const ThroughGroups& traversal, Vec4* velocity) {
    const ImplicitCoupling& coupling = traversal.deforming();
    for (std::size_t begin = 0; begin < sum_.size();) {
        if (traversal.touched_index(static_cast<Index>(begin)) == no_index) {
            ++begin;
            continue;
        }
        const std::size_t body = traversal.body_of(static_cast<Index>(begin)), touched = coupling.nodes[body].size();
        impulses_.start();
        for (std::size_t k = 0; k < touched; ++k) impulses_.add(coupling, body, static_cast<Index>(k), sum_[begin + k]);
        if (!impulses_.empty()) {
            const std::span<const Real> moved = impulses_.velocities(3 * touched);
            for (std::size_t k = 0; k < touched; ++k)
                velocity[begin + k] += node_velocity(coupling.turn[body], moved, k);
        }
        begin += touched;
    }
}

}  // namespace skerry
