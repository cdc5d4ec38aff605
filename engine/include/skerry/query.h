// Geometric queries of the present surfaces of a world: World::cast_ray, World::nearest_point.
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "components/handle.h"
#include "components/types.h"

#pragma GCC visibility push(default)
namespace skerry {

/// Selects the surfaces that a query tests.
struct QueryFilter {
    bool bodies = true;     // whether bodies are tested
    bool colliders = true;  // whether colliders are tested
    // only bodies and colliders whose collision group is in this bit set are tested
    std::uint32_t groups = 0xffffffffu;
    std::vector<BodyHandle> except_bodies{};         // bodies that are not tested
    std::vector<ColliderHandle> except_colliders{};  // colliders that are not tested
};

/// A point on the surface of a body or a collider.
struct SurfaceHit {
    BodyHandle body{};          // the body; a stale handle if the point is on a collider
    ColliderHandle collider{};  // the collider; a stale handle if the point is on a body
    // Index of the triangle in World::surface() of the body, or in the mesh of a mesh collider. -1 for all other
    // colliders, and for bodies that are rigid spheres, capsules or cylinders.
    Index triangle = -1;
    std::array<Real, 3> barycentric{};  // barycentric coordinates of `point` in the triangle: in [0, 1], with sum 1
    Vec3 point = Vec3::Zero();          // position of the hit in the world [m]
    Vec3 normal = Vec3::Zero();         // outward unit normal of the triangle or the shape
    Real distance = 0;                  // distance from the origin of the ray, or from the queried point [m]
};

}  // namespace skerry
#pragma GCC visibility pop
