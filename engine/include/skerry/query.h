// Queries of the present surfaces of a world: World::cast_ray, World::nearest_point.
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
    bool bodies = true;
    bool colliders = true;
    std::uint32_t groups = 0xffffffffu;  // only bodies and colliders in one of these collision groups
    std::vector<BodyHandle> except_bodies{};
    std::vector<ColliderHandle> except_colliders{};
};

/// A point on the surface of a body or a collider.
struct SurfaceHit {
    BodyHandle body{};          // the body; a stale handle if the surface is that of a collider
    ColliderHandle collider{};  // the collider; a stale handle if the surface is that of a body
    // triangle of World::surface, or of the mesh of a collider; -1 for analytic colliders and round rigid bodies
    Index triangle = -1;
    std::array<Real, 3> barycentric{};  // weights of the triangle's corners, in [0, 1], their sum 1
    Vec3 point = Vec3::Zero();          // [m]
    Vec3 normal = Vec3::Zero();         // outward unit normal of the triangle or the shape
    Real distance = 0;                  // from the origin of the ray, or from the queried point [m]
};

}  // namespace skerry
#pragma GCC visibility pop
