// Trial of a run: simulates its first part, to find faults at the start and to estimate the cost of the whole run.
#pragma once

#include <string>

#include "engine/program/run_plan.h"

namespace skerry {

struct SceneCost {
    double seconds = 0;     // wall time of the whole run, measured or estimated [s]
    double steps = 0;       // number of steps of the whole run, measured or estimated
    Real simulated = 0;     // time that the trial simulated [s]
    bool complete = false;  // true if the trial simulated the whole run
    Real overlap = 0;       // deepest overlap at the start [m]
    // Largest depth by which surfaces are closer than their contact distance at the start, minus the largest overlap of
    // surfaces [m]. The difference is the part of the contact distance that is missing.
    Real into_shell = 0;
    Index contacts = 0;  // number of contacts at the start
    std::string failure{}, turning{};
};

/// Simulates a run until its end or until the trial has taken a few seconds of CPU time. `overlap`: deepest overlap
/// known so far [m].
SceneCost try_run(World& world, const RunPlan& plan, Real overlap);

}  // namespace skerry
