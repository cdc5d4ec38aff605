#include "systems/dynamics/gather_node_forces.h"

#include "components/check.h"
#include "jobs/parallel_for.h"

namespace skerry {

void gather_node_forces(Executor& executor, RaggedView<Index> corners, std::span<const ElementForces> element_force,
                        std::span<const Real> mass, const Vec3& gravity, std::span<const Vec3> load, std::span<Vec3> force) {
    SKERRY_CHECK(corners.size() == force.size() && mass.size() == force.size() && load.size() == force.size());
    constexpr std::size_t nodes_per_job = 1024;
    const Vec3* const corner_force = element_force.empty() ? nullptr : &element_force[0][0][0];  // a flat list: 4 corners an element
    parallel_for(executor, force.size(), nodes_per_job, [&](std::size_t begin, std::size_t end) {
        // Prefetching corners 8 nodes ahead was tried: 20 % faster from memory (1M tetrahedra), 30 % slower in cache (10k).
        const Index* corner = corners.item.data() + corners.offset[begin];
        for (std::size_t n = begin; n < end; ++n) {
            // Corner order, the element order of the mesh: the same bits whatever the worker count.
            Vec3 sum = Vec3::Zero();
            for (const Index* last = corners.item.data() + corners.offset[n + 1]; corner != last; ++corner) sum += corner_force[*corner];
            force[n] = sum + mass[n] * gravity + load[n];
        }
    });
}

}  // namespace skerry
