#include "systems/collision/search/find_pairs.h"

#include <algorithm>
#include <cmath>

#include "jobs/parallel_for.h"
#include "systems/collision/inputs/contact_key.h"
#include "systems/collision/inputs/contact_reach.h"
#include "systems/collision/inputs/may_collide.h"
#include "systems/collision/narrow/collider_distance.h"
#include "systems/collision/search/step_reach.h"
#include "systems/collision/tree/box.h"

namespace skerry {

namespace {

constexpr std::size_t bodies_per_block = 16;
// Numbers of rows, groups or pairs that one task processes in some microseconds.
constexpr std::size_t rows_per_block = 64, groups_per_block = 256, pairs_per_block = 256;

bool is_movable(const BodyTable& body, Index b) {
    return body.kind[b] == BodyKind::deformable;
}

void widen(Aabb& box, Real margin) {
    box.lower.array() -= margin;
    box.upper.array() += margin;
}

Real mean_body_edge(const BodyTable& body) {
    Real sum = 0;
    Index count = 0;
    for (std::size_t b = 0; b < body.slot.size(); ++b) {
        if (!is_movable(body, static_cast<Index>(b))) continue;
        sum += body.mean_edge[b];
        ++count;
    }
    return count > 0 ? sum / count : 0;
}

/// Computes the boxes and bounding spheres of the bodies, and the travel bound up to which they are valid
/// (body_valid_until in contact_reach.h, 6). `common_travel`: travel that a kinematic body may make before the next
/// broad search [m].
void fit_body_boxes(Executor& executor, const CollisionInputs& inputs, const CollisionSettings& settings,
                    Real common_travel, SearchState& search) {
    const BodyTable& body = inputs.body;
    SearchMemory& memory = search.memory;
    parallel_for(executor, body.slot.size(), bodies_per_block, [&](std::size_t begin, std::size_t end) {
        for (std::size_t b = begin; b < end; ++b) {
            const Real travel =
                is_movable(body, static_cast<Index>(b)) ? settings.broad_skin / 2 * body.mean_edge[b] : common_travel;
            search.body_valid_until[b] = memory.body_travel_bound[b] - 2 * body.displacement[b] + travel;
            fit_bounds(inputs, static_cast<Index>(b), memory.box[b], memory.sphere[b]);
            const Real margin = memory.body_reach[b] + travel + body.contact_distance[b] / 2 + body.round_radius[b];
            widen(memory.box[b], margin);
            memory.sphere[b].radius += margin;
        }
    });
}

/// Distance from the origin of a collider to its furthest point that may touch a body [m]. For a plane, this is the
/// distance from the origin to the furthest corner of any body's box.
Real collider_extent(const CollisionInputs& inputs, Index collider, std::span<const Aabb> body_box) {
    const ColliderGeometry& geometry = inputs.collider.geometry[collider];
    if (geometry.shape != ColliderShape::plane) return collider_radius(geometry);
    const Vec3& origin = inputs.collider.motion[collider].position;
    Real extent = 0;
    for (const Aabb& box : body_box) {
        const Vec3 furthest = (box.upper - origin).cwiseAbs().cwiseMax((box.lower - origin).cwiseAbs());
        if (furthest.allFinite()) extent = std::max(extent, furthest.norm());
    }
    return extent;
}

/// Computes the boxes of the colliders, which are stored after the boxes of the bodies.
void fit_collider_boxes(const CollisionInputs& inputs, Real h, Real common_travel, SearchState& search) {
    const ColliderTable& collider = inputs.collider;
    const std::size_t body_count = inputs.body.slot.size();
    SearchMemory& memory = search.memory;
    for (std::size_t c = 0; c < collider.slot.size(); ++c) {
        const Index row = static_cast<Index>(c);
        memory.collider_extent[c] = collider_extent(inputs, row, memory.box.span().first(body_count));
        // The difference travel_bound - travel contains the motion of the collider in this step, but is not used here.
        // It would have a large rounding error, because the travel of a rotating shape grows without limit. So the
        // motion is computed again.
        memory.collider_margin[c] = collider_reach(inputs, row, memory.collider_extent[c], h) + common_travel;
        search.collider_valid_until[c] = collider.travel[c] + memory.collider_margin[c];
        memory.box[body_count + c] = collider_box(collider.geometry[c], collider.motion[c]);
        widen(memory.box[body_count + c], memory.collider_margin[c]);
    }
}

/// Least signed distance of a box from a plane; negative if a part of the box is behind the plane [m].
Real distance_to_plane(const Aabb& box, const RigidMotion& plane) {
    const Vec3 normal = plane.rotation.col(2);
    const Vec3 lowest = (normal.array() > 0).select(box.lower, box.upper);
    return normal.dot(lowest - plane.position);
}

/// Search for pairs of overlapping boxes. The result is memory.pairs, in key order.
class BroadSearch {
public:
    BroadSearch(Executor& executor, const CollisionInputs& inputs, SearchMemory& memory)
        : executor_(executor), inputs_(inputs), memory_(memory) {}

    void run() {
        list_entries();
        memory_.grid.build(memory_.box.span(), memory_.entry.span());
        list_planes();
        const std::size_t rows = memory_.box.size();
        block_count_ = (rows + rows_per_block - 1) / rows_per_block;
        if (memory_.found_pairs.size() < block_count_) memory_.found_pairs.resize(block_count_);
        parallel_for(executor_, rows, rows_per_block, [&](std::size_t begin, std::size_t end) {
            Column<FoundPair>& found = memory_.found_pairs[begin / rows_per_block];
            found.clear();
            for (std::size_t row = begin; row < end; ++row) find_pairs_of(static_cast<Index>(row), found);
        });
        sort_pairs();
    }

private:
    Index body_count() const { return static_cast<Index>(inputs_.body.slot.size()); }

    /// Lists the boxes that can be part of a pair. Mesh colliders are left out, because the kinematic body of the
    /// collider has a box, too. Boxes that are not finite are left out, for example those of planes.
    void list_entries() {
        memory_.entry.clear();
        memory_.has_box.assign(memory_.box.size(), 0);
        for (std::size_t row = 0; row < memory_.box.size(); ++row) {
            const Index index = static_cast<Index>(row);
            const bool bounded = memory_.box[row].lower.allFinite() && memory_.box[row].upper.allFinite();
            const bool mesh =
                index >= body_count() && inputs_.collider.geometry[index - body_count()].shape == ColliderShape::mesh;
            if (!bounded || mesh) continue;
            memory_.has_box[row] = 1;
            memory_.entry.push_back(index);
        }
    }

    void list_planes() {
        memory_.planes.clear();
        for (std::size_t c = 0; c < inputs_.collider.slot.size(); ++c)
            if (inputs_.collider.geometry[c].shape == ColliderShape::plane)
                memory_.planes.push_back(static_cast<Index>(c));
    }

    void find_pairs_of(Index row, Column<FoundPair>& found) const {
        if (memory_.has_box[row]) {
            const Aabb& box = memory_.box[row];
            memory_.grid.for_each_near(row, [&](Index other) {
                if (distance_squared(box, memory_.box[other]) == 0) add(row, other, found);
            });
        }
        if (row >= body_count() || !is_movable(inputs_.body, row)) return;
        add_planes(row, found);
        const BodyTable& body = inputs_.body;
        if (body.self_contact[row] && body.triangles[row].size() > 0)
            add_row(body_pair_key(body.slot[row], body.slot[row]), PairKind::self, row, row, found);
    }

    void add(Index a, Index b, Column<FoundPair>& found) const {
        if (a > b) std::swap(a, b);
        const BodyTable& body = inputs_.body;
        if (a >= body_count()) return;
        if (b >= body_count()) {
            if (is_movable(body, a)) add_collider(a, b - body_count(), found);
            return;
        }
        if (!is_movable(body, a) && !is_movable(body, b)) return;
        if (gap_between(memory_.sphere[a], memory_.sphere[b]) > 0) return;
        if (!is_movable(body, b))
            add_row(collider_pair_key(body.slot[a], body.slot[b]), PairKind::bodies, a, b, found);
        else if (!is_movable(body, a))
            add_row(collider_pair_key(body.slot[b], body.slot[a]), PairKind::bodies, b, a, found);
        else if (body.slot[a] < body.slot[b])
            add_row(body_pair_key(body.slot[a], body.slot[b]), PairKind::bodies, a, b, found);
        else
            add_row(body_pair_key(body.slot[b], body.slot[a]), PairKind::bodies, b, a, found);
    }

    void add_planes(Index b, Column<FoundPair>& found) const {
        if (inputs_.body.vertices[b].size() == 0) return;
        for (const Index plane : memory_.planes)
            if (distance_to_plane(memory_.box[b], inputs_.collider.motion[plane]) <= memory_.collider_margin[plane])
                add_collider(b, plane, found);
    }

    void add_collider(Index body, Index collider, Column<FoundPair>& found) const {
        add_row(collider_pair_key(inputs_.body.slot[body], inputs_.collider.slot[collider]), PairKind::collider, body,
                collider, found);
    }

    /// Adds a pair, unless another rank searches it or its partners may not collide. valid_until = -infinity marks the
    /// candidate list as expired. The pair is thus searched in this step, because only a search shows how far apart the
    /// partners are.
    void add_row(std::uint64_t key, PairKind kind, Index first, Index second, Column<FoundPair>& found) const {
        const bool both_move = kind != PairKind::collider && is_movable(inputs_.body, second);
        if (!inputs_.owners.owns(inputs_.body, first, both_move ? second : no_index)) return;
        if (!may_collide(inputs_.body, inputs_.collider, inputs_.disabled_pairs, kind, first, second)) return;
        const Vec3 frame_offset = kind == PairKind::collider
                                      ? Vec3(Vec3::Zero())
                                      : Vec3(inputs_.body.frame[first].position - inputs_.body.frame[second].position);
        found.push_back({key, kind, first, second, -infinity, PairState::unknown, frame_offset, 0});
    }

    /// Sorts the found pairs by key. The leading bits of the key are a flag for colliders and the slot of the first
    /// body. Pairs are first grouped by these bits, then each group is sorted.
    void sort_pairs() {
        const std::size_t slots = 1 + greatest_slot(), groups = 2 * slots;
        const auto group_of = [&](const FoundPair& pair) {
            const PairSlots pair_slots = slots_of_pair(pair.key);
            return (pair_slots.is_collider ? slots : 0) + pair_slots.first;
        };
        Column<Index>& begin = memory_.group_begin;
        begin.assign(groups + 1, 0);
        for (std::size_t b = 0; b < block_count_; ++b)
            for (const FoundPair& pair : memory_.found_pairs[b]) ++begin[group_of(pair) + 1];
        for (std::size_t g = 0; g < groups; ++g) begin[g + 1] += begin[g];
        memory_.pairs.resize(static_cast<std::size_t>(begin[groups]));
        memory_.group_end.resize(groups);
        std::copy(begin.begin(), begin.end() - 1, memory_.group_end.begin());
        for (std::size_t b = 0; b < block_count_; ++b)
            for (const FoundPair& pair : memory_.found_pairs[b])
                memory_.pairs[memory_.group_end[group_of(pair)]++] = pair;
        parallel_for(executor_, groups, groups_per_block, [&](std::size_t first, std::size_t last) {
            for (std::size_t g = first; g < last; ++g)
                std::sort(memory_.pairs.begin() + begin[g], memory_.pairs.begin() + begin[g + 1],
                          [](const FoundPair& a, const FoundPair& b) { return a.key < b.key; });
        });
    }

    std::uint32_t greatest_slot() const {
        std::uint32_t greatest = 0;
        for (const std::uint32_t slot : inputs_.body.slot) greatest = std::max(greatest, slot);
        return greatest;
    }

    Executor& executor_;
    const CollisionInputs& inputs_;
    SearchMemory& memory_;
    std::size_t block_count_ = 0;
};

bool is_forgotten(const SearchMemory& memory, const FoundPair& pair) {
    const auto& second_forgotten = pair.kind == PairKind::collider ? memory.collider_forgotten : memory.body_forgotten;
    return memory.body_forgotten[pair.first] || second_forgotten[pair.second];
}

/// For each found pair that PairTable already contains: copies its values from PairTable, and stores its row of
/// PairTable in memory.old_row. Pairs of an object that is forgotten (added or moved by the user) count as new.
void copy_known_pairs(Executor& executor, SearchMemory& memory, const PairTable& pairs) {
    memory.old_row.assign(memory.pairs.size(), no_index);
    parallel_for(executor, memory.pairs.size(), pairs_per_block, [&](std::size_t begin, std::size_t end) {
        for (std::size_t row = begin; row < end; ++row) {
            FoundPair& pair = memory.pairs[row];
            const auto key = std::lower_bound(pairs.key.begin(), pairs.key.end(), pair.key);
            if (key == pairs.key.end() || *key != pair.key || is_forgotten(memory, pair)) continue;
            const std::size_t old = static_cast<std::size_t>(key - pairs.key.begin());
            memory.old_row[row] = static_cast<Index>(old);
            pair.valid_until = pairs.valid_until[old];
            pair.state = pairs.state[old];
            pair.frame_apart = pairs.frame_apart[old];
            pair.frame_path = pairs.frame_path[old];
        }
    });
}

/// Moves the candidate lists of pairs that PairTable already contained to their new rows. New pairs reuse the memory of
/// the lists of removed pairs.
void move_lists(Executor& executor, SearchMemory& memory, PairTable& pairs) {
    const std::size_t count = memory.pairs.size();
    const std::size_t lists = std::max({count, pairs.candidates.size(), memory.candidates.size()});
    pairs.candidates.resize(lists);
    pairs.asleep_until.resize(lists);
    pairs.leaf_pairs.resize(lists);
    memory.candidates.resize(lists);
    memory.asleep_until.resize(lists);
    memory.leaf_pairs.resize(lists);
    memory.list_is_kept.assign(lists, 0);
    for (const Index old : memory.old_row)
        if (old != no_index) memory.list_is_kept[old] = 1;
    memory.old_list.resize(lists);
    for (std::size_t row = 0, free_list = 0; row < lists; ++row) {
        if (row < count && memory.old_row[row] != no_index) {
            memory.old_list[row] = memory.old_row[row];
            continue;
        }
        while (memory.list_is_kept[free_list]) ++free_list;
        memory.old_list[row] = static_cast<Index>(free_list++);
    }
    parallel_for(executor, lists, pairs_per_block, [&](std::size_t begin, std::size_t end) {
        for (std::size_t row = begin; row < end; ++row) {
            const std::size_t old = static_cast<std::size_t>(memory.old_list[row]);
            memory.candidates[row].swap(pairs.candidates[old]);
            memory.asleep_until[row].swap(pairs.asleep_until[old]);
            std::swap(memory.leaf_pairs[row], pairs.leaf_pairs[old]);
            if (row < count && memory.old_row[row] != no_index) continue;
            memory.candidates[row].clear();
            memory.asleep_until[row].clear();
            memory.leaf_pairs[row].listed.clear();
        }
    });
    pairs.candidates.swap(memory.candidates);
    pairs.asleep_until.swap(memory.asleep_until);
    pairs.leaf_pairs.swap(memory.leaf_pairs);
}

void write_rows(Executor& executor, const SearchMemory& memory, PairTable& pairs) {
    const std::size_t count = memory.pairs.size();
    pairs.key.resize(count);
    pairs.kind.resize(count);
    pairs.first.resize(count);
    pairs.second.resize(count);
    pairs.valid_until.resize(count);
    pairs.state.resize(count);
    pairs.frame_apart.resize(count);
    pairs.frame_path.resize(count);
    pairs.travel.resize(count);
    pairs.travel_bound.resize(count);
    pairs.closing.resize(count);
    pairs.longer_motion.assign(count, 0);
    parallel_for(executor, count, pairs_per_block, [&](std::size_t begin, std::size_t end) {
        for (std::size_t row = begin; row < end; ++row) {
            const FoundPair& found = memory.pairs[row];
            pairs.key[row] = found.key;
            pairs.kind[row] = found.kind;
            pairs.first[row] = found.first;
            pairs.second[row] = found.second;
            pairs.valid_until[row] = found.valid_until;
            pairs.state[row] = found.state;
            pairs.frame_apart[row] = found.frame_apart;
            pairs.frame_path[row] = found.frame_path;
        }
    });
}

/// Replaces the rows of PairTable by memory.pairs. A pair that PairTable already contained keeps its candidate list,
/// unless a partner is forgotten (added or moved by the user).
void replace_rows(Executor& executor, SearchMemory& memory, PairTable& pairs) {
    copy_known_pairs(executor, memory, pairs);
    move_lists(executor, memory, pairs);
    write_rows(executor, memory, pairs);
}

}  // namespace

void fit_bounds(const CollisionInputs& inputs, Index b, Aabb& box, BoundingSphere& sphere) {
    const Range vertices = inputs.body.vertices[b];
    const auto point_of = [&](Index v) -> const Vec3& { return inputs.position[inputs.surface.vertices.node[v]]; };
    box = empty_box();
    for (Index v = vertices.begin; v < vertices.end; ++v) grow(box, point_of(v));
    sphere = sphere_around(box, vertices.begin, vertices.end, point_of);
}

void find_pairs(Executor& executor, const CollisionInputs& inputs, const CollisionSettings& settings, Real h,
                SearchState& search, PairTable& pairs) {
    const std::size_t body_count = inputs.body.slot.size(), collider_count = inputs.collider.slot.size();
    search.body_valid_until.resize(body_count);
    search.collider_valid_until.resize(collider_count);
    search.memory.box.resize(body_count + collider_count);
    search.memory.sphere.resize(body_count);
    search.memory.collider_extent.resize(collider_count);
    search.memory.collider_margin.resize(collider_count);
    // Travel that colliders and kinematic bodies may make before the next broad search [m]. A deformable body may make
    // half of broad_skin times its mean edge; here the average over the mean edges of all deformable bodies is used.
    const Real common_travel = settings.broad_skin / 2 * mean_body_edge(inputs.body);
    fit_body_boxes(executor, inputs, settings, common_travel, search);
    fit_collider_boxes(inputs, h, common_travel, search);
    BroadSearch(executor, inputs, search.memory).run();
    replace_rows(executor, search.memory, pairs);
    ++search.broad_searches;
}

}  // namespace skerry
