// What a build without a part says where that part is called.
#pragma once

#include <string>

#include "skerry/error.h"

namespace skerry {

/// `option` is that of CMake which leaves the part out.
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
