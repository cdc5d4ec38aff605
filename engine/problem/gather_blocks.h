// Assembles the block rows of a ContactProblem from contributions in any order.
#pragma once

#include <vector>

#include "skerry/problem.h"

namespace skerry {

/// A contribution to the 3 x 3 block of W that couples two contacts. Contributions to the same block are summed in the
/// order of the list, so that the sum is bitwise reproducible.
struct BlockPart {
    Index row, column;  // numbers of the two contacts
    Mat3 value;
};

/// Fills row_offset, column and block of a problem. The size of problem.q gives the number of contacts. Blocks that are
/// exactly zero are omitted, except on the diagonal.
void gather_blocks(std::vector<BlockPart> parts, ContactProblem& problem);

}  // namespace skerry
