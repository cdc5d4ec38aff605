// Selects the kernels (numerical functions compiled for one instruction set) that this process runs.
#pragma once

#include <span>
#include <string_view>

#include "systems/kernels/kernels.h"

namespace skerry {

/// Returns the kernel set with the name `name`. If `name` is empty, returns the last of the `sets` that runs on
/// this CPU, which is the most advanced one. If no set named `name` runs here, throws SceneError with a list of the
/// available sets.
const Kernels& choose_kernels(std::span<const KernelSet> sets, std::string_view name);

/// Returns the kernels for the instruction set that the environment variable SKERRY_INSTRUCTION_SET names, or else for
/// the most advanced instruction set of this CPU. The choice is made at the first call. Throws SceneError, at every
/// call, if the variable names a set that this program lacks or this machine cannot run.
const Kernels& kernels();

}  // namespace skerry
