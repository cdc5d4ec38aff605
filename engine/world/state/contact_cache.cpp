#include "engine/world/state/contact_cache.h"

#include <algorithm>

namespace skerry {

void ContactCache::forget_body(Model& model, std::size_t body) {
    search.forget_body(body);
    constexpr Real long_ago = -infinity;
    model.bodies.uninverted_until[body] = long_ago;
    model.bodies.unstrained[body] = 0;
    std::ranges::fill(rows_of(model.tetrahedra.uninverted_until, model.bodies.tetrahedron_blocks[body]), long_ago);
}

void ContactCache::forget_collider(const Model& model, std::size_t collider) {
    search.forget_collider(collider);
    if (const Index body = model.colliders.body[collider]; body != no_index)
        search.forget_body(static_cast<std::size_t>(body));
}

void ContactCache::extend(const Model& model) {
    search.body_valid_until.resize(model.bodies.slot.size(), SearchState::forgotten);
    search.collider_valid_until.resize(model.colliders.slot.size(), SearchState::forgotten);
    search.memory.rebase.resize(model.bodies.slot.size());
    if (!pairs.self.origin.empty()) pairs.self.origin.resize(model.nodes.position.size(), Vec3::Zero());
    search.memory.collider_extent.resize(model.colliders.slot.size());
}

}  // namespace skerry
