#include "systems/dynamics/advance_positions.h"

#include "components/check.h"
#include "jobs/parallel_for.h"

namespace skerry {

void advance_positions(Executor& executor, std::span<const Vec3> velocity_next, Real h, std::span<Vec3> push_out, std::span<Vec3> position,
                       std::span<Vec3> velocity) {
    SKERRY_CHECK(velocity_next.size() == position.size() && push_out.size() == position.size() && velocity.size() == position.size());
    constexpr std::size_t nodes_per_job = 4096;
    parallel_for(executor, position.size(), nodes_per_job, [&](std::size_t begin, std::size_t end) {
        for (std::size_t n = begin; n < end; ++n) {
            position[n] += h * (velocity_next[n] + push_out[n]);
            velocity[n] = velocity_next[n];
            push_out[n].setZero();
        }
    });
}

}  // namespace skerry
