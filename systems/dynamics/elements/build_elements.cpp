#include "systems/dynamics/elements/build_elements.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <limits>
#include <numeric>

#include "components/check.h"

namespace skerry {

namespace {

/// Places of the elements of a list, block by block.
std::vector<Index> places_of(const ElementList& list, std::span<const std::uint8_t> level) {
    std::vector<Index> order(list.size());
    std::iota(order.begin(), order.end(), 0);
    const auto key = [&](Index e) {
        const auto at = static_cast<std::size_t>(e);
        return std::pair(level.empty() ? std::uint8_t{0} : level[at], list.part[at]);
    };
    std::stable_sort(order.begin(), order.end(), [&](Index a, Index b) { return key(a) < key(b); });
    constexpr std::size_t window = 256;
    std::vector<Index> places;
    for (std::size_t first = 0; first < order.size();) {
        const auto like_first = [&](Index e) {
            const auto at = static_cast<std::size_t>(e), leader = static_cast<std::size_t>(order[first]);
            return list.part[at] == list.part[leader] && list.material[at] == list.material[leader];
        };
        std::size_t end = first;
        while (end < order.size() && like_first(order[end])) ++end;
        for (std::size_t begin = first; begin < end; begin += window)
            std::stable_sort(
                order.begin() + static_cast<std::ptrdiff_t>(begin),
                order.begin() + static_cast<std::ptrdiff_t>(std::min(begin + window, end)), [&](Index a, Index b) {
                    const std::uint8_t la = key(a).first, lb = key(b).first;
                    if (la != lb) return la < lb;
                    return list.nodes_of(static_cast<std::size_t>(a)) < list.nodes_of(static_cast<std::size_t>(b));
                });
        places.insert(places.end(), order.begin() + static_cast<std::ptrdiff_t>(first),
                      order.begin() + static_cast<std::ptrdiff_t>(end));
        while (places.size() % element_lanes != 0) places.push_back(no_index);
        first = end;
    }
    return places;
}

}  // namespace

Real smallest_altitude(const std::array<Index, 4>& tetrahedron, std::span<const Vec3> rest_position) {
    const auto at = [&](std::size_t a) -> const Vec3& {
        return rest_position[static_cast<std::size_t>(tetrahedron[a % 4])];
    };
    Real largest_face = 0;  // twice its area
    for (std::size_t a = 0; a < 4; ++a)
        largest_face = std::max(largest_face, (at(a + 1) - at(a)).cross(at(a + 2) - at(a)).norm());
    return six_volumes(tetrahedron, rest_position) / largest_face;
}

Range append_tetrahedra(std::span<const std::array<Index, 4>> tetrahedra, std::span<const Vec3> rest_position,
                        Index first_node, TetrahedronBlockTable& table) {
    const Index first_block = static_cast<Index>(table.node.size());
    for (std::size_t first = 0; first < tetrahedra.size(); first += element_lanes) {
        TetrahedronNodes node;
        for (NodeLane& corner : node)
            for (Index& n : corner.lane) n = first_node;
        ElementLane volume{}, altitude;
        for (Real& left_over : altitude.lane) left_over = std::numeric_limits<Real>::infinity();
        for (std::size_t l = 0; l < element_lanes && first + l < tetrahedra.size(); ++l) {
            for (std::size_t a = 0; a < 4; ++a) node[a][l] = first_node + tetrahedra[first + l][a];
            volume[l] = six_volumes(tetrahedra[first + l], rest_position) / 6;
            altitude[l] = smallest_altitude(tetrahedra[first + l], rest_position);
        }
        table.node.push_back(node);
        table.volume.push_back(volume);
        table.altitude.push_back(altitude);
        table.leeway.push_back({{1, 1, 1, 1, 1, 1, 1, 1}});
        table.uninverted_until.push_back(-std::numeric_limits<Real>::infinity());
    }
    return {first_block, static_cast<Index>(table.node.size())};
}

AppendedElements append_elements(const ElementList& list, std::span<const std::uint8_t> level, Index first_node,
                                 Index body, ElementBlockTable& blocks, ElementNodeTable& nodes) {
    SKERRY_CHECK(level.empty() || level.size() == list.size());
    const std::size_t first_block = blocks.first.size(), first_row = nodes.node.size();
    AppendedElements appended{{}, {}, places_of(list, level)};
    for (std::size_t place = 0; place < appended.element.size(); place += element_lanes) {
        const std::span<const Index> lanes = std::span(appended.element).subspan(place, element_lanes);
        std::size_t count = 0;
        for (const Index e : lanes)
            if (e != no_index) count = std::max(count, list.nodes_of(static_cast<std::size_t>(e)));
        const std::size_t block = blocks.first.size(), row = nodes.node.size();
        const auto leader = static_cast<std::size_t>(lanes[0]);
        blocks.for_each_column([&](const char*, auto& column, ColumnRole) { column.resize(block + 1); });
        nodes.for_each_column([&](const char*, auto& column, ColumnRole) { column.resize(row + count); });
        blocks.first[block] = static_cast<Index>(row);
        blocks.count[block] = static_cast<Index>(count);
        blocks.body[block] = body;
        blocks.material[block] = list.material[leader];
        blocks.part[block] = list.part[leader];
        blocks.level[block] = level.empty() ? std::uint8_t{0} : level[leader];
        for (Real& w : blocks.rotation[block][0].lane) w = 1;
        blocks.rotation_next[block] = blocks.rotation[block];  // kernels of some laws touch neither, and the step swaps
        for (Real& share : blocks.mass_share[block].lane) share = 1;
        for (std::size_t k = 0; k < count; ++k) nodes.level[row + k] = blocks.level[block];
        for (std::size_t l = 0; l < element_lanes; ++l) {
            const bool used = lanes[l] != no_index;
            const auto e = static_cast<std::size_t>(lanes[l]);
            if (used) blocks.volume[block][l] = list.volume[e];
            const std::size_t own = used ? list.nodes_of(e) : 0;
            for (std::size_t k = 0; k < count; ++k) {
                const std::size_t at = used ? list.first_node[e] + (k < own ? k : 0) : 0;
                nodes.node[row + k][l] = first_node + (used ? list.node[at] : 0);
                for (std::size_t i = 0; i < 3 && k < own; ++i)
                    nodes.gradient[row + k][i][l] = list.gradient[at][static_cast<Eigen::Index>(i)];
                nodes.force[row + k][l] = Vec3::Zero();
            }
        }
    }
    appended.blocks = {static_cast<Index>(first_block), static_cast<Index>(blocks.first.size())};
    appended.nodes = {static_cast<Index>(first_row), static_cast<Index>(nodes.node.size())};
    return appended;
}

void add_lumped_mass(std::span<const std::array<Index, 4>> tetrahedra, std::span<const Vec3> rest_position,
                     std::span<const Real> density, std::span<Real> mass) {
    SKERRY_CHECK(density.size() == tetrahedra.size());
    for (std::size_t t = 0; t < tetrahedra.size(); ++t) {
        const Real share = density[t] * six_volumes(tetrahedra[t], rest_position) / 24;  // rho V / 4
        for (const Index n : tetrahedra[t]) mass[static_cast<std::size_t>(n)] += share;
    }
}

void build_corners(const ElementBlockTable& blocks, const ElementNodeTable& nodes, std::size_t node_count,
                   Ragged<Index>& corners) {
    // Counting sort: count, sum up, fill in element order.
    const auto for_each_corner = [&](auto&& visit) {
        for (std::size_t b = 0; b < blocks.first.size(); ++b) {
            const auto first = static_cast<std::size_t>(blocks.first[b]);
            const auto count = static_cast<std::size_t>(blocks.count[b]);
            for (std::size_t l = 0; l < element_lanes; ++l) {
                if (!(blocks.volume[b][l] > 0)) continue;
                const Index anchor = nodes.node[first][l];
                for (std::size_t k = 0; k < count; ++k)
                    if (k == 0 || nodes.node[first + k][l] != anchor)
                        visit(static_cast<std::size_t>(nodes.node[first + k][l]), (first + k) * element_lanes + l);
            }
        }
    };
    corners.offset.assign(node_count + 1, 0);
    for_each_corner([&](std::size_t n, std::size_t) { ++corners.offset[n + 1]; });
    for (std::size_t n = 0; n < node_count; ++n) corners.offset[n + 1] += corners.offset[n];
    corners.item.resize(static_cast<std::size_t>(corners.offset[node_count]));
    for_each_corner([&](std::size_t n, std::size_t corner) {
        corners.item[static_cast<std::size_t>(corners.offset[n]++)] = static_cast<Index>(corner);
    });
    for (std::size_t n = node_count; n > 0; --n) corners.offset[n] = corners.offset[n - 1];
    corners.offset[0] = 0;
}

}  // namespace skerry
