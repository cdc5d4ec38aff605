// Time at which a moving feature of a body touches a moving collider (docs/methods/collision.md 7.5).
#pragma once

#include <array>
#include <optional>

#include "components/collider_table.h"
#include "systems/geometry/closest_points.h"
#include "systems/geometry/time_of_contact.h"

namespace skerry {

/// A node, edge or face of a body and its motion in one step, together with the part or point of the collider against
/// which it is tested.
struct TouchingFeature {
    enum class Kind : std::uint8_t { node, edge, face };

    Kind kind;
    // For a node or edge: number of the collider part (collider_part_count). For a face: number of the collider point
    // (collider_point).
    Index part_or_point;
    std::array<Vec3, 3> position;        // world position of each node at the start of the step [m]
    std::array<Vec3, 3> displacement{};  // displacement of each node in the step [m]
    ContactThreshold threshold{};        // distance that must remain between the collider and the core of a round body

    std::size_t nodes() const { return static_cast<std::size_t>(kind) + 1; }
};

/// Nearest points of a feature and a collider.
struct Touch {
    // Distance between the nearest points [m]. At the wall of a bucket it may be smaller, but is at least a quarter of
    // the distance at `point`: several points may be nearest there, and the search stops early (nearest_on_wall).
    Real distance;
    std::array<Real, 3> weight;  // weight of each node in the nearest point of the feature; they add up to 1
    // Nearest point of the collider [m], and unit normal of the collider at this point. Vectors are in the frame of the
    // collider.
    Vec3 point, normal;
    // false: an edge of the face is nearest to the collider; then `weight` and `normal` are zero.
    bool in_face = true;
    bool within = false;  // true: the collider touches the face from inside the body; set by first_touch only
};

/// Finds the nearest points of a feature and a collider. `nodes`: nodes of the feature in the frame of the collider.
/// - Distances of nodes and edges are signed and reduced by `threshold.distance`.
/// - The distance from a face is positive on both of its sides.
/// - If a face is tested against the first point of a rim (collider_point), all points of the rim are considered. If
///   none faces the interior of the face, for example because the rim has already passed through it, the result is a
///   lower bound of the distance of the rim from the edges of the face.
Touch nearest_touch(const ColliderGeometry& geometry, const TouchingFeature& feature, const std::array<Vec3, 3>& nodes);

/// True if the positions at the end of the step suffice to detect a crossing: the collider is a plane, around which no
/// feature can move, and the feature is not the core of a round body. For a core they do not suffice: its distance from
/// the plane must not fall below the radius at any time of the step.
bool end_position_suffices(const ColliderGeometry& geometry, const TouchingFeature& feature);

/// Upper bound of the decrease in distance between the collider and any point of the feature, while both move for h
/// seconds [m].
Real greatest_approach(const RigidMotion& motion, Real h, const TouchingFeature& feature);

/// Finds the first time in the step at which a feature and a collider are nearly in contact, by conservative
/// advancement similar to time_of_contact, and returns their nearest points at this time. No value is returned if they
/// do not meet, if they touch or overlap at the start of the step, or if an edge of a face touches first, because edges
/// are features of their own.
///
/// `time_of_touch`: receives the time as a fraction of the step; may be null. If end_position_suffices is true, it is
/// left unchanged: only the end of the step is tested, and the nearest points are returned if the feature is behind the
/// plane.
std::optional<Touch> first_touch(const ColliderGeometry& geometry, const RigidMotion& motion, Real h,
                                 const TouchingFeature& feature, Real* time_of_touch = nullptr);

}  // namespace skerry
