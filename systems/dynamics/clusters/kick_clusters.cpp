#include "systems/dynamics/clusters/kick_clusters.h"

#include <algorithm>

#include "components/lanes.h"
#include "jobs/parallel_for.h"

namespace skerry {

namespace {

constexpr std::size_t rows_at_once = 4;  // what is loaded of kicks and sums serves all of them

Real8 lanes_at(const Real* from) {
    return *reinterpret_cast<const Real8InMemory*>(from);
}
void store_at(const Real8& from, Real* to) {
    *reinterpret_cast<Real8InMemory*>(to) = from;
}
Real sum_of_lanes(const Real8& of) {
    return ((of[0] + of[4]) + (of[2] + of[6])) + ((of[1] + of[5]) + (of[3] + of[7]));
}

/// A vector of a cluster, by component and place.
struct ByComponent {
    Real* component[3];

    ByComponent(Real* first, std::size_t count) : component{first, first + count, first + 2 * count} {}
    Vec3 at(std::size_t place) const { return {component[0][place], component[1][place], component[2][place]}; }
};

/// Adds to sum[.. place + Rows) what rows place .. place + Rows of a symmetric matrix give up to their diagonals, and
/// those columns above: only one triangle is read, since large matrices do not fit into the caches.
template <std::size_t Rows>
void add_rows_and_columns(const Real* matrix, std::size_t count, std::size_t place, const ByComponent& kick,
                          const ByComponent& sum) {
    const Real* const row = matrix + place * count;
    Real8 lanes[Rows][3]{};
    Real rest[Rows][3]{};
    std::size_t k = 0;
    for (; k + element_lanes <= place; k += element_lanes) {
        const Real8 kick_x = lanes_at(kick.component[0] + k), kick_y = lanes_at(kick.component[1] + k),
                    kick_z = lanes_at(kick.component[2] + k);
        Real8 sum_x = lanes_at(sum.component[0] + k), sum_y = lanes_at(sum.component[1] + k),
              sum_z = lanes_at(sum.component[2] + k);
        for (std::size_t r = 0; r < Rows; ++r) {
            const Real8 entries = lanes_at(row + r * count + k);
            lanes[r][0] += entries * kick_x;
            lanes[r][1] += entries * kick_y;
            lanes[r][2] += entries * kick_z;
            sum_x += entries * kick.component[0][place + r];
            sum_y += entries * kick.component[1][place + r];
            sum_z += entries * kick.component[2][place + r];
        }
        store_at(sum_x, sum.component[0] + k);
        store_at(sum_y, sum.component[1] + k);
        store_at(sum_z, sum.component[2] + k);
    }
    for (std::size_t r = 0; r < Rows; ++r)
        for (std::size_t c = 0; c < 3; ++c) {
            const Real* const entries = row + r * count;
            for (std::size_t j = k; j < place; ++j) {
                rest[r][c] += entries[j] * kick.component[c][j];
                sum.component[c][j] += entries[j] * kick.component[c][place + r];
            }
            for (std::size_t j = place; j < place + Rows; ++j) rest[r][c] += entries[j] * kick.component[c][j];
            sum.component[c][place + r] = sum_of_lanes(lanes[r][c]) + rest[r][c];
        }
}

/// sum = matrix kick.
void multiply(const Real* matrix, std::size_t count, const ByComponent& kick, const ByComponent& sum) {
    std::size_t place = 0;
    for (; place + rows_at_once <= count; place += rows_at_once)
        add_rows_and_columns<rows_at_once>(matrix, count, place, kick, sum);
    for (; place < count; ++place) add_rows_and_columns<1>(matrix, count, place, kick, sum);
}

}  // namespace

bool kick_clusters(Executor& executor, const ClusterKickInputs& inputs, std::span<const Vec3> velocity, bool known,
                   Column<Vec3>& kick, Column<Real>& work, std::span<Vec3> velocity_next) {
    const NodeClusters& clusters = inputs.clusters;
    if (clusters.empty()) return false;
    kick.resize(clusters.nodes.item.size());
    work.resize(6 * clusters.nodes.item.size());
    parallel_for(executor, clusters.size(), 1, [&](std::size_t first, std::size_t last) {
        for (std::size_t c = first; c < last; ++c) {
            if (!inputs.body_asleep.empty() && inputs.body_asleep[static_cast<std::size_t>(clusters.body[c])]) continue;
            const std::span<const Index> nodes = clusters.nodes[c];
            const std::size_t count = nodes.size();
            const auto begin = static_cast<std::size_t>(clusters.nodes.offset[c]);
            const ByComponent kicks(work.data() + 6 * begin, count), sums(work.data() + 6 * begin + 3 * count, count);
            if (!known) {
                for (std::size_t k = 0; k < count; ++k) {
                    const auto n = static_cast<std::size_t>(nodes[k]);
                    const Vec3 impulse = inputs.mass[n] * (velocity_next[n] - velocity[n]);
                    kick[begin + k] = impulse;
                    for (std::size_t i = 0; i < 3; ++i) kicks.component[i][k] = impulse[static_cast<Index>(i)];
                }
                multiply(clusters.inverse.data() + clusters.first_entry[c], count, kicks, sums);
            }
            for (std::size_t k = 0; k < count; ++k) {
                const auto n = static_cast<std::size_t>(nodes[k]);
                velocity_next[n] = velocity[n] + sums.at(k);
            }
        }
    });
    return true;
}

}  // namespace skerry
