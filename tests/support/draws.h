// Size of long tests: a part by default, all with SKERRY_FULL=1 in the environment (`scripts/test --full`).
#pragma once

#include <cstdlib>
#include <string_view>

namespace skerry::test {

/// True if long tests shall run in full.
inline bool full_tests() {
    const char* const value = std::getenv("SKERRY_FULL");
    return value != nullptr && std::string_view(value) == "1";
}

/// Number of random draws of a test that draws `all` of them in full.
inline int draws(int all) {
    return full_tests() ? all : (all + 9) / 10;
}

}  // namespace skerry::test
