// Finds the name of the column or value at an address in a world, for messages.
#include <string>

#include "engine/world/world_state.h"

namespace skerry {

std::string name_of_column(void* world, const void* address) {
    WorldState& w = *static_cast<WorldState*>(world);
    std::vector<AnyTable> tables = w.model.tables();
    tables.emplace_back(w.cache.warm_start, "warm_start");
    tables.emplace_back(w.cache.resting, "resting");
    tables.emplace_back(w.scratch.resting_memory.next, "resting_next");
    tables.emplace_back(w.scratch.contacts, "contacts");
    tables.emplace_back(w.scratch.joints, "joint_blocks");
    tables.emplace_back(w.scratch.ties, "tie_rows");
    tables.emplace_back(w.scratch.cables, "cable_blocks");
    tables.emplace_back(w.scratch.regions, "regions");
    for (const AnyTable& table : tables)
        for (const ColumnInfo& info : table.columns())
            if (table.column(info).is(address)) return std::string(table.name()) + "." + info.name;
    const auto offset = static_cast<const std::byte*>(address) - static_cast<const std::byte*>(world);
    return "the column " + std::to_string(offset) + " bytes into WorldState";
}

}  // namespace skerry
