#include "systems/collision/cylinders/cylinder_row.h"

#include <utility>

#include "systems/collision/inputs/contact_key.h"

namespace skerry {

CylinderPair::CylinderPair(const CollisionInputs& inputs, const PairTable& pairs, Index p)
    : key(pairs.key[p]), kind(pairs.kind[p]), cylinder(pairs.first[p]), other(pairs.second[p]) {
    if (kind != PairKind::collider && !is_cylinder(inputs, cylinder)) std::swap(cylinder, other);
}

bool has_cylinder(const CollisionInputs& inputs, const PairTable& pairs, Index p) {
    return is_cylinder(inputs, pairs.first[p]) ||
           (pairs.kind[p] != PairKind::collider && is_cylinder(inputs, pairs.second[p]));
}

ContactRow contact_row(const CollisionInputs& inputs, const CylinderPair& pair, const CylinderRow& row,
                       const SurfaceProperties& surface) {
    const Index other = pair.body();
    const bool has_faces = other != no_index && inputs.body.core_nodes[other] == 0;
    const Index numbers = has_faces ? touches_of_triangle : touches_of_shape;
    ContactRow found;
    found.key = {pair.key, (row.feature & ~local_mask) |
                               static_cast<std::uint64_t>(numbers * second_local(row.feature) + row.number)};
    found.kind = pair.kind == PairKind::collider ? ContactKind::point_collider : ContactKind::point_triangle;
    found.stencil = row.stencil;
    found.point = row.point;
    found.normal = row.normal;
    found.gap = row.distance - row.shell;
    found.distance = row.distance;
    found.surface_velocity = row.surface_velocity;
    found.static_friction = surface.static_friction;
    found.dynamic_friction = surface.dynamic_friction;
    found.restitution = surface.restitution;
    found.first_body = pair.cylinder;
    found.second_body = other;
    found.collider = pair.kind == PairKind::collider ? pair.other : inputs.body.collider[other];
    return found;
}

Stencil stencil_of_cylinder(Index middle, const std::array<Index, 3>& node, const std::array<Real, 3>& weight) {
    Stencil stencil{{middle, middle, middle, middle}, {1, 0, 0, 0}};
    for (std::size_t k = 0; k < 3; ++k) {
        if (weight[k] == 0) continue;
        stencil.node[k + 1] = node[k];
        stencil.weight[k + 1] = -weight[k];
    }
    return stencil;
}

}  // namespace skerry
