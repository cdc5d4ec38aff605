// One row per spring: a spring and a damper between two anchors (docs/methods/springs.md).
#pragma once

#include <cstdint>
#include <span>

#include "components/anchor.h"
#include "components/column.h"
#include "components/column_role.h"
#include "components/key_lists.h"
#include "components/spring_side.h"
#include "components/types.h"

namespace skerry {

/// Inverse mass of an anchor: the change of its velocity per unit impulse on it. Node n has the mass m_n, the weight
/// w_n in the anchor, and d_n dampers that act on it.
struct AnchorMass {
    Real inverse = 0;  // sum of w_n^2 / m_n; 0 if the anchor is not on a deformable body [1/kg]
    // Sum of d_n w_n^2 / m_n: the value of `inverse` for one damper if each node divides its mass equally among its
    // dampers [1/kg].
    Real divided = 0;
    // Number of dampers that act on the body of the anchor, if it is rigid or implicit; else 0. The mass of the body is
    // divided among them.
    Index dampers = 0;
};

/// Force of a spring in the present step.
struct SpringForce {
    Vec3 force = Vec3::Zero();    // force on the first anchor [N]
    Vec3 damping = Vec3::Zero();  // part of `force` that the damper exerts [N]
    Real tension = 0;             // force that pulls the anchors together; negative if it pushes them apart [N]
    Real elastic = 0;             // part of `tension` that the spring exerts [N]
    Real rest_rate = 0;           // rate of change of the rest length [m/s]
};

struct SpringTable {
    Column<std::uint32_t> slot;
    Column<SpringSide> side;
    AnchorColumns first, second;
    Column<Real> stiffness;     // [N/m]
    Column<Real> damping;       // [N s/m]
    Column<Real> strength;      // upper limit of the magnitude of the force [N]
    Column<Range> rest_length;  // range of rows in the column `key`
    // The four columns `force` to `rest_rate` describe the last step. They affect reports and the energy balance, but
    // no later step.
    Column<Vec3> force;  // force on the first anchor [N]
    // force that pulls the anchors together; `tension`: spring and damper together, `elastic`: the spring alone [N]
    Column<Real> tension, elastic;
    Column<Real> rest_rate;                      // rate of change of the rest length [m/s]
    Column<AnchorMass> first_mass, second_mass;  // inverse masses of both anchors, derived by weigh_springs
    // For an anchor on an implicit body: velocity of the anchor per unit impulse on the anchor, as far as it is due to
    // the deformation of the body in this step [1/kg]. Zero for other anchors. Written by respond_at_anchors.
    Column<Mat3> first_response, second_response;
    Column<SpringForce> next;  // forces in the present step, written by add_spring_forces
    Column<TimeKey> key;       // rest lengths of all springs [m]

    std::size_t size() const { return slot.size(); }

    std::span<const TimeKey> keys_of(std::size_t spring) const { return rows_of(key.span(), rest_length[spring]); }
    void erase_keys_of(std::size_t spring) { erase_keys(rest_length, key, spring); }

    /// Visits the columns with one row per spring. The column `key` is visited by for_each_column only.
    void for_each_row_column(auto&& visit) {
        visit("slot", slot, ColumnRole::state);
        visit("side", side, ColumnRole::state);
        first.for_each_column({"first_body", "first_collider", "first_point"}, visit);
        second.for_each_column({"second_body", "second_collider", "second_point"}, visit);
        visit("stiffness", stiffness, ColumnRole::state);
        visit("damping", damping, ColumnRole::state);
        visit("strength", strength, ColumnRole::state);
        visit("rest_length", rest_length, ColumnRole::link);
        visit("force", force, ColumnRole::memory);
        visit("tension", tension, ColumnRole::memory);
        visit("elastic", elastic, ColumnRole::memory);
        visit("rest_rate", rest_rate, ColumnRole::memory);
        visit("first_mass", first_mass, ColumnRole::derived);
        visit("second_mass", second_mass, ColumnRole::derived);
        visit("first_response", first_response, ColumnRole::scratch);
        visit("second_response", second_response, ColumnRole::scratch);
        visit("next", next, ColumnRole::scratch);
    }
    void for_each_column(auto&& visit) {
        for_each_row_column(visit);
        visit("key", key, ColumnRole::state);
    }
};

}  // namespace skerry
