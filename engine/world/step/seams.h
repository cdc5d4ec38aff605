// Seams along which a step is extended: force elements, motion models and constraint laws. The page of the step
// (step.cpp) walks the three lists and names no member of any.
#pragma once

#include <array>
#include <span>

#include "engine/world/world_state.h"
#include "jobs/stage_arguments.h"
#include "jobs/task_graph.h"

namespace skerry {

/// Adds stages to the graph of the step.
using ListStages = void (*)(WorldState&, TaskGraph&);

/// A force element: a force on nodes that is neither elastic nor a constraint. All bodies take its forces by their
/// nodes, however they move. Its forces count as work from outside in the balance of a run.
struct ForceElement {
    bool (*any)(const Model&);  // whether the world has one; without any, the stages of all are skipped
    ListStages add_forces;      // adds its forces at the start of the step to NodeTable::applied_force
    // For each body, adds a bound on the part of this element in the squares of its natural frequencies, which limits
    // the stable step [1/s^2]. Null: its forces do not depend on positions.
    void (*add_rate)(const Model&, std::span<Real> of_body) = nullptr;
};

/// A motion model: how the degrees of freedom of some bodies move in a step. Each member lists the stages of the model
/// in one phase of the step; null: it has none there.
struct MotionModel {
    ListStages add_forces = nullptr;  // adds the elastic forces at the positions of the start of the step
    ListStages predict = nullptr;     // computes the velocities at the end of the step, without contacts
    ListStages couple = nullptr;      // prepares the response of its bodies to contact impulses, beyond lumped masses
    ListStages apply = nullptr;       // moves inner degrees of freedom by the impulses of the solved regions
    ListStages find_pose = nullptr;   // computes the pose at the end of the step, so that checks see its velocities
    ListStages check = nullptr;       // checks the end of the step, and measures losses
    ListStages integrate = nullptr;   // moves the bodies, once the step can be taken
};

/// A constraint law: rows of the contact problem that all have the same kind of law. Each member lists the stages of
/// the law in one phase of the step; null: it has none there.
struct ConstraintLaw {
    ListStages find = nullptr;      // finds the rows of this step, with impulses to start from
    ListStages measure = nullptr;   // measures work, losses and errors of the solved rows
    ListStages check = nullptr;     // checks that the end of the step violates none of them
    ListStages remember = nullptr;  // keeps the impulses for the next step, once the step can be taken
};

extern const ForceElement nodal_loads;
extern const MotionModel explicit_nodes, node_clusters, rigid_bodies, implicit_bodies;
extern const ConstraintLaw contact_law, joint_law;

/// All force elements. The loads on nodes come first: their stage sets the sum that others add to.
inline constexpr std::array<const ForceElement*, 1> force_elements{&nodal_loads};
/// All motion models. The order matters where two of them write the same columns: frames of implicit bodies move as
/// rigid bodies do, so that rigid bodies come first.
inline constexpr std::array<const MotionModel*, 4> motion_models{&explicit_nodes, &node_clusters, &rigid_bodies,
                                                                 &implicit_bodies};
/// All constraint laws.
inline constexpr std::array<const ConstraintLaw*, 2> constraint_laws{&contact_law, &joint_law};

/// Guard of a stage that changes the state of the world: the step can be taken.
inline auto if_taken(const WorldState& world) {
    const StepFindings& found = world.scratch.findings;
    return only_if(can_be_taken, read(found.verdict), read(found.crossings), read(found.inversions),
                   value(world.scratch.parameters));
}
/// Guard of a stage that checks the end of the step: no fault was found so far.
inline auto if_possible(const WorldState& world) {
    return only_if([](const StepVerdict& verdict) { return verdict.fault == StepFault::none; },
                   read(world.scratch.findings.verdict));
}

}  // namespace skerry
