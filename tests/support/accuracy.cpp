#include "tests/support/accuracy.h"

#include <catch2/catch.hpp>
#include <cmath>

#include "tests/support/record.h"

namespace skerry::test::accuracy {

void check(const Quantity& q) {
    INFO("item " << q.item << ": " << q.name << " = " << q.formula);
    REQUIRE(std::isfinite(q.found));
    const Real scale = q.kind == Tolerance::relative ? std::abs(q.expected) : 1;
    INFO("expected " << q.expected << ", found " << q.found << ", error " << std::abs(q.found - q.expected) / scale
                     << ", tolerance " << q.tolerance);
    REQUIRE(std::abs(q.found - q.expected) <= q.tolerance * scale);
    RecordLine()
        .add("item", q.item)
        .add("name", q.name)
        .add("formula", q.formula)
        .add("expected", q.expected)
        .add("found", q.found)
        .add("tolerance", q.tolerance)
        .add("kind", q.kind == Tolerance::relative ? "relative" : "absolute")
        .add("note", q.note)
        .write();
}

}  // namespace skerry::test::accuracy
