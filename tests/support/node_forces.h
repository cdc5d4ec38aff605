// What predict_velocity does, by the textbook: forces summed at the nodes, then the kick.
#pragma once

#include <span>

#include "components/element_table.h"
#include "components/ragged.h"

namespace skerry::test {

/// force = sum of the forces of all corners around the node + mass gravity + load.
inline void gather_node_forces(RaggedView<Index> corners, std::span<const ElementForces> element_force,
                               std::span<const Real> mass, const Vec3& gravity, std::span<const Vec3> load,
                               std::span<Vec3> force) {
    for (std::size_t n = 0; n < force.size(); ++n) {
        Vec3 sum = Vec3::Zero();
        for (const Index corner : corners[n])
            sum += element_force[static_cast<std::size_t>(corner) / element_lanes]
                                [static_cast<std::size_t>(corner) % element_lanes];
        force[n] = sum + mass[n] * gravity + load[n];
    }
}

/// velocity_next = velocity + h force / mass where there is freedom.
inline void kick(std::span<const Vec3> force, std::span<const Real> inverse_mass, std::span<const Vec3> velocity,
                 Real h, std::span<Vec3> velocity_next) {
    for (std::size_t n = 0; n < force.size(); ++n)
        velocity_next[n] = inverse_mass[n] > 0 ? Vec3(velocity[n] + (h * inverse_mass[n]) * force[n]) : velocity[n];
}

}  // namespace skerry::test
