// Rows that follow each other.
#pragma once

#include "components/types.h"

namespace skerry {

/// Rows begin .. end - 1 of some table.
struct Range {
    Index begin = 0;
    Index end = 0;

    Index size() const { return end - begin; }
    bool operator==(const Range&) const = default;
};

}  // namespace skerry
