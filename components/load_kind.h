// The kinds of loads, and the handle of a load.
#pragma once

#include <cstdint>

#include "components/handle.h"
#include "components/options.h"

namespace skerry {

using LoadHandle = Handle<struct LoadTag>;  // refers to a load of a world

/// Force that a load exerts.
enum class LoadKind : std::uint8_t {
    force,         // total force on some nodes (ForceLoad)
    traction,      // force per area of some faces (TractionLoad)
    acceleration,  // uniform acceleration (AccelerationField)
    gravity,       // weight of the body times a factor (GravityScale)
    drag,          // force that draws velocities towards that of a wind (DragField)
};
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

/// Area on which a traction acts.
enum class LoadArea : std::uint8_t {
    reference,  // area of the faces in the rest shape: the force is constant (dead load)
    present,    // area of the deformed faces
};
template <>
struct EnumNames<LoadArea> {
    static constexpr std::array<std::pair<LoadArea, std::string_view>, 2> table{{
        {LoadArea::reference, "reference"},
        {LoadArea::present, "present"},
    }};
};

}  // namespace skerry
