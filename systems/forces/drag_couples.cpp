#include "systems/forces/drag_couples.h"

#include "systems/geometry/symmetric_eigen.h"

namespace skerry {

namespace {

/// Solves J x = y for a positive semidefinite J. Components of x along eigenvectors of J with an eigenvalue of almost
/// zero are set to zero.
Vec3 solve_where_possible(const Mat3& J, const Vec3& y) {
    constexpr Real negligible = 1e-9;
    const SymmetricEigen parts = symmetric_eigen(J);
    Vec3 x = Vec3::Zero();
    for (Index i = 0; i < 3; ++i)
        if (const Real value = parts.values[i]; value > negligible * parts.values[2])
            x += parts.vectors.col(i).dot(y) / value * parts.vectors.col(i);
    return x;
}

}  // namespace

bool add_drag_couples(const DraggedBodies& bodies, std::span<const BodyField> fields, std::span<Vec3> applied_force) {
    if (bodies.body.empty()) return false;
    for (std::size_t r = 0; r < bodies.body.size() && !fields.empty(); ++r) {
        const auto body = static_cast<std::size_t>(bodies.body[r]);
        const Real drag = fields[body].drag;
        if (drag == 0 || bodies.body_implicit[body].size() > 0) continue;
        const std::span<const Vec3> position = rows_of(bodies.position, bodies.body_nodes[body]),
                                    velocity = rows_of(bodies.velocity, bodies.body_nodes[body]);
        const std::span<const Real> mass = rows_of(bodies.mass, bodies.body_nodes[body]);
        const std::span<Vec3> force = rows_of(applied_force, bodies.body_nodes[body]);
        Vec3 middle = Vec3::Zero(), node_momentum = Vec3::Zero();
        for (std::size_t n = 0; n < position.size(); ++n) {
            middle += position[n] / static_cast<Real>(position.size());
            node_momentum += mass[n] * (position[n] - bodies.center[r]).cross(velocity[n]);
        }
        Mat3 J = Mat3::Zero();
        for (const Vec3& x : position) {
            const Vec3 arm = x - middle;
            J += arm.squaredNorm() * Mat3::Identity() - arm * arm.transpose();
        }
        const Vec3 turn = solve_where_possible(J, -drag * (bodies.angular_momentum[r] - node_momentum));
        for (std::size_t n = 0; n < position.size(); ++n) force[n] += turn.cross(position[n] - middle);
    }
    return true;
}

}  // namespace skerry
