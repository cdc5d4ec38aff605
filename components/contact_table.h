// Contacts of this step, and their impulses, with which the solver starts in the next step (warm start).
#pragma once

#include <array>
#include <cstdint>

#include "components/column.h"
#include "components/column_role.h"
#include "components/row_type.h"
#include "components/types.h"

namespace skerry {

/// Kinds of contacts. The last three are contacts of a node, an edge or a face of a body with an analytic collider,
/// which is given by a formula, not by a mesh.
enum class ContactKind : std::uint8_t { point_triangle, edge_edge, point_collider, edge_collider, face_collider };
template <>
inline constexpr std::uint64_t value_count<ContactKind> = 5;
enum class ContactState : std::uint8_t { open, stick, slide };
template <>
inline constexpr std::uint64_t value_count<ContactState> = 3;

/// Identifies the two touching features across steps. Keys are unique in a world and stay valid when other bodies are
/// removed.
/// - `pair`: bits 63..62 are the kind (0: two bodies, 1: body and collider); then follow the two handle slots, 31 bits
///   each
/// - `feature`: bit 63 marks an edge-edge contact, bit 62 a point-triangle contact whose point belongs to the second
///   body; then follow the numbers of point and triangle, or of the two edges, within their bodies, 31 bits each
/// - `feature` of a contact with an analytic collider: bit 63 marks an edge, bit 62 a face of the body (contact_key.h)
struct ContactKey {
    std::uint64_t pair;
    std::uint64_t feature;

    auto operator<=>(const ContactKey&) const = default;
};
template <>
struct NumbersOf<ContactKey> : SameNumbers<NumberType::uint64, 2> {};

/// Nodes of a contact and their weights. The relative velocity at the contact is v = sum_a weight[a] u[node[a]] with
/// the node velocities u. Unused entries repeat node[0] with weight 0.
struct Stencil {
    std::array<Index, 4> node;  // rows of NodeTable
    std::array<Real, 4> weight;
};
template <>
struct MembersOf<Stencil> {
    static std::span<const Member> list();
};

/// Tangent of a contact along which its friction coefficients apply. In the tangent plane, perpendicular to this
/// direction, the coefficients are multiplied by `across`, in (0, 1]. If `across` is 1, friction is the same in all
/// directions.
struct FrictionAxis {
    Vec3 direction = Vec3::Zero();
    Real across = 1;
};
template <>
struct NumbersOf<FrictionAxis> : Reals<4> {};

/// One contact with all its fields. find_contacts writes it.
struct ContactRow {
    ContactKey key;
    ContactKind kind;
    Stencil stencil;
    Vec3 point;  // contact point on the second partner [m]
    // unit vector from the second partner of the contact to the first; the first partner is the object with the point,
    // or with the first edge
    Vec3 normal;
    Real gap;       // `distance` minus the contact distance [m]
    Real distance;  // signed distance of the two surfaces; negative if they overlap [m]
    // Velocity of an analytic collider at the contact point [m/s]; 0 for two bodies, whose velocities the stencil
    // gives.
    Vec3 surface_velocity;
    Real static_friction;
    Real dynamic_friction;
    Real restitution;
    Index first_body;   // row of BodyTable
    Index second_body;  // row of BodyTable, or no_index
    Index collider;     // row of ColliderTable, or no_index
};

/// One row per contact, in key order.
struct ContactTable {
    Column<ContactKey> key;
    Column<ContactKind> kind;
    Column<Stencil> stencil;
    Column<Vec3> point;
    Column<Vec3> normal;
    Column<Real> gap;
    Column<Real> distance;
    Column<Vec3> surface_velocity;
    Column<Real> static_friction;
    Column<Real> dynamic_friction;
    Column<Real> restitution;
    Column<FrictionAxis> friction_axis;
    Column<Index> first_body;
    Column<Index> second_body;
    Column<Index> collider;
    Column<Vec3> impulse;  // impulse on the first partner in the world frame; before the solve: the warm start [N s]
    Column<Index> region;  // row of RegionTable; no_index if no node of the contact can move
    Column<Vec3> slip;     // tangential relative velocity after the solve [m/s]
    Column<ContactState> state;

    void for_each_column(auto&& visit) {
        visit("key", key, ColumnRole::scratch);
        visit("kind", kind, ColumnRole::scratch);
        visit("stencil", stencil, ColumnRole::scratch);
        visit("point", point, ColumnRole::scratch);
        visit("normal", normal, ColumnRole::scratch);
        visit("gap", gap, ColumnRole::scratch);
        visit("distance", distance, ColumnRole::scratch);
        visit("surface_velocity", surface_velocity, ColumnRole::scratch);
        visit("static_friction", static_friction, ColumnRole::scratch);
        visit("dynamic_friction", dynamic_friction, ColumnRole::scratch);
        visit("restitution", restitution, ColumnRole::scratch);
        visit("friction_axis", friction_axis, ColumnRole::scratch);
        visit("first_body", first_body, ColumnRole::scratch);
        visit("second_body", second_body, ColumnRole::scratch);
        visit("collider", collider, ColumnRole::scratch);
        visit("impulse", impulse, ColumnRole::scratch);
        visit("region", region, ColumnRole::scratch);
        visit("slip", slip, ColumnRole::scratch);
        visit("state", state, ColumnRole::scratch);
    }
    std::size_t size() const { return key.size(); }
    void resize(std::size_t count) {
        for_each_column([count](const char*, auto& column, ColumnRole) { column.resize(count); });
    }
};

/// Impulses of the last step's contacts, in key order.
struct WarmStartTable {
    Column<ContactKey> key;
    Column<Vec3> impulse;  // [N s]
    Column<Vec3> normal;
    Column<Vec3> point;  // contact point [m]; empty if no body is rigid or implicit
    // Time for which forces acted in the step that computed `impulse` [s]. If forces act for another time in the
    // present step, the impulses are scaled by the ratio of the times. One row; no row if that step had no contacts.
    Column<Real> step;

    void for_each_column(auto&& visit) {
        visit("key", key, ColumnRole::state);
        visit("impulse", impulse, ColumnRole::state);
        visit("normal", normal, ColumnRole::state);
        visit("point", point, ColumnRole::state);
        visit("step", step, ColumnRole::state);
    }
};

}  // namespace skerry
