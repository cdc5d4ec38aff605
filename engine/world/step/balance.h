// Balance of energy and momentum. The part lost or gained without a cause estimates the error of a run.
#pragma once

#include <cstdint>

#include "components/types.h"

namespace skerry {

struct Model;
struct StepScratch;

/// Sums since the last external change (a body added, velocities set, ...), and the worst errors of the whole run.
struct Balance {
    bool open = false;
    // false while a damped body is held, or an implicit element has a held node: the momentum that damping, or the
    // inertia of the element, takes from it is not measured
    bool momentum_known = true;
    std::uint64_t steps = 0;  // since the opening
    // at the opening
    Real energy = 0;                          // sum over moving nodes, elements and weights [J]
    Real potential = 0;                       // [J]
    Vec3 momentum = Vec3::Zero();             // sum over moving nodes [kg m/s]
    Vec3 impulse = Vec3::Zero();              // external impulse since the opening [N s]
    Real work = 0;                            // external work minus dissipation since the opening [J]
    Real energy_flow = 0, momentum_flow = 0;  // sums of magnitudes over steps, for each kind of impulse [J, N s]
    // the worst over the run
    Real energy_error = 0, energy_scale = 0;      // the scale is the largest energy available for exchange [J]
    Real momentum_error = 0, momentum_scale = 0;  // [kg m/s]

    void close() { open = false; }
};

/// Adds the energy and momentum that the step just committed exchanged with the outside.
void add_step(const StepScratch& step, Balance& balance);

/// Compares the present energy and momentum with the expected ones and records the difference if it is the worst so
/// far. Opens a balance that is closed. Walks all tables. `lag`: time by which velocities are older than positions [s].
/// Present forces bring the kinetic energy up to date.
void check_balance(const Model& model, Real lag, Balance& balance);

/// Returns the balance after check_balance, for a report; a closed balance is returned unchanged.
Balance checked_balance(const Model& model, Real lag, Balance balance);

}  // namespace skerry
