// Division of one world among several processes.
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <string_view>
#include <utility>

#include "components/options.h"
#include "skerry/world.h"

#pragma GCC visibility push(default)
namespace skerry {

/// The processes that simulate one world together. Each process is a rank.
class Ranks;

/// Rule that chooses the rank that owns each body. Connected bodies, for example those of a joint, always have one
/// owner. The rule does not affect the results of steps.
enum class OwnerMap : std::uint8_t {
    // A Hilbert curve through the bodies is cut into pieces of equal computing cost. Each rank owns the bodies of one
    // piece, which are neighbours.
    curve,
    round_robin,  // the ranks in turn, body by body
    random,       // random ranks, from RankSettings::seed
};
template <>
struct EnumNames<OwnerMap> {
    static constexpr std::array<std::pair<OwnerMap, std::string_view>, 3> table{{
        {OwnerMap::curve, "curve"},
        {OwnerMap::round_robin, "round_robin"},
        {OwnerMap::random, "random"},
    }};
};

/// Settings of distribute().
struct RankSettings {
    OwnerMap map = OwnerMap::curve;  // rule that chooses the owners
    // Upper limit of the computing cost of a rank, divided by the mean cost of the ranks. Above it the bodies get new
    // owners. Only for OwnerMap::curve.
    double most_imbalance = 1.2;
    std::uint64_t seed = 1;  // seed of OwnerMap::random
};

/// Divides the world of rank 0 among all ranks, which must all call the function. If the world cannot be divided,
/// throws SceneError on all ranks. The world of another rank may be empty. Its content is replaced by a part of the
/// world of rank 0, with the same handles; only its backend, its number of threads and the callback of watch_steps()
/// stay.
///
/// Afterwards each rank simulates the bodies that it owns. Rules for a divided world:
/// - All ranks must make the same calls of advance() and gathered().
/// - Calls that change objects throw SceneError.
/// - Functions that read it, such as energy() or state_hash(), use only the bodies that this rank holds. Read results
///   from gathered().
/// - An error of one rank alone, such as too little memory, ends all ranks with a message and exit code 1.
void distribute(World& world, Ranks& ranks, const RankSettings& settings = {});

/// Returns the complete world on rank 0, and an empty optional on the other ranks. All ranks must call the function.
/// The result equals the world that one process would have computed, with the same handles. If the world is not
/// divided, returns a copy of it.
std::optional<World> gathered(const World& world);

}  // namespace skerry
#pragma GCC visibility pop
