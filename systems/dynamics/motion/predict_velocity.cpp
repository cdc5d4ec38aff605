#include "systems/dynamics/motion/predict_velocity.h"

#include <array>
#include <cstring>

#include "components/check.h"
#include "jobs/parallel_for.h"

namespace skerry {

namespace {

constexpr std::size_t kicked_blocks_per_job = 4;

struct Kick {
    const KickInputs& nodes;
    std::span<const Vec3> velocity;
    Real seconds;
    std::span<Vec3> force, velocity_next;

    void block(std::size_t b) const {
        const auto begin = static_cast<std::size_t>(nodes.block_begin[b]),
                   end = static_cast<std::size_t>(nodes.block_end[b]);
        const auto body = static_cast<std::size_t>(nodes.block_body[b]);
        if (!nodes.body_idle.empty() && nodes.body_idle[body]) return;
        if (!nodes.body_unstrained.empty() && nodes.body_unstrained[body]) {
            fly(begin, end);
            return;
        }
        if (nodes.load.empty() && are_free(begin, end))
            all_free(begin, end);
        else
            sum_slots(begin, end, [&](std::size_t n, const Real4& sum) { add(n, {sum[0], sum[1], sum[2]}); });
    }

private:
    const Real4& force_of(Index slot) const {
        return *reinterpret_cast<const Real4*>(nodes.patch_force[static_cast<std::size_t>(slot)].lane);
    }

    /// Updates the velocities of nodes on which elements exert no force.
    void fly(std::size_t begin, std::size_t end) const {
        const Vec3 gained = seconds * nodes.gravity;
        for (std::size_t n = begin; n < end; ++n)
            if (nodes.load.empty() && nodes.inverse_mass[n] > 0)
                velocity_next[n] = velocity[n] + gained;
            else
                add(n, Vec3::Zero());
    }

    /// Calls visit(node, sum) for each node, with the sum of the forces on the node from all patches. The patches are
    /// added in ascending order, so the sums are bitwise equal for any number of workers.
    void sum_slots(std::size_t begin, std::size_t end, auto&& visit) const {
        const RaggedView<Index>& slots = nodes.slots_of_node;
        const Index* slot = slots.item.data() + slots.offset[begin];
        for (std::size_t n = begin; n < end; ++n) {
            Real4 sum{};
            for (const Index* last = slots.item.data() + slots.offset[n + 1]; slot != last; ++slot)
                sum = sum + force_of(*slot);
            visit(n, sum);
        }
    }
    bool are_free(std::size_t begin, std::size_t end) const {
        const Real* const inverse_mass = nodes.inverse_mass.data();
        unsigned held = 0;
#pragma omp simd reduction(| : held)
        for (std::size_t n = begin; n < end; ++n) held |= static_cast<unsigned>(!(inverse_mass[n] > 0));
        return held == 0;
    }
    /// Updates the velocities of nodes that are not held and have no applied force, several nodes at a time.
    void all_free(std::size_t begin, std::size_t end) const {
        std::array<Real, 3 * nodes_per_block + 1> force_on;
        const std::size_t count = end - begin;
        SKERRY_CHECK(3 * count < force_on.size());
        sum_slots(begin, end, [&](std::size_t n, const Real4& sum) {
            // Writes four numbers at once. The fourth number is overwritten by the next node.
            std::memcpy(force_on.data() + 3 * (n - begin), &sum, sizeof sum);
        });
        const Real *const v = velocity[begin].data(), *const mass = nodes.mass.data() + begin,
                          *const inverse_mass = nodes.inverse_mass.data() + begin, *const f = force_on.data();
        Real* const next = velocity_next[begin].data();
        const Real gx = nodes.gravity[0], gy = nodes.gravity[1], gz = nodes.gravity[2], h = seconds;
#pragma omp simd
        for (std::size_t n = 0; n < count; ++n) {
            const Real m = mass[n], time_over_mass = h * inverse_mass[n];
            next[3 * n] = v[3 * n] + time_over_mass * (f[3 * n] + m * gx);
            next[3 * n + 1] = v[3 * n + 1] + time_over_mass * (f[3 * n + 1] + m * gy);
            next[3 * n + 2] = v[3 * n + 2] + time_over_mass * (f[3 * n + 2] + m * gz);
        }
    }
    [[gnu::always_inline]] void add(std::size_t n, const Vec3& sum) const {
        Vec3 total = sum + nodes.mass[n] * nodes.gravity;
        if (!nodes.load.empty()) total += nodes.load[n];
        // A branch is used instead of a product with the inverse mass 0: a pinned node must not move even if the force
        // on the node is not finite.
        if (nodes.inverse_mass[n] > 0) {
            velocity_next[n] = velocity[n] + (seconds * nodes.inverse_mass[n]) * total;
        } else {
            velocity_next[n] = velocity[n];
            force[n] = total;
        }
    }
};

}  // namespace

void predict_velocity(Executor& executor, const KickInputs& nodes, std::span<const Vec3> velocity, Real kick,
                      std::span<Vec3> force, std::span<Vec3> velocity_next) {
    [[maybe_unused]] const std::size_t count = velocity_next.size();
    SKERRY_CHECK(nodes.slots_of_node.size() == count && nodes.mass.size() == count &&
                 nodes.inverse_mass.size() == count);
    SKERRY_CHECK(velocity.size() == count && force.size() == count &&
                 (nodes.load.empty() || nodes.load.size() == count));
    const Kick kicked{nodes, velocity, kick, force, velocity_next};
    parallel_for(executor, nodes.block_begin.size(), kicked_blocks_per_job, [&](std::size_t first, std::size_t last) {
        for (std::size_t b = first; b < last; ++b) kicked.block(b);
    });
}

}  // namespace skerry
