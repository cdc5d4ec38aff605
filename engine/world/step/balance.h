// Balance of energy and momentum in a run. A change of energy or momentum that no measured work or impulse explains is
// an estimate of the error.
#pragma once

#include <cstdint>

#include "components/types.h"

namespace skerry {

struct Model;
struct StepScratch;
struct WorldState;

/// Balance of energy and momentum: sums since the balance was opened, and the largest errors of the whole run. A change
/// from outside, such as an added body or set velocities, closes the balance. The next check opens it again with the
/// present energy and momentum.
struct Balance {
    bool open = false;
    // False if held nodes may get momentum that is not measured: by damping, if a damped body was held when the balance
    // was opened, or by the inertia of an implicit element to which a held node has belonged since then.
    bool momentum_known = true;
    std::uint64_t steps = 0;  // number of steps since the balance was opened
    // values when the balance was opened
    Real energy = 0;               // kinetic energy of moving nodes, plus elastic and potential energy [J]
    Real potential = 0;            // [J]
    Vec3 momentum = Vec3::Zero();  // momentum of moving nodes [kg m/s]
    Vec3 impulse = Vec3::Zero();   // external impulse since the balance was opened [N s]
    Real work = 0;                 // external work minus dissipation since the balance was opened [J]
    // Sums of |work| over all steps [J], and of |impulse| over all steps and causes [N s], since the balance was
    // opened.
    Real energy_flow = 0, momentum_flow = 0;
    // The largest values in the run. An error is the difference between the change of energy or momentum and the sum of
    // its measured causes.
    Real energy_error = 0, energy_scale = 0;      // energy_scale: energy present plus energy exchanged [J]
    Real momentum_error = 0, momentum_scale = 0;  // momentum_scale: |momentum| present plus exchanged [kg m/s]

    void close() { open = false; }
};

/// Adds a committed step to the sums: the impulse that the surroundings exert on the bodies, and the work of the
/// surroundings minus the energy that the step dissipated.
void add_step(const StepScratch& step, Balance& balance);

/// Compares the present energy and momentum with their expected values: the values when the balance was opened, plus
/// the work and impulse since then. Records the difference if it is the largest so far. Opens the balance if it is
/// closed. With ranks the function is collective, and sums over all ranks.
///
/// `time`: present time [s]. `lag`: time by which velocities are older than positions [s]; the kinetic energy is
/// corrected for it with the present forces.
void check_balance(const WorldState& world, Real time, Real lag, Balance& balance);

/// Checks a copy of the balance (check_balance) and returns it, for a report. A closed balance is returned unchecked.
/// So is the balance of a world divided among ranks, because check_balance is then collective.
Balance checked_balance(const WorldState& world, Real time, Real lag, Balance balance);

}  // namespace skerry
