// The kinds of ties, and the handle of a tie.
#pragma once

#include <cstdint>

#include "components/handle.h"
#include "components/options.h"

namespace skerry {

using TieHandle = Handle<struct TieTag>;  // refers to a tie of a world

/// Motion of a tied node relative to its point on the other object.
enum class TieKind : std::uint8_t {
    weld,   // no motion
    slide,  // motion in the tangent plane of the surface at the point
    // any motion that keeps the common centre of mass of all tied nodes at one point of the other object
    ball,
};
template <>
struct EnumNames<TieKind> {
    static constexpr std::array<std::pair<TieKind, std::string_view>, 3> table{{
        {TieKind::weld, "weld"},
        {TieKind::slide, "slide"},
        {TieKind::ball, "ball"},
    }};
};

}  // namespace skerry
