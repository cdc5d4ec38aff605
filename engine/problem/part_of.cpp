#include <vector>

#include "components/types.h"
#include "engine/base/complaint.h"
#include "engine/problem/check_arrays.h"
#include "skerry/problem.h"

namespace skerry {

ContactProblem part_of(const ContactProblem& problem, std::span<const Index> contacts) {
    check_arrays(problem);
    std::vector<Index> row_in_part(problem.q.size(), no_index);
    Index previous = -1;
    for (std::size_t i = 0; i < contacts.size(); ++i) {
        if (contacts[i] <= previous || contacts[i] >= problem.contacts())
            refuse(title_of(problem), "contacts", std::to_string(contacts[i]),
                   "contact indices from 0 to " + std::to_string(problem.contacts() - 1) + " in ascending order");
        previous = contacts[i];
        row_in_part[contacts[i]] = static_cast<Index>(i);
    }
    ContactProblem part;
    part.name = problem.name;
    part.description = problem.description;
    part.row_offset.push_back(0);
    for (const Index i : contacts) {
        part.q.push_back(problem.q[i]);
        part.mu.push_back(problem.mu[i]);
        for (Index k = problem.row_offset[i]; k < problem.row_offset[i + 1]; ++k)
            if (const Index column = row_in_part[problem.column[k]]; column != no_index) {
                part.column.push_back(column);
                part.block.push_back(problem.block[k]);
            }
        part.row_offset.push_back(static_cast<Index>(part.column.size()));
    }
    return part;
}

}  // namespace skerry
