#include "systems/collision/search/find_pairs.h"

#include <algorithm>
#include <cmath>
#include <limits>

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

bool is_movable(const BodyTable& body, Index b) {
    return body.kind[b] == BodyKind::deformable;
}

/// Box and sphere of a body as it is.
void fit(const CollisionInputs& inputs, Index b, Aabb& box, BoundingSphere& sphere) {
    const Range vertices = inputs.body.vertices[b];
    const auto point_of = [&](Index v) -> const Vec3& { return inputs.position[inputs.surface.vertices.node[v]]; };
    box = empty_box();
    for (Index v = vertices.begin; v < vertices.end; ++v) grow(box, point_of(v));
    sphere = sphere_around(box, vertices.begin, vertices.end, point_of);
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

/// Boxes of bodies and until when they hold.
void fit_body_boxes(Executor& executor, const CollisionInputs& inputs, const CollisionSettings& settings,
                    Real common_travel, SearchState& search) {
    const BodyTable& body = inputs.body;
    SearchMemory& memory = search.memory;
    parallel_for(executor, body.slot.size(), bodies_per_block, [&](std::size_t begin, std::size_t end) {
        for (std::size_t b = begin; b < end; ++b) {
            const Real travel =
                is_movable(body, static_cast<Index>(b)) ? settings.broad_skin / 2 * body.mean_edge[b] : common_travel;
            search.body_valid_until[b] = memory.body_travel_bound[b] - 2 * body.displacement[b] + travel;
            fit(inputs, static_cast<Index>(b), memory.box[b], memory.sphere[b]);
            const Real margin = memory.body_reach[b] + travel + body.contact_distance[b] / 2 + body.round_radius[b];
            widen(memory.box[b], margin);
            memory.sphere[b].radius += margin;
        }
    });
}

/// How far the points of a collider that matter are from its origin: its own size; of a plane, the furthest point of
/// any body's box.
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

/// Boxes of colliders, after those of the bodies.
void fit_collider_boxes(const CollisionInputs& inputs, Real h, Real common_travel, SearchState& search) {
    const ColliderTable& collider = inputs.collider;
    const std::size_t body_count = inputs.body.slot.size();
    SearchMemory& memory = search.memory;
    for (std::size_t c = 0; c < collider.slot.size(); ++c) {
        const Index row = static_cast<Index>(c);
        memory.collider_extent[c] = collider_extent(inputs, row, memory.box.span().first(body_count));
        // Not travel_bound minus travel: a shape that turns may have travelled without bounds.
        memory.collider_margin[c] = collider_reach(inputs, row, memory.collider_extent[c], h) + common_travel;
        search.collider_valid_until[c] = collider.travel[c] + memory.collider_margin[c];
        memory.box[body_count + c] = collider_box(collider.geometry[c], collider.motion[c]);
        widen(memory.box[body_count + c], memory.collider_margin[c]);
    }
}

/// Least distance of a box to a plane, m; negative when it reaches behind.
Real distance_to_plane(const Aabb& box, const RigidMotion& plane) {
    const Vec3 normal = plane.rotation.col(2);
    const Vec3 lowest = (normal.array() > 0).select(box.lower, box.upper);
    return normal.dot(lowest - plane.position);
}

/// Pairs of boxes that overlap go to memory.pairs.
class Sweep {
public:
    Sweep(const CollisionInputs& inputs, SearchState& search) : inputs_(inputs), memory_(search.memory) {}

    void run() {
        memory_.pairs.clear();
        list_entries();
        const int axis = widest_axis();
        const auto lower = [&](Index row) { return memory_.box[row].lower[axis]; };
        std::sort(memory_.order.begin(), memory_.order.end(),
                  [&](Index a, Index b) { return lower(a) != lower(b) ? lower(a) < lower(b) : a < b; });
        for (std::size_t i = 0; i < memory_.order.size(); ++i) {
            const Aabb& box = memory_.box[memory_.order[i]];
            for (std::size_t j = i + 1; j < memory_.order.size() && lower(memory_.order[j]) <= box.upper[axis]; ++j)
                if (distance_squared(box, memory_.box[memory_.order[j]]) == 0) add(memory_.order[i], memory_.order[j]);
        }
        add_planes();
        add_self_pairs();
        std::sort(memory_.pairs.begin(), memory_.pairs.end(),
                  [](const FoundPair& a, const FoundPair& b) { return a.key < b.key; });
    }

private:
    Index body_count() const { return static_cast<Index>(inputs_.body.slot.size()); }

    /// Boxes of finite size that can be part of a pair. A body with a position that is not finite has none.
    void list_entries() {
        memory_.order.clear();
        for (std::size_t row = 0; row < memory_.box.size(); ++row) {
            const Index index = static_cast<Index>(row);
            const bool bounded = memory_.box[row].lower.allFinite() && memory_.box[row].upper.allFinite();
            const bool mesh =
                index >= body_count() && inputs_.collider.geometry[index - body_count()].shape == ColliderShape::mesh;
            if (bounded && !mesh) memory_.order.push_back(index);
        }
    }

    int widest_axis() const {
        Vec3 sum = Vec3::Zero(), square_sum = Vec3::Zero();
        for (Index row : memory_.order) {
            const Vec3 centre = (memory_.box[row].lower + memory_.box[row].upper) / 2;
            sum += centre;
            square_sum += centre.cwiseAbs2();
        }
        const Vec3 spread = square_sum * static_cast<Real>(memory_.order.size()) - sum.cwiseAbs2();
        return spread[0] >= spread[1] && spread[0] >= spread[2] ? 0 : spread[1] >= spread[2] ? 1 : 2;
    }

    void add(Index a, Index b) {
        if (a > b) std::swap(a, b);
        const BodyTable& body = inputs_.body;
        if (a >= body_count()) return;
        if (b >= body_count()) {
            if (is_movable(body, a)) add_collider(a, b - body_count());
            return;
        }
        if (!is_movable(body, a) && !is_movable(body, b)) return;
        if (gap_between(memory_.sphere[a], memory_.sphere[b]) > 0) return;
        if (!is_movable(body, b))
            add_row(collider_pair_key(body.slot[a], body.slot[b]), PairKind::bodies, a, b);
        else if (!is_movable(body, a))
            add_row(collider_pair_key(body.slot[b], body.slot[a]), PairKind::bodies, b, a);
        else if (body.slot[a] < body.slot[b])
            add_row(body_pair_key(body.slot[a], body.slot[b]), PairKind::bodies, a, b);
        else
            add_row(body_pair_key(body.slot[b], body.slot[a]), PairKind::bodies, b, a);
    }

    void add_collider(Index body, Index collider) {
        add_row(collider_pair_key(inputs_.body.slot[body], inputs_.collider.slot[collider]), PairKind::collider, body,
                collider);
    }

    /// A new pair is searched at once: only that tells how far apart the two really are.
    void add_row(std::uint64_t key, PairKind kind, Index first, Index second) {
        if (!may_collide(inputs_.body, inputs_.collider, inputs_.disabled_pairs, kind, first, second)) return;
        const Vec3 apart = kind == PairKind::collider
                               ? Vec3(Vec3::Zero())
                               : Vec3(inputs_.body.frame[first].position - inputs_.body.frame[second].position);
        memory_.pairs.push_back(
            {key, kind, first, second, -std::numeric_limits<Real>::infinity(), PairState::unknown, apart, 0});
    }

    void add_planes() {
        for (std::size_t c = 0; c < inputs_.collider.slot.size(); ++c) {
            if (inputs_.collider.geometry[c].shape != ColliderShape::plane) continue;
            const Real margin = memory_.collider_margin[c];
            for (Index b = 0; b < body_count(); ++b) {
                if (!is_movable(inputs_.body, b) || inputs_.body.vertices[b].size() == 0) continue;
                if (distance_to_plane(memory_.box[b], inputs_.collider.motion[c]) <= margin)
                    add_collider(b, static_cast<Index>(c));
            }
        }
    }

    void add_self_pairs() {
        const BodyTable& body = inputs_.body;
        for (Index b = 0; b < body_count(); ++b)
            if (body.self_contact[b] && is_movable(body, b) && body.triangles[b].size() > 0)
                add_row(body_pair_key(body.slot[b], body.slot[b]), PairKind::self, b, b);
    }

    const CollisionInputs& inputs_;
    SearchMemory& memory_;
};

bool is_forgotten(const SearchMemory& memory, const FoundPair& pair) {
    const auto& of_second = pair.kind == PairKind::collider ? memory.collider_forgotten : memory.body_forgotten;
    return memory.body_forgotten[pair.first] || of_second[pair.second];
}

/// Puts memory.pairs in place of the old rows. Pairs that stay take their lists along, unless one of the two is
/// forgotten; the memory of those that went serves new ones.
void replace_rows(SearchMemory& memory, PairTable& pairs) {
    const std::size_t old_count = pairs.size(), count = memory.pairs.size();
    const std::size_t lists = std::max({count, pairs.candidates.size(), memory.candidates.size()});
    pairs.candidates.resize(lists);
    pairs.asleep_until.resize(lists);
    memory.candidates.resize(lists);
    memory.asleep_until.resize(lists);
    const auto move_list = [&](std::size_t from, std::size_t to) {
        memory.candidates[to].swap(pairs.candidates[from]);
        memory.asleep_until[to].swap(pairs.asleep_until[from]);
    };
    memory.moved.assign(lists, 0);
    for (std::size_t row = 0, old = 0; row < count; ++row) {
        while (old < old_count && pairs.key[old] < memory.pairs[row].key) ++old;
        if (old == old_count || pairs.key[old] != memory.pairs[row].key) continue;
        if (is_forgotten(memory, memory.pairs[row])) continue;
        memory.pairs[row].valid_until = pairs.valid_until[old];
        memory.pairs[row].state = pairs.state[old];
        memory.pairs[row].frame_apart = pairs.frame_apart[old];
        memory.pairs[row].frame_path = pairs.frame_path[old];
        move_list(old, row);
        memory.moved[old] |= 1;  // has given its list away
        memory.moved[row] |= 2;  // has got one
    }
    for (std::size_t row = 0, spare = 0; row < lists; ++row) {
        if (memory.moved[row] & 2) continue;
        while (memory.moved[spare] & 1) ++spare;
        move_list(spare++, row);
        memory.candidates[row].clear();
        memory.asleep_until[row].clear();
    }
    pairs.candidates.swap(memory.candidates);
    pairs.asleep_until.swap(memory.asleep_until);

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
    for (std::size_t row = 0; row < count; ++row) {
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
}

}  // namespace

void find_pairs(Executor& executor, const CollisionInputs& inputs, const CollisionSettings& settings, Real h,
                SearchState& search, PairTable& pairs) {
    const std::size_t body_count = inputs.body.slot.size(), collider_count = inputs.collider.slot.size();
    search.body_valid_until.resize(body_count);
    search.collider_valid_until.resize(collider_count);
    search.memory.box.resize(body_count + collider_count);
    search.memory.sphere.resize(body_count);
    search.memory.collider_extent.resize(collider_count);
    search.memory.collider_margin.resize(collider_count);
    // What moves by a script may travel as far as a mean body.
    const Real common_travel = settings.broad_skin / 2 * mean_body_edge(inputs.body);
    fit_body_boxes(executor, inputs, settings, common_travel, search);
    fit_collider_boxes(inputs, h, common_travel, search);
    Sweep(inputs, search).run();
    replace_rows(search.memory, pairs);
    ++search.broad_searches;
}

}  // namespace skerry
