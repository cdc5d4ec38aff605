// The elasticity of a body that moves implicitly, in the frame that moves with it: K and M of its nodes, and what
// impulses do to them in a step (docs/methods/implicit_bodies.md 2, 3).
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

/// N/m, -df_k/dx_l of an element in its rest shape, for nodes with these gradients (1/m); `volume`: m^3.
Mat3 element_stiffness(const MaterialConstants& material, Real volume, const Vec3& gradient_k, const Vec3& gradient_l);

/// What Newton steps of large strain took.
struct NewtonCounts {
    std::uint64_t solved = 0;   // steps of bodies
    std::uint64_t steps = 0;    // of Newton's method
    std::uint64_t factors = 0;  // of tangents

    NewtonCounts& operator+=(const NewtonCounts& other) {
        solved += other.solved;
        steps += other.steps;
        factors += other.factors;
        return *this;
    }
};

/// One step of a body of large strain, by place (docs/methods/implicit_bodies.md 8).
struct LargeStep {
    std::vector<Vec3> carried;   // m, displacements at its end of nodes that stand still
    std::vector<Vec3> impulse;   // N s, of momentum, loads and weight
    std::vector<Vec3> velocity;  // m/s, of the step's displacement, without contacts
    std::vector<Vec3> force;     // N, dU/du, within the step
    std::vector<Vec3> before;    // m/s, at its start, as elasticity finds them
    std::vector<Vec3> gradient, direction, within;
    // kg m^2/s, of the frame in which a free body deforms, in that of the mesh; zero of a held one
    Vec3 angular_momentum = Vec3::Zero();
    BodyShape shape;  // within the step, where there is such a momentum; memory of looks at shapes outside of it
    NewtonCounts counts;
    bool failed = false;  // no velocity was found

    void resize(std::size_t count) {
        for (std::vector<Vec3>* column :
             {&carried, &impulse, &velocity, &force, &before, &gradient, &direction, &within})
            column->resize(count);
        angular_momentum.setZero();
    }
};

/// A step of small strain while other bodies take several, by node (docs/methods/implicit_bodies.md 9).
struct LongStep {
    Real done = 0;       // s, of it by now; 0: the body is in none
    Real weight = 0;     // s/s, time at the end of this short step over its length; 0: this one is as all others
    bool rests = false;  // in this short step
    // of the start of the long step:
    std::vector<Vec3> start, start_velocity;  // m, m/s
    std::vector<Vec3> start_force;            // N, K u
    std::vector<Vec3> impulse, free;          // N s, m/s: all but contacts, and what they give
    std::vector<Vec3> left, left_impulse;     // m/s, N s: of contacts of the one before, which go on
    // of contacts since then, by now and at the end of this short step:
    std::vector<Vec3> answer, answer_next;    // m/s
    std::vector<Vec3> contact, contact_next;  // N s, in the frame of the mesh
    Real elastic = 0, elastic_next = 0;       // J

    void resize(std::size_t count) {
        for (std::vector<Vec3>* column : {&start, &start_velocity, &start_force, &impulse, &free, &left, &left_impulse,
                                          &answer, &answer_next, &contact, &contact_next})
            column->assign(count, Vec3::Zero());
    }
};

/// Vectors by node are in the order of elimination: place() says where a node of the body stands.
class StiffBody {
public:
    StiffBody() = default;
    /// `constants`: by row of MaterialTable. `mass` (kg) and `rest_position` (m): by node of the body.
    StiffBody(const ElementList& elements, std::span<const MaterialConstants> constants, std::span<const Real> mass,
              std::span<const Vec3> rest_position, std::span<const std::array<Index, 4>> tetrahedra,
              std::span<const Real> tetrahedron_mass);

    /// From now on nodes whose `inverse_mass` (by node of the body) is zero are held: impulses on them do nothing, and
    /// others move against them. Where none is the body is free. A factor that is there is kept where nothing changes.
    void hold(std::span<const Real> inverse_mass);
    bool is_held() const { return !held_.empty(); }

    bool empty() const { return place_.empty(); }
    std::size_t size() const { return place_.size(); }
    Index place(std::size_t node) const { return place_[node]; }
    /// By place.
    std::span<const Index> nodes() const { return node_; }
    Real mass(std::size_t place) const { return mass_[place]; }

    /// out = K u, N.
    void elastic_forces(std::span<const Vec3> displacement, std::span<Vec3> out) const {
        stiffness_.multiply(displacement, out);
    }
    /// Whether linear elasticity, or turning as at rest, is no longer good enough: somewhere |F - 1| is above
    /// small_strain, and the energies of elements are off those of their laws by more than energy_share in all, or the
    /// body spins, with more than that share of energy, by small_strain faster than its shape does; or its spin would
    /// stretch a bar by small_strain. `displacement`: by node of the body. `angular_momentum`: kg m^2/s, in the frame
    /// of the mesh; none of what is held.
    bool becomes_large(std::span<const Vec3> displacement, const Vec3& angular_momentum) {
        return is_beyond({displacement, node_}, angular_momentum);
    }
    /// The same of displacements by place. Looks at elements only where nodes have moved so far since it last did that
    /// it could be.
    bool becomes_large_in_places(std::span<const Vec3> displacement, const Vec3& angular_momentum);
    /// Whether both are good enough again: by a quarter of these shares, or small strain.
    bool becomes_small(std::span<const Vec3> displacement, const Vec3& angular_momentum);
    static constexpr Real small_strain = 0.02, energy_share = 0.01;
    /// J, u K u / 2, or where strain is `large` by the laws of the elements; `displacement`: by node of the body.
    Real elastic_energy(std::span<const Vec3> displacement, bool large) const;
    /// Takes the motion as a whole out of velocities (m/s), by node of the body.
    void take_rigid_motion(std::span<Vec3> velocity) const;
    /// Where nodes are with these displacements, and their arms.
    void find_shape(const Displacements& displacement, BodyShape& shape) const;
    /// From now on what moves the body as a whole is, in answers by tangents, that in this shape.
    void stand_in(const Displacements& displacement);
    /// Takes momentum and angular momentum in that shape out of velocities (m/s), by place.
    void take_momenta(std::span<Vec3> velocity) const { take_momenta_of(velocity); }
    const BodyShape& shape() const { return shape_; }
    /// The frame in which these displacements (by node) have no rigid part (1), in that of the mesh: turns them into
    /// it.
    Mat3 turn_to_own_frame(std::span<Vec3> displacement) const;

    /// Makes A = inertia M + stiffness K the matrix of respond(). A factor that is there is kept. Returns false where
    /// A is not positive definite. Of nodes that are held it has the diagonal alone.
    bool prepare(Real inertia, Real stiffness);
    /// The same with d2U/du2 of the elements at these displacements (by place) in the place of K, less what of it is
    /// negative. Always another factor; the next prepare() makes one again, too.
    bool prepare_tangent(Real inertia, Real stiffness, std::span<const Vec3> displacement);
    /// Whether the factor is one of prepare_tangent.
    bool is_tangent() const { return tangent_; }
    void forget_tangent() {
        if (tangent_) forget_factor();
    }
    /// Of the step that is being made, where its strain is large.
    LargeStep large_step;
    /// Of the long step that is being made.
    LongStep long_step;
    const BodyElements& elements() const { return elements_; }
    bool holds(std::size_t place) const { return is_held() && held_[place] != 0; }
    /// Impulses (N s) to the velocities (m/s) that they give by A^-1. Where the body is free without what moves it as a
    /// whole: that part of the impulses is left out, and velocities have none. Where it is held that of held nodes is
    /// left out, and these have no velocity.
    void respond(std::span<Vec3> impulse) const;

    /// What an impulse on a node gives to others by respond(), 1/kg: a column, by place.
    /// Calculated once for a factor, kept while there is room.
    std::span<const Mat3> column(std::size_t node);
    /// What impulses on some nodes give to them by respond(), 1/kg: a symmetric matrix, column by column, three numbers
    /// a node. `nodes` ascend, and begin with `first` for the first of the body. Kept while the same are asked for;
    /// zero without a factor.
    std::span<const Real> responses(std::span<const Index> nodes, Index first);
    /// Columns that are kept, at most, or as many as the nodes of one call of responses().
    static constexpr std::size_t column_memory = std::size_t(64) << 20;  // bytes
    std::uint64_t columns_made() const { return columns_made_; }

private:
    template <class X>
    void take_rigid_part(std::span<X> impulse) const;
    template <class X>
    void respond_to(std::span<X> impulse) const;
    void find_responses();
    void forget_factor();
    void forget_columns();
    /// But for the look at strain; `part`: of the shares.
    bool is_off(const Displacements& displacement, const Vec3& angular_momentum, Real part);
    /// J, as at rest.
    Real energy_of_spin(const Vec3& angular_momentum) const {
        return angular_momentum.dot(inverse_solid_inertia_ * angular_momentum) / 2;
    }
    bool is_beyond(const Displacements& displacement, const Vec3& angular_momentum);
    /// What keeps answers by a tangent free of rigid motion, which it does not leave alone.
    void find_rigid_answers();
    template <class X>
    void take_rigid_answer(std::span<X> velocity) const;
    template <class X>
    void take_momenta_of(std::span<X> velocity) const;

    std::vector<Index> place_;        // by node
    std::vector<Index> node_;         // by place
    std::vector<Real> mass_;          // kg, by place
    std::vector<Vec3> arm_;           // m, from the centre of mass, by place
    std::vector<std::uint8_t> held_;  // by place; empty: none is
    Real total_mass_ = 0;
    Mat3 inverse_inertia_ = Mat3::Zero();        // 1/(kg m^2), of the nodes
    Mat3 inverse_solid_inertia_ = Mat3::Zero();  // 1/(kg m^2), at rest
    Real stretching_spin_ = 0;                   // J, of a spin that would stretch a bar by small_strain
    SolidMasses solid_;
    BodyShape shape_;                          // of stand_in()
    Mat3 inverse_arm_inertia_ = Mat3::Zero();  // 1/(kg m^2), of arm_k arm_k / m_k
    BlockRows stiffness_, matrix_;
    Real inertia_factor_ = 0, stiffness_factor_ = 0;  // of A
    BlockCholesky factor_;
    BodyElements elements_;
    bool tangent_ = false;
    std::vector<Mat3> shifts_, turns_;         // by place: A^-1 of the inertia of unit velocities and spins
    Eigen::Matrix<Real, 6, 6> rigid_inverse_;  // of the momenta of those
    // of becomes_large_in_places(); empty: it has not looked
    std::vector<Vec3> looked_at_;      // m, by place
    Vec3 looked_with_ = Vec3::Zero();  // kg m^2/s
    Real strain_there_ = 0;
    bool large_there_ = false;
    // by node: which slot of `columns_` has its column, or no_index
    std::vector<Index> slot_of_;
    std::vector<Index> node_in_;          // by slot
    std::vector<std::uint64_t> used_at_;  // by slot
    std::uint64_t uses_ = 0, columns_made_ = 0;
    std::vector<Mat3> columns_;  // size() a slot
    // of responses(); nodes of the body
    std::vector<Index> touched_;
    std::vector<Real> responses_;
};

}  // namespace skerry
