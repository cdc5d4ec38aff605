#include "systems/dynamics/elements/build_elements.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <numeric>

#include "components/any_table.h"
#include "components/check.h"

namespace skerry {

namespace {

using Order = std::span<Index>;  // indices of elements in an ElementList

/// Mean rest position of the nodes of each element [m].
std::vector<Vec3> centres_of(const ElementList& list, std::span<const Vec3> rest_position) {
    std::vector<Vec3> centre(list.size());
    for (std::size_t e = 0; e < list.size(); ++e) {
        Vec3 sum = Vec3::Zero();
        for (std::size_t k = list.first_node[e]; k < list.first_node[e + 1]; ++k)
            sum += rest_position[static_cast<std::size_t>(list.node[k])];
        centre[e] = sum / static_cast<Real>(list.nodes_of(e));
    }
    return centre;
}

/// Halves a group of elements along the longest side of the bounding box of their centres, until every half is small
/// enough for a patch. Appends the number of elements of each patch to `patch_size`.
void split_into_patches(Order group, std::span<const Vec3> centre, std::vector<std::size_t>& patch_size) {
    const std::size_t patches = (group.size() + elements_per_patch - 1) / elements_per_patch;
    if (patches <= 1) {
        std::ranges::sort(group);
        if (!group.empty()) patch_size.push_back(group.size());
        return;
    }
    const auto at = [&](Index e) -> const Vec3& { return centre[static_cast<std::size_t>(e)]; };
    Vec3 low = at(group[0]), high = low;
    for (const Index e : group) {
        low = low.cwiseMin(at(e));
        high = high.cwiseMax(at(e));
    }
    Eigen::Index axis = 0;
    (high - low).maxCoeff(&axis);
    const std::size_t half = group.size() * (patches / 2) / patches;
    std::nth_element(group.begin(), group.begin() + static_cast<std::ptrdiff_t>(half), group.end(),
                     [&](Index a, Index b) { return std::pair(at(a)[axis], a) < std::pair(at(b)[axis], b); });
    split_into_patches(group.first(half), centre, patch_size);
    split_into_patches(group.subspan(half), centre, patch_size);
}

}  // namespace

ElementPlaces find_places(const ElementList& list, std::span<const Vec3> rest_position) {
    const std::vector<Vec3> centre = centres_of(list, rest_position);
    std::vector<Index> order(list.size());
    std::iota(order.begin(), order.end(), 0);
    // Inversion barriers get patches of their own. Inactive barriers then do not change the order in which the forces
    // of other elements are summed.
    const auto group_of = [&](Index e) { return list.part[static_cast<std::size_t>(e)] == ElementPart::guard; };
    std::ranges::stable_sort(order, {}, group_of);
    std::vector<std::size_t> patch_size;
    for (std::size_t first = 0; first < order.size();) {
        std::size_t end = first;
        while (end < order.size() && group_of(order[end]) == group_of(order[first])) ++end;
        split_into_patches(Order(order).subspan(first, end - first), centre, patch_size);
        first = end;
    }
    const auto kind = [&](Index e) {
        const auto at = static_cast<std::size_t>(e);
        return std::pair(list.part[at], list.material[at]);
    };
    const auto key = [&](Index e) { return std::pair(kind(e), list.nodes_of(static_cast<std::size_t>(e))); };
    ElementPlaces places;
    std::size_t first = 0;
    for (const std::size_t size : patch_size) {
        const Order patch = Order(order).subspan(first, size);
        std::ranges::stable_sort(patch, {}, key);
        const std::size_t first_block = places.opens_patch.size();
        for (std::size_t i = 0; i < size; ++i) {
            if (i > 0 && kind(patch[i]) != kind(patch[i - 1]))
                while (places.element.size() % element_lanes != 0) places.element.push_back(no_index);
            places.element.push_back(patch[i]);
        }
        while (places.element.size() % element_lanes != 0) places.element.push_back(no_index);
        places.opens_patch.resize(places.element.size() / element_lanes, 0);
        places.opens_patch[first_block] = 1;
        first += size;
    }
    return places;
}

Real smallest_altitude(const std::array<Index, 4>& tetrahedron, std::span<const Vec3> rest_position) {
    const auto at = [&](std::size_t a) -> const Vec3& {
        return rest_position[static_cast<std::size_t>(tetrahedron[a % 4])];
    };
    Real largest_face = 0;  // twice the area [m^2]
    for (std::size_t a = 0; a < 4; ++a)
        largest_face = std::max(largest_face, (at(a + 1) - at(a)).cross(at(a + 2) - at(a)).norm());
    return six_volumes(tetrahedron, rest_position) / largest_face;
}

Range append_tetrahedra(std::span<const std::array<Index, 4>> tetrahedra, std::span<const Vec3> rest_position,
                        Index first_node, TetrahedronBlockTable& table) {
    const Index first_block = static_cast<Index>(table.node.size());
    const std::vector<std::uint8_t> is_sliver = sliver_tetrahedra({tetrahedra, rest_position});
    for (std::size_t first = 0; first < tetrahedra.size(); first += element_lanes) {
        TetrahedronNodes node;
        for (NodeLane& corner : node)
            for (Index& n : corner.lane) n = first_node;
        ElementLane volume{}, altitude;
        for (Real& left_over : altitude.lane) left_over = infinity;
        unsigned sliver = 0;
        for (std::size_t l = 0; l < element_lanes && first + l < tetrahedra.size(); ++l) {
            for (std::size_t a = 0; a < 4; ++a) node[a][l] = first_node + tetrahedra[first + l][a];
            volume[l] = six_volumes(tetrahedra[first + l], rest_position) / 6;
            sliver |= static_cast<unsigned>(is_sliver[first + l]) << l;
            altitude[l] = smallest_altitude(tetrahedra[first + l], rest_position);
        }
        table.node.push_back(node);
        table.volume.push_back(volume);
        table.altitude.push_back(altitude);
        table.leeway.push_back({{1, 1, 1, 1, 1, 1, 1, 1}});
        table.sliver.push_back(static_cast<std::uint8_t>(sliver));
        table.uninverted_until.push_back(-infinity);
    }
    return {first_block, static_cast<Index>(table.node.size())};
}

namespace {

/// Chooses the order of the nodes of elements in the rows of their blocks. The kernel adds forces row by row and lane
/// by lane, and each addition waits for the previous addition to the same node. So every row gets that remaining node
/// of the element to which a force was added longest ago.
class RowOrder {
public:
    explicit RowOrder(std::size_t node_count) : last_addition_(node_count, 0) {}

    /// Chooses the node of an element for the next row and returns its index within the element. `taken` flags the
    /// nodes that already have a row; the chosen node is flagged too.
    std::size_t next(std::span<const Index> node, std::vector<bool>& taken) {
        const auto last_addition = [&](std::size_t k) -> std::size_t& {
            return last_addition_[static_cast<std::size_t>(node[k])];
        };
        std::size_t best = node.size();
        for (std::size_t k = 0; k < node.size(); ++k)
            if (!taken[k] && (best == node.size() || last_addition(k) < last_addition(best))) best = k;
        last_addition(best) = ++additions_;
        taken[best] = true;
        return best;
    }

private:
    std::vector<std::size_t> last_addition_;  // by node: number of its last addition, counted from 1; 0: none yet
    std::size_t additions_ = 0;
};

/// Fills the rows of a block with the nodes and gradients of the elements in its lanes.
void fill_rows(const ElementList& list, std::span<const Index> lanes, Index first_node, Range rows, RowOrder& order,
               ElementNodeTable& nodes) {
    std::array<std::vector<bool>, element_lanes> taken;
    std::array<Vec3, element_lanes> others;  // sum of the gradients in the rows after the first
    others.fill(Vec3::Zero());
    for (Index row = rows.begin; row < rows.end; ++row) {
        const auto r = static_cast<std::size_t>(row), k = r - static_cast<std::size_t>(rows.begin);
        for (std::size_t l = 0; l < element_lanes; ++l) {
            const bool used = lanes[l] != no_index;
            const auto e = static_cast<std::size_t>(used ? lanes[l] : lanes[0]);
            const std::size_t first = list.first_node[e], own = list.nodes_of(e);
            if (k % own == 0) taken[l].assign(own, false);
            const std::size_t next = first + order.next(std::span(list.node).subspan(first, own), taken[l]);
            nodes.node[r][l] = first_node + list.node[next];
            if (!used || k == 0 || k >= own) continue;
            others[l] += list.gradient[next];
            for (std::size_t i = 0; i < 3; ++i)
                nodes.gradient[r][i][l] = list.gradient[next][static_cast<Eigen::Index>(i)];
        }
    }
    // The gradient of the first node is minus the sum of all other gradients, in row order, like the force on the first
    // node in the kernel. The difference 0 - sum, unlike -sum, is never -0.
    for (std::size_t l = 0; l < element_lanes; ++l)
        for (std::size_t i = 0; i < 3; ++i)
            nodes.gradient[static_cast<std::size_t>(rows.begin)][i][l] = 0 - others[l][static_cast<Eigen::Index>(i)];
}

}  // namespace

AppendedElements append_elements(const ElementList& list, std::span<const Vec3> rest_position, Index first_node,
                                 Index body, ElementBlockTable& blocks, ElementNodeTable& nodes) {
    return append_elements(list, find_places(list, rest_position), first_node, body, blocks, nodes);
}

AppendedElements append_elements(const ElementList& list, const ElementPlaces& places, Index first_node, Index body,
                                 ElementBlockTable& blocks, ElementNodeTable& nodes) {
    SKERRY_CHECK(places.element.size() >= list.size());
    const std::size_t first_block = blocks.first.size(), first_row = nodes.node.size();
    AppendedElements appended{{}, {}, places.element};
    const auto lanes_of = [&](std::size_t lane_index) {
        return std::span<const Index>(appended.element).subspan(lane_index, element_lanes);
    };
    const std::size_t end_block = first_block + appended.element.size() / element_lanes;
    AnyTable(blocks).resize(end_block);
    std::size_t end_row = first_row;
    for (std::size_t block = first_block; block < end_block; ++block) {
        std::size_t count = 0;
        for (const Index e : lanes_of((block - first_block) * element_lanes))
            if (e != no_index) count = std::max(count, list.nodes_of(static_cast<std::size_t>(e)));
        blocks.first[block] = static_cast<Index>(end_row);
        blocks.count[block] = static_cast<Index>(count);
        end_row += count;
    }
    AnyTable(nodes).resize(end_row);
    RowOrder order(list.node.empty() ? 0 : static_cast<std::size_t>(std::ranges::max(list.node)) + 1);
    for (std::size_t block = first_block; block < end_block; ++block) {
        const std::size_t lane_index = (block - first_block) * element_lanes;
        const std::span<const Index> lanes = lanes_of(lane_index);
        const Index row = blocks.first[block];
        const auto leader = static_cast<std::size_t>(lanes[0]);
        blocks.body[block] = body;
        blocks.material[block] = list.material[leader];
        blocks.part[block] = list.part[leader];
        blocks.opens_patch[block] = places.opens_patch[lane_index / element_lanes];
        for (Real& w : blocks.rotation[block][0].lane) w = 1;
        // `rotation` and `rotation_next` must be equal: the step swaps the two columns, and laws without a corotational
        // frame write to neither of them.
        blocks.rotation_next[block] = blocks.rotation[block];
        blocks.orientation[block] = Mat3::Identity();
        for (Real& share : blocks.mass_share[block].lane) share = 1;
        for (std::size_t l = 0; l < element_lanes; ++l)
            if (lanes[l] != no_index) blocks.volume[block][l] = list.volume[static_cast<std::size_t>(lanes[l])];
        fill_rows(list, lanes, first_node, {row, row + blocks.count[block]}, order, nodes);
    }
    appended.blocks = {static_cast<Index>(first_block), static_cast<Index>(blocks.first.size())};
    appended.nodes = {static_cast<Index>(first_row), static_cast<Index>(nodes.node.size())};
    return appended;
}

void turn_elements(const Mat3& rotation, Range rows, ElementBlockTable& blocks, ElementNodeTable& nodes) {
    if (rotation == Mat3::Identity()) return;
    for (auto b = static_cast<std::size_t>(rows.begin); b < static_cast<std::size_t>(rows.end); ++b) {
        blocks.orientation[b] = rotation * blocks.orientation[b];
        const auto first = static_cast<std::size_t>(blocks.first[b]), count = static_cast<std::size_t>(blocks.count[b]);
        for (std::size_t l = 0; l < element_lanes; ++l) {
            Vec3 others = Vec3::Zero();
            for (std::size_t k = 1; k < count; ++k) {
                ElementGradient& g = nodes.gradient[first + k];
                const Vec3 turned = rotation * Vec3(g[0][l], g[1][l], g[2][l]);
                for (std::size_t i = 0; i < 3; ++i) g[i][l] = turned[static_cast<Eigen::Index>(i)];
                others += turned;
            }
            for (std::size_t i = 0; i < 3; ++i) nodes.gradient[first][i][l] = 0 - others[static_cast<Eigen::Index>(i)];
            ElementForm& q = blocks.mass_form[b];
            Mat3 form;
            form << q[0][l], q[3][l], q[5][l], q[3][l], q[1][l], q[4][l], q[5][l], q[4][l], q[2][l];
            form = rotation * form * rotation.transpose();
            const std::array<Real, 6> turned{form(0, 0), form(1, 1), form(2, 2), form(0, 1), form(1, 2), form(2, 0)};
            for (std::size_t i = 0; i < turned.size(); ++i) q[i][l] = turned[i];
        }
    }
}

void add_lumped_mass(std::span<const std::array<Index, 4>> tetrahedra, std::span<const Vec3> rest_position,
                     std::span<const Real> density, std::span<Real> mass) {
    SKERRY_CHECK(density.size() == tetrahedra.size());
    for (std::size_t t = 0; t < tetrahedra.size(); ++t) {
        // mass of a tetrahedron at each corner, rho V / 4 [kg]
        const Real share = density[t] * six_volumes(tetrahedra[t], rest_position) / 24;
        for (const Index n : tetrahedra[t]) mass[static_cast<std::size_t>(n)] += share;
    }
}

namespace {

/// Appends the lists of the rows from items.size() to row_count - 1, which have no list yet. The list of a row contains
/// all items i with row_of_item[i] == row, ascending. Items that are not in a list yet must belong to these rows.
void sort_by_row(std::span<const Index> row_of_item, std::size_t row_count, Ragged<Index>& items) {
    // Counting sort: count the items of each row, form prefix sums, fill the lists.
    if (items.offset.empty()) items.offset.push_back(0);
    const std::size_t first_row = items.size(), first_item = items.item.size();
    items.offset.resize(row_count + 1, 0);
    for (std::size_t i = first_item; i < row_of_item.size(); ++i)
        ++items.offset[static_cast<std::size_t>(row_of_item[i]) + 1];
    for (std::size_t r = first_row; r < row_count; ++r) items.offset[r + 1] += items.offset[r];
    items.item.resize(row_of_item.size());
    for (std::size_t i = first_item; i < row_of_item.size(); ++i)
        items.item[static_cast<std::size_t>(items.offset[static_cast<std::size_t>(row_of_item[i])]++)] =
            static_cast<Index>(i);
    for (std::size_t r = row_count; r > first_row; --r) items.offset[r] = items.offset[r - 1];
    items.offset[first_row] = static_cast<Index>(first_item);
}

}  // namespace

void build_patches(ElementBlockTable& blocks, std::size_t node_count, ElementNodeTable& nodes,
                   ElementPatches& patches) {
    const std::size_t first_node = patches.slots_of_node.size();
    std::vector<Index> slot_of_node(node_count - first_node, no_index);
    const auto slot_of = [&](Index node) -> Index& {
        SKERRY_CHECK(static_cast<std::size_t>(node) >= first_node);
        return slot_of_node[static_cast<std::size_t>(node) - first_node];
    };
    const std::size_t first_block =
        patches.blocks.empty() ? 0 : static_cast<std::size_t>(patches.blocks[patches.blocks.size() - 1].end);
    for (std::size_t begin = first_block; begin < blocks.first.size();) {
        std::size_t end = begin + 1;
        while (end < blocks.first.size() && !blocks.opens_patch[end]) ++end;
        const auto first_slot = static_cast<Index>(patches.node.size());
        const auto first_row = static_cast<std::size_t>(blocks.first[begin]);
        const auto end_row = static_cast<std::size_t>(blocks.first[end - 1] + blocks.count[end - 1]);
        for (std::size_t b = begin; b < end; ++b) SKERRY_CHECK(blocks.body[b] == blocks.body[begin]);
        // The nodes of a patch are sorted, so that the kernel reads their positions in the order of memory.
        for (std::size_t row = first_row; row < end_row; ++row)
            for (const Index n : nodes.node[row].lane)
                if (Index& slot = slot_of(n); slot == no_index) {
                    slot = 0;
                    patches.node.push_back(n);
                }
        std::sort(patches.node.begin() + first_slot, patches.node.end());
        for (auto s = static_cast<std::size_t>(first_slot); s < patches.node.size(); ++s)
            slot_of(patches.node[s]) = static_cast<Index>(s) - first_slot;
        for (std::size_t row = first_row; row < end_row; ++row)
            for (std::size_t l = 0; l < element_lanes; ++l)
                nodes.slot[row][l] = slot_width * slot_of(nodes.node[row][l]);
        const Range slots{first_slot, static_cast<Index>(patches.node.size())};
        for (Index s = slots.begin; s < slots.end; ++s) slot_of(patches.node[static_cast<std::size_t>(s)]) = no_index;
        patches.blocks.push_back({static_cast<Index>(begin), static_cast<Index>(end)});
        patches.slots.push_back(slots);
        begin = end;
    }
    patches.position.resize(patches.node.size());
    patches.force.resize(patches.node.size());
    patches.relaxed.resize(patches.blocks.size());
    sort_by_row(patches.node, node_count, patches.slots_of_node);
    const std::span<const Real> viscous_time = blocks.viscous_time.span().subspan(first_block);
    if (!patches.viscous_impulse.empty() || std::ranges::any_of(viscous_time, [](Real time) { return time > 0; }))
        patches.resize_viscous(blocks.first.size());
}

void truncate_patches(Index block_count, Index node_count, ElementPatches& patches) {
    const auto first_block_of = [](const Range& blocks) { return blocks.begin; };
    const auto kept = static_cast<std::size_t>(
        std::ranges::lower_bound(patches.blocks, block_count, {}, first_block_of) - patches.blocks.begin());
    const std::size_t slots = kept > 0 ? static_cast<std::size_t>(patches.slots[kept - 1].end) : 0;
    patches.blocks.resize(kept);
    patches.relaxed.resize(kept);
    if (!patches.viscous_impulse.empty()) patches.resize_viscous(static_cast<std::size_t>(block_count));
    patches.slots.resize(kept);
    patches.node.resize(slots);
    Ragged<Index>& slots_of_node = patches.slots_of_node;
    if (static_cast<std::size_t>(node_count) < slots_of_node.size())
        slots_of_node.offset.resize(static_cast<std::size_t>(node_count) + 1);
    slots_of_node.item.resize(slots);
}

}  // namespace skerry
