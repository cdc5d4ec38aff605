// The choice of the kernels that this process runs.
#pragma once

#include <span>
#include <string_view>

#include "systems/kernels/kernels.h"

namespace skerry {

/// Returns the set called `wanted`, or the last one if that is empty. Throws SceneError that lists the sets.
const Kernels& choose_kernels(std::span<const KernelSet> sets, std::string_view wanted);

/// Kernels named by the environment variable SKERRY_INSTRUCTION_SET, else the most demanding that run on this CPU.
/// Chosen at the first call. Throws SceneError, at every call, when the variable names no set.
const Kernels& kernels();

}  // namespace skerry
