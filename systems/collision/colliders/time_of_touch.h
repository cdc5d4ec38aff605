// When a feature of a body and a collider that move come together (docs/methods/collision.md 7.5).
#pragma once

#include <array>
#include <optional>

#include "components/collider_table.h"
#include "systems/geometry/closest_points.h"
#include "systems/geometry/time_of_contact.h"

namespace skerry {

/// A node, edge or face of a body in one step, and what of the collider it is looked at against.
struct TouchingFeature {
    enum class Kind : std::uint8_t { node, edge, face };

    Kind kind;
    Index of_collider;                   // a node and an edge: the part; a face: the point, see collider_point
    std::array<Vec3, 3> position;        // m, world, at the start of the step; as many as the feature has nodes
    std::array<Vec3, 3> displacement{};  // m, in the step
    KeptApart kept{};                    // of the round body whose core a node or edge is

    std::size_t nodes() const { return static_cast<std::size_t>(kind) + 1; }
};

/// How a feature and a collider are nearest.
struct Touch {
    Real distance;               // m; where the place is not unique no larger than it is, and at least a quarter of it
    std::array<Real, 3> weight;  // of the feature's nodes: its nearest point
    Vec3 point, normal;          // m, unit: of the collider, in its frame
    bool in_face = true;         // false: one of the edges of the face is nearest, how is not said
    bool within = false;         // the face is touched on its inner side
};

/// Where the feature, `nodes` in the frame of the collider, and the collider are nearest. Of a rim that follows a face
/// all points count. Distances of nodes and edges are signed, beyond what
/// is kept; of a face that the collider has gone through it is that
/// of the edges.
Touch nearest_touch(const ColliderGeometry& geometry, const TouchingFeature& feature, const std::array<Vec3, 3>& nodes);

/// No way leads around a plane: what has come through it ends behind it, and what a contact stops before it has not,
/// however near. Of a round body none of it may come in, also on the way.
bool the_end_tells(const ColliderGeometry& geometry, const TouchingFeature& feature);

/// No point of the feature comes nearer to the collider than by this while both move for h seconds, m.
Real greatest_approach(const RigidMotion& motion, Real h, const TouchingFeature& feature);

/// How they touch at the time of the step at which they are near contact, or nothing when they do not come as near;
/// conservative advancement, as time_of_contact; of a node and a plane, how they are at the end if it is behind then.
/// Nothing of what touches or overlaps at the start, and of a face whose edges touch first: they are looked at by
/// themselves. `time_of_touch`: where it is put, as a fraction of the step; null: nobody asks.
std::optional<Touch> first_touch(const ColliderGeometry& geometry, const RigidMotion& motion, Real h,
                                 const TouchingFeature& feature, Real* time_of_touch = nullptr);

}  // namespace skerry
