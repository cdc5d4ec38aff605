// One line of the accuracy table (docs/accuracy.md): a quantity that has a closed form, what the engine finds, and how
// far apart they may be.
#pragma once

#include <string>

#include "components/types.h"

namespace skerry::test::accuracy {

/// What the tolerance is of: the quantity itself, or a fraction of what is expected.
enum class Tolerance { absolute, relative };

struct Quantity {
    int item = 0;         // of the list in docs/accuracy.md
    std::string name;     // what is measured, with its unit
    std::string formula;  // where `expected` comes from
    Real expected = 0;    // in the unit of the name
    Real found = 0;       // in the unit of the name
    Real tolerance = 0;   // >= 0
    Tolerance kind = Tolerance::relative;
    std::string note{};  // why it is tested in this way, where that is not plain
};

/// Requires that found is within the tolerance of expected, and records the line (tests/support/record.h):
/// scripts/accuracy makes the table of these.
void check(const Quantity& quantity);

}  // namespace skerry::test::accuracy
