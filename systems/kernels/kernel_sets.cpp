#include <array>

#include "systems/kernels/kernels.h"

// kernel_sets.inc, which the build writes: a line SKERRY_KERNEL_SET(table, "name") for each set beside the first.
#define SKERRY_KERNEL_SET(table, name) extern "C" const skerry::Kernels table;
SKERRY_KERNEL_SET(skerry_kernels_base, )
#include <kernel_sets.inc>
#undef SKERRY_KERNEL_SET

namespace skerry {

std::span<const KernelSet> kernel_sets() {
#define SKERRY_KERNEL_SET(table, name) KernelSet{&table, __builtin_cpu_supports(name) != 0},
    static const std::array sets{
        KernelSet{&skerry_kernels_base, true},
#include <kernel_sets.inc>
    };
#undef SKERRY_KERNEL_SET
    return sets;
}

}  // namespace skerry
