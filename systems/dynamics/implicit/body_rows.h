// Table ranges of one implicit body, and the indices of its nodes in the elimination order.
#pragma once

#include <span>

#include "systems/dynamics/implicit/move_implicit_bodies.h"

namespace skerry {

struct BodyRows {
    const StiffBody& stiff;
    std::size_t first_node, first_row, count;

    BodyRows(const ImplicitBodies& bodies, const StiffBody& body, std::size_t r)
        : stiff(body),
          first_node(static_cast<std::size_t>(bodies.nodes(r).begin)),
          first_row(static_cast<std::size_t>(bodies.rows(r).begin)),
          count(static_cast<std::size_t>(bodies.rows(r).size())) {}

    template <class T>
    std::span<T> rows(std::span<T> column) const {
        return column.subspan(first_row, count);
    }
    std::size_t order_index(std::size_t n) const { return static_cast<std::size_t>(stiff.order_index(n)); }
};

/// Coefficient 1 + theta_h d of the masses M in the matrix (1 + theta_h d) M + theta_h^2 K of a step, with the damping
/// rate d of the material and the stiffness K. `theta_h`: step length times the parameter theta of ImplicitTimes [s].
Real inertia_of(const ImplicitBodies& bodies, std::size_t r, Real theta_h);
/// Computes the Cholesky factor of the matrix of a step at small strain, for later calls of stiff.respond(). Returns
/// false if the matrix cannot be factored.
bool make_factor(const ImplicitBodies& bodies, std::size_t r, Real h, Real theta, StiffBody& stiff);

/// Computes the impulses M velocity + theta_h (load - force) on the nodes of a free body, by index in the elimination
/// order [N s]. M are the node masses. `force`: elastic forces, by the same index [N]; `theta_h`: step length times
/// theta [s].
void add_up_impulses(const ImplicitBodies& bodies, const ImplicitLoads& loads, std::size_t r, Real theta_h,
                     std::span<const Vec3> force, const BodyRows& body, std::span<Vec3> impulse);

/// True if strain counts as large after a step. Strain that was large becomes small only below the limits of
/// becomes_small(). These are lower than those of becomes_large(), so that strain does not change between small and
/// large in every step. `displacement`: at the end of the step, by node [m]. `angular_momentum`: for a free body in the
/// frame of the mesh, zero for a held body [kg m^2/s].
bool is_large_after(bool was_large, std::span<const Vec3> displacement, const Vec3& angular_momentum,
                    const BodyRows& body, StiffBody& stiff);

}  // namespace skerry
