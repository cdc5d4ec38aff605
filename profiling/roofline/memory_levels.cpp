#include "profiling/roofline/memory_levels.h"

#include <algorithm>
#include <fstream>
#include <limits>

namespace skerry::profiling {

CacheSizes cache_sizes(const std::filesystem::path& folder) {
    CacheSizes sizes;
    std::size_t* const of_level[] = {&sizes.l1, &sizes.l2, &sizes.l3};
    for (int index = 0; std::filesystem::exists(folder / ("index" + std::to_string(index))); ++index) {
        const std::filesystem::path cache = folder / ("index" + std::to_string(index));
        std::size_t level = 0, kibibytes = 0;
        std::string type;
        std::ifstream(cache / "level") >> level;
        std::ifstream(cache / "type") >> type;
        std::ifstream(cache / "size") >> kibibytes;  // for example 1024K
        if (type != "Instruction" && level >= 1 && level <= std::size(of_level))
            *of_level[level - 1] = 1024 * kibibytes;
    }
    return sizes;
}

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
