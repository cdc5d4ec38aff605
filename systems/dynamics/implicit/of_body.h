// Rows of one implicit body, by node and by place in its factor.
#pragma once

#include <span>

#include "systems/dynamics/implicit/move_implicit_bodies.h"

namespace skerry {

struct OfBody {
    const StiffBody& stiff;
    std::size_t first_node, first_row, count;

    OfBody(const ImplicitBodies& bodies, const StiffBody& of, std::size_t r)
        : stiff(of),
          first_node(static_cast<std::size_t>(bodies.nodes(r).begin)),
          first_row(static_cast<std::size_t>(bodies.rows(r).begin)),
          count(static_cast<std::size_t>(bodies.rows(r).size())) {}

    template <class T>
    std::span<T> rows(std::span<T> column) const {
        return column.subspan(first_row, count);
    }
    std::size_t place(std::size_t n) const { return static_cast<std::size_t>(stiff.place(n)); }
};

/// The number `inertia` of the matrix inertia M + within^2 K of a step; `within`: theta h [s].
Real inertia_of(const ImplicitBodies& bodies, std::size_t r, Real within);
/// Makes the matrix of a step of small strain that of stiff.respond(). Returns false if it cannot be factored.
bool make_factor(const ImplicitBodies& bodies, std::size_t r, Real h, Real theta, StiffBody& stiff);

/// Adds up impulses on a free body, by place: M velocity + within (load - force) [N s]. `force`: elastic forces, by
/// place [N]; `within`: theta times the length of the step [s].
void add_up_impulses(const ImplicitBodies& bodies, const ImplicitLoads& loads, std::size_t r, Real within,
                     std::span<const Vec3> force, const OfBody& of, std::span<Vec3> impulse);

/// True if strain is large after a step. `displacement`: at its end, by node [m]. `angular_momentum`: of a free body,
/// in the frame of its mesh [kg m^2/s].
bool is_large_after(bool was_large, std::span<const Vec3> displacement, const Vec3& angular_momentum, const OfBody& of,
                    StiffBody& stiff);

}  // namespace skerry
