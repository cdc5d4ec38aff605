// Cache levels of a machine and its memory.
#pragma once

#include <cstddef>
#include <filesystem>
#include <string>
#include <vector>

namespace skerry::profiling {

/// Sizes of the L1 and L2 cache of one core, and of the L3 cache that cores share; 0 if unknown [B].
struct CacheSizes {
    std::size_t l1 = 0, l2 = 0, l3 = 0;
};

/// Sizes of the caches that Linux describes in `folder`. sysconf() cannot replace this: on a virtual machine its L3
/// cache is that of the whole host.
CacheSizes cache_sizes(const std::filesystem::path& folder = "/sys/devices/system/cpu/cpu0/cache");

/// A cache level or the memory.
struct MemoryLevel {
    std::string name;     // L1, L2, L3 or memory
    double capacity = 0;  // total for all workers; infinite for memory [B]
    double read = 0;      // rate at which all workers together read [B/s]
    double triad = 0;     // rate of to = x + s y; the line that a store fetches first is counted [B/s]
};

/// Levels for `workers` cores, ascending by capacity, without rates. A cache of unknown size, or no larger than the
/// level before, is left out.
std::vector<MemoryLevel> memory_levels(const CacheSizes& sizes, int workers);

/// The smallest level that can hold `bytes`.
const MemoryLevel& level_of(const std::vector<MemoryLevel>& levels, double bytes);

}  // namespace skerry::profiling
