// What is derived from all bodies together, after some came or went.
#include <algorithm>
#include <limits>

#include "engine/world/world_state.h"
#include "systems/dynamics/build_elements.h"

namespace skerry {

void WorldState::search_afresh() {
    search.body_valid_until.clear();
    search.collider_valid_until.clear();
    constexpr Real long_ago = -std::numeric_limits<Real>::infinity();
    std::ranges::fill(bodies.sound_until, long_ago);
    std::ranges::fill(elements.sound_until, long_ago);
}

void WorldState::topology_changed() {
    build_corners(elements.node, elements.volume, nodes.position.size(), corners);
    for (LevelMask& levels : nodes.levels) levels = 0;
    for (std::size_t b = 0; b < elements.node.size(); ++b)
        for (std::size_t l = 0; l < element_lanes; ++l)
            if (elements.volume[b][l] > 0)
                for (std::size_t a = 0; a < 4; ++a)
                    nodes.levels[static_cast<std::size_t>(elements.node[b][a][l])] |= static_cast<LevelMask>(1u << elements.level[b]);
    stiffness_sum.resize(nodes.position.size());
    body_mass.assign(bodies.slot.size(), 0);
    for (std::size_t n = 0; n < nodes.mass.size(); ++n) body_mass[static_cast<std::size_t>(nodes.body[n])] += nodes.mass[n];
    loaded = std::ranges::any_of(nodes.load, [](const Vec3& load) { return load != Vec3::Zero(); });
    balance.close();
    wake_all();
    // Rows have moved: pairs and contacts are found again. Impulses stay, since their keys name bodies by slot.
    pairs = PairTable{};
    search_afresh();
    contacts.resize(0);
    regions = RegionTable{};
    contact_view_is_current = false;
}

void WorldState::wake(std::size_t body) {
    bodies.asleep[body] = 0;
    bodies.calm[body] = 0;
}

void WorldState::wake_all() {
    for (std::size_t b = 0; b < bodies.asleep.size(); ++b) wake(b);
}

void WorldState::note_rest() {
    any_asleep = false;
    pressed.clear();
    step.awake_mass = 0;
    for (std::size_t b = 0; b < bodies.asleep.size(); ++b) {
        any_asleep |= bodies.asleep[b] != 0;
        if (!bodies.asleep[b]) step.awake_mass += body_mass[b];
    }
}

}  // namespace skerry
