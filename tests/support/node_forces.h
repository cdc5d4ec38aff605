// Textbook version of predict_velocity: forces summed at the nodes, then the kick.
#pragma once

#include <span>

#include "components/element_table.h"
#include "components/ragged.h"

namespace skerry::test {

inline Vec3 vector_of(const PaddedVec3& padded) {
    return {padded[0], padded[1], padded[2]};
}

/// force = sum of the forces of all patches around the node + mass gravity + load.
inline void gather_node_forces(RaggedView<Index> slots_of_node, std::span<const PaddedVec3> patch_force,
                               std::span<const Real> mass, const Vec3& gravity, std::span<const Vec3> load,
                               std::span<Vec3> force) {
    for (std::size_t n = 0; n < force.size(); ++n) {
        Vec3 sum = Vec3::Zero();
        for (const Index slot : slots_of_node[n]) sum += vector_of(patch_force[static_cast<std::size_t>(slot)]);
        force[n] = sum + mass[n] * gravity + load[n];
    }
}

/// velocity_next = velocity + h force / mass for free nodes; pinned nodes keep their velocity.
inline void kick(std::span<const Vec3> force, std::span<const Real> inverse_mass, std::span<const Vec3> velocity,
                 Real h, std::span<Vec3> velocity_next) {
    for (std::size_t n = 0; n < force.size(); ++n)
        velocity_next[n] = inverse_mass[n] > 0 ? Vec3(velocity[n] + (h * inverse_mass[n]) * force[n]) : velocity[n];
}

}  // namespace skerry::test
