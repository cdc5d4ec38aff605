#include "systems/dynamics/implicit/respond_at_anchors.h"

#include <algorithm>

#include "systems/dynamics/implicit/body_rows.h"

namespace skerry {

namespace {

/// Velocity of a point of a body per unit impulse at this point, in the frame of the mesh [1/kg].
Mat3 response_at(const AnchorRow& point, StiffBody& stiff) {
    Mat3 sum = Mat3::Zero();
    for (std::size_t a = 0; a < 4; ++a) {
        if (point.weight[a] == 0) continue;
        const std::span<const Mat3> column = stiff.column(static_cast<std::size_t>(point.node[a]));
        for (std::size_t b = 0; b < 4; ++b)
            sum += point.weight[a] * point.weight[b] *
                   column[static_cast<std::size_t>(stiff.order_index(static_cast<std::size_t>(point.node[b])))];
    }
    return sum;
}

}  // namespace

bool respond_at_anchors(const ImplicitBodies& bodies, const DampedAnchors& anchors, const ImplicitTimes& times,
                        StiffBodies& stiff, const AnchorResponses& out) {
    std::ranges::fill(out.first, Mat3::Zero());
    std::ranges::fill(out.second, Mat3::Zero());
    if (!bodies.any()) return false;
    const auto respond = [&](Index body, const AnchorRow& point, const AnchorMass& mass, Mat3& response) {
        if (mass.dampers == 0 || !(mass.inverse > 0)) return;
        const auto r = static_cast<std::size_t>(anchors.body_rigid[static_cast<std::size_t>(body)].begin);
        // This is the response at small strain. It is used at large strain too, because the tangent matrix of the step
        // is not known before the step.
        if (bodies.asleep(r) || !make_factor(bodies, r, times.h, times.theta, stiff[r])) return;
        const Mat3 turn = bodies.turn(r);
        response = turn * response_at(point, stiff[r]) * turn.transpose();
    };
    for (std::size_t s = 0; s < out.first.size(); ++s) {
        respond(anchors.first_body[s], anchors.first[s], anchors.first_mass[s], out.first[s]);
        respond(anchors.second_body[s], anchors.second[s], anchors.second_mass[s], out.second[s]);
    }
    return true;
}

}  // namespace skerry
