// Instruction sets that the kernels can use on this machine.
#pragma once

#include <string_view>
#include <vector>

#pragma GCC visibility push(default)
namespace skerry {

/// The instruction set that the kernels of this process are compiled for, such as "x86-64-v3"; "native" if the whole
/// library is compiled for the build machine. All sets give the same results.
///
/// The first call of this function, or the first World, chooses the set: the one that the environment variable
/// SKERRY_INSTRUCTION_SET names; without this variable, the last of instruction_sets(). Both throw SceneError if the
/// variable names none of instruction_sets().
std::string_view instruction_set();

/// The instruction sets for which this build has kernels and which this machine supports. The most advanced set comes
/// last.
std::vector<std::string_view> instruction_sets();

}  // namespace skerry
#pragma GCC visibility pop
