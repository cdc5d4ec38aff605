// The laws of the pressure in cavities, and the handles of cavities and pipes.
#pragma once

#include <cstdint>

#include "components/handle.h"
#include "components/options.h"

namespace skerry {

using CavityHandle = Handle<struct CavityTag>;  // refers to a cavity of a world
using PipeHandle = Handle<struct PipeTag>;      // refers to a pipe between cavities of a world

/// Law of the pressure in a cavity.
enum class CavityLaw : std::uint8_t {
    pressure,  // the pressure is prescribed
    gas,       // p V^exponent is constant while the mass of the gas is constant (GasFilling)
    liquid,    // the volume of the liquid is prescribed; its bulk modulus gives the pressure (LiquidFilling)
};
template <>
struct EnumNames<CavityLaw> {
    static constexpr std::array<std::pair<CavityLaw, std::string_view>, 3> table{{
        {CavityLaw::pressure, "pressure"},
        {CavityLaw::gas, "gas"},
        {CavityLaw::liquid, "liquid"},
    }};
};

}  // namespace skerry
