// Costs of handing out work on two cores of this machine. They calibrate the constants of the model.
#pragma once

namespace skerry::profiling {

struct HandingOutCosts {
    double join = 0;     // as MachineModel::join [s]
    double wake_up = 0;  // as MachineModel::wake_up [s]
    double barrier = 0;  // as MachineModel::barrier [s]
};

/// Measures with the default backend on two threads. Disturbances by other programs are filtered out (quiet.h).
HandingOutCosts measure_costs();

}  // namespace skerry::profiling
