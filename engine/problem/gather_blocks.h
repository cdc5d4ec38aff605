// Assembles the block rows of a ContactProblem from parts in any order.
#pragma once

#include <vector>

#include "skerry/problem.h"

namespace skerry {

/// A contribution to the block of two contacts. Contributions to the same block are summed in the given order.
struct BlockPart {
    Index row, column;  // contacts
    Mat3 value;
};

/// Fills row_offset, column and block of a problem; the size of its q gives the number of contacts. Blocks of exact
/// zeros are omitted, except on the diagonal.
void gather_blocks(std::vector<BlockPart> parts, ContactProblem& problem);

}  // namespace skerry
