// Overlap of surfaces whose motion is prescribed, so that contacts cannot separate them.
#pragma once

#include <cstdint>

#include "components/types.h"

namespace skerry {

/// Largest overlap of surfaces whose nodes no contact can move, because attachments or scripts prescribe their motion.
struct HeldDepth {
    static constexpr std::uint64_t no_pair = ~std::uint64_t{0};

    Real depth = 0;                // [m]
    std::uint64_t pair = no_pair;  // ContactKey::pair of the two objects; no_pair: no overlap, or an object was removed

    void take(const HeldDepth& other) {
        if (other.depth > depth) *this = other;
    }
};

}  // namespace skerry
