// Data that a file stores in another form than the world does: converted before the world is saved, and back after it
// is read.
#pragma once

#include <string>

#include "components/ragged.h"
#include "engine/hdf5/hdf5_file.h"
#include "engine/world/world_state.h"

namespace skerry {

/// Meshes of bodies and colliders. Equal meshes are stored once.
struct SavedMeshes {
    Column<Index> of_body;
    Ragged<Vec3> nodes;                       // rest positions [m]
    Ragged<std::array<Index, 4>> tetrahedra;  // nodes of the mesh
    Ragged<std::array<Index, 3>> surface;
    // parts of BodyRecord::element_tetrahedra
    Ragged<Index> covered_offset, covered_item;
};

/// Overlaps found before the first step. Handles are stored as slot and generation.
struct SavedStart {
    Column<std::array<std::uint32_t, 6>> overlap;  // the two bodies, the collider
    Column<OverlapKind> kind;
    Column<std::array<Real, 7>> measure;  // depth, direction, place [m]
    Column<std::uint8_t> resolved;
    Ragged<std::uint8_t> first_name, second_name, moved_name;
    Column<std::array<std::uint32_t, 2>> moved;
    Column<Vec3> translation;  // [m]
};

struct SavedRows {
    Real step_size = 0;  // Settings::step_size; 0: none [s]
    SavedMeshes meshes;
    std::uint32_t world = 0;  // number of the world in its handles
    Column<ElementKind> body_element, body_asked;
    Column<std::uint8_t> body_settled, collider_settled;
    Column<DynamicsReason> choice_reason;           // reason of BodyRecord::choice
    Column<std::array<Real, 7>> choice_estimate;    // other members of BodyRecord::choice in their order
    Ragged<Index> tetrahedron_material;             // BodyRecord::tetrahedron_material
    Ragged<std::uint8_t> body_name, collider_name;  // UTF-8
    Column<ColliderShape> shape_kind;               // alternative of Shape
    Column<std::array<Real, 6>> shape_size;         // members of the shape in their order, then zeros [m]
    Ragged<Candidate> candidates;                   // by pair
    Column<Real> asleep_until;                      // by candidate [m]
    Column<StepLimit> limit;
    Column<std::uint32_t> limit_slot, limit_generation;
    Ragged<std::uint8_t> limit_name;
    Column<std::uint64_t> limit_steps, limit_tries;
    Column<Real> limit_seconds;
    SavedStart start;
    ContactTable contacts;  // those of the last step; empty if it was refused
};

SavedRows rows_to_save(const WorldState& world);

// The functions below throw SceneError that names `file` if data do not fit the columns of the world or each other.
/// Restores meshes and names of bodies and colliders. Their ranges in the tables must have been checked.
void put_records(const SavedRows& saved, const Hdf5File& file, Model& model);
/// Restores candidates of pairs. Surfaces must have been built.
void put_candidates(const SavedRows& saved, const Hdf5File& file, const Model& model, PairTable& pairs);
void put_limits(const SavedRows& saved, const Hdf5File& file, StepLimits& limits);
void put_start(const SavedRows& saved, const Hdf5File& file, RunRecord& record);

}  // namespace skerry
