// What is derived from all bodies together, after some came or went.
#include <algorithm>

#include "engine/world/world_state.h"
#include "systems/dynamics/build_elements.h"

namespace skerry {

void WorldState::search_afresh() {
    search.body_valid_until.clear();
    search.collider_valid_until.clear();
}

void WorldState::topology_changed() {
    build_corners(elements.node, elements.volume, nodes.position.size(), corners);
    stiffness_sum.resize(nodes.position.size());
    total_mass = 0;
    for (const Real mass : nodes.mass) total_mass += mass;
    loaded = std::ranges::any_of(nodes.load, [](const Vec3& load) { return load != Vec3::Zero(); });
    balance.close();
    // Rows have moved: pairs and contacts are found again. Impulses stay, since their keys name bodies by slot.
    pairs = PairTable{};
    search_afresh();
    contacts.resize(0);
    regions = RegionTable{};
    contact_view_is_current = false;
}

}  // namespace skerry
