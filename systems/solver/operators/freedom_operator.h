// The Delassus operator of contacts that touch rigid bodies, beside nodes of their own mass and clusters of nodes: the
// blocks of W are matrices. It carries velocities along as LumpedOperator does, a rigid body's as two more: of its
// centre and its spin (docs/methods/rigid_bodies.md 3).
#pragma once

#include <array>
#include <optional>
#include <span>

#include "components/options.h"
#include "systems/solver/equations/body_equations.h"
#include "systems/solver/equations/pool.h"
#include "systems/solver/local/joint_law.h"
#include "systems/solver/local/rigid_part.h"
#include "systems/solver/operators/contact_operator.h"
#include "systems/solver/operators/contact_runs.h"
#include "systems/solver/operators/through_groups.h"

namespace skerry {

/// One region; by contact, but for velocities. The memory belongs to the caller. LumpedContact::diagonal is a third of
/// the trace of W_ii.
struct FreedomMemory {
    std::span<const LumpedContact> contact;  // its nodes are those without a rigid body
    std::span<RigidPart> part;
    std::span<const JointLaw> joint;      // of the last so many contacts, which are rows of joints
    std::span<Vec4> impulse;              // N s
    std::span<Vec4> velocity;             // m/s and rad/s, moved by the impulse
    std::span<const Vec4> free_velocity;  // without impulses
    std::span<Vec4> scratch;              // as velocity: previous ones, or those of a product
    std::array<std::span<Vec4>, workspace_limit> workspace;
};

using NewtonPool = Pool<NewtonEquations>;
using RunPool = Pool<ContactRuns>;

class FreedomOperator {
public:
    using Number = Real;

    /// `scale` is that of e_nat: sqrt(J). Velocities must be those of the impulse. `pool`: for Newton steps.
    FreedomOperator(const FreedomMemory& memory, Friction friction, Real scale, const ThroughGroups& walk,
                    NewtonPool& pool, RunPool& runs)
        : memory_(memory), friction_(friction), scale_(scale), walk_(walk), pool_(&pool) {
        if (!walk.any_deforms()) return;
        runs_ = runs.lease();
        runs_->start();
    }

    Index size() const { return static_cast<Index>(memory_.contact.size()); }
    std::span<Vec4> impulse() { return memory_.impulse; }
    std::span<Vec4> workspace(Index slot) { return memory_.workspace[static_cast<std::size_t>(slot)]; }
    void refresh() { refresh(memory_.impulse, memory_.velocity); }
    void refresh_all() {
        refresh();
        refresh(memory_.workspace[1], memory_.scratch);
    }
    void remember();
    void extrapolate(Real factor);
    Real sweep(Real relaxation);
    SweepChange accelerated_sweep(Real relaxation);
    /// e_nat of docs/methods/errors.md 2, with a third of the trace of W_ii for D.
    Real error() const;
    bool suggests_check(Real change, Real tolerance) const { return change <= tolerance * tolerance * scale_ * scale_; }
    Real inner(Index i, const Vec4& a, const Vec4& b) const { return a.dot(times(part(i).mobility, b)); }
    void residual(std::span<Vec4> out) const;
    void multiply(std::span<const Vec4> in, std::span<Vec4> out) const;
    Vec4 project(Index i, const Vec4& impulse) const {
        if (joint(i) != nullptr) return impulse;  // which sweeps do without
        return project_friction(impulse, contact(i).normal, contact(i).friction, friction_);
    }
    Vec4 feasible(Index i, const Vec4& residual) const {
        return feasible_direction(residual, memory_.impulse[static_cast<std::size_t>(i)], contact(i).normal,
                                  contact(i).friction, friction_);
    }
    Vec4 normal(Index i) const { return contact(i).normal; }
    FrictionLimits limits(Index i) const { return contact(i).friction; }
    Real mobility(Index i) const { return contact(i).inverse_diagonal > 0 ? contact(i).diagonal : 0; }
    Friction law() const { return friction_; }
    void assemble(Eigen::MatrixXd& matrix) const;

    /// Newton steps (docs/methods/region_solver.md 5.9) from an impulse of this error: at most `limit`, the best
    /// impulse stays. They take three vectors of the workspace, and memory when it is asked for first.
    SolveResult take_newton_steps(Real error, Real tolerance, Index limit);
    Real newton_step_cost() { return newton_memory().cost(); }  // ns, of the order of
    /// The same as if bodies moved as wholes (5.10), where that is another thing, and known of all of them. Steps stop
    /// where they gain little.
    SolveResult take_rounds_of_wholes(Real error, Real tolerance, Index limit);
    bool moves_wholes() const;
    Real sweep_cost() const;  // ns, of the order of

    /// The split impulse of a contact (push_contact.h): along its normal.
    [[gnu::always_inline]] Vec4 velocity_at(Index i, const Vec4* velocity) const {
        return add_rigid_velocities(part(i), velocity, add_node_velocities(contact(i), velocity, Vec4::Zero()));
    }
    /// The same impulse on what does not deform, nor does what it pushes.
    [[gnu::always_inline]] void push(Index i, const Vec4& impulse, Vec4* velocity) const {
        walk_.apply_undeformed(contact(i), impulse, velocity);
        apply_to_rigid(part(i), impulse, velocity);
    }

    /// null: a contact
    const JointLaw* joint(Index i) const {
        const Index first = size() - static_cast<Index>(memory_.joint.size());
        return i < first ? nullptr : &memory_.joint[static_cast<std::size_t>(i - first)];
    }

private:
    const LumpedContact& contact(Index i) const { return memory_.contact[static_cast<std::size_t>(i)]; }
    const RigidPart& part(Index i) const { return memory_.part[static_cast<std::size_t>(i)]; }
    // of Newton steps
    BodyEquations& newton_memory();
    void assemble(BodyEquations& equations) const;
    /// What impulses do to the unknowns, from the velocities of the region.
    void gather(BodyEquations& equations, Column<Real>& velocity) const;
    enum class Look { value, matrix, turns };
    Real answer_motion(BodyEquations& equations, std::span<const Vec4> start, Look look);
    void stop_turned(BodyEquations& equations, std::span<const Vec4> start);
    Real compare_motion(BodyEquations& equations, std::span<const Vec4> start);
    BodyEquations& list_equations(BodyEquations& equations);
    /// Whether a term of a contact is all of its body, and whether a node moves by itself.
    bool is_whole(const BodyEquations& equations, const RigidTerm& term) const;
    bool is_unknown(const BodyEquations& equations, Index node) const;
    BodyEquations* wholes_memory();
    void start_round_of_wholes(BodyEquations& equations);
    void push_wholes(std::span<const Vec4> start);
    std::optional<Real> go_on_as_before(BodyEquations& equations, std::span<const Vec4> start);
    std::optional<Real> step_motion(BodyEquations& equations, std::span<const Vec4> start, Real lack);
    void list_unknowns(BodyEquations& equations) const;
    void list_parts(BodyEquations& equations) const;
    void list_pushes(BodyEquations& equations) const;
    void couple_parts(BodyEquations& equations) const;
    void assemble_deforming(BodyEquations& equations, std::size_t begin, std::size_t end) const;
    Index name_of_node(Index node) const;
    bool touches_clusters() const;
    bool is_rigid(const BodyEquations::Unknown& unknown) const;
    bool deforms(const BodyEquations::Unknown& unknown) const;

    Vec4 velocity(Index i) const { return contact(i).offset + velocity_at(i, memory_.velocity.data()); }
    /// The impulse that the law answers with where the other impulses stay: exact for Coulomb's cone.
    Vec4 answer(Index i, const Vec4& impulse, const Vec4& u);
    /// Returns change . W_ii change.
    Real step(Index i, Real relaxation);
    /// Calls `of` for all contacts, in their order.
    void for_each_in_sweep(auto&& of);
    void list_runs() const;
    /// In a sweep: of nodes that deform bodies those of its run.
    void apply(Index i, const Vec4& impulse);
    void refresh(std::span<const Vec4> impulse, std::span<Vec4> velocity) const;
    /// Adds what impulses do. Of several contacts that name a node of a body that deforms they are summed up first:
    /// each moves all touched nodes of its body.
    void add_response(std::span<const Vec4> impulse, std::span<Vec4> velocity) const;

    FreedomMemory memory_;
    Friction friction_;
    Real scale_;
    ThroughGroups walk_;
    NewtonPool* pool_;
    NewtonPool::Lease newton_;
    RunPool::Lease runs_;  // where something deforms
    bool own_are_listed_ = false, wholes_are_listed_ = false;
    bool inertia_is_known_ = false;  // to the equations, from the first steps on
};

}  // namespace skerry
