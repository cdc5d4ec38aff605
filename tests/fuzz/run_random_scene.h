// Runs a random scene and checks all of its results and reports.
#pragma once

#include <filesystem>

#include "random_scene.h"
#include "skerry/scene.h"

namespace skerry::test {

enum class SceneEnd {
    done,      // the whole scene ran
    refused,   // the scene, or a step of it, was refused with a message that names the cause
    cut_short  // the time was used up; everything that ran was valid
};

struct SceneRun {
    SceneEnd end = SceneEnd::done;
    std::string message;  // message of the refusal
    std::uint64_t steps = 0, hash = 0;
    Index max_contacts = 0;
    Real energy_growth = 0;       // for a passive scene: highest energy so far over the start energy
    Real energy_error_share = 0;  // WorldReport::energy_error_share at the end
};

/// Builds the scene in `folder` and runs it. `seconds`: CPU time after which no further step is tried. Throws
/// std::runtime_error with the fault: a number that is not finite, an invalid contact, a refusal that names no cause,
/// or energy that appears from nothing.
SceneRun run_random_scene(const RandomScene& scene, const std::filesystem::path& folder,
                          const SceneOverrides& overrides = {}, double seconds = 1e9);

}  // namespace skerry::test
