// Data that have another form in a file than in a world. They are converted before saving and after reading.
#pragma once

#include <map>
#include <string>

#include "components/ragged.h"
#include "engine/world/save/saved_file.h"
#include "engine/world/save/saved_sets.h"
#include "engine/world/save/saved_visuals.h"
#include "engine/world/world_state.h"

namespace skerry {

/// Meshes of bodies and colliders. Objects with equal meshes share one entry.
struct SavedMeshes {
    Column<Index> of_body;
    Ragged<Vec3> nodes;                       // rest positions [m]
    Ragged<std::array<Index, 4>> tetrahedra;  // corners as node numbers within the mesh
    Ragged<std::array<Index, 3>> surface;
    // offsets and items of BodyRecord::element_tetrahedra
    Ragged<Index> covered_offset, covered_item;
};

/// Overlaps found before the first step. Handles are stored as slot and generation.
struct SavedStart {
    // slot and generation of the first body, of the second body and of the collider
    Column<std::array<std::uint32_t, 6>> overlap;
    Column<OverlapKind> kind;
    Column<std::array<Real, 7>> measure;  // depth [m], direction (unit vector) and location [m] of the overlap
    Column<std::uint8_t> resolved;
    Ragged<std::uint8_t> first_name, second_name, moved_name;
    Column<std::array<std::uint32_t, 2>> moved;
    Column<Vec3> translation;  // [m]
};

/// Bodies whose surface was found to cross itself (WorldReport::self_crossings).
struct SavedSelfCrossings {
    Column<std::array<std::uint32_t, 2>> body;  // slot and generation
    Ragged<std::uint8_t> name;
    Column<std::uint8_t> self_contact;
    Column<std::array<Real, 2>> time;  // times of the first and of the last check that found a crossing [s]
    // number of crossings at the last check, and largest number so far
    Column<std::array<Index, 2>> places;
};

struct SavedRows {
    Real step_size = 0;  // value of Settings::step_size [s]; 0 if it is not set
    SavedMeshes meshes;
    std::uint32_t world = 0;  // world number that is part of all handles of this world
    Column<ElementKind> body_element, body_asked;
    Column<std::uint8_t> body_settled, collider_settled;
    Column<GivenMass> given_mass;
    Column<DynamicsReason> choice_reason;  // reason of BodyRecord::choice
    // all members of BodyRecord::choice except the reason, in the order of their declaration
    Column<std::array<Real, 7>> choice_estimate;
    Column<std::array<Real, 12>> body_start;  // BodyRecord::start: position [m], and columns of the rotation
    Column<std::array<Real, 9>> body_built;   // BodyRecord::built: columns of the rotation
    Ragged<Vec3> mesh_shape;                  // BodyRecord::mesh_shape [m]
    Ragged<Index> tetrahedron_material;       // BodyRecord::tetrahedron_material
    SavedSets sets;
    SavedVisuals visuals;
    Ragged<std::uint8_t> body_name, collider_name;  // UTF-8
    // by name of a table that for_each_joining visits: names of the objects in the table; empty text: no name
    std::map<std::string, Ragged<std::uint8_t>> object_name;
    Column<ColliderShape> shape_kind;  // by collider: index of the alternative of Shape
    // members of the shape in the order of their declaration, filled up with zeros
    Column<std::array<Real, 6>> shape_size;
    Ragged<Candidate> candidates;  // contact candidates of each pair
    Column<Real> asleep_until;     // PairTable::asleep_until, by candidate [m]
    Ragged<LeafPair> leaf_pairs;   // LeafPairTable::listed of each pair
    Column<StepLimit> limit;
    Column<std::uint32_t> limit_slot, limit_generation;
    Ragged<std::uint8_t> limit_name;
    Column<std::uint64_t> limit_steps, limit_tries;
    Column<Real> limit_seconds;
    SavedStart start;
    SavedSelfCrossings self_crossings;
    ContactTable contacts;  // contacts of the last step; empty if the step was refused
};

SavedRows rows_to_save(WorldState& world);

// The following functions throw SceneError with the name of `file` if saved data are inconsistent with each other or
// with the columns of the world.

/// Restores the meshes and the records of bodies and colliders, and the names of joints and other objects. Must be
/// called after the ranges of the bodies were checked.
void put_records(const SavedRows& saved, const SavedFile& file, Model& model);
/// Restores the contact candidates of pairs. Must be called after the surfaces were built.
void put_candidates(const SavedRows& saved, const SavedFile& file, const Model& model, PairTable& pairs);
void put_limits(const SavedRows& saved, const SavedFile& file, StepLimits& limits);
void put_start(const SavedRows& saved, const SavedFile& file, RunRecord& record);
void put_self_crossings(const SavedRows& saved, const SavedFile& file, RunRecord& record);

}  // namespace skerry
