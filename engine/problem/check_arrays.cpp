#include "engine/problem/check_arrays.h"

#include <algorithm>
#include <string>

#include "skerry/error.h"

namespace skerry {

void check_arrays(const ContactProblem& problem) {
    const auto expect = [&](bool good, const char* field, const std::string& found, const std::string& expected) {
        if (!good)
            Complaint{.file = {},
                      .object = "problem " + problem.name,
                      .field = field,
                      .found = found,
                      .expected = expected,
                      .hint = {}}
                .raise();
    };
    const auto values = [](const auto& column) { return std::to_string(column.size()) + " values"; };
    const std::size_t count = problem.q.size(), blocks = problem.block.size();
    expect(problem.mu.size() == count, "mu", values(problem.mu), std::to_string(count));
    expect(problem.row_offset.size() == count + 1, "row_offset", values(problem.row_offset), std::to_string(count + 1));
    expect(problem.row_offset.front() == 0 && std::is_sorted(problem.row_offset.begin(), problem.row_offset.end()),
           "row_offset", "offsets that do not ascend from 0", "offsets in ascending order");
    expect(problem.column.size() == blocks && static_cast<std::size_t>(problem.row_offset.back()) == blocks, "column",
           values(problem.column), std::to_string(blocks) + " (blocks)");
    for (const Index column : problem.column)
        expect(column >= 0 && static_cast<std::size_t>(column) < count, "column", std::to_string(column),
               "the index of a contact");
}

}  // namespace skerry
