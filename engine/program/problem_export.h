// Exports the contact problems of a run as files for other solvers.
#pragma once

#include <memory>

#include "engine/output/writer.h"
#include "engine/program/commands.h"

namespace skerry {

/// Returns a writer for the contact problems of some steps of a run. `options` determines which steps, and whether a
/// file holds a whole step or one contact region. Throws SceneError if the name of the scene cannot be used as a file
/// name.
std::unique_ptr<Writer> exported_problems(const std::filesystem::path& folder, const Scene& scene,
                                          const RunOptions& options);

}  // namespace skerry
