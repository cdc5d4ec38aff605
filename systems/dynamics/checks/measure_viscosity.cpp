#include "systems/dynamics/checks/measure_viscosity.h"

#include "jobs/reduce.h"
#include "systems/dynamics/elements/element_block.h"

namespace skerry {

namespace {

constexpr std::size_t viscous_patches_per_job = 16;

Real work_on(const ElementViscousImpulse& impulse, const LaneMat3<Real8>& rate) {
    const Real8 lanes = load(impulse[0]) * rate.c0.x + load(impulse[1]) * rate.c0.y + load(impulse[2]) * rate.c0.z +
                        load(impulse[3]) * rate.c1.x + load(impulse[4]) * rate.c1.y + load(impulse[5]) * rate.c1.z +
                        load(impulse[6]) * rate.c2.x + load(impulse[7]) * rate.c2.y + load(impulse[8]) * rate.c2.z;
    Real sum = 0;
    for (std::size_t l = 0; l < element_lanes; ++l) sum += lanes[l];
    return sum;
}

}  // namespace

Real measure_viscosity(Executor& executor, const ElementInputs& elements, std::span<const Range> patches,
                       std::span<const ElementViscousImpulse> impulse, std::span<const std::uint8_t> viscous,
                       std::span<const Vec3> velocity, std::span<const Vec3> velocity_next, Column<Real>& partial) {
    const auto patch_work = [&](const Range& blocks) {
        Real work = 0;
        const auto first = static_cast<std::size_t>(blocks.begin), last = static_cast<std::size_t>(blocks.end);
        for (std::size_t b = first; b < last; ++b) {
            if (!(elements.viscous_time[b] > 0) || !viscous[b] || elements.is_left_out(b) || elements.is_of_ghost(b))
                continue;
            const BlockNodes nodes = elements.nodes_of(b);
            work += (work_on(impulse[b], deformation_gradient(nodes, velocity)) +
                     work_on(impulse[b], deformation_gradient(nodes, velocity_next))) /
                    2;
        }
        return work;
    };
    const auto work_of_range = [&](std::size_t begin, std::size_t end) {
        Real work = 0;
        for (std::size_t p = begin; p < end; ++p) work += patch_work(patches[p]);
        return work;
    };
    return reduce(executor, patches.size(), viscous_patches_per_job, partial, Real{0}, work_of_range,
                  [](Real a, Real b) { return a + b; });
}

}  // namespace skerry
