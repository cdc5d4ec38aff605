// Everything a world owns. A function of engine/world takes the parts that it may see; only what runs a whole step, or
// answers for the whole world, takes all of it. Systems get spans of the columns.
#pragma once

#include <memory>
#include <string>

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

/// What has come or gone: nothing, analytic colliders alone, or rows of nodes and elements, or their freedom.
enum class EditedRows { none, colliders, bodies };

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
    bool advancing = false;  // what it calls back must not change what it goes over

    /// Refuses a call from what advance calls back.
    void require_between_steps(const char* call) const;
    /// Before bodies, colliders or attachments come or go.
    void begin_edit(const char* call);
    /// After they did. What follows from all rows is left as it was until somebody needs it: many changes in a row cost
    /// it once.
    void end_edit(EditedRows rows);
    /// What follows from all rows, if these have changed: derived columns, pairs, who rests. Called by whatever reads
    /// any of it, functions that only look included.
    void settle();

private:
    EditedRows edited_ = EditedRows::none;  // since it was settled
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
