#include <array>

#include "systems/kernels/kernels.h"

extern "C" const skerry::Kernels skerry_kernels_base;
// The build generates two include files. kernel_tables.inc declares the kernel tables of all other instruction sets.
// kernel_sets.inc adds an entry for each of these tables to the array below.
#include <kernel_tables.inc>

namespace skerry {

std::span<const KernelSet> kernel_sets() {
    static const std::array sets{
        KernelSet{&skerry_kernels_base, true},
#include <kernel_sets.inc>
    };
    return sets;
}

}  // namespace skerry
