// The kinds of joints, and the handle of a joint.
#pragma once

#include <cstdint>

#include "components/handle.h"
#include "components/options.h"

namespace skerry {

using JointHandle = Handle<struct JointTag>;  // refers to a joint of a world

/// Relative motion of two bodies that a joint permits.
enum class JointKind : std::uint8_t {
    ball,    // rotation about a common point
    hinge,   // rotation about one axis
    slider,  // translation along one axis, without rotation
    fixed,   // no relative motion
};
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
