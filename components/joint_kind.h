// What joints there are, and how a user names one.
#pragma once

#include <cstdint>

#include "components/handle.h"
#include "components/options.h"

namespace skerry {

using JointHandle = Handle<struct JointTag>;

/// What a joint leaves to its two bodies. ball: a point of both stays one. hinge: that, and they turn about one axis.
/// slider: they move along one axis and do not turn against each other. fixed: neither.
enum class JointKind : std::uint8_t { ball, hinge, slider, fixed };
template <>
struct EnumNames<JointKind> {
    static constexpr std::array<std::pair<JointKind, std::string_view>, 4> table{{
        {JointKind::ball, "ball"},
        {JointKind::hinge, "hinge"},
        {JointKind::slider, "slider"},
        {JointKind::fixed, "fixed"},
    }};
};

}  // namespace skerry
