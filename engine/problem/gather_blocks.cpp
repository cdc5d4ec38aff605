#include "engine/problem/gather_blocks.h"

#include <algorithm>
#include <numeric>
#include <utility>

namespace skerry {

void gather_blocks(std::vector<BlockPart> parts, ContactProblem& problem) {
    const Index contacts = problem.contacts();
    for (Index i = 0; i < contacts; ++i) parts.push_back({i, i, Mat3::Zero()});
    const auto place = [](const BlockPart& part) { return std::pair(part.row, part.column); };
    std::stable_sort(parts.begin(), parts.end(),
                     [&](const BlockPart& a, const BlockPart& b) { return place(a) < place(b); });
    problem.row_offset.assign(static_cast<std::size_t>(contacts) + 1, 0);
    problem.column.clear();
    problem.block.clear();
    for (std::size_t begin = 0, end = 0; begin < parts.size(); begin = end) {
        const auto [row, column] = place(parts[begin]);
        Mat3 block = Mat3::Zero();
        for (; end < parts.size() && place(parts[end]) == std::pair(row, column); ++end) block += parts[end].value;
        if (row != column && block.isZero(0)) continue;
        problem.column.push_back(column);
        problem.block.push_back(block);
        ++problem.row_offset[row + 1];
    }
    std::partial_sum(problem.row_offset.begin(), problem.row_offset.end(), problem.row_offset.begin());
}

}  // namespace skerry
