// Runs one variant of a scene.
#pragma once

#include <atomic>
#include <filesystem>

#include "skerry/scene.h"
#include "skerry/study.h"

namespace skerry {

/// A run to be made.
struct VariantJob {
    std::filesystem::path scene;
    SceneOverrides overrides;  // assignments of the variant, and the number of threads
    StudyVariant variant;
};

/// Simulates a variant, with the same calls of World::advance as `skerry run`. Stores all results in `run`, except the
/// assignments. If the scene is invalid or a step fails, the status in `run` says so. Returns false if `stop` ended the
/// run between two steps. `progress`: receives the simulated part of the duration, from 0 to 1.
bool run_variant(const VariantJob& job, const std::atomic<bool>& stop, std::atomic<double>& progress, StudyRun& run);

/// Moves the nodes that no attachment holds by at most 1e-12 m, so that a comparison of runs shows how much tiny
/// differences grow. A rigid body moves as a whole, unless an attachment holds it. `draw`: seed of the random
/// movements; 0 moves nothing.
void perturb_start(int draw, World& world);

}  // namespace skerry
