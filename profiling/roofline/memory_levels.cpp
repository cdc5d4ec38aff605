#include "profiling/roofline/memory_levels.h"

#include <algorithm>
#include <limits>

namespace skerry::profiling {

std::vector<MemoryLevel> memory_levels(const CacheSizes& sizes, int workers) {
    std::vector<MemoryLevel> levels;
    const auto add = [&](const char* name, double capacity) {
        if (capacity > (levels.empty() ? 0 : levels.back().capacity)) levels.push_back({name, capacity});
    };
    add("L1", static_cast<double>(sizes.l1) * workers);
    add("L2", static_cast<double>(sizes.l2) * workers);
    add("L3", static_cast<double>(sizes.l3));
    add("memory", std::numeric_limits<double>::infinity());
    return levels;
}

const MemoryLevel& level_of(const std::vector<MemoryLevel>& levels, double bytes) {
    return *std::ranges::find_if(levels, [&](const MemoryLevel& level) { return bytes <= level.capacity; });
}

}  // namespace skerry::profiling
