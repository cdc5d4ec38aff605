// What a file holds that lies in a world otherwise than in columns: made from the world before it is saved, and put
// into it after it is read.
#pragma once

#include <string>

#include "components/ragged.h"
#include "engine/hdf5/hdf5_file.h"
#include "engine/world/world_state.h"

namespace skerry {

/// Meshes of bodies and colliders, each once: equal ones are one.
struct SavedMeshes {
    Column<Index> of_body;
    Ragged<Vec3> nodes;                       // m, at rest
    Ragged<std::array<Index, 4>> tetrahedra;  // nodes of the mesh
    Ragged<std::array<Index, 3>> surface;
    // of BodyRecord::element_tetrahedra
    Ragged<Index> covered_offset, covered_item;
};

/// What was found before the first step. Handles as slot and generation.
struct SavedStart {
    Column<std::array<std::uint32_t, 6>> overlap;  // the two bodies, the collider
    Column<OverlapKind> kind;
    Column<std::array<Real, 7>> measure;  // m, depth; direction; place
    Column<std::uint8_t> resolved;
    Ragged<std::uint8_t> first_name, second_name, moved_name;
    Column<std::array<std::uint32_t, 2>> moved;
    Column<Vec3> translation;  // m
};

struct SavedRows {
    Real step_size = 0;  // s, of the settings; 0: none
    SavedMeshes meshes;
    std::uint32_t world = 0;  // the number that handles bear
    Column<ElementKind> body_element, body_asked;
    Column<std::uint8_t> body_settled, collider_settled;
    Column<DynamicsReason> choice_reason;           // of BodyRecord::choice, and
    Column<std::array<Real, 7>> choice_estimate;    // its members in their order
    Ragged<Index> tetrahedron_material;             // of BodyRecord
    Ragged<std::uint8_t> body_name, collider_name;  // UTF-8
    Column<ColliderShape> shape_kind;               // the alternative of Shape, and
    Column<std::array<Real, 6>> shape_size;         // m, its members in their order, then zeros
    Ragged<Candidate> candidates;                   // by pair
    Column<Real> asleep_until;                      // m, by candidate
    Column<StepLimit> limit;
    Column<std::uint32_t> limit_slot, limit_generation;
    Ragged<std::uint8_t> limit_name;
    Column<std::uint64_t> limit_steps, limit_tries;
    Column<Real> limit_seconds;
    SavedStart start;
    ContactTable contacts;  // of the last step, unless it was refused
};

SavedRows rows_to_save(const WorldState& world);

// Each complains by `file` about what does not fit to the columns of the world, or to itself.
/// Meshes and names of bodies and colliders. Their ranges in the tables must have been checked.
void put_records(const SavedRows& saved, const Hdf5File& file, Model& model);
/// Candidates of pairs, and what kept steps from being longer. Surfaces must have been built.
void put_candidates(const SavedRows& saved, const Hdf5File& file, const Model& model, PairTable& pairs);
void put_limits(const SavedRows& saved, const Hdf5File& file, StepLimits& limits);
void put_start(const SavedRows& saved, const Hdf5File& file, RunRecord& record);

}  // namespace skerry
