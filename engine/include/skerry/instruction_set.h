// Which instructions the step uses on this machine.
#pragma once

#include <string_view>
#include <vector>

#pragma GCC visibility push(default)
namespace skerry {

/// The instruction set that the kernels of this process are compiled for: x86-64-v3, or native where everything is
/// compiled for the machine that builds. Chosen at the first call, here or by a World: the one that the environment
/// variable SKERRY_INSTRUCTION_SET names, else the last of instruction_sets(). Results are the same with each. Throws
/// SceneError, as building a World does, when the variable names none of them.
std::string_view instruction_set();

/// Those that this build has kernels for and this machine can run, the most demanding last.
std::vector<std::string_view> instruction_sets();

}  // namespace skerry
#pragma GCC visibility pop
