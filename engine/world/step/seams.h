// Interfaces for extensions of a step: force elements, motion models and constraint laws. For each of these three
// kinds, step.cpp iterates over one list and names none of its entries.
#pragma once

#include <array>
#include <span>

#include "engine/world/world_state.h"
#include "jobs/stage_arguments.h"
#include "jobs/task_graph.h"

namespace skerry {

/// A function that adds stages to the graph of the step.
using ListStages = void (*)(WorldState&, TaskGraph&);

/// A force element: a force on nodes that is neither an elastic force of a body nor a constraint. It can act on bodies
/// of every motion model. The energy balance of a run counts the work of its forces as external work, unless the
/// element has a function `energy`. All members after add_forces may be null.
struct ForceElement {
    // Returns whether the world has at least one object of this kind, for example a spring. If it has none of any kind,
    // the stages of all force elements are skipped.
    bool (*any)(const Model&);
    ListStages add_forces;  // adds forces to NodeTable::applied_force at the start of the step
    // Computes derived columns. It is called after force elements, or bodies on which they act, have changed.
    void (*derive)(Model&) = nullptr;
    // For each body, adds an upper bound of the contribution of this force element to the squared natural frequencies
    // of the body [1/s^2]. This bound limits the stable step. The pointer is null if the forces do not depend on
    // positions.
    void (*add_rate)(Model&, std::span<Real> of_body) = nullptr;
    bool rate_moves = false;  // true: the bound depends on positions, and is computed again before each step
    // For each body, raises the entry of `of_body` to a rate r if it is lower [1/s]: in a step of length h, the dampers
    // of this force element reduce no node velocity below exp(-r h) times its value. This rate limits the stable step.
    void (*bound_damping)(const Model&, std::span<Real> of_body) = nullptr;
    // For each body, adds the rate c of drag forces -c m v on its nodes with the mass m and the velocity v [1/s]. These
    // forces limit the stable step too, because they are computed with the velocities at the start of the step.
    void (*add_drag)(const Model&, std::span<Real> of_body) = nullptr;
    // marks in StepScratch::driven the bodies that must be awake, because the force on them changes with time
    ListStages mark_driven = nullptr;
    // Returns true if the forces change with time in the step of length `h` [s] that starts at time `t` [s], even if no
    // body moves.
    bool (*is_driven)(const Model&, Real t, Real h) = nullptr;
    // measures the work and the losses of these forces, which the balance subtracts from the external work
    ListStages measure = nullptr;
    ListStages remember = nullptr;  // stores results for the next step, if the step can be committed
    // Stored energy at the time `t` [s], with a correction if velocities are `lag` seconds older than positions [J].
    // spring_energy (systems/forces/springs.h) is an example.
    Real (*energy)(const Model&, Real t, Real lag) = nullptr;
};

/// Factor on the stiffness of a force whose law has a kink, in its contribution to ForceElement::add_rate. It makes the
/// stable step of the force three times shorter, because motion across a kink gains energy. Kinks are the rest length
/// of a one-sided spring, and the pressure at which a liquid boils.
///
/// A mass that bounces on a one-sided spring leaves it with 3.4 times its energy at the stable step of the linear law,
/// and with 1.004 times at a third of this step (symplectic Euler, mean over all phases of the impact).
inline constexpr Real kink_factor = 9;

/// A motion model: the rule by which the degrees of freedom of some bodies move in a step. Each member is a function
/// that lists the stages of the model in one phase of the step. A null pointer means that the model has no stages in
/// this phase.
struct MotionModel {
    ListStages add_forces = nullptr;  // adds the elastic forces for the positions at the start of the step
    ListStages predict = nullptr;     // computes the velocities at the end of the step, without contacts
    // prepares the response of bodies to contact impulses, if the nodes of a body do not respond as single masses
    ListStages couple = nullptr;
    // lets the contact impulses that the solver has found act on internal degrees of freedom
    ListStages apply = nullptr;
    ListStages find_pose = nullptr;  // computes the pose at the end of the step, before the checks
    ListStages check = nullptr;      // checks the state at the end of the step, and measures losses
    ListStages integrate = nullptr;  // moves the bodies if the step can be committed
};

/// A constraint law: one kind of rows (equations or inequalities) of the contact problem. Each member is a function
/// that lists the stages of the law in one phase of the step. A null pointer means that the law has no stages in this
/// phase.
struct ConstraintLaw {
    ListStages find = nullptr;      // finds the rows of this step and the impulses with which the solver starts
    ListStages take = nullptr;      // removes rows that were in the contact table only for the solve
    ListStages measure = nullptr;   // measures work, losses and errors of the rows after the solve
    ListStages check = nullptr;     // checks that no constraint is violated at the end of the step
    ListStages remember = nullptr;  // stores the impulses for the next step, if the step can be committed
};

extern const ForceElement nodal_loads, cable_forces, cavity_pressures, fibre_forces, loads_and_fields, spring_forces;
extern const MotionModel explicit_nodes, node_clusters, rigid_bodies, implicit_bodies, held_axes;
extern const ConstraintLaw contact_law, joint_law, tie_law, cable_law, held_axes_law;

/// All force elements. Nodal loads come first: their stage overwrites NodeTable::applied_force, and the stages of all
/// other force elements add to it.
inline constexpr std::array<const ForceElement*, 6> force_elements{&nodal_loads,  &loads_and_fields, &spring_forces,
                                                                   &cable_forces, &cavity_pressures, &fibre_forces};
/// All motion models, in an order that matters where two of them write the same columns:
/// - rigid_bodies comes before implicit_bodies, because it also moves the frames relative to which implicit bodies
///   deform.
/// - held_axes (nodes held along single directions) comes last, because it corrects the velocities of other models.
inline constexpr std::array<const MotionModel*, 5> motion_models{&explicit_nodes, &node_clusters, &rigid_bodies,
                                                                 &implicit_bodies, &held_axes};
/// All constraint laws. Contacts come before ties, like their rows in the contact table. Held axes come last, because
/// they have rows for nodes that other rows touch. `take` is called in the reverse order, so that each law finds its
/// rows at the end of the table.
inline constexpr std::array<const ConstraintLaw*, 5> constraint_laws{&contact_law, &joint_law, &tie_law, &cable_law,
                                                                     &held_axes_law};

/// Condition of a stage that changes the state of the world: the stage runs only if the step can be committed.
inline auto if_taken(const WorldState& world) {
    const StepFindings& found = world.scratch.findings;
    return only_if(can_be_taken, read(found.verdict), read(found.crossings), read(found.inversions),
                   value(world.scratch.parameters));
}
/// Condition of a stage that lets bodies fall asleep or wake: the stage runs only if the settings allow sleep.
inline auto if_sleepy(const WorldState& world) {
    return only_if([](const SleepSettings& sleep) { return sleep.on(); }, value(world.scratch.parameters.sleep));
}
/// Condition of a stage that checks the end of the step: the stage runs only if no fault has been found so far.
inline auto if_possible(const WorldState& world) {
    return only_if([](const StepVerdict& verdict) { return verdict.fault == StepFault::none; },
                   read(world.scratch.findings.verdict));
}

}  // namespace skerry
