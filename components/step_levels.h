// Levels of multirate stepping: elements of level l get one impulse in 2^l steps.
#pragma once

#include <algorithm>
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

/// Stands for a level where elements are meant that get an impulse in every step, whatever their level is, since
/// contacts act on their nodes (docs/methods/stable_step.md 7.5).
inline constexpr int touched_level = 15;
static_assert(touched_level >= element_level_count && touched_level < 16);

/// Which levels get an impulse in this step, and how long each lasts, in kicks of the step; 0: none. Without multirate
/// every level lasts one.
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
    std::span<const std::uint8_t> body_asleep = {};       // by body; empty: none
    std::span<const std::uint16_t> body_unstrained = {};  // BodyTable; empty: elements that do nothing count, too
    std::span<const std::uint8_t> body_cap = {};  // by body: highest level in the world; empty: none is too high
    // by block: contacts act on its nodes; by body: whether any block is touched; empty: none
    std::span<const std::uint8_t> touched = {}, body_has_touched = {};

    Real duration(std::size_t block) const {
        if (!left_out(block) && !touched.empty() && touched[block]) return 1;
        return duration_of_level(block);
    }
    /// The same of a block that is not touched.
    Real duration_of_level(std::size_t block) const {
        if (left_out(block)) return 0;
        return level.empty() ? 1 : active.duration[level_in_world(block)];
    }
    /// Of a block that is not touched, where blocks have levels.
    std::size_t level_in_world(std::size_t block) const {
        const auto of_body = static_cast<std::size_t>(body[block]);
        const std::size_t own = std::size_t{level[block]} + body_level[of_body];
        return body_cap.empty() ? own : std::min(own, std::size_t{body_cap[of_body]});
    }
    /// Whether nothing in begin .. end - 1 is due, where two looks can tell: blocks of a body are sorted by level.
    bool none_active(std::size_t begin, std::size_t end) const {
        if (level.empty() || level[begin] != level[end - 1] || body[begin] != body[end - 1]) return false;
        if (!body_has_touched.empty() && body_has_touched[static_cast<std::size_t>(body[begin])]) return false;
        return duration(begin) == 0;
    }

private:
    bool left_out(std::size_t block) const {
        return (!body_asleep.empty() && body_asleep[static_cast<std::size_t>(body[block])]) ||
               (!body_unstrained.empty() && body_unstrained[static_cast<std::size_t>(body[block])]);
    }
};

}  // namespace skerry
