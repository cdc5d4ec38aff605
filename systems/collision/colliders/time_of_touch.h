// Time at which a moving feature of a body and a moving collider meet (docs/methods/collision.md 7.5).
#pragma once

#include <array>
#include <optional>

#include "components/collider_table.h"
#include "systems/geometry/closest_points.h"
#include "systems/geometry/time_of_contact.h"

namespace skerry {

/// A node, edge or face of a body in one step, and the part or point of the collider that it is tested against.
struct TouchingFeature {
    enum class Kind : std::uint8_t { node, edge, face };

    Kind kind;
    Index of_shape;                      // for a node or edge the part, for a face the point (see collider_point)
    std::array<Vec3, 3> position;        // in the world at the start of the step, one for each node of the feature [m]
    std::array<Vec3, 3> displacement{};  // in the step [m]
    KeptApart kept{};                    // for a node or edge that is the core of a round body

    std::size_t nodes() const { return static_cast<std::size_t>(kind) + 1; }
};

/// The nearest points of a feature and a collider.
struct Touch {
    // distance; for the wall of a bucket, where several places may be nearest, a lower bound and at least a quarter of
    // it [m]
    Real distance;
    std::array<Real, 3> weight;  // weights of the feature's nodes at its nearest point
    Vec3 point, normal;          // nearest point of the collider [m] and unit normal there, in its frame
    bool in_face = true;         // false if an edge of the face is nearest; weights and normal are then zero
    bool within = false;         // true if the face is touched on its inner side
};

/// Nearest points of the feature and the collider. `nodes`: the feature's nodes in the frame of the collider. For the
/// point of a rim that follows a face, all points of the rim count. Distances of nodes and edges are signed and
/// measured beyond the kept distance. If the collider has gone through a face, the distance is that of the face's
/// edges.
Touch nearest_touch(const ColliderGeometry& geometry, const TouchingFeature& feature, const std::array<Vec3, 3>& nodes);

/// True if the end of the step alone decides about a crossing. Nothing gets around a plane: a feature that has passed
/// it ends behind it, and one that a contact stops before it has not crossed, however near. A round body is excluded,
/// since no part of it may come behind the plane at any time of the step.
bool the_end_tells(const ColliderGeometry& geometry, const TouchingFeature& feature);

/// Upper bound of how much nearer any point of the feature comes to the collider while both move for h seconds [m].
Real greatest_approach(const RigidMotion& motion, Real h, const TouchingFeature& feature);

/// Nearest points at the time of the step at which feature and collider come near contact, or nothing if they do not.
/// Uses conservative advancement, as time_of_contact does. Where the_end_tells, the result is the state at the end of
/// the step if the feature is behind the plane then. Features that touch or overlap at the start give nothing, nor does
/// a face whose edges touch first: edges are tested as features of their own. `time_of_touch`, unless null, receives
/// the time found by advancement as a fraction of the step.
std::optional<Touch> first_touch(const ColliderGeometry& geometry, const RigidMotion& motion, Real h,
                                 const TouchingFeature& feature, Real* time_of_touch = nullptr);

}  // namespace skerry
