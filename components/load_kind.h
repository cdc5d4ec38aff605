// The kinds of loads, and the handle of a load.
#pragma once

#include <cstdint>

#include "components/handle.h"
#include "components/options.h"

namespace skerry {

using LoadHandle = Handle<struct LoadTag>;

/// Force that a load exerts. force: a total force on some nodes. traction: a force per area of some faces.
/// acceleration: a uniform acceleration. gravity: a factor of the weight. drag: a force towards the velocity of a wind.
enum class LoadKind : std::uint8_t { force, traction, acceleration, gravity, drag };
template <>
struct EnumNames<LoadKind> {
    static constexpr std::array<std::pair<LoadKind, std::string_view>, 5> table{{
        {LoadKind::force, "force"},
        {LoadKind::traction, "traction"},
        {LoadKind::acceleration, "acceleration"},
        {LoadKind::gravity, "gravity"},
        {LoadKind::drag, "drag"},
    }};
};

/// Area on which a traction acts: of the faces in the rest shape (dead load), or of the deformed faces.
enum class LoadArea : std::uint8_t { reference, present };
template <>
struct EnumNames<LoadArea> {
    static constexpr std::array<std::pair<LoadArea, std::string_view>, 2> table{{
        {LoadArea::reference, "reference"},
        {LoadArea::present, "present"},
    }};
};

}  // namespace skerry
