// Delassus operator W of regions with rigid bodies, which maps contact impulses to contact velocities. The regions may
// also contain implicit bodies, clusters, and nodes with their own mass.
//
// The blocks of W are 3x3 matrices. Like LumpedOperator, the operator stores the velocities that the impulses produce.
// A rigid body has two velocity rows: the velocity of its centre and its spin (docs/methods/rigid_bodies.md 3).
#pragma once

#include <array>
#include <optional>
#include <span>

#include "components/options.h"
#include "systems/solver/equations/body_equations.h"
#include "systems/solver/equations/pool.h"
#include "systems/solver/local/cable_law.h"
#include "systems/solver/local/joint_law.h"
#include "systems/solver/local/push_contact.h"
#include "systems/solver/local/rigid_part.h"
#include "systems/solver/operators/contact_operator.h"
#include "systems/solver/operators/contact_runs.h"
#include "systems/solver/operators/through_groups.h"

namespace skerry {

/// Memory of one region. The LumpedContacts omit nodes of rigid bodies, which RigidPart describes.
/// LumpedContact::diagonal is a third of the trace of W_ii.
struct BodyMemory : ContactMemory {
    std::span<RigidPart> part;            // by contact
    Index contacts = 0;                   // number of contacts without joint blocks and cable points, which follow them
    std::span<const JointLaw> joint;      // by joint block (three rows); block k has the contact index contacts + k
    std::span<const Index> cable;         // indices in cable_law; the points of these cables follow the joint blocks
    std::span<const CableLaw> cable_law;  // by solved cable of the step
    std::span<const Vec4> free_velocity;  // by velocity row: velocity without impulses [m/s, rad/s]
};

using NewtonPool = Pool<NewtonEquations>;
using RunPool = Pool<ContactRuns>;

class BodyOperator : public RegionOperatorBase<BodyOperator, ThroughGroups, BodyMemory> {
    using Base = RegionOperatorBase<BodyOperator, ThroughGroups, BodyMemory>;
    friend Base;

public:
    /// The error e_nat is divided by `scale` [sqrt(J)]. The velocities in `memory` must be those that its impulses
    /// produce. `pool` lends memory for Newton steps, `runs` for sweeps over implicit bodies.
    BodyOperator(const BodyMemory& memory, Friction friction, Real scale, const ThroughGroups& traversal,
                 NewtonPool& pool, RunPool& runs)
        : Base(memory, friction, scale, traversal), pool_(&pool) {
        if (!traversal.any_deforms()) return;
        runs_ = runs.lease();
        runs_->start();
    }

    void extrapolate(Real factor);
    Real sweep(Real relaxation);
    SweepChange accelerated_sweep(Real relaxation);
    Real inner(Index i, const Vec4& a, const Vec4& b) const { return a.dot(times(part(i).mobility, b)); }
    Vec4 project(Index i, const Vec4& impulse) const {
        if (i >= memory_.contacts) return impulse;  // impulses of joints and cables have no friction cone
        if (part(i).across != 1) return project_in_frame(i, impulse);
        return project_friction(impulse, contact(i).normal, contact(i).friction, friction_);
    }
    void assemble(Eigen::MatrixXd& matrix) const;

    /// Takes at most `limit` Newton steps (docs/methods/region_solver.md 5.9) from the present impulse, whose error is
    /// `error`. The final impulse is the best one. The steps use slots 1 and 2 of the workspace, and lease memory at
    /// the first call.
    SolveResult take_newton_steps(Real error, Real tolerance, Index limit);
    Real newton_step_cost() { return newton_memory().cost(); }  // estimate [ns]
    /// Coarse correction: rounds of Newton steps in which deformable bodies move as rigid bodies
    /// (docs/methods/region_solver.md 5.10). Deformations are updated once per round. The rounds end when one reduces
    /// the error little.
    SolveResult correct_rigid_modes(Real error, Real tolerance, Index limit);
    /// True if the coarse correction pays off: some implicit body is not held, there are no clusters, and there are
    /// many contacts per body.
    bool corrects_rigid_modes() const;
    Real sweep_cost() const;  // estimate [ns]

    /// Velocity of a contact [m/s]
    Vec4 velocity(Index i) const { return contact(i).offset + velocity_at(i, memory_.velocity.data()); }
    /// Velocity of a contact without its offset (the part that no impulse changes), for the velocity rows `velocity`
    /// [m/s]
    [[gnu::always_inline]] Vec4 velocity_at(Index i, const Vec4* velocity) const {
        return add_rigid_velocities(part(i), velocity, add_node_velocities(contact(i), velocity, Vec4::Zero()));
    }
    /// Applies an impulse to rigid bodies, clusters and nodes with their own mass. Implicit bodies move rigidly: their
    /// deformations do not change.
    [[gnu::always_inline]] void apply_undeformed(Index i, const Vec4& impulse, Vec4* velocity) const {
        traversal_.apply_undeformed(contact(i), impulse, velocity);
        apply_to_rigid(part(i), impulse, velocity);
    }
    /// Squared energy norm of the impulse that changes the normal speed of a contact by `speed` [J]
    Real push_size(Index i, Real speed) const {
        return part(i).along_normal > 0 ? speed * speed / part(i).along_normal : 0;
    }
    /// Gauss-Seidel step of the split impulse for contact i (push_contact.h). Changes the pseudo velocities `velocity`
    /// and the push impulse `impulse`. Returns the squared energy norm of the change of the impulse [J]
    [[gnu::always_inline]] Real push(Index i, Real bias, Vec4* velocity, Real& impulse) const {
        const Real mobility = part(i).along_normal;
        if (!(mobility > 0)) return 0;
        const Vec4& normal = contact(i).normal;
        const Vec4 pushed = velocity_at(i, velocity);
        if (limits(i).ties()) return push_tie(i, held_part(contact(i), pushed), velocity);
        const Real next = std::max(Real(0), impulse - (bias + normal.dot(pushed)) / mobility);
        const Real change = next - impulse;
        if (change == 0) return 0;
        apply_undeformed(i, change * normal, velocity);
        impulse = next;
        return mobility * change * change;
    }

    /// Returns the law of a joint block, or null for a contact or a point of a cable.
    const JointLaw* joint(Index i) const {
        return i < memory_.contacts || i >= swept_count()
                   ? nullptr
                   : &memory_.joint[static_cast<std::size_t>(i - memory_.contacts)];
    }

    /// Rate at which the mimic equation of the blocks i and i + 1 is violated: the sum of their coefficients times axis
    /// velocities. `velocity_of(k)`: velocity of block k.
    Real mimic_rate(Index i, auto&& velocity_of) const {
        Real rate = 0;
        for (const Index k : {i, i + 1}) rate += joint(k)->mimic * part(k).frame[2].dot(velocity_of(k));
        return rate;
    }
    /// Solves the mimic equation of the blocks i and i + 1 while all other impulses stay. `apply(k, change)` changes
    /// the impulse of block k. Returns the squared energy norm of the change [J]
    Real solve_mimic(Index i, Real relaxation, auto&& velocity_of, auto&& apply) const {
        const Real change = -relaxation * mimic_rate(i, velocity_of) * contact(i).inverse_diagonal;
        for (const Index k : {i, i + 1}) apply(k, Vec4(joint(k)->mimic * change * part(k).frame[2]));
        return contact(i).diagonal * change * change;
    }

private:
    // Functions that the base class calls.
    bool moves(Index i) const { return contact(i).inverse_diagonal > 0; }
    Real squared_residual(Index i) const;  // uses a third of the trace of the diagonal block W_ii as mobility D
    const Vec4& free_velocity(std::size_t n) const { return memory_.free_velocity[n]; }
    /// Adds the velocity change by `impulse` to `velocity`. An impulse on an implicit body moves all nodes of the body
    /// that have contacts. So the impulses are first summed by node, and each node is then processed once.
    void add_response(std::span<const Vec4> impulse, std::span<Vec4> velocity) const;

    const RigidPart& part(Index i) const { return memory_.part[static_cast<std::size_t>(i)]; }
    // Functions of the Newton steps.
    BodyEquations& newton_memory();
    void assemble(BodyEquations& equations) const;
    /// Copies the velocities of the region to `velocity`, in the order of the unknowns.
    void gather(BodyEquations& equations, Column<Real>& velocity) const;
    enum class Evaluation { value, matrix, turns };
    Real evaluate_motion(BodyEquations& equations, std::span<const Vec4> start, Evaluation evaluation);
    void stop_reversed(BodyEquations& equations, std::span<const Vec4> start);
    Real compare_motion(BodyEquations& equations, std::span<const Vec4> start);
    BodyEquations& list_equations(BodyEquations& equations);
    /// moves_rigidly(): true if the rigid motion of the body of `term` is an unknown. is_unknown(): true if the
    /// velocity of the node is an unknown.
    bool moves_rigidly(const BodyEquations& equations, const RigidTerm& term) const;
    bool is_unknown(const BodyEquations& equations, Index node) const;
    BodyEquations* rigid_mode_memory();
    void start_rigid_round(BodyEquations& equations);
    void push_rigid_modes(std::span<const Vec4> start);
    /// Step of the split impulse for a tie. `held_velocity`: part of the pseudo velocity of the tie that the tie locks.
    /// The step makes this part zero.
    Real push_tie(Index i, const Vec4& held_velocity, Vec4* velocity) const;
    std::optional<Real> step_with_last_states(BodyEquations& equations, std::span<const Vec4> start);
    std::optional<Real> step_motion(BodyEquations& equations, std::span<const Vec4> start, Real merit);
    void list_unknowns(BodyEquations& equations) const;
    void list_parts(BodyEquations& equations) const;
    void list_effects(BodyEquations& equations) const;
    void couple_parts(BodyEquations& equations) const;
    void assemble_deforming(BodyEquations& equations, std::size_t begin, std::size_t end) const;
    Index body_id_of_node(Index node) const;
    bool touches_clusters() const;
    bool is_rigid(const BodyEquations::Unknown& unknown) const;
    bool deforms(const BodyEquations::Unknown& unknown) const;

    /// project() for a contact whose friction depends on the direction.
    Vec4 project_in_frame(Index i, const Vec4& impulse) const;
    /// Impulse of contact i from its law while all other impulses are fixed. It is exact for the friction cone; for the
    /// pyramid the step is damped.
    Vec4 solve_law(Index i, const Vec4& impulse, const Vec4& u);
    /// Solves contact i and applies the change of its impulse. Returns change . W_ii change, where W_ii is the diagonal
    /// block of contact i [J]
    Real step(Index i, Real relaxation);
    /// Number of contacts and joint blocks. The points of cables have the indices after them.
    Index swept_count() const { return memory_.contacts + static_cast<Index>(memory_.joint.size()); }
    /// Calls `visit` for all contacts and joint blocks in ascending order.
    void for_each_in_sweep(auto&& visit);
    /// Solves the cables one after the other. Adds their part of the change in this sweep to `sum`.
    void sweep_cables(Real relaxation, SweepChange& sum);
    /// Computes the present impulses and rates of a cable from the region's impulses and velocities, and stores them in
    /// its law.
    const CableLaw& read_cable(Index cable) const;
    void list_runs() const;
    /// Applies an impulse of contact i within a sweep. On an implicit body only the nodes of the present run (a short
    /// sequence of contacts, see ContactRuns) move at once. The other nodes follow at the end of the run.
    void apply(Index i, const Vec4& impulse);

    NewtonPool* pool_;
    NewtonPool::Lease newton_;
    RunPool::Lease runs_;  // leased if contacts of the step touch implicit bodies
    bool own_are_listed_ = false, rigid_modes_are_listed_ = false;
    bool inertia_is_known_ = false;  // true after the first Newton steps, when the equations contain K
};

extern template class RegionOperatorBase<BodyOperator, ThroughGroups, BodyMemory>;  // compiled in body_operator.cpp

}  // namespace skerry
