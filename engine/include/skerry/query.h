// Questions to the surfaces of a world as they are now: World::cast_ray, World::nearest_point.
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "components/handle.h"
#include "components/types.h"

#pragma GCC visibility push(default)
namespace skerry {

/// What a query looks at.
struct QueryFilter {
    bool bodies = true;
    bool colliders = true;
    std::uint32_t groups = 0xffffffffu;  // only what is in one of these collision groups
    std::vector<BodyHandle> except_bodies{};
    std::vector<ColliderHandle> except_colliders{};
};

/// A point of the surface of a body or a collider.
struct SurfaceHit {
    BodyHandle body{};          // the body, or a stale handle where it is a collider
    ColliderHandle collider{};  // the collider, or a stale handle
    // of World::surface, or of the mesh of a collider; -1 of an analytic one
    Index triangle = -1;
    std::array<Real, 3> barycentric{};  // weights of the corners of that triangle, in [0, 1], their sum 1
    Vec3 point = Vec3::Zero();          // m
    Vec3 normal = Vec3::Zero();         // unit, outwards: of the triangle, or of the shape
    Real distance = 0;                  // m, from the origin of the ray, or from the point that was asked about
};

}  // namespace skerry
#pragma GCC visibility pop
