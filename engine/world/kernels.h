// The kernels (for one instruction set) that this process runs.
#pragma once

#include <span>
#include <string_view>

#include "systems/kernels/kernels.h"

namespace skerry {

/// Returns the kernel set called `wanted`; if `wanted` is empty, the last set that runs on this CPU. Throws SceneError
/// with a list of the sets if no set of this name runs here.
const Kernels& choose_kernels(std::span<const KernelSet> sets, std::string_view wanted);

/// Kernels for the instruction set named by the environment variable SKERRY_INSTRUCTION_SET. Without this variable,
/// kernels for the most advanced instruction set of this CPU. The choice is made at the first call. Throws SceneError,
/// at every call, when the variable names no known set.
const Kernels& kernels();

}  // namespace skerry
