// A value that changes over time.
#pragma once

#include <vector>

#include "components/time_key.h"
#include "components/types.h"

#pragma GCC visibility push(default)
namespace skerry {

/// A value that changes over time, given by keys with ascending times [s]. The value changes linearly between two keys,
/// and is constant before the first and after the last key. A number converts to a table with this constant value.
struct TimeTable {
    std::vector<TimeKey> keys{{0, 0}};  // at least one key

    /// The constant value 0.
    TimeTable() = default;
    /// A constant value.
    TimeTable(Real constant) : keys{{0, constant}} {}
    /// A value given by keys. The function that uses the table checks the keys; it throws SceneError if the list is
    /// empty or the times do not ascend.
    TimeTable(std::vector<TimeKey> values) : keys(std::move(values)) {}

    bool operator==(const TimeTable&) const = default;
};

}  // namespace skerry
#pragma GCC visibility pop
