// Which kernels this process runs.
#pragma once

#include <span>
#include <string_view>

#include "systems/kernels/kernels.h"

namespace skerry {

/// Of the sets that run here the one called `wanted`, or the last if that is empty. Throws SceneError that lists them.
const Kernels& choose_kernels(std::span<const KernelSet> sets, std::string_view wanted);

/// The one that the environment variable SKERRY_INSTRUCTION_SET names, else the most demanding that runs. Chosen at the
/// first call. Throws SceneError, at every call, when the variable names none.
const Kernels& kernels();

}  // namespace skerry
