// One row of the accuracy table (docs/accuracy.md): a quantity with a closed form, the value that the engine finds, and
// the allowed difference.
#pragma once

#include <string>

#include "components/types.h"

namespace skerry::test::accuracy {

/// Kind of the tolerance: in the unit of the quantity, or a fraction of the expected value.
enum class Tolerance { absolute, relative };

struct Quantity {
    int item = 0;         // number in the list of docs/accuracy.md
    std::string name;     // measured quantity, with its unit
    std::string formula;  // formula that gives `expected`
    Real expected = 0;    // in the unit of the name
    Real found = 0;       // in the unit of the name
    Real tolerance = 0;   // >= 0
    Tolerance kind = Tolerance::relative;
    std::string note{};  // reason for testing it in this way, if not obvious
};

/// Requires that `found` is within the tolerance of `expected`, and records the row (tests/support/record.h).
/// scripts/accuracy makes the table from these rows.
void check(const Quantity& quantity);

}  // namespace skerry::test::accuracy
