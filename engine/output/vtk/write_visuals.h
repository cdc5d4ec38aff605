// Writes the visual surfaces of one frame as a VTK file.
#pragma once

#include <filesystem>
#include <map>
#include <span>
#include <string>
#include <vector>

#include "engine/output/frame.h"

namespace skerry {

/// Numbers and names of bodies, and the node positions from which displacements are measured [m].
struct SeriesBodies {
    const std::map<BodyHandle, Index>& number;
    std::span<const std::string> names;
    const std::map<BodyHandle, std::vector<Vec3>>& origin;
};

/// Writes the visual surfaces of all bodies as one surface. A node with several pairs of texture coordinates becomes
/// one point per pair.
void write_visuals(const Frame& frame, const SeriesBodies& bodies, const std::filesystem::path& file);

}  // namespace skerry
