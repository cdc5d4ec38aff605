#include "systems/dynamics/predict_velocity.h"

#include "components/check.h"
#include "jobs/parallel_for.h"

namespace skerry {

void predict_velocity(Executor& executor, std::span<const Vec3> force, std::span<const Real> inverse_mass, std::span<const Vec3> velocity,
                      Real h, const RestingNodes& resting, std::span<Vec3> velocity_next) {
    SKERRY_CHECK(force.size() == velocity_next.size() && inverse_mass.size() == force.size() && velocity.size() == force.size());
    constexpr std::size_t nodes_per_job = 4096;
    parallel_for(executor, force.size(), nodes_per_job, [&](std::size_t begin, std::size_t end) {
        for (std::size_t n = begin; n < end; ++n) {
            if (resting.contain(n)) continue;
            // Not a product with zero: a pinned node stays put even when the force on it is not finite.
            velocity_next[n] = inverse_mass[n] > 0 ? Vec3(velocity[n] + (h * inverse_mass[n]) * force[n]) : velocity[n];
        }
    });
}

}  // namespace skerry
