// Response of implicit bodies at the anchors of dampers.
#pragma once

#include <span>

#include "components/spring_table.h"
#include "systems/dynamics/implicit/move_implicit_bodies.h"

namespace skerry {

/// Both anchors of each spring.
struct DampedAnchors {
    std::span<const Index> first_body, second_body;
    std::span<const AnchorRow> first, second;
    std::span<const AnchorMass> first_mass, second_mass;
    std::span<const Range> body_rigid;  // BodyTable

    static DampedAnchors bind(const Binder& binder, const SpringTable& springs, const BodyTable& bodies) {
        return {.first_body = binder.read(springs.first.body),
                .second_body = binder.read(springs.second.body),
                .first = binder.read(springs.first.point),
                .second = binder.read(springs.second.point),
                .first_mass = binder.read(springs.first_mass),
                .second_mass = binder.read(springs.second_mass),
                .body_rigid = binder.read(bodies.rigid)};
    }
};

struct AnchorResponses {
    std::span<Mat3> first, second;  // [1/kg]

    static AnchorResponses bind(const Binder& binder, SpringTable& springs) {
        return {.first = binder.write(springs.first_response), .second = binder.write(springs.second_response)};
    }
};

/// Writes the response at each anchor: the velocity of the anchor, in world axes, that a unit impulse on it causes in
/// this step by deforming the body. Only anchors of dampers on awake implicit bodies respond; all others get zero.
/// Returns false if there is no implicit body.
bool respond_at_anchors(const ImplicitBodies& bodies, const DampedAnchors& anchors, const ImplicitTimes& times,
                        StiffBodies& stiff, const AnchorResponses& out);

}  // namespace skerry
