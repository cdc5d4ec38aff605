// The elasticity of a body that moves implicitly, in the frame that moves with it: K and M of its nodes, and what
// impulses do to them in a step (docs/methods/implicit_bodies.md 2, 3).
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "components/material_table.h"
#include "components/types.h"
#include "systems/dynamics/implicit/block_cholesky.h"
#include "systems/dynamics/kinds/element_list.h"

namespace skerry {

/// N/m, -df_k/dx_l of an element in its rest shape, for nodes with these gradients (1/m); `volume`: m^3.
Mat3 element_stiffness(const MaterialConstants& material, Real volume, const Vec3& gradient_k, const Vec3& gradient_l);

/// Vectors by node are in the order of elimination: place() says where a node of the body stands.
class StiffBody {
public:
    StiffBody() = default;
    /// `constants`: by row of MaterialTable. `mass` (kg) and `rest_position` (m): by node of the body.
    StiffBody(const ElementList& elements, std::span<const MaterialConstants> constants, std::span<const Real> mass,
              std::span<const Vec3> rest_position);

    /// From now on nodes whose `inverse_mass` (by node of the body) is zero are held: impulses on them do nothing, and
    /// others move against them. Where none is the body is free. A factor that is there is kept where nothing changes.
    void hold(std::span<const Real> inverse_mass);
    bool is_held() const { return !held_.empty(); }

    bool empty() const { return place_.empty(); }
    std::size_t size() const { return place_.size(); }
    Index place(std::size_t node) const { return place_[node]; }
    Real mass(std::size_t place) const { return mass_[place]; }

    /// out = K u, N.
    void elastic_forces(std::span<const Vec3> displacement, std::span<Vec3> out) const {
        stiffness_.multiply(displacement, out);
    }
    /// u K u / 2, J; `displacement`: by node of the body.
    Real elastic_energy(std::span<const Vec3> displacement) const;
    /// Takes the motion as a whole out of velocities (m/s), by node of the body.
    void take_rigid_motion(std::span<Vec3> velocity) const;
    /// Makes A = inertia M + stiffness K the matrix of respond(). A factor that is there is kept. Returns false where
    /// A is not positive definite. Of nodes that are held it has the diagonal alone.
    bool prepare(Real inertia, Real stiffness);
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
    /// Columns that are kept, at most.
    static constexpr std::size_t column_memory = std::size_t(64) << 20;  // bytes

    std::size_t factor_blocks() const { return factor_.blocks(); }

private:
    template <class X>
    void take_rigid_part(std::span<X> impulse) const;
    template <class X>
    void respond_to(std::span<X> impulse) const;
    void find_responses();
    void forget_factor();

    std::vector<Index> place_;        // by node
    std::vector<Index> node_;         // by place
    std::vector<Real> mass_;          // kg, by place
    std::vector<Vec3> arm_;           // m, from the centre of mass, by place
    std::vector<std::uint8_t> held_;  // by place; empty: none is
    Real total_mass_ = 0;
    Mat3 inverse_inertia_ = Mat3::Zero();  // 1/(kg m^2)
    BlockRows stiffness_, matrix_;
    Real inertia_factor_ = 0, stiffness_factor_ = 0;  // of A
    BlockCholesky factor_;
    // by node: which slot of `columns_` has its column, or no_index
    std::vector<Index> slot_of_;
    std::vector<Index> node_in_;          // by slot
    std::vector<std::uint64_t> used_at_;  // by slot
    std::uint64_t uses_ = 0;
    std::vector<Mat3> columns_;  // size() a slot
    // of responses(); nodes of the body
    std::vector<Index> touched_;
    std::vector<Real> responses_;
};

}  // namespace skerry
