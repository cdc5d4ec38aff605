// All data of some bodies. Bodies move between the ranks of a divided world in this form.
#pragma once

#include <cstdint>
#include <functional>
#include <span>
#include <vector>

#include "engine/world/world_state.h"

namespace skerry {

/// Members of StepWatch with the progress of the stable-step checks. `body` and `kept` are rows of the BodyTable in
/// BodyRows::model.
struct WatchProgress {
    Index body = 0, kept = 0;
    StepEvaluation evaluation;
};

/// Entry of WorldReport::self_crossings, without the name.
struct FoundSelfCrossing {
    std::uint32_t slot = no_slot;  // slot of the handle of the body
    bool self_contact = false;
    Real first_time = 0, last_time = 0;  // [s]
    Index last_places = 0, most_places = 0;
};

/// Rows of bodies, of their attachments, and of the tables that join bodies (Model::for_each_joining). No row refers to
/// any other body. Handles, colliders and materials are not included, because every rank has them.
struct BodyRows {
    Model model;                  // only these rows, node clusters and the columns of StepWatch
    Column<Index> world_row;      // by row of BodyTable: row in the undivided world
    Column<WatchProgress> watch;  // a single row, stored as a column because message_of() sends only columns
    Column<Real> valid_until;     // SearchState::body_valid_until
    WarmStartTable warm_start;
    RestingContactTable resting;
    PairTable pairs;        // pairs whose surfaces intersect, without candidates
    ContactTable contacts;  // contacts of the last step
    Column<FoundSelfCrossing> self_crossings;
    Column<std::uint64_t> enabled_pairs;  // RankState
    // Records by row of BodyTable. Empty in a message to rank 0, which keeps the records of all bodies.
    std::vector<BodyRecord> records;
};

/// Selects pairs by their key `pair` (ContactKey::pair). rows_of_bodies copies the contact data of the pairs for which
/// it returns true, and replace_rows keeps the contact data of these pairs.
using WantsPair = std::function<bool(std::uint64_t pair)>;

/// Returns copies of the rows of marked bodies. The world must have no pending changes (WorldState::settle). If a body
/// is marked, all bodies of its unit, to which joints or similar rows connect it (WholeWorld::unit), must be marked.
/// `marked`: by row of BodyTable.
BodyRows rows_of_bodies(WorldState& world, std::span<const std::uint8_t> marked, const WantsPair& wants_pair);
/// Adds the records of the marked bodies to their rows. Rows for rank 0 need none, because rank 0 keeps all records.
void copy_records(const Model& model, std::span<const std::uint8_t> marked, BodyRows& to);

/// Removes all bodies that are not marked in `kept`, and adds bodies. The world must have no pending changes. Removes
/// contact data of all pairs for which `keeps_pair` is false. Changes no other state and wakes no body. Afterwards the
/// rows of all tables are in the order of the undivided world, and `added` is empty.
void replace_rows(WorldState& world, std::span<const std::uint8_t> kept, std::span<BodyRows> added,
                  const WantsPair& keeps_pair);

/// Binary message with all columns of the rows. Only the same program can read it.
RankMessage message_of(BodyRows& rows);
/// Reads a message of message_of.
BodyRows rows_of_message(std::span<const std::byte> message);

}  // namespace skerry
