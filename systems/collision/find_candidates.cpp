#include "systems/collision/find_candidates.h"

#include <algorithm>
#include <atomic>
#include <cmath>

#include "components/check.h"
#include "jobs/parallel_for.h"
#include "systems/collision/inputs/contact_reach.h"
#include "systems/collision/search/find_pairs.h"
#include "systems/collision/search/search_pair.h"
#include "systems/collision/search/self_motion.h"
#include "systems/collision/search/step_reach.h"
#include "systems/collision/tree/box.h"
#include "systems/collision/tree/bvh.h"

namespace skerry {

namespace {

// Number of trees that one task refits, and number of bodies whose boxes and spheres one task computes. A task takes at
// most a few microseconds.
constexpr std::size_t trees_per_block = 2, bounds_per_block = 32;
// Numbers of bodies or pairs that one task processes in a few microseconds.
constexpr std::size_t bounded_bodies_per_block = 128, bounded_pairs_per_block = 256, far_pairs_per_block = 64;

/// Marks the forgotten bodies or colliders: those that are new or that the user has moved, so that their distances from
/// other objects are unknown (SearchState). With `all`, marks every object. Returns true if any object is marked.
bool mark_forgotten(std::size_t count, bool all, Column<Real>& valid_until, Column<std::uint8_t>& forgotten) {
    if (all) valid_until.clear();
    SKERRY_CHECK(valid_until.size() <= count);
    valid_until.resize(count, SearchState::forgotten);
    forgotten.resize(count);
    bool any = false;
    for (std::size_t row = 0; row < count; ++row) any |= forgotten[row] = valid_until[row] == SearchState::forgotten;
    return any;
}

/// Marks the forgotten bodies also in body_unmeasured, because their stored speeds (max_speed and frame_speed of
/// BodyTable) are out of date.
void mark_unmeasured(SearchMemory& memory) {
    const std::size_t count = memory.body_forgotten.size();
    if (!memory.any_unmeasured) memory.body_unmeasured.clear();
    memory.body_unmeasured.resize(count, 0);
    memory.any_unmeasured = true;
    for (std::size_t b = 0; b < count; ++b) memory.body_unmeasured[b] |= memory.body_forgotten[b];
}

void bound_body_travels(Executor& executor, const CollisionInputs& inputs, const CollisionSettings& settings, Real h,
                        SearchMemory& memory) {
    memory.body_travel_bound.resize(inputs.body.slot.size());
    memory.body_frame_reach.resize(inputs.body.slot.size());
    memory.body_reach.resize(inputs.body.slot.size());
    parallel_for(executor, inputs.body.slot.size(), bounded_bodies_per_block, [&](std::size_t begin, std::size_t end) {
        for (std::size_t b = begin; b < end; ++b) {
            const bool measure = memory.any_unmeasured && memory.body_unmeasured[b] != 0;
            const BodyReach reach = body_reach(inputs, settings, static_cast<Index>(b), measure, h);
            memory.body_travel_bound[b] = inputs.body.travel[b] + inputs.body.frame[b].path + reach.in_world;
            memory.body_frame_reach[b] = reach.in_frame;
            memory.body_reach[b] = reach.in_world;
        }
    });
}

void bound_collider_travels(const CollisionInputs& inputs, Real h, SearchMemory& memory) {
    memory.collider_travel_bound.resize(inputs.collider.slot.size());
    memory.collider_extent.resize(inputs.collider.slot.size());
    for (std::size_t c = 0; c < memory.collider_travel_bound.size(); ++c)
        memory.collider_travel_bound[c] =
            inputs.collider.travel[c] + collider_reach(inputs, static_cast<Index>(c), memory.collider_extent[c], h);
}

bool all_below(const Column<Real>& travel_bound, const Column<Real>& valid_until) {
    bool below = true;
    for (std::size_t i = 0; i < travel_bound.size(); ++i) below &= travel_bound[i] < valid_until[i];
    return below;
}

/// True if the travel bounds of all colliders are below their limits. Mesh colliders are skipped, because each has a
/// kinematic body, whose travel bound is compared instead.
bool colliders_below(const CollisionInputs& inputs, const SearchState& search) {
    bool below = true;
    for (std::size_t c = 0; c < search.memory.collider_travel_bound.size(); ++c)
        below &= search.memory.collider_travel_bound[c] < search.collider_valid_until[c] ||
                 inputs.collider.body[c] != no_index;
    return below;
}

/// Writes bounds of the relative motion of the partners of a pair: `travel` up to the start of this step,
/// `travel_bound` up to its end, `closing` within it. For two bodies, also updates frame_apart and frame_path.
void bound_travel(const CollisionInputs& inputs, const SearchMemory& memory, Real h, Index p, PairTable& pairs) {
    const Index a = pairs.first[p], b = pairs.second[p];
    if (pairs.kind[p] == PairKind::collider) {
        pairs.travel[p] = inputs.body.travel[a] + inputs.body.frame[a].path + inputs.collider.travel[b];
        pairs.travel_bound[p] = memory.body_travel_bound[a] + memory.collider_travel_bound[b];
        // The difference travel_bound - travel contains the motion of the collider in this step, but is not used here.
        // It would have a large rounding error, because the travel of a rotating shape grows without limit. So the
        // motion is computed again.
        pairs.closing[p] = memory.body_reach[a] + collider_reach(inputs, b, memory.collider_extent[b], h);
        return;
    }
    const Vec3 frame_offset = inputs.body.frame[a].position - inputs.body.frame[b].position;
    pairs.frame_path[p] += (frame_offset - pairs.frame_apart[p]).norm();
    pairs.frame_apart[p] = frame_offset;
    pairs.travel[p] = inputs.body.travel[a] + inputs.body.travel[b] + pairs.frame_path[p];
    pairs.travel_bound[p] =
        pairs.travel[p] + memory.body_frame_reach[a] + memory.body_frame_reach[b] + frame_reach(inputs, a, b, h);
    pairs.closing[p] = memory.body_reach[a] + memory.body_reach[b];
}

/// Lists the rows of the bodies that are marked in needs_refit.
void list_bodies(SearchMemory& memory) {
    for (std::size_t b = 0; b < memory.needs_refit.size(); ++b)
        if (memory.needs_refit[b]) memory.refit.push_back(static_cast<Index>(b));
}

/// True if the candidate list of a pair is complete for the step that begins. For a body paired with itself, the list
/// may stay complete beyond valid_until, because neighbouring parts of the body move alike (self_motion.h). The
/// function then raises valid_until.
bool is_valid(const CollisionInputs& inputs, const CollisionSettings& settings, Real h, Index p, PairTable& pairs) {
    if (pairs.travel_bound[p] < pairs.valid_until[p]) return true;
    if (pairs.kind[p] != PairKind::self || !settings.use_budgets || !(pairs.valid_until[p] > -infinity)) return false;
    const SelfMotion motion = self_motion_of(inputs, settings, pairs.state[p], pairs.first[p], h);
    const Real spare = update_spare(motion, pairs.leaf_pairs[p].listed.span(), pairs.self);
    if (!(spare > 0)) return false;
    pairs.valid_until[p] = pair_travel_base(inputs, pairs, p) + spare;
    return true;
}

void list_expired(Executor& executor, const CollisionInputs& inputs, const CollisionSettings& settings, Real h,
                  SearchMemory& memory, PairTable& pairs) {
    pairs.rebuilt.resize(pairs.size());
    if (std::ranges::find(pairs.kind, PairKind::self) != pairs.kind.end()) resize(inputs, pairs.self);
    parallel_for(executor, pairs.size(), bounded_pairs_per_block, [&](std::size_t begin, std::size_t end) {
        for (std::size_t p = begin; p < end; ++p) {
            bound_travel(inputs, memory, h, static_cast<Index>(p), pairs);
            pairs.rebuilt[p] = !is_valid(inputs, settings, h, static_cast<Index>(p), pairs);
        }
    });
    // Every index is written, but the next one overwrites it unless the list of the pair has expired. The loop thus
    // needs no branch, which would be hard to predict.
    memory.expired.resize(pairs.size() + 1);
    std::size_t expired = 0;
    for (std::size_t p = 0; p < pairs.size(); ++p) {
        memory.expired[expired] = static_cast<Index>(p);
        expired += pairs.rebuilt[p];
    }
    memory.expired.resize(expired);
    memory.refit.clear();
    if (memory.expired.empty()) return;
    memory.needs_refit.assign(inputs.body.slot.size(), 0);
    for (Index p : memory.expired) {
        if (pairs.kind[p] == PairKind::collider) continue;
        memory.needs_refit[pairs.first[p]] = memory.needs_refit[pairs.second[p]] = 1;
    }
    list_bodies(memory);
}

/// Computes the box and the bounding sphere of each body in a pair whose candidate list has expired, from the present
/// node positions.
void fit_expired(Executor& executor, const CollisionInputs& inputs, std::span<Aabb> box, SearchMemory& memory) {
    parallel_for(executor, memory.refit.size(), bounds_per_block, [&](std::size_t begin, std::size_t end) {
        for (std::size_t i = begin; i < end; ++i) {
            const Index b = memory.refit[i];
            const Range tree = inputs.body.bvh_nodes[b];
            if (tree.size() > 0) fit_bounds(inputs, b, box[tree.begin], memory.sphere[b]);
        }
    });
}

/// Upper bound of the decrease in distance between the partners of a pair in this step [m]. For two bodies, the bound
/// from motions relative to their frames (travel_bound - travel) is sharper than PairTable::closing, which follows from
/// their speeds in the world.
Real closing(const PairTable& pairs, Index p) {
    return pairs.kind[p] == PairKind::collider ? pairs.closing[p] : pairs.travel_bound[p] - pairs.travel[p];
}

/// Lower bound of the distance between the features of two bodies [m], from the boxes and bounding spheres of the
/// bodies; 0 if a body has no tree.
Real least_distance(const CollisionInputs& inputs, std::span<const Aabb> box, const SearchMemory& memory, Index first,
                    Index second) {
    const Range a = inputs.body.bvh_nodes[first], b = inputs.body.bvh_nodes[second];
    if (a.size() == 0 || b.size() == 0) return 0;
    return std::max(gap_between(memory.sphere[first], memory.sphere[second]),
                    std::sqrt(distance_squared(box[a.begin], box[b.begin])));
}

PairToSearch pair_to_search(const CollisionInputs& inputs, const CollisionSettings& settings, std::span<const Aabb> box,
                            const SearchMemory& memory, const PairTable& pairs, Index p) {
    PairToSearch pair{pairs.kind[p], pairs.first[p], pairs.second[p], {}, 0, 0, 0};
    pair.scale = pair_scale(inputs, pair.kind, pair.first, pair.second);
    pair.travel_base = pair_travel_base(inputs, pairs, p);
    pair.margin = settings.pair_skin * pair.scale.edge + std::max(closing(pairs, p), pairs.longer_motion[p]);
    if (pair.kind == PairKind::collider) return pair;
    pair.scale = pair_scale_as_known(settings, pairs.state[p], pair.scale);
    if (pair.kind == PairKind::bodies) pair.min_distance = least_distance(inputs, box, memory, pair.first, pair.second);
    return pair;
}

/// True if the boxes and spheres of two bodies show that no features are close enough to become candidates.
bool is_far(const PairToSearch& pair) {
    return pair.min_distance - pair.scale.zone >= pair.margin;
}

/// Splits the expired pairs into far pairs, which get an empty candidate list, and near pairs, whose trees must be
/// searched. Lists the bodies in near pairs, each once, for refit_trees().
void list_refits(const CollisionInputs& inputs, const CollisionSettings& settings, std::span<const Aabb> box,
                 SearchMemory& memory, const PairTable& pairs) {
    memory.refit.clear();
    memory.needs_refit.assign(inputs.body.slot.size(), 0);
    memory.near.clear();
    memory.far.clear();
    memory.near.reserve(pairs.size());  // so that later steps, in which more pairs expire, allocate nothing
    memory.far.reserve(pairs.size());
    for (Index p : memory.expired) {
        const bool surfaces = pairs.kind[p] != PairKind::collider;
        const bool far = surfaces && is_far(pair_to_search(inputs, settings, box, memory, pairs, p));
        (far ? memory.far : memory.near).push_back(p);
        if (surfaces && !far) memory.needs_refit[pairs.first[p]] = memory.needs_refit[pairs.second[p]] = 1;
    }
    list_bodies(memory);
}

void refit_trees(Executor& executor, const CollisionInputs& inputs, std::span<Aabb> box, const SearchMemory& memory) {
    parallel_for(executor, memory.refit.size(), trees_per_block, [&](std::size_t begin, std::size_t end) {
        for (std::size_t i = begin; i < end; ++i)
            refit_bvh(inputs.body.bvh_nodes[memory.refit[i]], inputs.bvh_node, inputs.leaf_nodes, inputs.position, box);
    });
}

/// Merges `found` into a candidate list; both are sorted by feature. The list is filled from its new end, so that no
/// candidate is overwritten before it has been moved.
void add_found(std::span<const FoundCandidate> found, Column<Candidate>& candidates, Column<Real>& asleep_until) {
    std::size_t kept = candidates.size(), added = found.size(), row = kept + added;
    candidates.resize(row);
    asleep_until.resize(row);
    while (added > 0) {
        --row;
        const FoundCandidate& next = found[added - 1];
        if (kept > 0 && candidates[kept - 1].feature > next.candidate.feature) {
            candidates[row] = candidates[--kept];
            asleep_until[row] = asleep_until[kept];
        } else {
            candidates[row] = next.candidate;
            asleep_until[row] = next.asleep_until;
            --added;
        }
    }
}

void search_again(const CollisionInputs& inputs, const CollisionSettings& settings, Real h, std::span<const Aabb> box,
                  Index p, const SearchMemory& memory, PairTable& pairs, Column<FoundCandidate>& found) {
    PairToSearch pair = pair_to_search(inputs, settings, box, memory, pairs, p);
    const bool compare_all = !(pairs.valid_until[p] > -infinity) || pairs.state[p] != PairState::apart;
    if (pair.kind != PairKind::collider && pairs.state[p] != PairState::apart) {
        // The test for crossing surfaces precedes the search, because surfaces that do not cross need a smaller search
        // distance. The test is left out for a pair that is known to be apart, because it stays apart
        // (PairTable::state).
        const bool crossing = !is_far(pair) && surfaces_cross(inputs, pair, box);
        pairs.state[p] = crossing ? PairState::overlapping : PairState::apart;
        pair.scale = pair_scale_as_known(settings, pairs.state[p], pair.scale);
    }
    if (pair.kind == PairKind::self) {
        renew_leaf_pairs(
            self_motion_of(inputs, settings, pairs.state[p], pair.first, h, std::max(pairs.longer_motion[p], Real(0))),
            box, compare_all, p, pairs);
        pair.leaf_pairs = pairs.leaf_pairs[p].searched.span();
        pair.margin = smallest_spare(pairs.leaf_pairs[p].listed.span());
    } else {
        pairs.candidates[p].clear();
        pairs.asleep_until[p].clear();
    }
    pairs.longer_motion[p] = pairs.longer_motion[p] > 0 ? -pairs.longer_motion[p] : 0;
    pairs.valid_until[p] = search_pair(inputs, pair, box, found);
    add_found(found.span(), pairs.candidates[p], pairs.asleep_until[p]);
}

/// Searches the expired pairs. Each task searches at most one near pair, which takes some tens of microseconds. The far
/// pairs, which take almost no time each, are divided evenly among the tasks.
void search_expired(Executor& executor, const CollisionInputs& inputs, const CollisionSettings& settings, Real h,
                    std::span<const Aabb> box, SearchMemory& memory, PairTable& pairs) {
    const std::size_t near = memory.near.size(), far = memory.far.size();
    const std::size_t blocks = std::max(near, (far + far_pairs_per_block - 1) / far_pairs_per_block);
    if (memory.found.size() < blocks) memory.found.resize(blocks);
    parallel_for(executor, blocks, 1, [&](std::size_t begin, std::size_t end) {
        for (std::size_t k = begin; k < end; ++k) {
            const auto search = [&](Index p) {
                search_again(inputs, settings, h, box, p, memory, pairs, memory.found[k]);
            };
            if (k < near) search(memory.near[k]);
            for (std::size_t i = far * k / blocks; i < far * (k + 1) / blocks; ++i) search(memory.far[i]);
        }
    });
}

std::size_t count_candidates(Executor& executor, const PairTable& pairs) {
    std::atomic<std::size_t> count{0};
    parallel_for(executor, pairs.size(), bounded_pairs_per_block, [&](std::size_t begin, std::size_t end) {
        std::size_t block_count = 0;
        for (std::size_t p = begin; p < end; ++p) block_count += pairs.candidates[p].size();
        count.fetch_add(block_count, std::memory_order_relaxed);
    });
    return count;
}

/// Requests that measure_displacement resets the displacements of the bodies in expired pairs to zero, so that new
/// lists are valid for longer. With the margin m and the displacement d at the time of the search, a list is valid for
/// the travel m - 2 d (contact_reach.h).
void request_new_origins(const CollisionInputs& inputs, const CollisionSettings& settings, SearchMemory& memory,
                         const PairTable& pairs) {
    // Bodies are left out if twice their displacement is at most this fraction of the margin, because they would gain
    // little.
    constexpr Real rebase_fraction = 0.25;
    memory.rebase.resize(inputs.body.slot.size());
    const auto request = [&](Index b, Real skin) {
        if (2 * inputs.body.displacement[b] > rebase_fraction * skin) memory.rebase[b] = 1;
    };
    for (Index p : memory.expired) {
        const Real skin = settings.pair_skin * pair_scale(inputs, pairs.kind[p], pairs.first[p], pairs.second[p]).edge;
        request(pairs.first[p], skin);
        if (pairs.kind[p] != PairKind::collider) request(pairs.second[p], skin);
    }
}

}  // namespace

bool find_candidates(Executor& executor, const CollisionInputs& inputs, const CollisionSettings& settings, Real h,
                     std::span<Aabb> box, SearchState& search, PairTable& pairs) {
    SearchMemory& memory = search.memory;
    const bool all = !settings.use_budgets;
    bool broad = mark_forgotten(inputs.body.slot.size(), all, search.body_valid_until, memory.body_forgotten);
    if (broad) mark_unmeasured(memory);
    broad |= mark_forgotten(inputs.collider.slot.size(), all, search.collider_valid_until, memory.collider_forgotten);
    bound_body_travels(executor, inputs, settings, h, memory);
    bound_collider_travels(inputs, h, memory);
    broad |= !all_below(memory.body_travel_bound, search.body_valid_until) || !colliders_below(inputs, search);
    if (broad) {
        find_pairs(executor, inputs, settings, h, search, pairs);
        // find_pairs() has updated collider_extent, from which the travel bounds of rotating colliders follow.
        bound_collider_travels(inputs, h, memory);
    }
    list_expired(executor, inputs, settings, h, memory, pairs);
    if (!broad && memory.expired.empty()) return false;

    fit_expired(executor, inputs, box, memory);
    list_refits(inputs, settings, box, memory, pairs);
    refit_trees(executor, inputs, box, memory);
    search_expired(executor, inputs, settings, h, box, memory, pairs);
    request_new_origins(inputs, settings, memory, pairs);
    search.pair_searches += memory.expired.size();
    search.candidate_count = count_candidates(executor, pairs);
    return true;
}

}  // namespace skerry
