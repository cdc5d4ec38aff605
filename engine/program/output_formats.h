// List of the outputs that `skerry run` offers. To add a format, write a Writer and add a row to the list in
// output_formats.cpp.
#pragma once

#include <filesystem>
#include <memory>
#include <span>

#include "engine/output/writer.h"
#include "engine/program/commands.h"
#include "engine/program/run_result.h"

namespace skerry {

/// Data from which a Writer is constructed. The objects that it refers to outlive the writer.
struct OutputRequest {
    std::filesystem::path path;
    const Scene& scene;
    const RunOptions& options;
    // Result of the run. When a writer is closed, the result is complete except for the entries about writers that are
    // closed later.
    const RunResult& result;
};

struct OutputFormat {
    const char* option;   // option on the command line; its value is the file or folder
    const char* meaning;  // description of the option for `skerry run --help`
    bool is_folder;       // true if the value of the option is a folder
    std::unique_ptr<Writer> (*make)(const OutputRequest&);
};

/// Returns all formats, in the order in which the outputs of a run are written. The statistics come last, because they
/// list the outputs that failed.
std::span<const OutputFormat> output_formats();

}  // namespace skerry
