// Columns of tables: each is listed once and found by the list.
#include <catch2/catch.hpp>
#include <set>
#include <string>

#include "components/attachment_table.h"
#include "components/check.h"
#include "components/contact_table.h"
#include "components/element_table.h"
#include "components/node_block_table.h"
#include "components/node_table.h"
#include "components/region_table.h"
#include "components/resting_contact_table.h"
#include "components/surface_table.h"

namespace skerry::test::tables_test {

// A snapshot would lose a column that is missing from the list. All columns have equal size in memory, so the size of
// the table gives their number. A flag or two beside them (RegionTable) take less space than a column.
TEMPLATE_TEST_CASE("the list of a table names every column of it once", "[unit]", NodeTable, ElementBlockTable,
                   BodyTable, BvhTable, MaterialTable, NodeBlockTable, ColliderTable, AttachmentTable, ContactTable,
                   WarmStartTable, RestingContactTable, RegionTable, RegionHistoryTable, TriangleTable, EdgeTable,
                   VertexTable, SurfaceTables) {
    TestType table;
    std::set<const void*> columns;
    std::set<std::string> names;
    std::size_t visits = 0;
    table.for_each_column([&](const char* name, auto& column, ColumnRole) {
        columns.insert(&column);
        names.insert(name);
        ++visits;
    });
    REQUIRE(columns.size() == visits);
    REQUIRE(sizeof(TestType) / sizeof(Column<Real>) == visits);
    // The parts of SurfaceTables have columns with equal names.
    if constexpr (!std::is_same_v<TestType, SurfaceTables>) REQUIRE(names.size() == visits);
}

TEST_CASE("resizing the contact table resizes every column", "[unit]") {
    ContactTable contacts;
    contacts.resize(5);
    REQUIRE(contacts.size() == 5);
    contacts.for_each_column([](const char* name, auto& column, ColumnRole) {
        CAPTURE(name);
        REQUIRE(column.size() == 5);
    });
}

TEST_CASE("lanes of eight reals fill one cache line", "[unit]") {
    REQUIRE(sizeof(ElementLane) == 64);
    REQUIRE(alignof(ElementLane) == 64);
}

#ifndef SKERRY_NO_CHECKS
TEST_CASE("a failed check reports condition and place", "[unit]") {
    const int rows = 3;
    REQUIRE_NOTHROW(SKERRY_CHECK(rows == 3));
    REQUIRE_THROWS_WITH(SKERRY_CHECK(rows == 4), Catch::Contains("rows == 4") && Catch::Contains("tables_test.cpp"));
}
#endif

}  // namespace skerry::test::tables_test
