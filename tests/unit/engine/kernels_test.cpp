#include "engine/world/kernels.h"

#include <algorithm>
#include <catch2/catch.hpp>
#include <string>
#include <vector>

#include "skerry/instruction_set.h"
#include "tests/support/message_of.h"

namespace skerry::test::kernels_test {

namespace {

Kernels called(const char* name) {
    Kernels kernels = *kernel_sets().front().kernels;
    kernels.instruction_set = name;
    return kernels;
}

std::string refusal(std::span<const KernelSet> sets, std::string_view wanted) {
    return message_of([&] { choose_kernels(sets, wanted); });
}

}  // namespace

TEST_CASE("without a wish the last set of kernels that runs here is taken", "[unit]") {
    const Kernels base = called("base"), wide = called("wide"), widest = called("widest");
    const std::vector<KernelSet> sets{{&base, true}, {&wide, true}, {&widest, false}};
    CHECK(&choose_kernels(sets, "") == &wide);
    CHECK(&choose_kernels(sets, "base") == &base);
    CHECK(&choose_kernels(sets, "wide") == &wide);
}

TEST_CASE("an instruction set that is not there is refused with those that are", "[unit]") {
    const Kernels base = called("base"), wide = called("wide"), widest = called("widest");
    const std::vector<KernelSet> sets{{&base, true}, {&wide, true}, {&widest, false}};
    CHECK(refusal(sets, "avx") == "environment: SKERRY_INSTRUCTION_SET: found \"avx\", expected one of base, wide");
    CHECK(refusal(sets, "widest") ==
          "environment: SKERRY_INSTRUCTION_SET: found \"widest\", expected one of base, wide (this build contains this "
          "instruction set, "
          "but the processor or the operating system does not support it)");
}

TEST_CASE("the kernels of this process are among those that it lists", "[unit]") {
    const std::vector<std::string_view> sets = instruction_sets();
    CHECK(std::count(sets.begin(), sets.end(), instruction_set()) == 1);
    CHECK(kernel_sets().front().runs);
}

}  // namespace skerry::test::kernels_test
