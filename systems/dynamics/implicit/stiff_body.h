// Elasticity of an implicit body in the frame that moves with it: K and M of its nodes, and its response to impulses in
// a step (docs/methods/implicit_bodies.md 2, 3).
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "components/material_table.h"
#include "components/types.h"
#include "systems/dynamics/implicit/block_cholesky.h"
#include "systems/dynamics/implicit/body_elements.h"
#include "systems/dynamics/implicit/solid_masses.h"
#include "systems/dynamics/kinds/element_list.h"

namespace skerry {

/// Stiffness block -df_k/dx_l of an element in its rest shape [N/m]. `gradient_k`, `gradient_l`: of its nodes [1/m];
/// `volume`: [m^3].
Mat3 element_stiffness(const MaterialConstants& material, Real volume, const Vec3& gradient_k, const Vec3& gradient_l);

/// Counters of steps of large strain.
struct NewtonCounts {
    std::uint64_t solved = 0;   // steps of bodies that were solved
    std::uint64_t steps = 0;    // steps of Newton's method
    std::uint64_t factors = 0;  // factorisations of tangents

    NewtonCounts& operator+=(const NewtonCounts& other) {
        solved += other.solved;
        steps += other.steps;
        factors += other.factors;
        return *this;
    }
};

/// State of one step of a body of large strain, by place (docs/methods/implicit_bodies.md 8).
struct LargeStep {
    std::vector<Vec3> carried;   // displacements at the end of the step if nodes stand still [m]
    std::vector<Vec3> impulse;   // impulses of momentum, loads and weight [N s]
    std::vector<Vec3> velocity;  // velocities of the step's displacement, without contacts [m/s]
    std::vector<Vec3> force;     // dU/du within the step [N]
    std::vector<Vec3> before;    // velocities at the start, turned by Coriolis forces, without momenta [m/s]
    std::vector<Vec3> gradient, direction, within;
    // angular momentum of a free body, in the frame of its mesh; zero for a held body [kg m^2/s]
    Vec3 angular_momentum = Vec3::Zero();
    BodyShape shape;  // shape within the step if angular_momentum is not zero; work memory outside of steps
    NewtonCounts counts;
    bool failed = false;  // no velocity was found

    void resize(std::size_t count) {
        for (std::vector<Vec3>* column :
             {&carried, &impulse, &velocity, &force, &before, &gradient, &direction, &within})
            column->resize(count);
        angular_momentum.setZero();
    }
};

/// State of a long step of small strain, while other bodies take several steps, by node
/// (docs/methods/implicit_bodies.md 9).
struct LongStep {
    Real done = 0;       // elapsed time; 0: the body is in no long step [s]
    Real weight = 0;     // elapsed time at the end of this short step over its length; 0: ordinary step
    bool rests = false;  // true if the body rests in this short step
    // Values at the start of the long step:
    std::vector<Vec3> start, start_velocity;  // [m], [m/s]
    std::vector<Vec3> start_force;            // K u [N]
    std::vector<Vec3> impulse, free;          // impulses without contacts [N s], the velocities they give [m/s]
    std::vector<Vec3> left,
        left_impulse;  // velocities and impulses of the last long step's contacts, which continue [m/s], [N s]
    // Contributions of contacts since the start of the long step, at the start and at the end of this short step:
    std::vector<Vec3> answer, answer_next;    // velocities that contacts gave [m/s]
    std::vector<Vec3> contact, contact_next;  // impulses of contacts, in the frame of the mesh [N s]
    Real elastic = 0, elastic_next = 0;       // elastic energy [J]

    void resize(std::size_t count) {
        for (std::vector<Vec3>* column : {&start, &start_velocity, &start_force, &impulse, &free, &left, &left_impulse,
                                          &answer, &answer_next, &contact, &contact_next})
            column->assign(count, Vec3::Zero());
    }
};

/// Stiffness, masses and factor of one implicit body. Vectors by node are in the elimination order unless a comment
/// says "by node of the body"; place() gives the place of a node.
class StiffBody {
public:
    StiffBody() = default;
    /// `constants`: by row of MaterialTable; `mass` [kg] and `rest_position` [m]: by node of the body.
    StiffBody(const ElementList& elements, std::span<const MaterialConstants> constants, std::span<const Real> mass,
              std::span<const Vec3> rest_position, std::span<const std::array<Index, 4>> tetrahedra,
              std::span<const Real> tetrahedron_mass);

    /// Holds the nodes whose `inverse_mass` (by node of the body) is zero from now on. Impulses on held nodes do
    /// nothing, and other nodes move against them. If there are none the body is free. Keeps the present factor if
    /// nothing changes.
    void hold(std::span<const Real> inverse_mass);
    bool is_held() const { return !held_.empty(); }

    bool empty() const { return place_.empty(); }
    std::size_t size() const { return place_.size(); }
    Index place(std::size_t node) const { return place_[node]; }
    /// Node of the body at each place.
    std::span<const Index> nodes() const { return node_; }
    Real mass(std::size_t place) const { return mass_[place]; }

    /// out = K u [N].
    void elastic_forces(std::span<const Vec3> displacement, std::span<Vec3> out) const {
        stiffness_.multiply(displacement, out);
    }
    /// True if linear elasticity or the moments of inertia at rest are no longer accurate enough, which is so in two
    /// cases. First: |F - 1| is above small_strain somewhere, and either the energies of elements differ from those of
    /// their laws by more than energy_share in all, or the spin has more than that share of energy and changes by more
    /// than small_strain with the inertia of the present shape. Second: the spin would stretch a bar by small_strain.
    /// Always false if all laws are linear. `displacement`: by node of the body [m]. `angular_momentum`: in the frame
    /// of the mesh; zero for a held body [kg m^2/s].
    bool becomes_large(std::span<const Vec3> displacement, const Vec3& angular_momentum) {
        return is_beyond({displacement, node_}, angular_momentum);
    }
    /// Version of becomes_large() for displacements by place. Evaluates elements only if nodes have moved far enough
    /// since the last evaluation for strain to be large.
    bool becomes_large_in_places(std::span<const Vec3> displacement, const Vec3& angular_momentum);
    /// True if linear elasticity and the moments of inertia at rest are accurate enough again. The energy of the spin
    /// must be below a quarter of its bound. Also all strains must be below a tenth of small_strain, or the other
    /// bounds of becomes_large() be met by a quarter.
    bool becomes_small(std::span<const Vec3> displacement, const Vec3& angular_momentum);
    static constexpr Real small_strain = 0.02, energy_share = 0.01;
    /// Elastic energy [J]: u K u / 2, or by the laws of the elements if strain is `large`. `displacement`: by node of
    /// the body.
    Real elastic_energy(std::span<const Vec3> displacement, bool large) const;
    /// Removes the rigid motion from velocities, by node of the body [m/s].
    void take_rigid_motion(std::span<Vec3> velocity) const;
    /// Computes positions and arms of the shape with these displacements.
    void find_shape(const Displacements& displacement, BodyShape& shape) const;
    /// Sets the shape with these displacements as the one whose rigid motion responses by tangents leave out.
    void stand_in(const Displacements& displacement);
    /// Removes momentum and angular momentum in the shape of stand_in() from velocities, by place [m/s].
    void take_momenta(std::span<Vec3> velocity) const { take_momenta_of(velocity); }
    const BodyShape& shape() const { return shape_; }
    /// Turns displacements (by node) into the frame in which they have no rigid part (docs/methods/implicit_bodies.md
    /// 1). Returns the rotation from that frame to the frame of the mesh.
    Mat3 turn_to_own_frame(std::span<Vec3> displacement) const;

    /// Makes A = inertia M + stiffness K the matrix of respond(). Keeps the present factor if it is of this matrix.
    /// Returns false if A is not positive definite. Rows of held nodes have only their diagonal.
    bool prepare(Real inertia, Real stiffness);
    /// Makes A the matrix of respond() with d2U/du2 of the elements at these displacements (by place), without its
    /// negative part, in place of K. Always computes a new factor, and so does the next prepare(). Returns false if A
    /// is not positive definite.
    bool prepare_tangent(Real inertia, Real stiffness, std::span<const Vec3> displacement);
    /// True if the present factor is one of prepare_tangent().
    bool is_tangent() const { return tangent_; }
    void forget_tangent() {
        if (tangent_) forget_factor();
    }
    /// State of the step in progress if its strain is large.
    LargeStep large_step;
    /// State of the long step in progress.
    LongStep long_step;
    const BodyElements& elements() const { return elements_; }
    bool holds(std::size_t place) const { return is_held() && held_[place] != 0; }
    /// Replaces impulses [N s] by the velocities [m/s] that they give by A^-1. For a free body the rigid part of the
    /// impulses is left out, and velocities have none. For a held body impulses on held nodes are left out, and these
    /// nodes have no velocity.
    void respond(std::span<Vec3> impulse) const;

    /// Responses of all nodes to unit impulses on one node by respond() [1/kg]: a column, by place. Computed once for a
    /// factor, and kept while there is room.
    std::span<const Mat3> column(std::size_t node);
    /// Responses of some nodes to unit impulses on them by respond() [1/kg]: a symmetric matrix, column by column,
    /// three numbers a node. `nodes` ascend; `first` is the first node of the body in the same numbering. Kept while
    /// the same nodes are asked for; zero without a factor.
    std::span<const Real> responses(std::span<const Index> nodes, Index first);
    /// Largest memory of kept columns. It is exceeded if one call of responses() needs more columns.
    static constexpr std::size_t column_memory = std::size_t(64) << 20;  // [bytes]
    std::uint64_t columns_made() const { return columns_made_; }

private:
    template <class X>
    void take_rigid_part(std::span<X> impulse) const;
    template <class X>
    void respond_to(std::span<X> impulse) const;
    void find_responses();
    void forget_factor();
    void forget_columns();
    /// Test of becomes_large() for energies and spin, without that for |F - 1|; `part`: of the bounds.
    bool is_off(const Displacements& displacement, const Vec3& angular_momentum, Real part);
    /// Energy of the spin with the inertia at rest [J].
    Real energy_of_spin(const Vec3& angular_momentum) const {
        return angular_momentum.dot(inverse_solid_inertia_ * angular_momentum) / 2;
    }
    bool is_beyond(const Displacements& displacement, const Vec3& angular_momentum);
    /// Computes the corrections that keep responses by a tangent free of rigid motion. K gives no force for rigid
    /// motion, but a tangent does.
    void find_rigid_answers();
    template <class X>
    void take_rigid_answer(std::span<X> velocity) const;
    template <class X>
    void take_momenta_of(std::span<X> velocity) const;

    std::vector<Index> place_;        // place of each node of the body
    std::vector<Index> node_;         // node of the body at each place
    std::vector<Real> mass_;          // by place [kg]
    std::vector<Vec3> arm_;           // rest position from the centre of mass, by place [m]
    std::vector<std::uint8_t> held_;  // by place; empty: no node is held
    Real total_mass_ = 0;
    Mat3 inverse_inertia_ = Mat3::Zero();        // of nodal masses at rest [1/(kg m^2)]
    Mat3 inverse_solid_inertia_ = Mat3::Zero();  // of the solid at rest [1/(kg m^2)]
    Real stretching_spin_ = 0;                   // energy of a spin that would stretch a bar by small_strain [J]
    SolidMasses solid_;
    BodyShape shape_;                          // set by stand_in()
    Mat3 inverse_arm_inertia_ = Mat3::Zero();  // inverse of the sum of (|a|^2 1 - a a^T) / m, a = arm [1/(kg m^2)]
    BlockRows stiffness_, matrix_;
    Real inertia_factor_ = 0, stiffness_factor_ = 0;  // coefficients of M and K in A
    BlockCholesky factor_;
    BodyElements elements_;
    bool tangent_ = false;
    std::vector<Mat3> shifts_, turns_;         // A^-1 times the momenta of unit velocities and unit spins, by place
    Eigen::Matrix<Real, 6, 6> rigid_inverse_;  // inverse of the momenta of shifts_ and turns_
    // Last evaluation of becomes_large_in_places(); empty: none yet
    std::vector<Vec3> looked_at_;      // displacements, by place [m]
    Vec3 looked_with_ = Vec3::Zero();  // angular momentum [kg m^2/s]
    Real strain_there_ = 0;
    bool large_there_ = false;
    // Slot of `columns_` with the column of each node of the body, or no_index:
    std::vector<Index> slot_of_;
    std::vector<Index> node_in_;          // node of each slot
    std::vector<std::uint64_t> used_at_;  // count of uses at the last use of each slot
    std::uint64_t uses_ = 0, columns_made_ = 0;
    std::vector<Mat3> columns_;  // size() blocks for each slot
    // Nodes of the body in the last call of responses(), and its result:
    std::vector<Index> touched_;
    std::vector<Real> responses_;
};

}  // namespace skerry
