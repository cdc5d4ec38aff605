// Time at which a moving feature of a body touches a moving collider (docs/methods/collision.md 7.5).
#pragma once

#include <array>
#include <optional>

#include "components/collider_table.h"
#include "systems/geometry/closest_points.h"
#include "systems/geometry/time_of_contact.h"

namespace skerry {

/// A node, edge or face of a body and its motion in one step, together with the part or point of the collider to test.
struct TouchingFeature {
    enum class Kind : std::uint8_t { node, edge, face };

    Kind kind;
    // For a node or edge: number of the part; for a face: number of the point (see collider_point).
    Index of_shape;
    std::array<Vec3, 3> position;        // world position of each node at the start of the step [m]
    std::array<Vec3, 3> displacement{};  // displacement of each node in the step [m]
    KeptApart kept{};                    // distance to be kept by the core of a round body

    std::size_t nodes() const { return static_cast<std::size_t>(kind) + 1; }
};

/// Nearest points of a feature and a collider.
struct Touch {
    // Distance between the nearest points [m]. For the wall of a bucket, where several points may be nearest, it is a
    // lower bound and at least a quarter of the distance at `point`.
    Real distance;
    std::array<Real, 3> weight;  // weights of the feature's nodes at its nearest point
    // Nearest point of the collider [m] and unit normal there, both in the frame of the collider.
    Vec3 point, normal;
    bool in_face = true;  // false if an edge of the face is nearest; then weights and normal are zero
    bool within = false;  // true if the face is touched on its inner side
};

/// Nearest points of a feature and a collider. `nodes`: nodes of the feature in the frame of the collider. For the rim
/// point that depends on the face, all points of the rim are considered. Distances of nodes and edges are signed and
/// reduced by the distance to be kept. If the rim has passed through a face, the distance is that of the edges of the
/// face.
Touch nearest_touch(const ColliderGeometry& geometry, const TouchingFeature& feature, const std::array<Vec3, 3>& nodes);

/// True if a crossing can be decided at the end of the step alone, because the collider is a plane. No feature can get
/// around a plane, so a feature that has passed it ends behind it. A feature that a contact stops in front of the plane
/// has not crossed, however near it is. The result is false for round bodies, because no part of their surface may be
/// behind the plane at any time of the step.
bool the_end_tells(const ColliderGeometry& geometry, const TouchingFeature& feature);

/// Upper bound of the decrease in distance between any point of the feature and the collider while both move for h
/// seconds [m].
Real greatest_approach(const RigidMotion& motion, Real h, const TouchingFeature& feature);

/// Nearest points at the time at which feature and collider come near contact within the step, or nothing if they do
/// not. It uses conservative advancement, similar to time_of_contact. If the_end_tells is true, the result is the state
/// at the end of the step, provided that the feature is behind the plane then. The result is nothing for features that
/// touch or overlap at the start. It is also nothing for a face whose edges touch first, because edges are tested as
/// separate features. `time_of_touch`, unless null, receives the time of the touch as a fraction of the step, if it was
/// found by advancement.
std::optional<Touch> first_touch(const ColliderGeometry& geometry, const RigidMotion& motion, Real h,
                                 const TouchingFeature& feature, Real* time_of_touch = nullptr);

}  // namespace skerry
