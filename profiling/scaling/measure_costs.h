// What handing out work costs on two cores of this machine, to set the model's constants by.
#pragma once

namespace skerry::profiling {

struct HandingOutCosts {
    double join = 0;     // s, MachineModel::join
    double wake_up = 0;  // s, MachineModel::wake_up
    double barrier = 0;  // s, MachineModel::barrier
};

/// With the default backend on two threads, undisturbed (quiet.h).
HandingOutCosts measure_costs();

}  // namespace skerry::profiling
