// Balance of energy and momentum in a run. A change of energy or momentum that no measured work or impulse explains is
// an estimate of the error.
#pragma once

#include <cstdint>

#include "components/types.h"

namespace skerry {

struct Model;
struct StepScratch;
struct WorldState;

/// Sums since the last change from outside (such as an added body or set velocities), and the largest errors of the
/// whole run. The balance is opened at the first check after such a change.
struct Balance {
    bool open = false;
    // True if all exchanged momentum is measured. False if a damped body was held when the balance was opened, or if a
    // held node has belonged to an implicit element since then. The held nodes then take up momentum that is not
    // measured, through damping or through the inertia of the element.
    bool momentum_known = true;
    std::uint64_t steps = 0;  // number of steps since the balance was opened
    // values when the balance was opened
    Real energy = 0;               // kinetic energy of moving nodes, plus elastic and potential energy [J]
    Real potential = 0;            // [J]
    Vec3 momentum = Vec3::Zero();  // momentum of moving nodes [kg m/s]
    Vec3 impulse = Vec3::Zero();   // external impulse since the balance was opened [N s]
    Real work = 0;                 // external work minus dissipation since the balance was opened [J]
    // sums of |work| and |impulse| over all steps and causes since the balance was opened [J, N s]
    Real energy_flow = 0, momentum_flow = 0;
    // The largest values in the run. An error is the difference between a measured change and the sum of its known
    // causes.
    Real energy_error = 0, energy_scale = 0;      // energy_scale: largest energy present or exchanged [J]
    Real momentum_error = 0, momentum_scale = 0;  // momentum_scale: sum of magnitudes, like energy_scale [kg m/s]

    void close() { open = false; }
};

/// Adds a committed step: the impulse of the surroundings on the bodies, and their work minus the energy that the step
/// dissipated.
void add_step(const StepScratch& step, Balance& balance);

/// Compares the present energy and momentum with their values at the opening plus work and impulse since then. Records
/// the error if it is the largest so far. Opens the balance if it is closed. Reads all tables. `time`: present time
/// [s]; `lag`: time by which velocities are older than positions [s]. The kinetic energy is corrected for this lag with
/// the present forces. With ranks the function is collective, and energy and momentum are those of all ranks.
void check_balance(const WorldState& world, Real time, Real lag, Balance& balance);

/// Returns a copy of the balance, checked by check_balance, for a report. A closed balance is returned unchanged, and
/// so is that of a divided world, because check_balance is then collective.
Balance checked_balance(const WorldState& world, Real time, Real lag, Balance balance);

}  // namespace skerry
