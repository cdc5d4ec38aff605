// Engines that run a scene of profile_stiff_peers, and their settings.
#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "profiling/work_precision/runs.h"

namespace skerry::profiling {

/// One engine with one setting: a point of a plot. It is Skerry if `peer` is empty.
struct Runner {
    std::string engine, setting;
    Real step = 0;  // step size; 0 leaves it to the engine [s]
    SkerryVariant ours{};
    std::optional<Peer> peer{};
    ElementKind element = ElementKind::linear;  // kind of element of Skerry
    bool keeps_distance = true;                 // true if the engine keeps a distance between surfaces

    /// Returns the scene in the form for this engine.
    PrecisionScene prepared(const PrecisionScene& scene) const;
    /// Runs a scene returned by prepared().
    Record run(const PrecisionScene& scene, double cap, const std::filesystem::path& folder) const;
};

/// Returns the runners that are installed. `mujoco` and `drake` are Python interpreters that have the module, or empty.
std::vector<Runner> make_runners(const PrecisionScene& scene, const std::string& mujoco, const std::string& drake);

}  // namespace skerry::profiling
