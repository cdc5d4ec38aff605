// Scenes that run on ranks, and the comparison of such a run with the run without ranks.
#pragma once

#include <cstdint>
#include <functional>
#include <string>
#include <vector>

#include "components/types.h"
#include "engine/world/tuning.h"
#include "jobs/ranks/ranks.h"
#include "skerry/world.h"

namespace skerry::test {

struct RankScene {
    std::string name;
    std::function<World(int threads)> make;
    Real seconds = 0;  // simulated time of a run
};

/// Scene in a JSON file. `file`: path from the source folder.
RankScene scene_of_file(const std::string& file, const Tuning& tuning = {});
/// Scene of make_random_scene, for at most `steps` stable steps. Its changes during the run are left out, and settings
/// that ranks refuse are replaced.
RankScene random_rank_scene(std::uint64_t seed, int steps);

/// Record of a run without ranks.
struct WholeRun {
    std::vector<std::vector<std::uint64_t>> bodies;  // after each step: hash of each body, in the order of the slots
    std::vector<StepReport> reports;                 // of each call of advance
    Index most_asleep = 0;                           // largest number of sleeping bodies after a step
    bool woken = false;                              // true if a body that slept woke
};
WholeRun run_whole(const RankScene& scene, int threads = 1);

/// Runs a scene on ranks that are threads. `divide` divides a world that was just made. After each step, each rank
/// compares the bodies that it owns with the run without ranks. Returns a description of the first difference, with the
/// step, the body and the column; empty if all bits are equal.
std::string run_on_ranks_differs(const RankScene& scene, const WholeRun& whole, int ranks, int threads,
                                 const std::function<void(World&, Ranks&)>& divide);

}  // namespace skerry::test
