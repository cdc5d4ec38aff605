// Runs a random scene and looks at everything that it says.
#pragma once

#include <filesystem>

#include "random_scene.h"
#include "skerry/scene.h"

namespace skerry::test {

enum class SceneEnd {
    done,      // all of it ran
    refused,   // the scene, or a step of it, was refused with a message that says whose fault it was
    cut_short  // it used up its time; what ran was fine
};

struct SceneRun {
    SceneEnd end = SceneEnd::done;
    std::string message;  // of the refusal
    std::uint64_t steps = 0, hash = 0;
    Index max_contacts = 0;
    Real energy_growth = 0;       // of a passive scene: the highest energy so far over what it started with
    Real energy_error_share = 0;  // WorldReport, at the end
};

/// Builds the scene in `folder` and runs it. Throws std::runtime_error that says what is wrong: a number that is not
/// finite, a contact that makes no sense, a refusal without a culprit, energy out of nothing. `seconds`: CPU time after
/// which no further step is tried.
SceneRun run_random_scene(const RandomScene& scene, const std::filesystem::path& folder,
                          const SceneOverrides& overrides = {}, double seconds = 1e9);

}  // namespace skerry::test
