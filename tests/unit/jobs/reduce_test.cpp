#include "jobs/reduce.h"

#include <catch2/catch.hpp>
#include <numeric>
#include <vector>

#include "components/types.h"
#include "tests/unit/jobs/executors.h"

namespace skerry::test::reduce_test {

TEST_CASE("block results are joined in block order, starting from the identity", "[unit]") {
    for (const ExecutorChoice& choice : executor_choices()) {
        CAPTURE(choice.text());
        const auto executor = choice.make();
        Column<int> partial;
        // The operation is not associative: any other order gives another number.
        const auto digits = [&](std::size_t count) {
            return reduce(
                *executor, count, 2, partial, 7,
                [](std::size_t begin, std::size_t) { return static_cast<int>(begin / 2 + 1); },
                [](int a, int b) { return 10 * a + b; });
        };
        REQUIRE(digits(0) == 7);
        REQUIRE(digits(1) == 71);
        REQUIRE(digits(2) == 71);
        REQUIRE(digits(3) == 712);
        REQUIRE(digits(12) == 7123456);
        REQUIRE(digits(4) == 712);  // results of the longer earlier run are not counted
    }
}

TEST_CASE("a sum covers every row once", "[unit]") {
    std::vector<int> rows(1001);
    std::iota(rows.begin(), rows.end(), 0);
    for (const ExecutorChoice& choice : executor_choices()) {
        CAPTURE(choice.text());
        Column<int> partial;
        const int sum = reduce(
            *choice.make(), rows.size(), 64, partial, 0,
            [&](std::size_t begin, std::size_t end) {
                return std::accumulate(rows.begin() + static_cast<std::ptrdiff_t>(begin),
                                       rows.begin() + static_cast<std::ptrdiff_t>(end), 0);
            },
            [](int a, int b) { return a + b; });
        REQUIRE(sum == 1001 * 500);
    }
}

TEST_CASE("vectors are reduced too, and the memory of the blocks is kept", "[unit]") {
    const auto executor = make_executor(available_backends().front(), 2);
    Column<Vec3> partial;
    const auto sum = [&](std::size_t count) {
        return reduce(
            *executor, count, 10, partial, Vec3::Zero(),
            [](std::size_t begin, std::size_t end) { return Vec3(Vec3::Constant(static_cast<Real>(end - begin))); },
            [](const Vec3& a, const Vec3& b) { return Vec3(a + b); });
    };
    REQUIRE(sum(95) == Vec3::Constant(95));
    const Vec3* const memory = partial.data();
    REQUIRE(sum(15) == Vec3::Constant(15));
    REQUIRE(sum(95) == Vec3::Constant(95));
    REQUIRE(partial.data() == memory);
}

}  // namespace skerry::test::reduce_test
