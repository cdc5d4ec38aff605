// Elasticity of an implicit body in the frame that moves with the body: stiffness K and masses M of its nodes, and
// velocities that impulses cause in a step (docs/methods/implicit_bodies.md 2, 3).
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

/// Counters of Newton's method in steps at large strain.
struct NewtonCounts {
    std::uint64_t solved = 0;   // number of steps of single bodies in which Newton's method was run
    std::uint64_t steps = 0;    // number of iterations of Newton's method
    std::uint64_t factors = 0;  // number of factorisations of tangent matrices

    NewtonCounts& operator+=(const NewtonCounts& other) {
        solved += other.solved;
        steps += other.steps;
        factors += other.factors;
        return *this;
    }
};

/// State of one step of a body at large strain, by index of the nodes in the elimination order
/// (docs/methods/implicit_bodies.md 8).
struct LargeStep {
    // displacements at the end of the step if the nodes do not move in it, in the frame at the end of the step [m]
    std::vector<Vec3> unmoved_displacement;
    std::vector<Vec3> impulse;   // momentum at the start plus impulses of loads and weight [N s]
    std::vector<Vec3> velocity;  // node velocities in the step, without contacts [m/s]
    // gradient dU/du of U (elastic energy plus energy of the spin) at `displacement_in_step` [N]
    std::vector<Vec3> force;
    // velocities at the start of the step without rigid motion, rotated by Coriolis forces [m/s]
    std::vector<Vec3> velocity_before;
    // Newton's method: gradient [N s], search direction [m/s], and the displacements at which forces are computed [m].
    std::vector<Vec3> gradient, direction, displacement_in_step;
    // Angular momentum of a free body in the frame of its mesh; zero for a held body [kg m^2/s].
    Vec3 angular_momentum = Vec3::Zero();
    // Shape with the displacements `displacement_in_step`, set only if angular_momentum is not zero. Between steps it
    // is work memory.
    BodyShape shape;
    NewtonCounts counts;
    bool failed = false;  // true if Newton's method found no velocity

    void resize(std::size_t count) {
        for (std::vector<Vec3>* column : {&unmoved_displacement, &impulse, &velocity, &force, &velocity_before,
                                          &gradient, &direction, &displacement_in_step})
            column->resize(count);
        angular_momentum.setZero();
    }
};

/// State, by node, of a long step at small strain, during which other bodies take several steps
/// (docs/methods/implicit_bodies.md 9).
struct LongStep {
    Real done = 0;  // elapsed time of the long step; 0 outside of a long step [s]
    // Time from the start of the long step to the end of this short step, divided by the length of this short step. It
    // is a factor on the response to contacts. 0 in an ordinary step.
    Real response_factor = 0;
    bool asleep = false;  // true if the body is asleep in this short step
    // Values at the start of the long step:
    std::vector<Vec3> start, start_velocity;  // [m], [m/s]
    std::vector<Vec3> start_force;            // elastic forces K u at the displacements `start` [N]
    std::vector<Vec3> impulse,
        free_velocity;  // impulses without contacts [N s], and the velocities that they cause [m/s]
    // Velocities [m/s] that the contacts of the last long step caused, and their impulses [N s]. This long step starts
    // with the assumption that these contacts continue.
    std::vector<Vec3> assumed_velocity, assumed_impulse;
    // Contributions of contacts from the start of the long step to the start of this short step; columns `_next`: to
    // the end of this short step.
    std::vector<Vec3> contact_velocity, contact_velocity_next;  // velocities caused by contacts [m/s]
    std::vector<Vec3> contact_impulse, contact_impulse_next;    // impulses of contacts, in the frame of the mesh [N s]
    Real elastic = 0, elastic_next = 0;  // elastic energy at the start and at the end of this short step [J]

    void resize(std::size_t count) {
        for (std::vector<Vec3>* column :
             {&start, &start_velocity, &start_force, &impulse, &free_velocity, &assumed_velocity, &assumed_impulse,
              &contact_velocity, &contact_velocity_next, &contact_impulse, &contact_impulse_next})
            column->assign(count, Vec3::Zero());
    }
};

/// Stiffness, masses and matrix factor of one implicit body. Vectors by node are in the elimination order unless a
/// comment says "by node of the body"; order_index() gives the index of a node in this order.
class StiffBody {
public:
    StiffBody() = default;
    /// `constants`: material constants by row of MaterialTable. `mass` [kg] and `rest_position` [m]: by node of the
    /// body.
    StiffBody(const ElementList& elements, std::span<const MaterialConstants> constants, std::span<const Real> mass,
              std::span<const Vec3> rest_position, std::span<const std::array<Index, 4>> tetrahedra,
              std::span<const Real> tetrahedron_mass);

    /// From now on holds the nodes whose `inverse_mass` (by node of the body) is zero. Impulses do not move held nodes,
    /// and other nodes deform against them. A body without held nodes is free. The present matrix factor remains valid
    /// if the set of held nodes is unchanged.
    void hold(std::span<const Real> inverse_mass);
    bool is_held() const { return !held_.empty(); }

    bool empty() const { return order_index_.empty(); }
    std::size_t size() const { return order_index_.size(); }
    Index order_index(std::size_t node) const { return order_index_[node]; }
    /// Node of the body at each index of the elimination order.
    std::span<const Index> nodes() const { return node_; }
    Real mass(std::size_t order_index) const { return mass_[order_index]; }

    /// Computes out = K u for the displacements u, with the stiffness K at rest [N].
    void elastic_forces(std::span<const Vec3> displacement, std::span<Vec3> out) const {
        stiffness_.multiply(displacement, out);
    }
    /// True if linear elasticity or the moments of inertia at rest are too inaccurate in this state
    /// (docs/methods/implicit_bodies.md 8). Always false if all material laws are linear. `displacement`: by node of
    /// the body [m]. `angular_momentum`: in the frame of the mesh; zero for a held body [kg m^2/s].
    ///
    /// The result is true in two cases:
    /// - Centrifugal forces would stretch a bar with the same spin energy per volume by the strain small_strain.
    /// - |F - 1| exceeds small_strain in an element with the deformation gradient F, and the energies or the spin are
    ///   inaccurate.
    ///
    /// Inaccurate energies: linear elasticity and the material law give energies of elements whose absolute differences
    /// sum to more than energy_share of the linear energy. Inaccurate spin: its energy exceeds energy_share of the
    /// linear energy, and deformation changes the spin by more than the fraction small_strain.
    bool becomes_large(std::span<const Vec3> displacement, const Vec3& angular_momentum) {
        return is_large({displacement, node_}, angular_momentum);
    }
    /// Variant of becomes_large() for displacements by index in the elimination order. Evaluates elements only if nodes
    /// have moved far enough since the last evaluation for strain to become large.
    bool becomes_large_in_order(std::span<const Vec3> displacement, const Vec3& angular_momentum);
    /// True if linear elasticity and the moments of inertia at rest are accurate enough again. The limits are lower
    /// than in becomes_large(), so that strain does not change between small and large in every step. Both conditions
    /// must hold:
    /// - The energy of the spin is below a quarter of the limit there.
    /// - All strains |F - 1| are below a tenth of small_strain, or the energies and the spin are accurate within a
    ///   quarter of the limits there.
    bool becomes_small(std::span<const Vec3> displacement, const Vec3& angular_momentum);
    static constexpr Real small_strain = 0.02, energy_share = 0.01;
    /// Elastic energy [J]: u.K u / 2 for the displacements u, or by the material laws of the elements if strain is
    /// `large`. `displacement`: by node of the body [m].
    Real elastic_energy(std::span<const Vec3> displacement, bool large) const;
    /// Removes rigid-body motion from node velocities, with the masses and lever arms of the rest shape. `velocity`: by
    /// node of the body [m/s].
    void remove_rigid_motion(std::span<Vec3> velocity) const;
    /// Computes node positions and lever arms (BodyShape) of the shape with the given displacements.
    void find_shape(const Displacements& displacement, BodyShape& shape) const;
    /// Sets shape() to the shape with the given displacements. After prepare_tangent(), respond() removes the
    /// rigid-body motion of this shape from velocities.
    void set_shape(const Displacements& displacement);
    /// Removes momentum and angular momentum from node velocities, for the shape that set_shape() has set. `velocity`:
    /// by index in the elimination order [m/s].
    void remove_momenta(std::span<Vec3> velocity) const { remove_momenta_of(velocity); }
    const BodyShape& shape() const { return shape_; }
    /// Rotates displacements (by node) into the frame in which they contain no rigid rotation
    /// (docs/methods/implicit_bodies.md 1). Returns the rotation from this frame to the frame of the mesh.
    Mat3 rotate_to_own_frame(std::span<Vec3> displacement) const;

    /// Makes A = inertia M + stiffness K the matrix of respond(), with masses M and stiffness matrix K. Reuses the
    /// present factor if it was computed for this matrix. Returns false if A is not positive definite. Rows of held
    /// nodes in A have only a diagonal entry.
    bool prepare(Real inertia, Real stiffness);
    /// Makes A = inertia M + stiffness d2U/du2 the matrix of respond(). d2U/du2 is the second derivative of the elastic
    /// energy at `displacement` (by index in the elimination order), without the negative eigenvalues of single
    /// elements. Always computes a new factor, and forces the next prepare() to compute one. Returns false if A is not
    /// positive definite.
    bool prepare_tangent(Real inertia, Real stiffness, std::span<const Vec3> displacement);
    /// True if prepare_tangent() has computed the present factor.
    bool is_tangent() const { return tangent_; }
    void forget_tangent() {
        if (tangent_) forget_factor();
    }
    /// State of the step in progress, used if strain is large.
    LargeStep large_step;
    /// State of the long step in progress.
    LongStep long_step;
    const BodyElements& elements() const { return elements_; }
    bool holds(std::size_t order_index) const { return is_held() && held_[order_index] != 0; }
    /// Replaces impulses [N s] by the velocities that they cause, A^-1 times the impulses [m/s]. For a free body the
    /// rigid part of the impulses is removed, and the velocities have no rigid part. For a held body impulses on held
    /// nodes are ignored, and held nodes get zero velocity.
    void respond(std::span<Vec3> impulse) const;

    /// Velocities of all nodes per unit impulse on one node, by index in the elimination order, computed by respond()
    /// [1/kg]. The result is stored until the matrix factor changes or newer results need its memory (column_memory).
    std::span<const Mat3> column(std::size_t node);
    /// Velocities of the given nodes per unit impulse on these nodes, computed by respond() [1/kg]: a symmetric matrix,
    /// stored column by column, with three rows and three columns for each node. It is zero without a matrix factor,
    /// and is reused while the factor and the list of nodes stay the same.
    ///
    /// `nodes`: ascending. `first`: first node of the body in the same numbering.
    std::span<const Real> responses(std::span<const Index> nodes, Index first);
    /// Memory limit for the results of column(). It is exceeded if one call of responses() needs more columns.
    static constexpr std::size_t column_memory = std::size_t(64) << 20;  // [bytes]
    std::uint64_t columns_made() const { return columns_made_; }

private:
    template <class X>
    void remove_rigid_part(std::span<X> impulse) const;
    template <class X>
    void respond_to(std::span<X> impulse) const;
    void find_responses();
    void forget_factor();
    void forget_columns();
    /// True if the energies or the spin are inaccurate as defined at becomes_large(), with its bounds multiplied by
    /// `factor`. Does not test the strain |F - 1|.
    bool is_inaccurate(const Displacements& displacement, const Vec3& angular_momentum, Real factor);
    /// Energy of the spin for an angular momentum, with the inertia at rest [J].
    Real energy_of_spin(const Vec3& angular_momentum) const {
        return angular_momentum.dot(inverse_solid_inertia_ * angular_momentum) / 2;
    }
    bool is_large(const Displacements& displacement, const Vec3& angular_momentum);
    /// Computes the corrections that remove rigid motion from responses with a tangent matrix. They are needed because
    /// a tangent matrix, unlike the stiffness K at rest, gives elastic forces also for rigid motion.
    void prepare_rigid_responses();
    template <class X>
    void remove_rigid_response(std::span<X> velocity) const;
    template <class X>
    void remove_momenta_of(std::span<X> velocity) const;

    std::vector<Index> order_index_;  // index of each node of the body in the elimination order
    std::vector<Index> node_;         // node of the body at each index of the elimination order
    std::vector<Real> mass_;          // by index in the elimination order [kg]
    std::vector<Vec3> arm_;  // rest position relative to the centre of mass, by index in the elimination order [m]
    // 1 for held nodes, by index in the elimination order; empty if no node is held.
    std::vector<std::uint8_t> held_;
    Real total_mass_ = 0;
    Mat3 inverse_inertia_ = Mat3::Zero();        // inverse inertia of the nodal masses at rest [1/(kg m^2)]
    Mat3 inverse_solid_inertia_ = Mat3::Zero();  // inverse inertia of the solid at rest [1/(kg m^2)]
    Real stretching_spin_ = 0;                   // energy of the spin that would stretch a bar by small_strain [J]
    SolidMasses solid_;
    BodyShape shape_;  // set by set_shape()
    // Inverse of the sum over the nodes of (|a|^2 I - a a^T) / m [1/(kg m^2)], with the unit matrix I and the mass m of
    // the node. a is its mass-weighted lever arm shape_.arm [kg m].
    Mat3 inverse_arm_inertia_ = Mat3::Zero();
    BlockRows stiffness_, matrix_;
    // Coefficients of the masses and of the stiffness in the factored matrix. 0 if there is no factor, or if a tangent
    // matrix is factored.
    Real inertia_factor_ = 0, stiffness_factor_ = 0;
    BlockCholesky factor_;
    BodyElements elements_;
    bool tangent_ = false;
    // Velocities A^-1 p by index in the elimination order, with the factored matrix A and the nodal momenta p of a
    // rigid motion of the body. shifts_: unit translations along the three axes. turns_: unit rotations about them.
    std::vector<Mat3> shifts_, turns_;
    // Inverse of a 6x6 matrix. Each column of the matrix contains the total momentum and angular momentum of the
    // velocities in one column of shifts_ or turns_. With the inverse, remove_rigid_response() finds the combination of
    // these velocities that has given momenta.
    Eigen::Matrix<Real, 6, 6> rigid_inverse_;
    // Inputs and results of the last evaluation in becomes_large_in_order(). evaluated_at_ is empty before the first
    // evaluation, and after one with a strain that is not finite.
    std::vector<Vec3> evaluated_at_;      // displacements at the last evaluation, by index in the elimination order [m]
    Vec3 evaluated_with_ = Vec3::Zero();  // angular momentum at the last evaluation [kg m^2/s]
    Real evaluated_strain_ = 0;
    bool evaluated_large_ = false;
    // For each node of the body: slot in `columns_` with the column of the node, or no_index.
    std::vector<Index> slot_of_;
    std::vector<Index> node_in_;          // node of each slot
    std::vector<std::uint64_t> used_at_;  // for each slot: value of uses_ when the slot was last used
    std::uint64_t uses_ = 0, columns_made_ = 0;
    std::vector<Mat3> columns_;  // stored columns of velocity responses, size() blocks in each slot
    // Nodes of the body in the last call of responses(), and the result of this call:
    std::vector<Index> touched_;
    std::vector<Real> responses_;
};

}  // namespace skerry
