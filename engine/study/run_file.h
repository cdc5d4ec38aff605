// Files with the results of the runs of a study.
#pragma once

#include <filesystem>
#include <optional>
#include <string>

#include "engine/base/separate_outputs.h"
#include "engine/scene/place.h"
#include "skerry/study.h"

namespace skerry {

/// Short name of a variant, for messages and files: scene, refine_1, step_0.5, tolerance_0.01, element_linear, draw_1.
std::string variant_name(const StudyVariant& variant);

/// Reserves a folder for one study. An empty path reserves nothing. Throws SceneError if another study has the folder.
OutputLock reserve_folder(const std::filesystem::path& folder, const std::filesystem::path& scene);

/// Writes the result of a run, completely or not at all. `inputs`: text that identifies all inputs of the run. Throws
/// SceneError.
void write_run(const std::filesystem::path& folder, const std::string& inputs, const StudyRun& run);

/// Result of a run in a folder.
struct StoredRun {
    std::optional<StudyRun> run;  // the run, if the file holds it and was written for the given inputs
    // if the file holds anything but this run: its content in words, for messages; else empty
    std::string found;
};
StoredRun read_run(const std::filesystem::path& folder, const std::string& inputs, const StudyVariant& variant);

/// Removes the file of a run, if there is one. Throws SceneError if the file holds anything else than a run of a study.
void remove_run(const std::filesystem::path& folder, const StudyVariant& variant);

Json variant_json(const StudyVariant& variant);
/// JSON document of a run without its time series.
Json run_json(const StudyRun& run);

}  // namespace skerry
