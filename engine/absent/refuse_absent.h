// Error of calls to a part that this build does not have.
#pragma once

#include <string>

#include "skerry/error.h"

namespace skerry {

/// Throws SceneError. `option` is the CMake option that disabled the part.
[[noreturn]] inline void refuse_absent(const char* call, const char* option) {
    Complaint{.file = {},
              .object = call,
              .field = {},
              .found = "a Skerry built with " + std::string(option) + "=OFF",
              .expected = "one with " + std::string(option) + "=ON",
              .hint = {}}
        .raise();
}

}  // namespace skerry
