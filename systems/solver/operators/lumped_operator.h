// The contact operator of lumped masses: every block is a number times the identity (methods.md 0.1, fact A). It carries the velocities of
// the region's moving nodes, so that one contact step is a gather and a scatter.
#pragma once

#include <array>
#include <cstdint>
#include <span>

#include "components/options.h"
#include "components/types.h"
#include "systems/solver/operators/contact_operator.h"
#include "systems/solver/solve_regions.h"

namespace skerry {

/// What a sweep needs of one contact, side by side. Nodes that do not move are not in the stencil: their velocity is in `offset`.
struct LumpedContact {
    Vec4 normal;                 // unit
    Vec4 offset;                 // m/s: velocity of fixed nodes minus that of the collider, plus bias along the normal
    std::array<Real, 4> weight;  // of the moving nodes
    std::array<Real, 4> step;    // 1/kg, weight times inverse mass
    std::array<Index, 4> node;   // rows of the region's own nodes
    Index node_count;            // 0: no impulse of this contact could move anything
    Real diagonal;               // 1/kg, D of methods.md 2.2
    Real inverse_diagonal;       // kg
    Real bias;                   // m/s, its part of the offset
    FrictionLimits friction;
};

/// start + sum of weight times velocity of the moving nodes.
inline Vec4 add_node_velocities(const LumpedContact& contact, const Vec4* velocity, Vec4 start) {
    for (Index a = 0; a < contact.node_count; ++a) start += contact.weight[a] * velocity[contact.node[a]];
    return start;
}

/// u = W r + q of one contact.
inline Vec4 contact_velocity(const LumpedContact& contact, const Vec4* velocity) {
    return add_node_velocities(contact, velocity, contact.offset);
}

inline void apply_impulse(const LumpedContact& contact, const Vec4& impulse, Vec4* velocity) {
    for (Index a = 0; a < contact.node_count; ++a) velocity[contact.node[a]] += contact.step[a] * impulse;
}

/// The Gauss-Seidel step of one contact (methods.md 2.2). Returns D |change|^2.
inline Real solve_contact(const LumpedContact& contact, Friction friction, Real relaxation, Vec4* velocity, Vec4& impulse) {
    const Vec4 u = contact_velocity(contact, velocity);
    const Vec4 stopping = impulse - (relaxation * contact.inverse_diagonal) * u;
    const Vec4 next = project_friction(stopping, contact.normal, contact.friction, friction);
    const Vec4 change = next - impulse;
    const Real size = change.dot(change);
    if (size == 0) return 0;  // most contacts that are apart: nothing to scatter
    apply_impulse(contact, change, velocity);
    impulse = next;
    return contact.diagonal * size;
}

/// F_i of methods.md 2.1: how far the impulse is from the one its velocity asks for. The De Saxce form where it exists (cone, one
/// coefficient), else the residual of the contact step.
inline Vec4 natural_map(const LumpedContact& contact, Friction friction, const Vec4& impulse, const Vec4& u) {
    const FrictionLimits mu = contact.friction;
    if (friction == Friction::cone && mu.stick == mu.slide) {
        const Vec4 tangential = u - contact.normal.dot(u) * contact.normal;
        const Vec4 shifted = u + (mu.stick * tangential.norm()) * contact.normal;
        return impulse - project_onto_cone(Vec4(impulse - contact.inverse_diagonal * shifted), contact.normal, mu.stick);
    }
    return impulse - project_friction(Vec4(impulse - contact.inverse_diagonal * u), contact.normal, mu, friction);
}

/// Whether a contact with this velocity needs no impulse. The associated law presses on what slides unless it lifts off fast enough.
inline bool separates(const LumpedContact& contact, Friction friction, const Vec4& u) {
    const Real along = contact.normal.dot(u);
    if (friction != Friction::cone_convex) return along >= 0;
    return along >= contact.friction.slide * (u - along * contact.normal).norm();
}

/// Loads contact `row`; `local(node)` gives the region's row of a moving node. `velocity_next` is what the contact sees before the solve.
template <class Local>
LumpedContact load_contact(const RegionInputs& inputs, Index row, std::span<const Vec3> velocity_next, const SolverSettings& settings,
                           Real h, Local&& local);

/// b_n of methods.md 1.3 c: the gap may close within the step; an impact turns back with the restitution. Gaps below zero are left to
/// push_out_region.
Real contact_bias(const RegionInputs& inputs, Index row, std::span<const Vec3> velocity_next, const SolverSettings& settings, Real h);

/// m/s, half of what forces turn the slip by in this step, at right angles to it. The law of friction looks at the velocity after the impulse;
/// without this the direction of sliding would be that at the end of the step's kick, an error of first order, instead of that in its middle.
/// Zero where nothing slides, without friction, or where it goes straight on.
Vec3 half_turn(const RegionInputs& inputs, Index row, std::span<const Vec3> velocity_next);

/// One region. The memory belongs to the caller.
class LumpedOperator {
public:
    /// A contact that has not been looked at since the last measure of the error: its last velocity says nothing.
    static constexpr std::uint8_t velocity_unknown = 255;

    struct Memory {
        std::span<const LumpedContact> contact;
        std::span<Vec4> impulse;                                 // N s
        std::span<Vec4> velocity;                                // m/s, of the region's nodes, moved by the impulse
        std::span<const Index> node;                             // rows of NodeTable
        std::span<const Vec3> free_velocity;                     // m/s, by row of NodeTable
        std::span<Vec4> scratch;                                 // by node of the region: previous velocities, or those of a product
        std::array<std::span<Vec4>, workspace_limit> workspace;  // by contact
        std::span<std::uint8_t> resting{};  // by contact: sweeps without a change, at first velocity_unknown. None: no contact is frozen
        std::span<Vec4> last_velocity{};    // m/s, by contact, while one may rest
        Real still = 0;                     // J, a smaller change is none
    };

    /// `scale` is that of e_nat: sqrt(J). Velocities must be those of the impulse.
    LumpedOperator(const Memory& memory, Friction friction, Real scale) : memory_(memory), friction_(friction), scale_(scale) {}

    Index size() const { return static_cast<Index>(memory_.contact.size()); }
    std::span<Vec4> impulse() { return memory_.impulse; }
    std::span<Vec4> workspace(Index slot) { return memory_.workspace[slot]; }
    void refresh() { refresh(memory_.impulse, memory_.velocity); }
    void refresh_all();
    void remember();
    void extrapolate(Real factor);
    Real sweep(Real relaxation) {
        if (may_freeze()) return sweep_in_order(*this, [this, relaxation](Index i) { return step_unless_frozen(i, relaxation); });
        return sweep_in_order(*this, [this, relaxation](Index i) { return step(i, relaxation); });
    }
    SweepChange accelerated_sweep(Real relaxation) {
        if (may_freeze())
            return accelerated_sweep_in_order(*this, [this, relaxation](Index i) { return step_unless_frozen(i, relaxation); });
        return accelerated_sweep_in_order(*this, [this, relaxation](Index i) { return step(i, relaxation); });
    }
    /// e_nat of methods.md 2.1, of all contacts: frozen ones are looked at, and go on.
    Real error();
    /// Contact steps left out so far.
    Index frozen() const { return frozen_; }
    /// Puts every impulse into its cone: the acceleration carries those of frozen contacts on without one. Returns whether any was outside.
    bool make_feasible();
    /// A sweep's change is about the natural map of its start: worth a look once it is as small.
    bool suggests_check(Real change, Real tolerance) const { return change <= tolerance * tolerance * scale_ * scale_; }
    Real inner(Index i, const Vec4& a, const Vec4& b) const { return memory_.contact[i].diagonal * a.dot(b); }
    void residual(std::span<Vec4> out) const;
    void multiply(std::span<const Vec4> in, std::span<Vec4> out);
    Vec4 project(Index i, const Vec4& impulse) const {
        return project_friction(impulse, memory_.contact[i].normal, memory_.contact[i].friction, friction_);
    }
    Vec4 feasible(Index i, const Vec4& residual) const {
        return feasible_direction(residual, memory_.impulse[i], memory_.contact[i].normal, memory_.contact[i].friction, friction_);
    }

    Vec4 normal(Index i) const { return memory_.contact[i].normal; }
    FrictionLimits limits(Index i) const { return memory_.contact[i].friction; }
    Real mobility(Index i) const { return memory_.contact[i].node_count > 0 ? memory_.contact[i].diagonal : 0; }
    Friction law() const { return friction_; }
    void assemble(Eigen::MatrixXd& matrix) const;

private:
    /// Counts the sweep. The first ones are not worth the bookkeeping: most solves end with them.
    bool may_freeze() {
        constexpr Index first_sweeps = 8;
        return !memory_.resting.empty() && ++sweeps_ > first_sweeps;
    }
    Real step_unless_frozen(Index i, Real relaxation);
    Real step(Index i, Real relaxation) {
        return solve_contact(memory_.contact[i], friction_, relaxation, memory_.velocity.data(), memory_.impulse[i]);
    }
    void refresh(std::span<const Vec4> impulse, std::span<Vec4> velocity) const;

    Memory memory_;
    Friction friction_;
    Real scale_;
    Index sweeps_ = 0, frozen_ = 0;
};

template <class Local>
LumpedContact load_contact(const RegionInputs& inputs, Index row, std::span<const Vec3> velocity_next, const SolverSettings& settings,
                           Real h, Local&& local) {
    const Stencil& stencil = inputs.stencil[row];
    LumpedContact contact;
    contact.normal = padded(inputs.normal[row]);
    contact.bias = contact_bias(inputs, row, velocity_next, settings, h);
    Vec3 offset = contact.bias * inputs.normal[row] - inputs.surface_velocity[row];
    contact.node_count = 0;
    contact.diagonal = 0;
    Real lightest = 0;  // 1/kg
    for (std::size_t a = 0; a < 4; ++a) {
        const Real weight = stencil.weight[a];
        if (weight == 0) continue;
        const Index node = stencil.node[a];
        const Real inverse_mass = inputs.inverse_mass[node];
        if (!(inverse_mass > 0)) {
            offset += weight * velocity_next[node];
            continue;
        }
        const Index place = contact.node_count++;
        contact.weight[place] = weight;
        contact.step[place] = weight * inverse_mass;
        contact.node[place] = local(node);
        contact.diagonal += weight * weight * inverse_mass;
        lightest = std::max(lightest, inverse_mass);
    }
    // a moving node whose share is below 1e-6 would have to move a million times faster than the contact to stop it: it cannot
    constexpr Real smallest_share = 1e-12;  // of the squared weight
    if (contact.diagonal <= smallest_share * lightest) contact.node_count = 0;
    contact.inverse_diagonal = contact.node_count > 0 ? 1 / contact.diagonal : 0;
    contact.friction = {inputs.static_friction[row], inputs.dynamic_friction[row]};
    offset -= half_turn(inputs, row, velocity_next);
    contact.offset = padded(offset);
    return contact;
}

}  // namespace skerry
