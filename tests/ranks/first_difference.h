// Comparison of the states of a body in two worlds.
#pragma once

#include <cstddef>
#include <string>

#include "engine/world/state/model.h"

namespace skerry::test {

/// Names the first column in which the state of a body (row of BodyTable) differs between two worlds, with the row
/// counted from the first row of the body, and both values. Empty if no state column differs.
std::string first_difference(Model& expected, std::size_t body, Model& found, std::size_t same_body);

}  // namespace skerry::test
