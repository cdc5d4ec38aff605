#include "systems/collision/contact_rows.h"

#include <utility>

#include "systems/collision/cylinders/rigid_cylinder.h"
#include "systems/collision/inputs/contact_key.h"

namespace skerry {

PairData::PairData(const CollisionInputs& all_inputs, const PairTable& pairs, Index p)
    : inputs(all_inputs),
      key(pairs.key[p]),
      kind(pairs.kind[p]),
      first(pairs.first[p]),
      second(pairs.second[p]),
      state(pairs.state[p]),
      scale(pair_scale(inputs, kind, first, second)),
      surface(pair_surface(inputs, kind, first, second)),
      travel(pairs.travel[p]),
      candidates(pairs.candidates[p].span()) {
    if (!is_cylinder(inputs, first) && has_cylinder(inputs, pairs, p)) std::swap(first, second);
}

ContactRow contact_row(const PairData& pair, std::uint64_t feature, ContactKind kind, const Stencil& stencil,
                       const ContactGeometry& geometry) {
    const BodyTable& body = pair.inputs.body;
    ContactRow row{.key = {pair.key, feature},
                   .kind = kind,
                   .stencil = stencil,
                   .point = geometry.point,
                   .normal = geometry.normal,
                   .gap = geometry.distance - geometry.contact_distance,
                   .distance = geometry.distance,
                   .surface_velocity = geometry.surface_velocity,
                   .static_friction = pair.surface.static_friction,
                   .dynamic_friction = pair.surface.dynamic_friction,
                   .restitution = pair.surface.restitution,
                   .first_body = pair.first,
                   .second_body = pair.second_body(),
                   .collider = pair.kind == PairKind::collider ? pair.second : body.collider[pair.second]};
    if (is_cylinder(pair.inputs, pair.first)) return row;
    if (kind == ContactKind::point_triangle && is_point_of_second(feature)) std::swap(row.first_body, row.second_body);
    const Real first_radius = body.round_radius[row.first_body],
               second_radius = row.second_body == no_index ? 0 : body.round_radius[row.second_body];
    row.point += second_radius * geometry.normal;
    row.distance -= first_radius + second_radius;
    return row;
}

std::uint64_t feature_of_touch(const PairData& pair, std::uint64_t feature, Index number) {
    const Index other = pair.second_body();
    const bool has_faces = other != no_index && pair.inputs.body.core_nodes[other] == 0;
    const Index numbers = has_faces ? touches_of_triangle : touches_of_shape;
    return (feature & ~local_mask) | static_cast<std::uint64_t>(numbers * second_local(feature) + number);
}

Stencil stencil_of_point(const std::array<Index, 4>& node, const std::array<Real, 3>& weight) {
    Stencil stencil{{node[0], node[0], node[0], node[0]}, {1, 0, 0, 0}};
    for (std::size_t k = 0; k < 3; ++k) {
        if (weight[k] == 0) continue;
        stencil.node[k + 1] = node[k + 1];
        stencil.weight[k + 1] = -weight[k];
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
