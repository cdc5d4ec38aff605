#include "engine/world/state/contact_cache.h"

#include <algorithm>
#include <limits>

namespace skerry {

void ContactCache::search_afresh(Model& model) {
    search.body_valid_until.clear();
    search.collider_valid_until.clear();
    constexpr Real long_ago = -std::numeric_limits<Real>::infinity();
    std::ranges::fill(model.bodies.uninverted_until, long_ago);
    std::ranges::fill(model.tetrahedra.uninverted_until, long_ago);
}

void ContactCache::forget_distances(Model& model) {
    const std::size_t body_count = model.bodies.slot.size(), collider_count = model.colliders.slot.size();
    search_afresh(model);
    std::ranges::copy(model.nodes.position, model.nodes.displacement_origin.begin());
    std::ranges::fill(model.node_blocks.displacement_squared, 0);
    std::ranges::fill(model.bodies.displacement, 0);
    std::ranges::fill(model.bodies.travel, 0);
    std::ranges::fill(model.bodies.frame, MovingFrame{});
    std::ranges::copy(model.bodies.max_speed, model.bodies.frame_speed.begin());
    std::ranges::fill(model.colliders.travel, 0);
    // Not empty columns, which would say that what is known of the pairs' sides is wrong, too.
    constexpr Real long_ago = -std::numeric_limits<Real>::infinity();
    search.body_valid_until.assign(body_count, long_ago);
    search.collider_valid_until.assign(collider_count, long_ago);
    search.memory.collider_extent.assign(collider_count, 0);
    search.memory.rebase.assign(body_count, 0);
    pairs.candidates.resize(std::max(pairs.candidates.size(), pairs.size()));
    pairs.asleep_until.resize(pairs.candidates.size());
    for (auto& list : pairs.candidates) list.clear();
    for (auto& list : pairs.asleep_until) list.clear();
    pairs.travel_bound.resize(pairs.size());
    pairs.travel.resize(pairs.size());
    pairs.closing.resize(pairs.size());
    pairs.longer_motion.assign(pairs.size(), 0);
    pairs.frame_apart.assign(pairs.size(), Vec3::Zero());
    pairs.frame_path.assign(pairs.size(), 0);
    pairs.valid_until.assign(pairs.size(), long_ago);
}

void ContactCache::drop_pairs(Model& model) {
    pairs = PairTable{};
    search_afresh(model);
}

}  // namespace skerry
