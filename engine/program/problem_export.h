// Exports the contact problems of a run as files that other solvers can read.
#pragma once

#include <memory>

#include "engine/output/writer.h"
#include "engine/program/commands.h"

namespace skerry {

/// Writes the problems of the steps that the options name. Throws SceneError if the scene's name is not a file name.
std::unique_ptr<Writer> exported_problems(const std::filesystem::path& folder, const Scene& scene,
                                          const RunOptions& options);

}  // namespace skerry
