#include "systems/dynamics/clusters/kick_clusters.h"

#include <algorithm>
#include <array>
#include <type_traits>
#include <utility>

#include "components/lanes.h"
#include "jobs/parallel_for.h"

namespace skerry {

namespace {

// Number of matrix rows whose sums are in registers at the same time. An impulse and a column sum are loaded once for
// all of these rows. Rows add to a column sum in ascending order, so this number does not change the results.
constexpr std::size_t rows_at_once = kernel_parts == 1 ? 8 : 2;
constexpr std::size_t tile = element_lanes;  // rows and columns of one square tile of a matrix

Real8 lanes_at(const Real* from) {
    return *reinterpret_cast<const Real8InMemory*>(from);
}
void store_at(const Real8& from, Real* to) {
    *reinterpret_cast<Real8InMemory*>(to) = from;
}
Real sum_of_lanes(const Real8& lanes) {
    return ((lanes[0] + lanes[1]) + (lanes[2] + lanes[3])) + ((lanes[4] + lanes[5]) + (lanes[6] + lanes[7]));
}

/// A vector for each node of a cluster, stored as three lists: all x, all y and all z components, by index of the node
/// in the cluster. Each list begins at a multiple of the register length, so that one load touches one cache line.
struct ByComponent {
    Real* component[3];

    ByComponent(Real* first, std::size_t stride) : component{first, first + stride, first + 2 * stride} {}
    Vec3 at(std::size_t index) const { return {component[0][index], component[1][index], component[2][index]}; }
};

/// Products of some matrix rows with the vectors of a ByComponent, one for each component. Lane l sums the columns
/// l, l + 8, l + 16 and so on.
template <std::size_t Rows>
struct RowSums {
    std::array<Real8, Rows> x{}, y{}, z{};
};

template <std::size_t Rows, class Visit>
[[gnu::always_inline]] inline void for_each_row(Visit&& visit) {
    [&]<std::size_t... r>(std::index_sequence<r...>) {
        (visit(std::integral_constant<std::size_t, r>()), ...);
    }
    (std::make_index_sequence<Rows>());
}

/// Multiplies `Rows` rows of a symmetric matrix, from row `first_row` on, by the vectors `kick` (impulses on the
/// nodes), and returns the products. Reads only columns 0 to width - 1; `width` is a multiple of the tile.
///
/// Each entry (r, c) is used twice, so that only one triangle of the matrix is read (large matrices do not fit into the
/// caches):
/// - Entry (r, c) times the vector `kick` of column c belongs to the product of row r.
/// - The transposed entry (c, r) times the vector `kick` of row r is added to `sum` at c.
template <std::size_t Rows>
[[gnu::always_inline]] inline RowSums<Rows> add_rows_and_columns(const Real* matrix, std::size_t count,
                                                                 std::size_t first_row, std::size_t width,
                                                                 const ByComponent& kick, const ByComponent& sum) {
    const Real* const row = matrix + first_row * count;
    const auto [kick_x, kick_y, kick_z] = kick.component;
    const auto [sum_x, sum_y, sum_z] = sum.component;
    Real own_x[Rows], own_y[Rows], own_z[Rows];  // contiguous memory, so that one base address serves all rows
    std::copy_n(kick_x + first_row, Rows, own_x);
    std::copy_n(kick_y + first_row, Rows, own_y);
    std::copy_n(kick_z + first_row, Rows, own_z);
    RowSums<Rows> rows;
    for (std::size_t k = 0; k < width; k += tile) {
        const Real8 x = lanes_at(kick_x + k), y = lanes_at(kick_y + k), z = lanes_at(kick_z + k);
        Real8 to_x = lanes_at(sum_x + k), to_y = lanes_at(sum_y + k), to_z = lanes_at(sum_z + k);
        for_each_row<Rows>([&](auto r) __attribute__((always_inline)) {
            const Real8 entries = lanes_at(row + r * count + k);
            rows.x[r] += entries * x;
            rows.y[r] += entries * y;
            rows.z[r] += entries * z;
            to_x += entries * own_x[r];
            to_y += entries * own_y[r];
            to_z += entries * own_z[r];
        });
        store_at(to_x, sum_x + k);
        store_at(to_y, sum_y + k);
        store_at(to_z, sum_z + k);
    }
    return rows;
}

/// Sums the lanes of each register and stores the sums one after the other.
template <std::size_t Rows>
[[gnu::always_inline]] inline void store_sums(const std::array<Real8, Rows>& rows, Real* to) {
    for_each_row<Rows>([&](auto r) __attribute__((always_inline)) { to[r] = sum_of_lanes(rows[r]); });
}
[[gnu::always_inline]] inline void store_sums(const std::array<Real8, tile>& rows, Real* to) {
    const auto pairs = [](const Real8& a, const Real8& b) __attribute__((always_inline)) {
        return __builtin_shufflevector(a, b, 0, 8, 2, 10, 4, 12, 6, 14) +
               __builtin_shufflevector(a, b, 1, 9, 3, 11, 5, 13, 7, 15);
    };
    const auto quads = [](const Real8& a, const Real8& b) __attribute__((always_inline)) {
        return __builtin_shufflevector(a, b, 0, 1, 8, 9, 4, 5, 12, 13) +
               __builtin_shufflevector(a, b, 2, 3, 10, 11, 6, 7, 14, 15);
    };
    const Real8 low = quads(pairs(rows[0], rows[1]), pairs(rows[2], rows[3])),
                high = quads(pairs(rows[4], rows[5]), pairs(rows[6], rows[7]));
    store_at(__builtin_shufflevector(low, high, 0, 1, 2, 3, 8, 9, 10, 11) +
                 __builtin_shufflevector(low, high, 4, 5, 6, 7, 12, 13, 14, 15),
             to);
}

/// Multiplies `Rows` rows of a symmetric matrix, from row `first_row` on, by the vectors `kick`, and stores the
/// products. The rows cross the diagonal in the tile (8x8 block) that begins at row and column `first`:
/// - Entries left of this tile are used twice, also for the entries mirrored at the diagonal (add_rows_and_columns()).
/// - In this tile the entries on both sides of the diagonal are read, so each is used once.
template <std::size_t Rows>
void add_rows_of_tile(const Real* matrix, std::size_t count, std::size_t first, std::size_t first_row,
                      const ByComponent& kick, const ByComponent& sum) {
    RowSums<Rows> rows = add_rows_and_columns<Rows>(matrix, count, first_row, first, kick, sum);
    const Real8 x = lanes_at(kick.component[0] + first), y = lanes_at(kick.component[1] + first),
                z = lanes_at(kick.component[2] + first);
    for_each_row<Rows>([&](auto r) __attribute__((always_inline)) {
        const Real8 entries = lanes_at(matrix + (first_row + r) * count + first);
        rows.x[r] += entries * x;
        rows.y[r] += entries * y;
        rows.z[r] += entries * z;
    });
    store_sums(rows.x, sum.component[0] + first_row);
    store_sums(rows.y, sum.component[1] + first_row);
    store_sums(rows.z, sum.component[2] + first_row);
}

/// Version of add_rows_of_tile() for the last rows if they do not fill a tile. The incomplete tile with the diagonal
/// begins at row and column `first`, and has fewer than 8 rows and columns.
template <std::size_t Rows>
void add_rows_at_end(const Real* matrix, std::size_t count, std::size_t first, std::size_t first_row,
                     const ByComponent& kick, const ByComponent& sum) {
    const RowSums<Rows> rows = add_rows_and_columns<Rows>(matrix, count, first_row, first, kick, sum);
    for_each_row<Rows>([&](auto r) __attribute__((always_inline)) {
        const Real* const entry = matrix + (first_row + r) * count;
        Real x = sum_of_lanes(rows.x[r]), y = sum_of_lanes(rows.y[r]), z = sum_of_lanes(rows.z[r]);
        for (std::size_t k = first; k < count; ++k) {
            x += entry[k] * kick.component[0][k];
            y += entry[k] * kick.component[1][k];
            z += entry[k] * kick.component[2][k];
        }
        sum.component[0][first_row + r] = x;
        sum.component[1][first_row + r] = y;
        sum.component[2][first_row + r] = z;
    });
}

/// Computes the product `sum` of a symmetric matrix and the vectors `kick`.
void multiply(const Real* matrix, std::size_t count, const ByComponent& kick, const ByComponent& sum) {
    std::size_t first = 0;
    for (; first + tile <= count; first += tile)
        for (std::size_t first_row = first; first_row < first + tile; first_row += rows_at_once)
            add_rows_of_tile<rows_at_once>(matrix, count, first, first_row, kick, sum);
    std::size_t first_row = first;
    for (; first_row + 2 <= count; first_row += 2) add_rows_at_end<2>(matrix, count, first, first_row, kick, sum);
    if (first_row < count) add_rows_at_end<1>(matrix, count, first, first_row, kick, sum);
}

/// Index of the tile of working memory at which cluster `c` begins. `begin`: index of the first node of the cluster in
/// the list of all cluster nodes. At most 7 nodes pad each of the c clusters before it to complete tiles. So they fill
/// at most (begin + 7 c)/8 tiles, which is at most begin/8 + c (both rounded down).
std::size_t tile_of(std::size_t begin, std::size_t c) {
    return begin / tile + c;
}
bool have_equal_velocity(std::span<const Index> nodes, std::span<const Vec3> velocity) {
    const Vec3& first = velocity[static_cast<std::size_t>(nodes.front())];
    return std::ranges::all_of(nodes, [&](Index n) { return velocity[static_cast<std::size_t>(n)] == first; });
}

std::size_t padded_count(std::size_t count) {
    return (count + tile - 1) / tile * tile;
}

}  // namespace

bool kick_clusters(Executor& executor, const ClusterKickInputs& inputs, std::span<const Vec3> velocity, bool known,
                   Column<Vec3>& kick, Column<Real>& work, std::span<Vec3> velocity_next) {
    const NodeClusters& clusters = inputs.clusters;
    if (clusters.empty()) return false;
    kick.resize(clusters.nodes.item.size());
    work.resize(6 * tile * tile_of(clusters.nodes.item.size(), clusters.size()));
    parallel_for(executor, clusters.size(), 1, [&](std::size_t first, std::size_t last) {
        for (std::size_t c = first; c < last; ++c) {
            if (!inputs.body_asleep.empty() && inputs.body_asleep[static_cast<std::size_t>(clusters.body[c])]) continue;
            const std::span<const Index> nodes = clusters.nodes[c];
            const std::size_t count = nodes.size();
            const auto begin = static_cast<std::size_t>(clusters.nodes.offset[c]);
            Real* const memory = work.data() + 6 * tile * tile_of(begin, c);
            const ByComponent kicks(memory, padded_count(count)),
                sums(memory + 3 * padded_count(count), padded_count(count));
            const bool moves_freely = inputs.is_unstrained(c) && have_equal_velocity(nodes, velocity_next);
            if (!known) {
                for (std::size_t k = 0; k < count; ++k) {
                    const auto n = static_cast<std::size_t>(nodes[k]);
                    const Vec3 impulse = inputs.mass[n] * (velocity_next[n] - velocity[n]);
                    kick[begin + k] = impulse;
                    for (std::size_t i = 0; i < 3; ++i) kicks.component[i][k] = impulse[static_cast<Index>(i)];
                }
                if (!moves_freely) multiply(clusters.inverse.data() + clusters.first_entry[c], count, kicks, sums);
            }
            if (moves_freely) continue;
            for (std::size_t k = 0; k < count; ++k) {
                const auto n = static_cast<std::size_t>(nodes[k]);
                velocity_next[n] = velocity[n] + sums.at(k);
            }
        }
    });
    return true;
}

}  // namespace skerry
