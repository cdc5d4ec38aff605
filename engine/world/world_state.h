// Everything a world owns. A function of engine/world takes the parts that it may see; only what runs a whole step, or
// answers for the whole world, takes all of it. Systems get spans of the columns.
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

/// What has changed since the world was settled.
struct OpenEdits {
    bool rows = false;      // bodies, colliders or attachments came or went
    bool elements = false;  // bodies with elements did, or nodes lost or got their freedom
    std::vector<std::uint8_t> bodies_gone, colliders_gone;  // by row, not 0: gone; rows beyond the end are there
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
    bool advancing = false;     // what it calls back must not change what it goes over
    bool drawn_behind = false;  // nodes that only draw round bodies are behind: within advance alone

    /// Refuses a call from what advance calls back.
    void require_between_steps(const char* call) const;
    /// Takes out what is gone, derives what is new, wakes what rests beside either. It is left until somebody needs
    /// it, so that many changes in a row cost it once. Called by whatever goes over all rows, hands out what lies in
    /// them or asks who rests, functions that only look included; one row is found without. Draws round bodies, too.
    void settle();
    /// Puts what only draws round bodies where it belongs; `resting`: some came to rest in the last step.
    void draw(bool resting = false);

private:
    void erase_gone_rows();
};

/// For what stands beside World: tests, and what reads and writes whole worlds.
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

/// What lies at a place in a WorldState, for messages: "nodes.velocity".
std::string name_of_column(void* world, const void* place);

}  // namespace skerry
