// Cavities, which are sets of faces of one body under one pressure, and pipes between cavities
// (docs/methods/cavities.md).
#pragma once

#include <array>
#include <cstdint>
#include <span>

#include "components/cavity_law.h"
#include "components/column.h"
#include "components/column_role.h"
#include "components/key_lists.h"
#include "components/range.h"
#include "components/row_type.h"
#include "components/types.h"

namespace skerry {

/// Constants of the filling of a cavity. A gas uses `ambient`, `density` and `exponent`, a liquid `ambient` and
/// `bulk_modulus`.
struct CavityFluid {
    Real ambient = 0;       // absolute pressure outside of the body [Pa]
    Real density = 0;       // density of the gas at ambient pressure [kg/m^3]
    Real exponent = 1;      // polytropic exponent of the gas
    Real bulk_modulus = 0;  // bulk modulus of the liquid [Pa]

    bool operator==(const CavityFluid&) const = default;
};
template <>
struct NumbersOf<CavityFluid> : Reals<4> {};

/// One row per cavity.
struct CavityTable {
    Column<std::uint32_t> slot;
    Column<Index> body;  // row of BodyTable
    Column<CavityLaw> law;
    Column<std::uint8_t> closed;  // 1: every edge of a face belongs to two faces of the cavity
    Column<Range> faces;          // rows of `face`
    // Rows of `key`, at least one. These keys prescribe one quantity over time. Law `pressure`: pressure above ambient
    // [Pa]. Law `gas`: flow of gas into the cavity [kg/s]. Law `liquid`: volume that the liquid has at ambient pressure
    // [m^3].
    Column<Range> keys;
    Column<CavityFluid> fluid;
    Column<Real> mass;  // mass of the gas [kg]
    // Volume at the end of the last step, for a cavity that is not closed; its faces then had the nodes at `corners`
    // [m^3]. The volume that the faces sweep afterwards is added to it. Unused if `closed` is 1 or the law is
    // `pressure`.
    Column<Real> volume;
    Column<Real> pressure_now;  // pressure above ambient in the last step [Pa]
    // Power that the forces of the last step exert on free nodes with their velocities after this step [W]; unused for
    // the law `pressure`.
    Column<Real> power;
    Column<Real> volume_now;  // volume at the start of this step [m^3]
    // The next columns have one row per face.
    Column<std::array<Index, 3>> face;  // node numbers in the mesh of the body
    // Columns of the matrix: positions of the three nodes at the end of the last step [m]. Unused if `closed` is 1 or
    // the law is `pressure`.
    Column<Mat3> corners;
    Column<Vec3> area;         // area times the normal that points from the body into the cavity, in this step [m^2]
    Column<Real> swept_parts;  // working memory of add_cavity_forces: swept volume of each group of faces [m^3]
    Column<TimeKey> key;       // keys of all cavities

    std::size_t size() const { return slot.size(); }

    std::span<const std::array<Index, 3>> faces_of(std::size_t row) const { return rows_of(face.span(), faces[row]); }
    std::span<const Mat3> corners_of(std::size_t row) const { return rows_of(corners.span(), faces[row]); }
    std::span<const TimeKey> keys_of(std::size_t row) const { return rows_of(key.span(), keys[row]); }
    /// Erases the keys and the faces of one cavity.
    void erase_keys_of(std::size_t row) {
        erase_keys(keys, key, row);
        const Range erased = faces[row];
        const auto begin = static_cast<std::size_t>(erased.begin), count = static_cast<std::size_t>(erased.size());
        face.erase(begin, count);
        corners.erase(begin, count);
        faces[row] = {};
        for (Range& other : faces)
            if (other.begin > erased.begin) other = {other.begin - erased.size(), other.end - erased.size()};
    }

    /// Visits the columns with one row per cavity.
    void for_each_row_column(auto&& visit) {
        visit("slot", slot, ColumnRole::state);
        visit("body", body, ColumnRole::body);
        visit("law", law, ColumnRole::state);
        visit("closed", closed, ColumnRole::state);
        visit("faces", faces, ColumnRole::link);
        visit("keys", keys, ColumnRole::link);
        visit("fluid", fluid, ColumnRole::state);
        visit("mass", mass, ColumnRole::state);
        visit("volume", volume, ColumnRole::state);
        visit("pressure_now", pressure_now, ColumnRole::state);
        visit("power", power, ColumnRole::state);
        visit("volume_now", volume_now, ColumnRole::scratch);
    }
    void for_each_column(auto&& visit) {
        for_each_row_column(visit);
        visit("face", face, ColumnRole::link);
        visit("corners", corners, ColumnRole::link);
        visit("area", area, ColumnRole::scratch);
        visit("swept_parts", swept_parts, ColumnRole::scratch);
        visit("key", key, ColumnRole::state);
    }
};

/// One row per pipe. A pipe connects two cavities that contain gas, or a cavity that contains gas and a reservoir of
/// prescribed pressure.
struct PipeTable {
    Column<std::uint32_t> slot;
    Column<Index> first_body, second_body;  // bodies of the cavities, rows of BodyTable; no_index for a reservoir
    Column<std::uint32_t> first, second;  // CavityTable::slot of the cavities; `second` equals `first` for a reservoir
    Column<Real> conductance;             // mass flow divided by the pressure difference [kg/(s Pa)]
    Column<Range> keys;                   // rows of `key`; empty without a reservoir
    Column<Real> flow;                    // mean mass flow in the last step, out of the first cavity [kg/s]
    Column<TimeKey> key;                  // pressures of the reservoirs above ambient [Pa]

    std::size_t size() const { return slot.size(); }
    std::span<const TimeKey> keys_of(std::size_t row) const { return rows_of(key.span(), keys[row]); }
    void erase_keys_of(std::size_t row) { erase_keys(keys, key, row); }

    /// Visits the columns with one row per pipe.
    void for_each_row_column(auto&& visit) {
        visit("slot", slot, ColumnRole::state);
        visit("first_body", first_body, ColumnRole::body);
        visit("second_body", second_body, ColumnRole::body);
        visit("first", first, ColumnRole::state);
        visit("second", second, ColumnRole::state);
        visit("conductance", conductance, ColumnRole::state);
        visit("keys", keys, ColumnRole::link);
        visit("flow", flow, ColumnRole::state);
    }
    void for_each_column(auto&& visit) {
        for_each_row_column(visit);
        visit("key", key, ColumnRole::state);
    }
};

}  // namespace skerry
