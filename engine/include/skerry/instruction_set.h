// Instruction sets of the kernels on this machine.
#pragma once

#include <string_view>
#include <vector>

#pragma GCC visibility push(default)
namespace skerry {

/// The instruction set that the kernels of this process are compiled for, such as "x86-64-v3"; "native" if the whole
/// library is compiled for the build machine. It is chosen at the first call, here or by a World: the set named by the
/// environment variable SKERRY_INSTRUCTION_SET, else the last of instruction_sets(). Results are the same with each.
/// Throws SceneError if the variable names none of these sets; the constructor of World then throws, too.
std::string_view instruction_set();

/// The instruction sets that this build has kernels for and this machine can run, the most demanding last.
std::vector<std::string_view> instruction_sets();

}  // namespace skerry
#pragma GCC visibility pop
