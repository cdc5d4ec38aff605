// The outputs that `skerry run` offers. To add a format, write a Writer and add a row to the list in the source.
#pragma once

#include <filesystem>
#include <memory>
#include <span>

#include "engine/output/writer.h"
#include "engine/program/commands.h"
#include "engine/program/run_result.h"

namespace skerry {

/// The data from which a writer is made. The referenced objects outlive the writer.
struct OutputRequest {
    std::filesystem::path place;
    const Scene& scene;
    const RunOptions& options;
    const RunResult& result;  // complete when the writer is closed, except for writers further down the list
};

struct OutputFormat {
    const char* option;   // option of the command line whose value is the place
    const char* meaning;  // for `skerry run --help`
    bool is_folder;       // the place is a folder, not a file
    std::unique_ptr<Writer> (*make)(const OutputRequest&);
};

/// All formats, in the order in which the outputs of a run are written. The statistics are last: they report the
/// outputs that failed.
std::span<const OutputFormat> output_formats();

}  // namespace skerry
