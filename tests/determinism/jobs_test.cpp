// Results are bitwise equal on any number of workers, on every backend, in every run.
#include <bit>
#include <catch2/catch.hpp>
#include <cstdint>
#include <random>
#include <set>
#include <vector>

#include "components/types.h"
#include "jobs/reduce.h"
#include "jobs/task_graph.h"
#include "tests/unit/jobs/executors.h"

namespace skerry::test::jobs_test {

namespace {

constexpr unsigned seed = 20100201;

// Magnitudes from 1e-8 to 1e8 with both signs: nearly every order of summation rounds to another sum.
std::vector<Real> awkward_numbers(std::size_t count) {
    std::mt19937_64 random(seed);
    std::uniform_real_distribution<Real> exponent(-8, 8), sign(-1, 1);
    std::vector<Real> numbers(count);
    for (Real& number : numbers) number = std::copysign(std::pow(10.0, exponent(random)), sign(random));
    return numbers;
}

Real sum_of(const std::vector<Real>& numbers, std::size_t begin, std::size_t end) {
    Real sum = 0;
    for (std::size_t i = begin; i < end; ++i) sum += numbers[i];
    return sum;
}

const std::vector<int> worker_counts{1, 2, 3, 4, 5, 6, 7, 8};

}  // namespace

TEST_CASE("a sum is the same bits on 1 to 8 workers and every backend", "[determinism]") {
    CAPTURE(seed);
    const std::vector<Real> numbers = awkward_numbers(10000);
    const std::size_t block = 64;

    // Shows that the test can fail: other orders of the same blocks give other bits.
    std::vector<Real> blocks;
    for (std::size_t begin = 0; begin < numbers.size(); begin += block)
        blocks.push_back(sum_of(numbers, begin, std::min(begin + block, numbers.size())));
    const std::uint64_t expected = std::bit_cast<std::uint64_t>(sum_of(blocks, 0, blocks.size()));
    std::mt19937 random(seed);
    std::set<std::uint64_t> shuffled;
    for (int i = 0; i < 20; ++i) {
        std::shuffle(blocks.begin(), blocks.end(), random);
        shuffled.insert(std::bit_cast<std::uint64_t>(sum_of(blocks, 0, blocks.size())));
    }
    REQUIRE(shuffled.size() > 1);

    for (const ExecutorChoice& choice : executor_choices(worker_counts)) {
        CAPTURE(choice.text());
        const auto executor = choice.make();
        Column<Real> partial;
        for (int run = 0; run < 20; ++run) {
            const Real sum = reduce(
                *executor, numbers.size(), block, partial, 0.0,
                [&](std::size_t begin, std::size_t end) { return sum_of(numbers, begin, end); },
                [](Real a, Real b) { return a + b; });
            REQUIRE(std::bit_cast<std::uint64_t>(sum) == expected);
        }
    }
}

TEST_CASE("a graph of stages that do not commute gives the same bits on 1 to 8 workers and every backend",
          "[determinism]") {
    CAPTURE(seed);
    const std::size_t column_count = 6, stage_count = 30, rows = 500;
    const std::vector<Real> start = awkward_numbers(column_count * rows);
    std::vector<Column<Real>> columns(column_count);
    std::vector<std::string> names;
    for (std::size_t s = 0; s < stage_count; ++s) names.push_back("stage " + std::to_string(s));

    // x -> 1 / (1 + |x + y|): any other order of the stages gives other numbers.
    const auto mix = [](Executor& executor, std::span<const Real> from, std::span<Real> to) {
        parallel_for(executor, to.size(), 32, [&](std::size_t begin, std::size_t end) {
            for (std::size_t row = begin; row < end; ++row)
                to[row] = 1 / (1 + std::abs(to[row] + from[from.size() - 1 - row]));
        });
    };
    std::mt19937 random(seed);
    TaskGraph graph;
    for (std::size_t s = 0; s < stage_count; ++s) {
        const std::size_t from = random() % column_count,
                          to = (from + 1 + random() % (column_count - 1)) % column_count;
        graph.stage(names[s].c_str(), mix, read(columns[from]), write(columns[to]));
    }
    graph.compile();

    const auto reset = [&] {
        for (std::size_t c = 0; c < column_count; ++c) {
            columns[c].resize(rows);
            std::copy_n(start.begin() + static_cast<std::ptrdiff_t>(c * rows), rows, columns[c].begin());
        }
    };
    const auto all = [&] {
        std::vector<Real> numbers;
        for (const auto& column : columns) numbers.insert(numbers.end(), column.begin(), column.end());
        return numbers;
    };
    reset();
    graph.run_inline();
    const std::vector<Real> expected = all();
    REQUIRE(expected != start);
    for (const ExecutorChoice& choice : executor_choices(worker_counts)) {
        CAPTURE(choice.text());
        const auto executor = choice.make();
        for (int run = 0; run < 5; ++run) {
            reset();
            graph.run(*executor);
            REQUIRE(all() == expected);
        }
    }
}

}  // namespace skerry::test::jobs_test
