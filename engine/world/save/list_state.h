// The only list of the data in a saved world. Both the code that writes files and the code that reads files use this
// list.
#pragma once

#include <string>

#include "components/any_table.h"
#include "engine/world/save/saved_rows.h"
#include "engine/world/tuning.h"

namespace skerry {

/// Interface that writes or reads columns and values at paths in a file.
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
/// Lists all data except the settings. When a file is read, the world must be made from the saved settings first.
void list_state(WorldState& world, SavedRows& saved, Archive& archive);

}  // namespace skerry
