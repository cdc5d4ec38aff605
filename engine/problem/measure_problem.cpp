#include "engine/problem/measure_problem.h"

#include <algorithm>
#include <cmath>
#include <string>

#include "engine/base/complaint.h"
#include "engine/problem/check_arrays.h"
#include "systems/solver/operators/block_operator.h"

namespace skerry {
namespace {

/// Violation of Coulomb's law by one contact with the impulse r and the relative velocity u [J]. It is the sum of
/// - r_n u_n, which is zero if complementarity holds in the normal direction,
/// - mu r_n |u_t| + r_t . u_t, which is zero if the dissipation by friction is maximal.
///
/// For the friction pyramid, |u_t| is the 1-norm.
Real coulomb_gap(const Vec3& r, const Vec3& u, Real mu, Friction friction) {
    const Real slip = friction == Friction::cone ? std::hypot(u[1], u[2]) : std::abs(u[1]) + std::abs(u[2]);
    return r[0] * u[0] + mu * r[0] * slip + r[1] * u[1] + r[2] * u[2];
}

}  // namespace

ProblemError measure_problem(const ContactProblem& problem, std::span<const Vec3> reaction, Friction friction) {
    Real natural_map_squares = 0, q = 0, r = 0, u = 0, gap = 0;
    for (std::size_t i = 0; i < problem.q.size(); ++i) {
        Vec3 velocity = problem.q[i];
        for (Index k = problem.row_offset[i]; k < problem.row_offset[i + 1]; ++k)
            velocity += problem.block[k] * reaction[problem.column[k]];
        natural_map_squares += natural_map(reaction[i], velocity, problem.mu[i], friction).squaredNorm();
        gap += coulomb_gap(reaction[i], velocity, problem.mu[i], friction);
        q += problem.q[i].squaredNorm();
        r += reaction[i].squaredNorm();
        u += velocity.squaredNorm();
    }
    if (natural_map_squares == 0) return {0, 0, 0, gap};
    return {std::sqrt(natural_map_squares), std::sqrt(natural_map_squares / std::max({q, r, u})),
            std::sqrt(natural_map_squares / q), gap};
}

ProblemError problem_error(const ContactProblem& problem, std::span<const Vec3> reaction) {
    if (reaction.size() != problem.q.size())
        refuse(title_of(problem), "reaction", std::to_string(reaction.size()) + " values",
               std::to_string(problem.q.size()) + ", one per contact");
    return measure_problem(problem, reaction, Friction::cone);
}

}  // namespace skerry
