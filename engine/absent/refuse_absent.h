// Error for a call to a part of the library that this build does not contain.
#pragma once

#include <string>

#include "engine/base/complaint.h"

namespace skerry {

/// Throws SceneError that names the call. `option` is the CMake option that disabled this part of the library.
[[noreturn]] inline void refuse_absent(const char* call, const char* option) {
    refuse(call, {}, "a Skerry built with " + std::string(option) + "=OFF", "one with " + std::string(option) + "=ON");
}

}  // namespace skerry
