// All data that a world owns. Most functions of engine/world get only those parts of it that they access. Functions
// that run a whole step, or report about the whole world, get all of it. Systems (the functions in systems/) get spans
// of columns.
#pragma once

#include <cstdint>
#include <memory>
#include <string>
#include <vector>

#include "engine/world/edit/changed_places.h"
#include "engine/world/ranks/rank_state.h"
#include "engine/world/state/clock.h"
#include "engine/world/state/contact_cache.h"
#include "engine/world/state/model.h"
#include "engine/world/state/query_trees.h"
#include "engine/world/state/run_record.h"
#include "engine/world/state/step_scratch.h"
#include "engine/world/step/transaction.h"
#include "jobs/executor.h"
#include "jobs/task_graph.h"

namespace skerry {

/// Changes of a world that WorldState::settle has yet to complete.
struct OpenEdits {
    bool rows = false;  // true if bodies, colliders or attachments were added or removed
    // True if bodies with elements were added or removed, or nodes became held or free.
    bool elements = false;
    // For each row of BodyTable or ColliderTable: nonzero if it must be removed. Rows beyond the end of the list
    // remain.
    std::vector<std::uint8_t> removed_bodies, removed_colliders;
    ChangedPlaces places;
};

struct WorldState {
    explicit WorldState(const Settings& settings);

    Model model;
    Clock clock;
    ContactCache cache;
    StepScratch scratch;
    RunRecord record;
    RankState ranks;
    StepTransaction transaction;
    QueryTrees query_trees;
    std::unique_ptr<Executor> executor;
    TaskGraph graph;
    OpenEdits edits;
    bool advancing = false;  // true within advance(), when callbacks must not change the world
    // true if nodes that are only drawn (those of round bodies) are out of date; only within advance()
    bool drawn_behind = false;

    /// Throws SceneError if a callback of advance() makes the call `call`, or if the call is not allowed in a world
    /// divided among ranks. `call`: name of the called function, for the message.
    void require_between_steps(const char* call) const;
    /// Completes all pending changes: removes rows, computes derived columns of new rows, wakes sleeping bodies near
    /// the changes, and updates the nodes that draw round bodies. Call it as late as possible, so that many changes in
    /// succession are completed at once.
    ///
    /// Functions must call it first, even const ones, if they read all rows, return the contents of rows or ask which
    /// bodies sleep. Functions that only find a single row need not call it.
    void settle();
    /// Updates the nodes that draw round bodies, if they are out of date. `resting`: true if bodies fell asleep in the
    /// last step, so that nodes of sleeping bodies must be updated too.
    void draw(bool resting = false);

private:
    void erase_gone_rows();
};

/// Gives access to the state of a world, for tests and for functions that read or write whole worlds.
struct WorldAccess {
    static WorldState& state_of(World& world) {
        world.state_->settle();
        return *world.state_;
    }
    static const WorldState& state_of(const World& world) {
        world.state_->settle();
        return *world.state_;
    }
};

/// Returns a copy of a world. `source`: must have no pending changes (WorldState::settle); it is only read, so several
/// threads may copy one world at the same time. `load_settings`: backend and number of threads of the copy.
World copy_of_settled(const WorldState& source, const LoadSettings& load_settings);

/// Returns the name of the column or value at an address inside a WorldState, such as "nodes.velocity". The name is
/// used in messages.
std::string name_of_column(void* world, const void* address);

}  // namespace skerry
