#include "systems/dynamics/advance_positions.h"

#include "components/check.h"
#include "jobs/parallel_for.h"

namespace skerry {

void advance_positions(Executor& executor, std::span<const Vec3> velocity_next, Real h, Integrator integrator, const RestingNodes& resting,
                       std::span<Vec3> push_out, std::span<Vec3> position, std::span<Vec3> velocity) {
    SKERRY_CHECK(velocity_next.size() == position.size() && push_out.size() == position.size() && velocity.size() == position.size());
    constexpr std::size_t nodes_per_job = 4096;
    const bool literal = integrator == Integrator::literal;
    parallel_for(executor, position.size(), nodes_per_job, [&](std::size_t begin, std::size_t end) {
        for (std::size_t n = begin; n < end; ++n) {
            if (resting.contain(n)) continue;
            position[n] += h * ((literal ? velocity[n] : velocity_next[n]) + push_out[n]);
            velocity[n] = velocity_next[n];
            if (!push_out[n].isZero(0)) push_out[n].setZero();  // most are: writing them all costs a third of the stage
        }
    });
}

}  // namespace skerry
