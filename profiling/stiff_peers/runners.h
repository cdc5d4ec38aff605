// Who runs a scene of profile_stiff_peers, and with which settings.
#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "profiling/work_precision/runs.h"

namespace skerry::profiling {

/// A point of a plot: ours if it has no peer.
struct Runner {
    std::string engine, setting;
    Real step = 0;  // s; 0 leaves it to the engine
    SkerryVariant ours{};
    std::optional<Peer> peer{};
    ElementKind element = ElementKind::linear;  // of ours
    bool keeps_distance = true;                 // between surfaces

    /// The scene as this engine gets it.
    PrecisionScene prepared(const PrecisionScene& scene) const;
    /// Runs what prepared() gave.
    Record run(const PrecisionScene& scene, double cap, const std::filesystem::path& folder) const;
};

/// Those that have a program here. `mujoco` and `drake` are Pythons that may have the module.
std::vector<Runner> make_runners(const PrecisionScene& scene, const std::string& mujoco, const std::string& drake);

}  // namespace skerry::profiling
