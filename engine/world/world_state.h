// All state that a world owns. A function of engine/world takes only the parts that it may access. Functions that run a
// whole step, or answer for the whole world, take all of it. Systems get spans of the columns.
#pragma once

#include <cstdint>
#include <memory>
#include <string>
#include <vector>

#include "engine/world/edit/changed_places.h"
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

/// Changes since the last call of WorldState::settle.
struct OpenEdits {
    bool rows = false;                                      // bodies, colliders or attachments were added or removed
    bool elements = false;                                  // bodies with elements were, or nodes became held or free
    std::vector<std::uint8_t> bodies_gone, colliders_gone;  // by row, nonzero: gone; rows beyond the end are present
    ChangedPlaces places;
};

struct WorldState {
    explicit WorldState(const Settings& settings);

    Model model;
    Clock clock;
    ContactCache cache;
    StepScratch scratch;
    RunRecord record;
    StepTransaction transaction;
    QueryTrees query_trees;
    std::unique_ptr<Executor> executor;
    TaskGraph graph;
    OpenEdits edits;
    bool advancing = false;     // true within advance(): its callbacks must not change the world
    bool drawn_behind = false;  // nodes that only draw round bodies are out of date; only within advance()

    /// Throws if the call comes from a callback of advance().
    void require_between_steps(const char* call) const;
    /// Removes rows that are gone, computes derived columns of new rows, wakes bodies that rest beside either, and
    /// draws round bodies. It is deferred until it is needed, so that many changes in a row cost it once. Every
    /// function that walks all rows, returns their contents or asks which bodies rest calls it, const ones too. Finding
    /// one row does not.
    void settle();
    /// Updates the nodes that only draw round bodies. `resting`: some bodies came to rest in the last step.
    void draw(bool resting = false);

private:
    void erase_gone_rows();
};

/// Access for code beside World: tests, and functions that read and write whole worlds.
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

/// Name of the column or value at an address inside a WorldState, for messages: "nodes.velocity".
std::string name_of_column(void* world, const void* place);

}  // namespace skerry
