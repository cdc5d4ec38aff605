#include "engine/world/kernels.h"

#include <cstdlib>
#include <string>

#include "engine/base/complaint.h"
#include "skerry/instruction_set.h"

namespace skerry {

namespace {

std::string listed(std::span<const KernelSet> sets) {
    std::string names;
    for (const KernelSet& set : sets)
        if (set.runs) names += (names.empty() ? "" : ", ") + std::string(set.kernels->instruction_set);
    return names;
}

}  // namespace

const Kernels& choose_kernels(std::span<const KernelSet> sets, std::string_view name) {
    const Kernels* last = nullptr;
    std::string hint;
    for (const KernelSet& set : sets) {
        if (set.runs) last = set.kernels;
        if (name != set.kernels->instruction_set) continue;
        if (set.runs) return *set.kernels;
        hint =
            "this build contains this instruction set, but the processor or the operating system does not support it";
    }
    if (name.empty()) return *last;
    refuse("environment", "SKERRY_INSTRUCTION_SET", "\"" + std::string(name) + "\"", "one of " + listed(sets), hint);
}

const Kernels& kernels() {
    static const Kernels& chosen = []() -> const Kernels& {
        const char* const name = std::getenv("SKERRY_INSTRUCTION_SET");
        return choose_kernels(kernel_sets(), name != nullptr ? name : "");
    }();
    return chosen;
}

std::string_view instruction_set() {
    return kernels().instruction_set;
}

std::vector<std::string_view> instruction_sets() {
    std::vector<std::string_view> names;
    for (const KernelSet& set : kernel_sets())
        if (set.runs) names.emplace_back(set.kernels->instruction_set);
    return names;
}

}  // namespace skerry
