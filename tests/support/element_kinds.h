// The registered kinds of elements, except the one that stands for others.
#pragma once

#include <array>

#include "components/options.h"

namespace skerry::test {

inline constexpr std::array element_kinds{ElementKind::linear, ElementKind::edge_smoothed,
                                          ElementKind::edge_node_smoothed};

}  // namespace skerry::test
