// The only list of the contents of a saved world, used by the code that writes files and by the code that reads them.
#pragma once

#include <string>

#include "components/any_table.h"
#include "engine/world/save/saved_rows.h"
#include "engine/world/tuning.h"

namespace skerry {

/// Writes or reads columns and values under their paths.
class Archive {
public:
    virtual void column(const std::string& path, AnyColumn column) = 0;
    template <class T>
    void value(const std::string& path, T& value) {
        put_value(path, &value, row_type<T>);
    }

protected:
    ~Archive() = default;

private:
    virtual void put_value(const std::string& path, void* value, const RowType& type) = 0;
};

void list_settings(Settings& settings, Tuning& tuning, SavedRows& saved, Archive& archive);
/// Lists everything but the settings, which are needed to make a world.
void list_state(WorldState& world, SavedRows& saved, Archive& archive);

}  // namespace skerry
