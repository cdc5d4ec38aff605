// A value at a point in time.
#pragma once

#include "components/types.h"

namespace skerry {

/// A value at a point in time. Between two keys of a list the value changes linearly. It is constant before the first
/// key and after the last key.
struct TimeKey {
    Real time = 0;   // absolute time [s]
    Real value = 0;  // value at this time, in the unit of the quantity

    bool operator==(const TimeKey&) const = default;
};
}  // namespace skerry
