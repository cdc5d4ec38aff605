// Which column lies at a place in a world: only messages ask.
#include <string>

#include "engine/world/world_state.h"

namespace skerry {

std::string name_of_column(void* world, const void* place) {
    WorldState& w = *static_cast<WorldState*>(world);
    std::string found;
    const auto look_in = [&](const char* table, auto& columns) {
        columns.for_each_column([&](const char* name, const auto&... parts) {
            if (((static_cast<const void*>(&parts) == place) || ...)) found = std::string(table) + "." + name;
        });
    };
    w.model.for_each_table(look_in);
    look_in("warm_start", w.cache.warm_start);
    look_in("resting", w.cache.resting);
    look_in("resting_next", w.scratch.resting_memory.next);
    look_in("contacts", w.scratch.contacts);
    look_in("joint_blocks", w.scratch.joints);
    look_in("regions", w.scratch.regions);
    if (!found.empty()) return found;
    const auto offset = static_cast<const std::byte*>(place) - static_cast<const std::byte*>(world);
    return "the column " + std::to_string(offset) + " bytes into WorldState";
}

}  // namespace skerry
