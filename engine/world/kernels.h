// Selects the kernels that this process runs: numerical functions that are compiled once for each instruction set.
#pragma once

#include <span>
#include <string_view>

#include "systems/kernels/kernels.h"

namespace skerry {

/// Returns the kernels of the set with the name `name`. If `name` is empty, returns those of the last set in `sets`
/// that this CPU can run, which is the most advanced one. If this CPU can run no set with this name, throws SceneError
/// with a list of the available sets.
const Kernels& choose_kernels(std::span<const KernelSet> sets, std::string_view name);

/// Returns the kernels for the instruction set that the environment variable SKERRY_INSTRUCTION_SET names. Without this
/// variable, returns those for the most advanced instruction set of this CPU. The choice is made at the first call.
/// Every call throws SceneError if the variable names a set that this program lacks or this machine cannot run.
const Kernels& kernels();

}  // namespace skerry
