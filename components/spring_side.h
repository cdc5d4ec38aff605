// Springs: their handle, and the sides on which they act.
#pragma once

#include <cstdint>

#include "components/handle.h"
#include "components/options.h"

namespace skerry {

using SpringHandle = Handle<struct SpringTag>;  // refers to a spring of a world

/// Side on which a spring and its damper exert forces.
enum class SpringSide : std::uint8_t {
    both,         // at any length
    tension,      // only while the spring is longer than its rest length, like a cord
    compression,  // only while the spring is shorter than its rest length, like a buffer
};
template <>
struct EnumNames<SpringSide> {
    static constexpr std::array<std::pair<SpringSide, std::string_view>, 3> table{{
        {SpringSide::both, "both"},
        {SpringSide::tension, "tension"},
        {SpringSide::compression, "compression"},
    }};
};

}  // namespace skerry
