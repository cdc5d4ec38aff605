#include "systems/solver/regions/push_freedom.h"

#include <algorithm>

#include "systems/solver/regions/turned_axes.h"

namespace skerry {
namespace {

/// Joints during the push: locked rows hold, and axes stay within their limits for push and step together. The impulses
/// of the push use a workspace that the method no longer needs.
class PushedJoints {
public:
    PushedJoints(const FreedomRegion& region, const FreedomOperator& op)
        : region_(region), op_(op), impulse_(region.memory.workspace[0]) {
        for (std::size_t k = 0; k < region.joint.size(); ++k) impulse_[region.row.size() + k].setZero();
    }

    /// One sweep. Returns the size of the change [J]
    Real sweep(std::span<Vec4> velocity) const {
        Real size = 0;
        for (std::size_t k = 0; k < region_.joint.size(); ++k) {
            const std::size_t at = region_.row.size() + k;
            const auto i = static_cast<Index>(at);
            const RigidPart& part = region_.memory.part[at];
            const JointLaw& law = *op_.joint(i);
            const Mat3 frame = matrix_of(part.frame);
            const Vec3 r = frame.transpose() * impulse_[at].head<3>();
            const Vec3 u = frame.transpose() * op_.velocity_at(i, velocity.data()).head<3>();
            const Vec4 next = padded(frame * law.answer(bounds(at, law), u - law.block * r));
            const Vec4 change = next - impulse_[at];
            if (change.isZero(0)) continue;
            op_.push(i, change, velocity.data());
            impulse_[at] = next;
            size += op_.inner(i, change, change);
        }
        return size;
    }

private:
    AxisBounds bounds(std::size_t at, const JointLaw& law) const {
        const RigidPart& part = region_.memory.part[at];
        const Vec4 u =
            region_.memory.contact[at].offset + op_.velocity_at(static_cast<Index>(at), region_.memory.velocity.data());
        const Real along = part.frame[2].dot(u);
        return {std::min(law.axis.low - along, Real(0)), std::max(law.axis.high - along, Real(0)), 0, 0};
    }

    const FreedomRegion& region_;
    const FreedomOperator& op_;
    std::span<Vec4> impulse_;
};

/// Push of one region.
class Push {
public:
    Push(const RegionStage& stage, const FreedomRegion& region, const FreedomOperator& op)
        : stage_(stage),
          region_(region),
          op_(op),
          slop_(push_slop(stage.inputs.gravity, stage.h)),
          axes_(stage, region.rigid, region.memory.velocity),
          memory_(push_memory(stage, region.base, region.row.size(), region.memory.scratch)) {}

    bool run() {
        const bool pressed = std::ranges::any_of(region_.row, [&](Index i) { return gap(i) < -slop_; });
        if (!pressed && !axes_.any()) return false;
        std::ranges::fill(memory_.velocity, Vec4::Zero());
        std::ranges::fill(memory_.impulse, 0);
        const Asked asked = ask();
        if (!pressed && !asked.by_turns) return false;
        const PushedJoints joints(region_, op_);
        sweep(joints, asked.size);
        // The push rotates the axes, too, so the loss is evaluated again.
        for (int round = 0; round < turn_rounds && axes_.any(); ++round) sweep(joints, ask().size);
        return true;
    }

private:
    static constexpr int turn_rounds = 2;

    struct Asked {
        Real size = 0;  // [J]
        bool by_turns = false;
    };

    Real gap(Index row) const { return stage_.inputs.gap[static_cast<std::size_t>(row)]; }

    Asked ask() {
        Asked asked;
        for (std::size_t at = 0; at < region_.row.size(); ++at) {
            const LumpedContact& contact = region_.memory.contact[at];
            const RigidPart& part = region_.memory.part[at];
            const Real along = contact.normal.dot(contact.offset + op_.velocity_at(static_cast<Index>(at),
                                                                                   region_.memory.velocity.data())) -
                               contact.bias;
            const Real depth = gap(region_.row[at]);
            const Real loss = axes_.any() ? axes_.loss(region_.row[at], part, memory_.velocity) : 0;
            memory_.bias[at] = push_bias(along, depth, slop_, stage_.settings, stage_.inputs.gravity, stage_.h);
            if (loss < 0) memory_.bias[at] = push_bias_turned(memory_.bias[at], along, depth, slop_, loss, stage_.h);
            asked.by_turns |= loss < 0 && memory_.bias[at] < 0;
            const Real approach = std::min(memory_.bias[at], Real(0));
            if (part.along_normal > 0) asked.size += approach * approach / part.along_normal;
        }
        return asked;
    }

    void sweep(const PushedJoints& joints, Real asked) {
        const Real small = region_.tolerance * region_.tolerance * asked;
        for (Index iteration = 1; iteration <= stage_.settings.max_iterations; ++iteration) {
            Real size = joints.sweep(memory_.velocity);
            for (std::size_t at = 0; at < region_.row.size(); ++at) size += push_at(at);
            if (size <= small && !stage_.settings.fixed_iterations) break;
        }
    }

    /// Returns the size of the change [J]
    [[gnu::always_inline]] Real push_at(std::size_t at) {
        const auto i = static_cast<Index>(at);
        const Real mobility = region_.memory.part[at].along_normal;
        if (!(mobility > 0)) return 0;
        const Vec4& normal = region_.memory.contact[at].normal;
        const Real along = memory_.bias[at] + normal.dot(op_.velocity_at(i, memory_.velocity.data()));
        const Real next = std::max(Real(0), memory_.impulse[at] - along / mobility);
        const Real change = next - memory_.impulse[at];
        if (change == 0) return 0;
        op_.push(i, change * normal, memory_.velocity.data());
        memory_.impulse[at] = next;
        return mobility * change * change;
    }

    const RegionStage& stage_;
    const FreedomRegion& region_;
    const FreedomOperator& op_;
    const Real slop_;
    const TurnedAxes axes_;
    const PushMemory memory_;
};

}  // namespace

bool push_freedom(const RegionStage& stage, const FreedomRegion& region, const FreedomOperator& op) {
    return Push(stage, region, op).run();
}

}  // namespace skerry
