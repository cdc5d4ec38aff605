// Roofline of the machine: the peak rates of arithmetic and of memory, which bound the speed of a kernel.
#pragma once

#include <string>
#include <vector>

#include "profiling/roofline/memory_levels.h"
#include "profiling/roofline/peak_loops.h"

namespace skerry::profiling {

/// Rates of all workers together.
struct Roofline {
    double separate_double = 0;                    // multiplications and additions in double precision [1/s]
    double fused_double = 0;                       // the same as fused multiply-adds; 0 if there are none [1/s]
    double separate_single = 0, fused_single = 0;  // the same in single precision [1/s]
    std::vector<MemoryLevel> levels;               // ascending by capacity
};

/// Measures all rates with `workers` threads that run the same loop at the same time. Each rate is the highest sum of
/// all threads among the repeats, because other programs can only make a loop slower.
Roofline measure_roofline(const PeakLoops& loops, const CacheSizes& sizes, int workers, int repeats);

/// The loops for an instruction set. Throws std::invalid_argument if the build has none.
const PeakLoops& peak_loops_for(const std::string& instruction_set);

}  // namespace skerry::profiling
