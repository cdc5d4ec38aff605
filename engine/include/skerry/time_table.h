// A value that changes over time.
#pragma once

#include <vector>

#include "components/time_key.h"
#include "components/types.h"

#pragma GCC visibility push(default)
namespace skerry {

/// A value that changes over time, given by keys with ascending times. A number converts to a table with one key, which
/// means a constant value.
struct TimeTable {
    std::vector<TimeKey> keys{{0, 0}};  // at least one key

    /// The constant value 0.
    TimeTable() = default;
    /// A constant value.
    TimeTable(Real constant) : keys{{0, constant}} {}
    /// A value given by keys. Keys are checked where the table is used: an empty list and times that do not ascend are
    /// refused.
    TimeTable(std::vector<TimeKey> values) : keys(std::move(values)) {}

    bool operator==(const TimeTable&) const = default;
};

}  // namespace skerry
#pragma GCC visibility pop
