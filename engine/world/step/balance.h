// Balance of energy and momentum in a run. Energy and momentum lost or gained without a cause estimate the error.
#pragma once

#include <cstdint>

#include "components/types.h"

namespace skerry {

struct Model;
struct StepScratch;

/// Sums since the last external change, such as a body added or velocities set, and the largest errors of the whole
/// run.
struct Balance {
    bool open = false;
    // False while a damped body is held, or an implicit element has a held node. Held nodes then take up momentum,
    // through damping or through the inertia of the element, that is not measured.
    bool momentum_known = true;
    std::uint64_t steps = 0;  // since the opening
    // at the opening
    Real energy = 0;                          // kinetic energy of moving nodes, elastic and potential energy [J]
    Real potential = 0;                       // [J]
    Vec3 momentum = Vec3::Zero();             // momentum of moving nodes [kg m/s]
    Vec3 impulse = Vec3::Zero();              // external impulse since the opening [N s]
    Real work = 0;                            // external work minus dissipation since the opening [J]
    Real energy_flow = 0, momentum_flow = 0;  // sums of |work| and |impulse| over all steps and causes [J, N s]
    // Largest values of the run.
    Real energy_error = 0, energy_scale = 0;      // energy_scale: largest energy available for exchange [J]
    Real momentum_error = 0, momentum_scale = 0;  // [kg m/s]

    void close() { open = false; }
};

/// Adds the energy and momentum that a committed step exchanged with the surroundings of the bodies.
void add_step(const StepScratch& step, Balance& balance);

/// Compares the present energy and momentum with the expected values. Records the error if it is the largest so far.
/// Opens the balance if it is closed. Reads all tables. `lag`: time by which velocities are older than positions [s].
/// The kinetic energy is corrected for this lag with the present forces.
void check_balance(const Model& model, Real lag, Balance& balance);

/// Returns a copy of the balance after check_balance, for a report. A closed balance is returned unchanged.
Balance checked_balance(const Model& model, Real lag, Balance balance);

}  // namespace skerry
