// Roofline of the machine: the peak rates of arithmetic and of memory, which bound the speed of a kernel.
#pragma once

#include <cstddef>
#include <string>
#include <vector>

#include "profiling/roofline/peak_loops.h"

namespace skerry::profiling {

/// A cache level or the memory.
struct MemoryLevel {
    std::string name;     // L1, L2, L3 or memory
    double capacity = 0;  // total for all workers; infinite for memory [B]
    double read = 0;      // rate at which all workers together read [B/s]
    double triad = 0;     // rate of to = x + s y, with the line that a store fetches first [B/s]
};

/// Rates of all workers together.
struct Roofline {
    double separate_double = 0;                    // multiplications and additions in double precision [1/s]
    double fused_double = 0;                       // the same as fused multiply-adds; 0 if there are none [1/s]
    double separate_single = 0, fused_single = 0;  // the same in single precision [1/s]
    std::vector<MemoryLevel> levels;               // ascending by capacity

    /// The smallest level that can hold `bytes`.
    const MemoryLevel& level_of(double bytes) const;
};

/// Sizes of the caches, ascending: L1 and L2 of one core, and the L3 that cores share [B]. Unknown levels are left out.
struct CacheSizes {
    std::size_t l1 = 0, l2 = 0, l3 = 0;
};
CacheSizes cache_sizes();

/// The levels of a machine, without rates. A level without a size is left out.
std::vector<MemoryLevel> memory_levels(const CacheSizes& sizes, int workers);

/// Measures all rates with `workers` threads that run the same loop at the same time. Each rate is the best of
/// `repeats`, because other programs can only make a loop slower.
Roofline measure_roofline(const PeakLoops& loops, const CacheSizes& sizes, int workers, int repeats);

/// The loops for an instruction set. Throws std::invalid_argument if the build has none.
const PeakLoops& peak_loops_for(const std::string& instruction_set);

}  // namespace skerry::profiling
