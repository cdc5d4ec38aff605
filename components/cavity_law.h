// The laws of the pressure in cavities, and the handles of cavities and pipes.
#pragma once

#include <cstdint>

#include "components/handle.h"
#include "components/options.h"

namespace skerry {

using CavityHandle = Handle<struct CavityTag>;
using PipeHandle = Handle<struct PipeTag>;

/// Law of the pressure in a cavity. pressure: prescribed. gas: p V^gamma is constant while the mass of the gas is
/// constant. liquid: the volume of the liquid is prescribed, and its bulk modulus is given.
enum class CavityLaw : std::uint8_t { pressure, gas, liquid };
template <>
struct EnumNames<CavityLaw> {
    static constexpr std::array<std::pair<CavityLaw, std::string_view>, 3> table{{
        {CavityLaw::pressure, "pressure"},
        {CavityLaw::gas, "gas"},
        {CavityLaw::liquid, "liquid"},
    }};
};

}  // namespace skerry
