#include <array>

#include "systems/kernels/kernels.h"

extern "C" const skerry::Kernels skerry_kernels_base;
// What the build writes: a declaration of each other table, and below an entry for it.
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
