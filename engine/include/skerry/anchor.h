// Points on bodies and colliders, at which springs, cables and ties act.
#pragma once

#include <optional>

#include "components/handle.h"
#include "components/types.h"

#pragma GCC visibility push(default)
namespace skerry {

/// A point that is fixed to a body, to a collider, or to the world if neither is given.
///
/// On a rigid body the point may be anywhere. On a deformable body the point moves with the nearest tetrahedron. It
/// must be inside the body, or outside at a distance of at most one mean edge length of the body's surface.
struct Anchor {
    std::optional<BodyHandle> body{};          // the anchor moves with this body; not together with `collider`
    std::optional<ColliderHandle> collider{};  // the anchor moves with this collider
    Vec3 point = Vec3::Zero();                 // position in the world at the time when the anchor is created [m]
};

}  // namespace skerry
#pragma GCC visibility pop
