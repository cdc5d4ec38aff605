#include "systems/contact/prepare_ties.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <utility>

#include "components/append_cable.h"
#include "components/write_contact.h"
#include "systems/geometry/rotation.h"

namespace skerry {

Mat3 triangle_axes(const std::array<Vec3, 3>& corner) {
    const Vec3 along = (corner[1] - corner[0]).normalized();
    const Vec3 normal = (corner[1] - corner[0]).cross(corner[2] - corner[0]).normalized();
    Mat3 axes;
    axes << along, normal.cross(along), normal;
    return axes;
}

namespace {

using Corners = std::array<Vec3, 3>;

/// Barycentric weights of the point nearest to `point` in the plane of a triangle.
Vec3 weights_at(const Corners& corner, const Vec3& point) {
    const Vec3 first = corner[1] - corner[0], second = corner[2] - corner[0], to = point - corner[0];
    const Real a = first.squaredNorm(), b = first.dot(second), c = second.squaredNorm();
    const Real of_first = to.dot(first), of_second = to.dot(second), size = a * c - b * b;
    const Real one = (c * of_first - b * of_second) / size, two = (a * of_second - b * of_first) / size;
    return {1 - one - two, one, two};
}

Vec3 sum_of(const Corners& corner, const Vec3& weight) {
    return weight[0] * corner[0] + weight[1] * corner[1] + weight[2] * corner[2];
}

Corners corners_of(const TieInputs& ties, std::size_t t, std::size_t k) {
    Corners corner;
    for (std::size_t a = 0; a < 3; ++a)
        corner[a] = ties.position[static_cast<std::size_t>(ties.row_of(ties.tie.second[t], ties.tie.corner[k][a]))];
    return corner;
}

/// Rotation matrix from the frame of the mesh of a rigid or implicit body to the world frame.
Mat3 mesh_axes(const TieInputs& ties, Index frame) {
    const auto r = static_cast<std::size_t>(frame);
    return ties.rotation[r] * ties.axes[r].transpose();
}

/// Motion of a point that moves with the frame of a body, after the kick (the velocity change by forces).
struct FrameMotion {
    Vec3 turning = Vec3::Zero();       // part of `velocity` that stems from the spin of the body [m/s]
    Vec3 velocity = Vec3::Zero();      // [m/s]
    Vec3 acceleration = Vec3::Zero();  // due to the rotation of the frame [m/s^2]
};

/// Velocity of a frame at `point`, and acceleration of the point due to the rotation of the frame. `frame`: row of
/// RigidBodyTable. `node`: row of NodeTable of the node at the point, whose velocity relative to the frame adds the
/// Coriolis acceleration; no_index if the point is fixed to the frame.
FrameMotion frame_motion(const TieInputs& ties, Index frame, const Vec3& point, Index node) {
    FrameMotion at;
    if (frame == no_index) return at;
    const auto r = static_cast<std::size_t>(frame);
    const Vec3 arm = point - ties.center[r], spin = ties.spins.kicked(r);
    at.turning = spin.cross(arm);
    at.velocity = (ties.momentum[r] + ties.kick[r]) / ties.mass[r] + at.turning;
    at.acceleration = spin.cross(at.turning);
    if (ties.holder[r] == no_index)
        at.acceleration +=
            (ties.spins.inverse_inertia[r] * (ties.spins.angular_momentum[r] + ties.spins.moment_kick[r]).cross(spin))
                .cross(arm);
    if (node != no_index)
        at.acceleration += 2 * spin.cross(ties.velocity_next[static_cast<std::size_t>(node)] - at.velocity);
    return at;
}

/// Mean velocity over the step of the offset of a tie: the vector from the triangle to the tied point, which turns with
/// the triangle [m/s]. The triangle moves at the predicted velocities.
Vec3 turning_offset(const TieInputs& ties, std::size_t t, std::size_t k, Real h) {
    const Vec3& offset = ties.tie.place[k];
    if (offset.isZero(0)) return Vec3::Zero();
    const Corners corner = corners_of(ties, t, k);
    Corners next = corner;
    for (std::size_t a = 0; a < 3; ++a)
        next[a] +=
            h * ties.velocity_next[static_cast<std::size_t>(ties.row_of(ties.tie.second[t], ties.tie.corner[k][a]))];
    return (triangle_axes(next) - triangle_axes(corner)) * offset / h;
}

/// Mean velocity over the step of a point that moves with a collider [m/s]
Vec3 collider_velocity(const RigidMotion& motion, const Vec3& point, Real h) {
    const Vec3 arm = point - motion.position;
    return motion.velocity + (rotation_matrix(h * motion.angular_velocity) * arm - arm) / h;
}

/// A point of the first body of a tie: one tied node, or the mean point of all nodes of the tie.
struct TiedPoint {
    Vec3 position = Vec3::Zero();  // [m]
    FrameMotion body_motion;       // motion of the frame of its body
};

TiedPoint tied_point(const TieInputs& ties, std::size_t t, Index node) {
    const Index frame = ties.frame(ties.tie.first[t]);
    const Vec3& position = ties.position[static_cast<std::size_t>(node)];
    return {position, frame_motion(ties, frame, position, frame == no_index ? no_index : node)};
}

TiedPoint mean_of_points(const TieInputs& ties, std::size_t t) {
    TiedPoint mean;
    ties.for_each_share(t, [&](Index node, Real share) {
        const TiedPoint tied = tied_point(ties, t, node);
        mean.position += share * tied.position;
        mean.body_motion.turning += share * tied.body_motion.turning;
        mean.body_motion.acceleration += share * tied.body_motion.acceleration;
    });
    return mean;
}

/// Equation of one tied node, or of the mean point of the nodes of a tie of the kind `ball`. `k`: row of the node in
/// the columns of TieTable that have one entry per tied node; for a `ball` the row of its first node.
class TieRow {
public:
    /// `weight`: weight of node `k` in the stencil; 0 for a mean point, whose nodes have stencils of their own.
    TieRow(const TieInputs& ties, const TieStep& step, std::size_t t, std::size_t k, const TiedPoint& point,
           Real weight)
        : ties_(ties), step_(step), t_(t), k_(k), point_(point), target_(ties.target(t, k)) {
        const TieTable& tie = ties.tie;
        const Index node = ties.row_of(tie.first[t], tie.node[k]);
        stencil_ = {{node, node, node, node}, {weight, 0, 0, 0}};
        if (ties.deforms(tie.second[t])) {
            for (std::size_t a = 0; a < 3; ++a) {
                stencil_.node[a + 1] = ties.row_of(tie.second[t], tie.corner[k][a]);
                stencil_.weight[a + 1] = -target_.weight[static_cast<Index>(a)];
            }
        } else if (const Index frame = ties.frame(tie.second[t]);
                   frame != no_index && ties.holder[static_cast<std::size_t>(frame)] == no_index) {
            stencil_.node[1] = ties.row_of(tie.second[t], 0);
            stencil_.weight[1] = -1;
        }
    }

    const Stencil& stencil() const { return stencil_; }
    const Vec3& point() const { return point_.position; }
    const Vec3& normal() const { return target_.normal; }

    /// Velocity that the row prescribes for the node relative to the nodes of the other object [m/s]. The formula is
    /// derived in docs/methods/ties.md.
    Vec3 demanded() const {
        const TieTable& tie = ties_.tie;
        const Index second = tie.second[t_], frame = ties_.frame(second);
        const FrameMotion& first_motion = point_.body_motion;
        const FrameMotion second_motion = frame_motion(ties_, frame, point(), no_index);
        Vec3 velocity = Vec3::Zero();
        if (tie.collider[t_] != no_index)
            velocity =
                collider_velocity(ties_.motion[static_cast<std::size_t>(tie.collider[t_])], target_.point, step_.h);
        else if (ties_.deforms(second) && frame == no_index)
            velocity = turning_offset(ties_, t_, k_, step_.h);
        else if (!ties_.deforms(second) && frame != no_index && stencil_.weight[1] == 0)
            velocity = second_motion.velocity;
        Vec3 error = point() - target_.point;
        if (tie.kind[t_] == TieKind::slide) error = target_.normal.dot(error) * target_.normal;
        Vec3 pull = error / step_.h;
        const Real fastest = step_.recovery_speed + first_motion.turning.norm() + second_motion.turning.norm();
        if (const Real speed = pull.norm(); speed > fastest) pull *= fastest / speed;
        return velocity - pull - step_.h / 2 * (first_motion.acceleration - second_motion.acceleration);
    }

private:
    const TieInputs& ties_;
    const TieStep& step_;
    std::size_t t_, k_;
    TiedPoint point_;
    TieTarget target_;
    Stencil stencil_;
};

/// Key of the row of a tied node. It is greater than all keys of contacts, because bit 63 of ContactKey::pair is set.
/// So the rows of ties follow the contacts in key order.
ContactKey key_of(const TieTable& tie, std::size_t t, std::size_t k) {
    constexpr std::uint64_t of_ties = std::uint64_t{1} << 63;
    return {of_ties | tie.slot[t], static_cast<std::uint64_t>(k) - static_cast<std::uint64_t>(tie.nodes[t].begin)};
}

/// Contact row of a tied node.
ContactRow contact_row_of(const TieTable& tie, std::size_t t, std::size_t k, const TieRow& row) {
    return {.key = key_of(tie, t, k),
            .kind = ContactKind::point_triangle,
            .stencil = row.stencil(),
            .point = row.point(),
            .normal = row.normal(),
            .gap = 0,
            .distance = 0,
            .surface_velocity = row.demanded(),
            .static_friction = tie.kind[t] == TieKind::weld ? infinity : 0,
            .dynamic_friction = infinity,
            .restitution = 0,
            .first_body = tie.first[t],
            .second_body = tie.second[t],
            .collider = tie.collider[t]};
}

/// Appends a block (CableBlock) for the equation of the mean point of a tie, if impulses can move at least one of its
/// nodes. The points of the block are stencils, that is, nodes with weights:
/// - The first points consist of up to four tied nodes each. Their sum is the mean point.
/// - The last point consists of nodes of the other object.
void append_mean(const TieInputs& ties, const TieStep& step, std::size_t t, Real scale, CableBlockTable& blocks) {
    const TieTable& tie = ties.tie;
    const TieRow row(ties, step, t, static_cast<std::size_t>(tie.nodes[t].begin), mean_of_points(ties, t), 0);
    const auto begin = static_cast<Index>(blocks.stencil.size());
    bool moves = false;
    const auto append = [&](const Stencil& stencil, const Vec3& velocity) {
        for (std::size_t a = 0; a < 4; ++a)
            moves |= stencil.weight[a] != 0 && ties.inverse_mass[static_cast<std::size_t>(stencil.node[a])] > 0;
        append_point(stencil, velocity, blocks);
    };
    Stencil four{};
    std::size_t count = 0;
    const auto end_point = [&] {
        for (std::size_t a = count; a < 4; ++a) four.node[a] = row.stencil().node[0];
        append(std::exchange(four, {}), Vec3::Zero());
        count = 0;
    };
    ties.for_each_share(t, [&](Index node, Real share) {
        four.node[count] = node;
        four.weight[count] = share;
        if (++count == 4) end_point();
    });
    // A block stores one scalar impulse per point. The impulse of a tie has three components, so the block needs at
    // least three points.
    while (count > 0 || static_cast<Index>(blocks.stencil.size()) < begin + 2) end_point();
    append(row.stencil(), -row.demanded());
    if (!moves) {
        truncate_points(begin, blocks);
        return;
    }
    Vec3 impulse = Vec3::Zero();
    for (const Vec3& node_impulse : rows_of(tie.impulse.span(), tie.nodes[t])) impulse += scale * node_impulse;
    for (Index k = 0; k < 3; ++k) blocks.impulse[begin + k] = impulse[k];
    append_block({.cable = static_cast<Index>(t),
                  .points = {begin, static_cast<Index>(blocks.stencil.size())},
                  .solved = true,
                  .by_length = false,
                  .prescribed = 0,
                  .released = 0,
                  .mobility = blocks.mobilities,
                  .is_tie = true,
                  .acts_at = row.point()},
                 blocks);
}

}  // namespace

bool TieInputs::rests(std::size_t t) const {
    if (body_asleep.empty() || is_led(t)) return false;
    const Index second = tie.second[t];
    return body_asleep[static_cast<std::size_t>(tie.first[t])] != 0 &&
           (second == no_index || body_asleep[static_cast<std::size_t>(second)] != 0);
}

TieTarget TieInputs::target(std::size_t t, std::size_t k) const {
    const Index second = tie.second[t], frame = this->frame(second);
    if (deforms(second)) {
        const Corners corner = corners_of(*this, t, k);
        const Mat3 axes_of_triangle = triangle_axes(corner);
        const Vec3& node = position[static_cast<std::size_t>(row_of(tie.first[t], tie.node[k]))];
        const Vec3 weight = tie.kind[t] == TieKind::slide ? weights_at(corner, node) : tie.weight[k];
        const Vec3 offset = (frame == no_index ? axes_of_triangle : mesh_axes(*this, frame)) * tie.place[k];
        return {sum_of(corner, weight) + offset, axes_of_triangle.col(2), weight};
    }
    if (frame != no_index) {
        const auto r = static_cast<std::size_t>(frame);
        const Mat3 turn = mesh_axes(*this, frame);
        return {center[r] + turn * (tie.place[k] - rest_center[r]), turn * tie.normal[k]};
    }
    if (tie.collider[t] == no_index) return {tie.place[k], tie.normal[k]};
    const RigidMotion& pose = motion[static_cast<std::size_t>(tie.collider[t])];
    return {pose.position + pose.rotation * tie.place[k], pose.rotation * tie.normal[k]};
}

bool prepare_ties(const TieInputs& ties, const TieStep& step, ContactTable& contacts, TieRowTable& rows,
                  CableBlockTable& blocks) {
    const TieTable& tie = ties.tie;
    rows.rests.resize(tie.size());
    rows.tie.clear();
    rows.node.clear();
    rows.stencil.clear();
    rows.point.clear();
    for (std::size_t t = 0; t < tie.size(); ++t) {
        rows.rests[t] = ties.rests(t);
        if (rows.rests[t]) continue;
        const Real scale = step.warm_start == WarmStart::on && tie.step[t] > 0 ? step.kick / tie.step[t] : 0;
        if (tie.kind[t] == TieKind::ball) {
            if (tie.holds(t)) append_mean(ties, step, t, scale, blocks);
            continue;
        }
        for (Index k = tie.nodes[t].begin; k < tie.nodes[t].end; ++k) {
            const auto at = static_cast<std::size_t>(k);
            if (tie.broken[at] < infinity) continue;
            const TieRow row(ties, step, t, at, tied_point(ties, t, ties.row_of(tie.first[t], tie.node[k])), 1);
            append_row(contact_row_of(tie, t, at, row), scale * tie.impulse[at], contacts);
            rows.tie.push_back(static_cast<Index>(t));
            rows.node.push_back(k);
            rows.stencil.push_back(row.stencil());
            rows.point.push_back(row.point());
        }
    }
    return tie.size() > 0;
}

bool mark_led(const TieInputs& ties, std::span<std::uint8_t> marked) {
    bool any = false;
    for (std::size_t t = 0; t < ties.tie.size(); ++t) {
        if (!ties.is_led(t)) continue;
        any = true;
        marked[static_cast<std::size_t>(ties.tie.first[t])] = 1;
    }
    return any;
}

}  // namespace skerry
