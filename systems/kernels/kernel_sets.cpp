#include <array>

#include "systems/kernels/kernels.h"

extern "C" const skerry::Kernels skerry_kernels_base;
// The build generates the declarations of the tables of all other instruction sets, and the entries for these tables
// below.
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
