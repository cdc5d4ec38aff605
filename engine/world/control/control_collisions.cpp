// Functions that read and change which objects may collide: groups, masks and disabled pairs.
#include <algorithm>

#include "engine/world/control/control.h"
#include "systems/collision/inputs/contact_key.h"
#include "systems/collision/inputs/may_collide.h"

namespace skerry {

namespace {

/// Two objects that may collide. `first` is a row of BodyTable. `second` is a row of ColliderTable if `kind` is
/// `collider`, otherwise of BodyTable.
struct RowPair {
    PairKind kind;
    Index first, second;
};

RowPair rows_of(const Model& model, BodyHandle a, BodyHandle b, const char* call) {
    const Index first = model.row(a, call), second = model.row(b, call);
    return {first == second ? PairKind::self : PairKind::bodies, first, second};
}

RowPair rows_of(const Model& model, BodyHandle body, ColliderHandle collider, const char* call) {
    return {PairKind::collider, model.row(body, call), model.row(collider, call)};
}

void request_overlap_check(Model& model, Index body) {
    model.body_records[static_cast<std::size_t>(body)].settled = model.settled = false;
}

void request_overlap_check_of_collider(Model& model, Index collider) {
    const auto c = static_cast<std::size_t>(collider);
    model.collider_records[c].settled = model.settled = false;
    if (model.colliders.body[c] != no_index) request_overlap_check(model, model.colliders.body[c]);
}

/// Makes the next step search all pairs of a body again, and wakes the body. Sleeping bodies near it wake when pending
/// edits are completed (ChangedPlaces::wake_near).
void find_pairs_of(WorldState& world, Index body) {
    const auto b = static_cast<std::size_t>(body);
    world.cache.forget_body(world.model, b);
    world.edits.places.add_body(world.model, b);
    world.model.wake(b);
}

void set_collision(WorldState& world, const RowPair& pair, bool on) {
    Model& model = world.model;
    Column<std::uint64_t>& disabled = model.disabled_pairs.key;
    const std::uint64_t key = pair_key(model.bodies, model.colliders, pair.kind, pair.first, pair.second);
    const auto place = std::lower_bound(disabled.begin(), disabled.end(), key);
    const bool is_off = place != disabled.end() && *place == key;
    if (is_off == !on) return;
    const auto at = static_cast<std::size_t>(place - disabled.begin());
    if (on) {
        disabled.erase(at, 1);
        request_overlap_check(model, pair.first);
    } else {
        disabled.push_back(key);
        std::rotate(disabled.begin() + static_cast<std::ptrdiff_t>(at), disabled.end() - 1, disabled.end());
    }
    find_pairs_of(world, pair.first);
}

bool collide(const Model& model, const RowPair& pair) {
    if (pair.kind == PairKind::self) return model.bodies.self_contact[pair.first] != 0;
    return may_collide(model.bodies, model.colliders, model.disabled_pairs.key, pair.kind, pair.first, pair.second);
}

void enable_if(Column<std::uint64_t>& disabled, auto&& names) {
    for (std::size_t i = disabled.size(); i-- > 0;)
        if (names(slots_of_pair(disabled[i]))) disabled.erase(i, 1);
}

}  // namespace

void enable_pairs_of(BodyHandle body, DisabledPairTable& disabled) {
    enable_if(disabled.key, [&](const PairSlots& pair) {
        return pair.first == body.slot || (!pair.is_collider && pair.second == body.slot);
    });
}

void enable_pairs_of(ColliderHandle collider, DisabledPairTable& disabled) {
    enable_if(disabled.key, [&](const PairSlots& pair) { return pair.is_collider && pair.second == collider.slot; });
}

void enable_pair(WorldState& world, PairKind kind, Index first, Index second) {
    Column<std::uint64_t>& disabled = world.model.disabled_pairs.key;
    const std::uint64_t key = pair_key(world.model.bodies, world.model.colliders, kind, first, second);
    const auto place = std::lower_bound(disabled.begin(), disabled.end(), key);
    if (place == disabled.end() || *place != key) return;
    disabled.erase(static_cast<std::size_t>(place - disabled.begin()), 1);
    world.cache.forget_body(world.model, static_cast<std::size_t>(first));
}

CollisionGroups World::collision_groups(BodyHandle body) const {
    const auto row = static_cast<std::size_t>(state_->model.row(body, "collision_groups"));
    const CollisionFilter& filter = state_->model.bodies.filter[row];
    return {filter.group, filter.mask};
}

CollisionGroups World::collision_groups(ColliderHandle collider) const {
    const auto row = static_cast<std::size_t>(state_->model.row(collider, "collision_groups"));
    const CollisionFilter& filter = state_->model.colliders.filter[row];
    return {filter.group, filter.mask};
}

void World::set_collision_groups(BodyHandle body, std::uint32_t group, std::uint32_t mask) {
    state_->require_between_steps("set_collision_groups");
    Model& model = state_->model;
    const Index row = model.row(body, "set_collision_groups");
    CollisionFilter& filter = model.bodies.filter[static_cast<std::size_t>(row)];
    if (filter == CollisionFilter{group, mask}) return;
    filter = {group, mask};
    request_overlap_check(model, row);
    find_pairs_of(*state_, row);
}

void World::set_collision_groups(ColliderHandle collider, std::uint32_t group, std::uint32_t mask) {
    state_->require_between_steps("set_collision_groups");
    Model& model = state_->model;
    const Index row = model.row(collider, "set_collision_groups");
    CollisionFilter& filter = model.colliders.filter[static_cast<std::size_t>(row)];
    if (filter == CollisionFilter{group, mask}) return;
    filter = {group, mask};
    request_overlap_check_of_collider(model, row);
    state_->cache.forget_collider(model, static_cast<std::size_t>(row));
    state_->edits.places.add_collider(model, static_cast<std::size_t>(row), time());
}

void World::set_collision(BodyHandle a, BodyHandle b, bool on) {
    state_->require_between_steps("set_collision");
    const RowPair pair = rows_of(state_->model, a, b, "set_collision");
    if (pair.kind != PairKind::self) return skerry::set_collision(*state_, pair, on);
    std::uint8_t& self_contact = state_->model.bodies.self_contact[static_cast<std::size_t>(pair.first)];
    if ((self_contact != 0) == on) return;
    self_contact = on;
    find_pairs_of(*state_, pair.first);
}

void World::set_collision(BodyHandle body, ColliderHandle collider, bool on) {
    state_->require_between_steps("set_collision");
    skerry::set_collision(*state_, rows_of(state_->model, body, collider, "set_collision"), on);
}

bool World::may_collide(BodyHandle a, BodyHandle b) const {
    return collide(state_->model, rows_of(state_->model, a, b, "may_collide"));
}

bool World::may_collide(BodyHandle body, ColliderHandle collider) const {
    return collide(state_->model, rows_of(state_->model, body, collider, "may_collide"));
}

}  // namespace skerry
