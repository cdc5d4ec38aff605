// Whether energy and momentum add up: what a run lost or won without a cause, as an estimate of its error.
#pragma once

#include <cstdint>

#include "components/types.h"

namespace skerry {

struct Model;
struct StepScratch;

/// Since the last change from outside (a body added, velocities set, ...), and the worst of all times before.
struct Balance {
    bool open = false;
    // false while a body that is damped is held, or by a node of an implicit element: what damping or the inertia of
    // the element takes from it is not measured
    bool momentum_known = true;
    std::uint64_t steps = 0;  // since the opening
    // at the opening
    Real energy = 0;                          // J, of moving nodes, elements and weights
    Real potential = 0;                       // J
    Vec3 momentum = Vec3::Zero();             // kg m/s, of moving nodes
    Vec3 impulse = Vec3::Zero();              // N s, from outside, since then
    Real work = 0;                            // J, from outside less what was dissipated, since then
    Real energy_flow = 0, momentum_flow = 0;  // sums of their sizes by step, J and N s: of impulses, of each kind
    // the worst over the run
    Real energy_error = 0, energy_scale = 0;      // J; the largest energy that was there to be exchanged
    Real momentum_error = 0, momentum_scale = 0;  // kg m/s

    void close() { open = false; }
};

/// Adds what the step just committed exchanged with the outside.
void add_step(const StepScratch& step, Balance& balance);

/// Compares what is with what ought to be, and notes the difference if it is the worst so far; opens a balance that is
/// closed. Walks all tables. `lag`: time by which velocities are older than positions [s]. Present forces bring the
/// kinetic energy up to date.
void check_balance(const Model& model, Real lag, Balance& balance);

/// The same for a report: the balance after such a check.
Balance checked_balance(const Model& model, Real lag, Balance balance);

}  // namespace skerry
