// What the collision stages read.
#pragma once

#include <cstdint>
#include <span>

#include "components/body_table.h"
#include "components/bvh_table.h"
#include "components/collider_table.h"
#include "components/material_table.h"
#include "components/surface_table.h"

namespace skerry {

struct CollisionInputs {
    const BodyTable& body;
    const ColliderTable& collider;
    const SurfaceTables& surface;
    std::span<const Real> inverse_mass;                   // by node
    std::span<const SurfaceProperties> material_surface;  // by material
    std::span<const BvhNode> bvh_node;
    std::span<const LeafTriangles> leaf_triangle;
    std::span<const Vec3> position;            // by node, start of the step
    std::span<const Vec3> velocity;            // by node, start of the step
    std::span<const Vec3> rest_position = {};  // by node; empty: self-contact has no rest shape to compare with
};

/// How far apart things are looked at, all in metres or metres per second.
struct CollisionSettings {
    Real gravity = 0;         // m/s^2, norm: how much faster things may become in a step
    Real pair_skin = 0.25;    // fraction of the mean edge: candidates are kept this much beyond the distance at which they matter
    Real broad_skin = 4.0;    // fraction of the mean edge: pairs of bodies are kept this much beyond it
    bool use_budgets = true;  // off: search everything in every step (the simple twin, for tests)
    bool continuous = true;   // off: the motion of a step is not looked at for crossings
};

}  // namespace skerry
