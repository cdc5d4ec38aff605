#include "systems/collision/contact_rows.h"

#include <utility>

#include "systems/collision/inputs/contact_key.h"

namespace skerry {

ContactRow contact_row(const CollisionInputs& inputs, const ContactPair& pair, const Candidate& candidate,
                       ContactKind kind, const Stencil& stencil, const Vec3& point, const Vec3& normal, Real distance,
                       Real contact_distance, const SurfaceProperties& surface) {
    const bool turned = kind == ContactKind::point_triangle && is_point_of_second(candidate.feature);
    const bool collider = pair.kind == PairKind::collider;
    ContactRow row;
    row.key = {pair.key, candidate.feature};
    row.kind = kind;
    row.stencil = stencil;
    row.normal = normal;
    row.gap = distance - contact_distance;
    row.surface_velocity = Vec3::Zero();
    row.static_friction = surface.static_friction;
    row.dynamic_friction = surface.dynamic_friction;
    row.restitution = surface.restitution;
    row.first_body = turned ? pair.second : pair.first;
    row.second_body = collider ? no_index : turned ? pair.first : pair.second;
    row.collider = collider ? pair.second : inputs.body.collider[pair.second];
    const Real of_first = inputs.body.round_radius[row.first_body],
               of_second = collider ? 0 : inputs.body.round_radius[row.second_body];
    row.point = point + of_second * normal;
    row.distance = distance - (of_first + of_second);
    return row;
}

Stencil stencil_of_point(const std::array<Index, 4>& node, const PointTriangle& closest) {
    Stencil stencil{{node[0], node[0], node[0], node[0]}, {1, 0, 0, 0}};
    for (std::size_t k = 0; k < 3; ++k) {
        if (closest.weight[k] == 0) continue;
        stencil.node[k + 1] = node[k + 1];
        stencil.weight[k + 1] = -closest.weight[k];
    }
    return stencil;
}

Stencil stencil_of_edges(const std::array<Index, 4>& node, const SegmentSegment& closest) {
    Stencil stencil{node, {1 - closest.s, closest.s, -(1 - closest.t), -closest.t}};
    if (stencil.weight[0] == 0) {
        std::swap(stencil.node[0], stencil.node[1]);
        std::swap(stencil.weight[0], stencil.weight[1]);
    }
    for (std::size_t a = 1; a < 4; ++a)
        if (stencil.weight[a] == 0) stencil.node[a] = stencil.node[0];
    return stencil;
}

void merge_rows(const std::vector<Column<ContactRow>>& blocks, const Column<ContactRow>& more, bool prefer_blocks,
                Column<ContactRow>& merged) {
    merged.clear();
    std::size_t next = 0;
    for (const auto& block : blocks)
        for (const ContactRow& row : block) {
            for (; next < more.size() && more[next].key < row.key; ++next) merged.push_back(more[next]);
            const bool both = next < more.size() && more[next].key == row.key;
            merged.push_back(both && !prefer_blocks ? more[next] : row);
            next += both;
        }
    for (; next < more.size(); ++next) merged.push_back(more[next]);
}

}  // namespace skerry
