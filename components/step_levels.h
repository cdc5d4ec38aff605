// Levels of multirate stepping: elements of level l get one impulse in 2^l steps.
#pragma once

#include <array>
#include <cstdint>
#include <span>

#include "components/types.h"

namespace skerry {

inline constexpr int element_level_count = 8;  // levels of elements within their body
// levels in the world: that of the element within its body plus that of the body
inline constexpr int step_level_count = 16;

/// One bit a level.
using LevelMask = std::uint16_t;

/// Which levels get an impulse in this step, and how long each lasts in steps; 0: none. Without multirate every level
/// lasts one step.
struct ActiveLevels {
    std::array<Real, step_level_count> duration;

    ActiveLevels() { duration.fill(1); }
    bool all() const { return mask() == LevelMask(~0u); }
    LevelMask mask() const {
        unsigned bits = 0;
        for (int l = 0; l < step_level_count; ++l)
            if (duration[static_cast<std::size_t>(l)] != 0) bits |= 1u << l;
        return static_cast<LevelMask>(bits);
    }
};

/// What a kernel must know to leave out the blocks that get no impulse in this step. With empty spans every block is
/// due for one step.
struct ElementSchedule {
    std::span<const std::uint8_t> level = {};       // by block, within its body
    std::span<const Index> body = {};               // by block
    std::span<const std::uint8_t> body_level = {};  // by body
    ActiveLevels active = {};
    std::span<const std::uint8_t> body_asleep = {};  // by body; empty: none

    Real duration(std::size_t block) const {
        if (!body_asleep.empty() && body_asleep[static_cast<std::size_t>(body[block])]) return 0;
        return level.empty()
                   ? 1
                   : active.duration[std::size_t{level[block]} + body_level[static_cast<std::size_t>(body[block])]];
    }
    /// Whether nothing in begin .. end - 1 is due, where two looks can tell: blocks of a body are sorted by level.
    bool none_active(std::size_t begin, std::size_t end) const {
        if (level.empty() || level[begin] != level[end - 1] || body[begin] != body[end - 1]) return false;
        return duration(begin) == 0;
    }
};

}  // namespace skerry
