#include "components/column.h"

#include <algorithm>
#include <catch2/catch.hpp>
#include <cstdint>
#include <fstream>
#include <sstream>
#include <string>
#include <vector>

#include "components/types.h"

namespace skerry::test::column_test {

namespace {

Column<int> counting(int count) {
    Column<int> column;
    for (int i = 0; i < count; ++i) column.push_back(i);
    return column;
}

}  // namespace

TEMPLATE_TEST_CASE("a column starts on a cache line, whatever its rows and however it grew", "[unit]", std::uint8_t,
                   int, Real, Vec3, Mat3) {
    Column<TestType> column;
    for (std::size_t rows = 1; rows < 3000; rows = 2 * rows + 1) {
        column.resize(rows);
        REQUIRE(reinterpret_cast<std::uintptr_t>(column.data()) % 64 == 0);
    }
}

#ifdef __linux__
namespace {

/// Flags of the memory at an address, as the kernel lists them.
std::string flags_of_memory(const void* at) {
    const auto address = reinterpret_cast<std::uintptr_t>(at);
    std::ifstream maps("/proc/self/smaps");
    bool here = false;
    for (std::string line; std::getline(maps, line);) {
        std::uintptr_t begin = 0, end = 0;
        char dash = 0;
        std::istringstream range(line);
        if (range >> std::hex >> begin >> dash >> end && dash == '-') here = begin <= address && address < end;
        if (here && line.starts_with("VmFlags:")) return line + " ";
    }
    return "";
}

}  // namespace

TEST_CASE("long columns use large pages, short ones do not", "[unit]") {
    if (!std::ifstream("/sys/kernel/mm/transparent_hugepage/enabled"))
        SUCCEED("this system has none");
    else {
        Column<Real> column;
        column.resize(std::size_t{1} << 20);  // 8 MiB
        CHECK(flags_of_memory(column.data() + column.size() / 2).find(" hg ") != std::string::npos);
        Column<Real> small;
        small.resize(1000);
        CHECK(flags_of_memory(small.data()).find(" hg ") == std::string::npos);
    }
}
#endif

TEST_CASE("rows made by resize are zero, rows that were there stay", "[unit]") {
    Column<int> column = counting(3);
    column.resize(6);
    REQUIRE(column[2] == 2);
    for (std::size_t row = 3; row < 6; ++row) REQUIRE(column[row] == 0);
    column.resize(2);
    column.resize(4, 9);
    REQUIRE(std::vector<int>(column.begin(), column.end()) == std::vector<int>{0, 1, 9, 9});
}

TEST_CASE("erase keeps the order of the rows that are left", "[unit]") {
    Column<int> column = counting(6);
    column.erase(1, 2);
    REQUIRE(std::vector<int>(column.begin(), column.end()) == std::vector<int>{0, 3, 4, 5});
    column.erase(0, 1);
    column.erase(2, 1);  // the last row
    REQUIRE(std::vector<int>(column.begin(), column.end()) == std::vector<int>{3, 4});
    column.erase(1, 0);
    REQUIRE(column.size() == 2);
    column.erase(0, 2);
    REQUIRE(column.empty());
}

TEST_CASE("ranges erased at once leave the same rows as ranges erased one by one", "[unit]") {
    std::vector<Range> gone;
    for (const Range rows : {Range{1, 2}, Range{2, 2}, Range{2, 4}, Range{5, 6}, Range{9, 12}}) append_gone(rows, gone);
    REQUIRE(gone == std::vector<Range>{{1, 4}, {5, 6}, {9, 12}});
    const std::vector<int> left{0, 4, 6, 7, 8, 12};
    for (const int count : {13, 10, 9, 5, 3, 1, 0}) {
        CAPTURE(count);
        Column<int> column = counting(count);
        column.erase(gone);
        std::vector<int> expected;
        for (const int row : left)
            if (row < count) expected.push_back(row);
        REQUIRE(std::vector<int>(column.begin(), column.end()) == expected);
    }
    Column<int> whole = counting(3);
    whole.erase(std::vector<Range>{});
    REQUIRE(whole.size() == 3);
    for (std::size_t now = 0; now < left.size(); ++now)
        REQUIRE(row_without(static_cast<Index>(left[now]), gone) == static_cast<Index>(now));
    REQUIRE(row_without(2, gone) == 1);
}

TEST_CASE("a column that shrinks and grows again stays where it is", "[unit]") {
    Column<Vec3> column;
    column.resize(1000);
    const Vec3* const before = column.data();
    column.clear();
    column.resize(10);
    column.assign(1000, Vec3::Zero());
    column.erase(0, 500);
    REQUIRE(column.data() == before);
}

TEST_CASE("swapping columns moves no row", "[unit]") {
    Column<int> a = counting(3), b = counting(5);
    const int* const of_a = a.data();
    swap(a, b);
    REQUIRE(b.data() == of_a);
    REQUIRE(a.size() == 5);
    REQUIRE(b.size() == 3);
}

TEST_CASE("spans of a column show its rows", "[unit]") {
    Column<int> column = counting(3);
    std::span<int> rows = column;
    rows[1] = 7;
    const Column<int>& same = column;
    std::span<const int> shown = same;
    REQUIRE(shown.size() == 3);
    REQUIRE(shown[1] == 7);
    REQUIRE(Column<int>().span().empty());
}

// Purpose of const: a system that gets a column to read cannot write it.
static_assert(!std::is_convertible_v<const Column<int>&, std::span<int>>);
// A column of vectors is a flat array of reals, which output and snapshots rely on.
static_assert(sizeof(Vec3) == 3 * sizeof(Real) && sizeof(Mat3) == 9 * sizeof(Real));

TEST_CASE("a row of a column can be appended to it, also where that moves all rows", "[unit]") {
    Column<int> column = counting(1);
    for (int i = 0; i < 100; ++i) column.push_back(column[0]);
    CHECK(column.size() == 101);
    CHECK(std::ranges::all_of(column, [](int row) { return row == 0; }));
    column[0] = 7;
    column.resize(1000, column[0]);
    CHECK(column[999] == 7);
    column.assign(2000, column[0]);
    CHECK(column[1999] == 7);
}

TEST_CASE("a copy of a column has its rows and keeps its own memory where they fit", "[unit]") {
    const Column<int> five = counting(5);
    Column<int> copy = counting(8);
    const int* const place = copy.data();
    copy = five;
    CHECK(std::vector<int>(copy.begin(), copy.end()) == std::vector<int>{0, 1, 2, 3, 4});
    CHECK(copy.data() == place);
    copy = Column<int>(copy);
    CHECK(copy.size() == 5);
    const Column<int> larger = counting(50);
    copy = larger;
    CHECK(copy[49] == 49);
}

TEST_CASE("a column that is moved from has no rows", "[unit]") {
    Column<int> from = counting(5);
    const Column<int> made = std::move(from);
    CHECK(made.size() == 5);
    CHECK(from.size() == 0);
    Column<int> other = counting(3), to = counting(4);
    to = std::move(other);
    CHECK(to.size() == 3);
    CHECK(other.size() == 0);
    other.push_back(1);
    CHECK(other[0] == 1);
}

}  // namespace skerry::test::column_test
