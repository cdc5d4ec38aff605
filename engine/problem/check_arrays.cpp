#include "engine/problem/check_arrays.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <functional>

#include "engine/base/complaint.h"

namespace skerry {

namespace {

/// Returns the index of the block in row i and column j. If this block is not stored, returns the number of blocks.
std::size_t block_at(const ContactProblem& problem, std::size_t i, std::size_t j) {
    const auto begin = problem.column.begin() + problem.row_offset[i];
    const auto end = problem.column.begin() + problem.row_offset[i + 1];
    const auto place = std::lower_bound(begin, end, static_cast<Index>(j));
    return place != end && *place == static_cast<Index>(j) ? static_cast<std::size_t>(place - problem.column.begin())
                                                           : problem.block.size();
}

/// True if the blocks W_ij and W_ji are transposes of each other, apart from errors in the assembly of W. In problems
/// of the FCLIB collection these errors reach 0.004 of the norm of a diagonal block.
bool symmetric(const ContactProblem& problem, std::size_t i, std::size_t j) {
    constexpr Real tolerance = 0.01;  // largest asymmetry, as a fraction of the larger of the two diagonal blocks
    const auto block = [&](std::size_t row, std::size_t column) -> Mat3 {
        const std::size_t number = block_at(problem, row, column);
        return number < problem.block.size() ? problem.block[number] : Mat3::Zero();
    };
    return (block(i, j) - block(j, i).transpose()).norm() <=
           tolerance * std::max(block(i, i).norm(), block(j, j).norm());
}

}  // namespace

std::string title_of(const ContactProblem& problem) {
    return problem.name.empty() ? "problem" : "problem " + problem.name;
}

void check_arrays(const ContactProblem& problem) {
    const auto expect = [&](bool good, const char* field, const std::string& found, const std::string& expected) {
        if (!good) refuse(title_of(problem), field, found, expected);
    };
    const auto values = [](const auto& column) { return std::to_string(column.size()) + " values"; };
    const std::size_t count = problem.q.size(), blocks = problem.block.size();
    expect(problem.mu.size() == count, "mu", values(problem.mu), std::to_string(count) + ", one per contact");
    expect(problem.row_offset.size() == count + 1, "row_offset", values(problem.row_offset),
           std::to_string(count + 1) + ", one more than contacts");
    expect(problem.row_offset.front() == 0, "row_offset", std::to_string(problem.row_offset.front()) + " at entry 0",
           "0, the first offset");
    const auto fall = std::adjacent_find(problem.row_offset.begin(), problem.row_offset.end(), std::greater<>());
    if (fall != problem.row_offset.end())
        expect(false, "row_offset",
               std::to_string(fall[1]) + " at entry " + std::to_string(fall - problem.row_offset.begin() + 1),
               "an offset >= " + std::to_string(fall[0]) + ", because offsets ascend");
    expect(problem.column.size() == blocks, "column", values(problem.column),
           std::to_string(blocks) + ", one per block");
    expect(static_cast<std::size_t>(problem.row_offset.back()) == blocks, "row_offset",
           std::to_string(problem.row_offset.back()) + " as the last offset",
           std::to_string(blocks) + ", the number of blocks");
    for (const Index column : problem.column)
        expect(column >= 0 && static_cast<std::size_t>(column) < count, "column", std::to_string(column),
               "the index of a contact, 0 to " + std::to_string(static_cast<Index>(count) - 1));
    const auto at = [](std::size_t number) { return " at entry " + std::to_string(number); };
    for (std::size_t i = 0; i < count; ++i) {
        const auto begin = problem.column.begin() + problem.row_offset[i];
        const auto end = problem.column.begin() + problem.row_offset[i + 1];
        expect(std::adjacent_find(begin, end, std::greater_equal<>()) == end, "column",
               "columns that do not ascend in row " + std::to_string(i), "ascending columns in each row");
        expect(std::binary_search(begin, end, static_cast<Index>(i)), "column",
               "no diagonal block in row " + std::to_string(i), "a diagonal block in each row");
        expect(problem.q[i].allFinite(), "q", "a value that is not finite" + at(i), "finite velocities (m/s)");
        expect(problem.mu[i] >= 0 && std::isfinite(problem.mu[i]), "mu", std::to_string(problem.mu[i]) + at(i),
               "friction coefficients >= 0");
    }
    for (std::size_t k = 0; k < blocks; ++k)
        expect(problem.block[k].allFinite(), "block", "a value that is not finite" + at(k), "finite blocks (1/kg)");
    for (std::size_t i = 0; i < count; ++i)
        for (Index k = problem.row_offset[i]; k < problem.row_offset[i + 1]; ++k)
            expect(symmetric(problem, i, static_cast<std::size_t>(problem.column[static_cast<std::size_t>(k)])),
                   "block",
                   "a matrix W that is not symmetric in the rows of contact " + std::to_string(i) +
                       " and the columns of contact " + std::to_string(problem.column[static_cast<std::size_t>(k)]),
                   "a symmetric matrix with both triangles stored");
}

}  // namespace skerry
