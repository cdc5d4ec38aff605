// The block rows of a ContactProblem, put together from parts in any order.
#pragma once

#include <vector>

#include "skerry/problem.h"

namespace skerry {

/// A part of the block of two contacts; parts of the same block add up, in the order given.
struct BlockPart {
    Index row, column;  // contacts
    Mat3 value;
};

/// Fills row_offset, column and block of a problem whose q says how many contacts it has. A block of exact zeros
/// couples nothing and is left out; the diagonal is always there.
void gather_blocks(std::vector<BlockPart> parts, ContactProblem& problem);

}  // namespace skerry
