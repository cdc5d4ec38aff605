#include "engine/program/run_outputs.h"
#include "engine/base/write_file.h"

#include <algorithm>
#include <exception>
#include <iostream>
#include <set>
#include <string_view>
#include <system_error>

#include "engine/base/complaint.h"
#include "engine/program/output_formats.h"
#include "engine/program/progress.h"
#include "engine/program/require_writable.h"

namespace skerry {

namespace {

/// Returns the file or folder of an output, or an empty path if the output is not requested.
std::filesystem::path path_of(const OutputFormat& format, const RunOptions& options) {
    const auto found = options.outputs.find(format.option);
    return found == options.outputs.end() ? std::filesystem::path() : found->second;
}

/// Throws SceneError unless all outputs can be written and no file is used twice. Returns all files that the user has
/// named, for reading or for writing.
std::vector<NamedFile> check_paths(const RunOptions& options) {
    // The checkpoint file may be the file from which the run resumes. It is then listed only once, because
    // require_distinct() refuses equal files.
    std::error_code error;
    const bool same_file = std::filesystem::equivalent(options.restart, options.checkpoint, error);
    std::vector<NamedFile> files{{"the scene", options.scene},
                                 {"--restart", same_file ? std::filesystem::path() : options.restart},
                                 {"--checkpoint", options.checkpoint}};
    if (!options.checkpoint.empty()) require_writable_file(options.checkpoint);
    for (const OutputFormat& format : output_formats()) {
        const std::filesystem::path path = path_of(format, options);
        if (path.empty()) continue;
        if (format.is_folder) {
            require_writable_folder(path);
        } else {
            require_writable_file(path);
            files.push_back({format.option, path});
        }
    }
    require_distinct(files);
    const auto is_requested = [&](const char* option) {
        const auto found = options.outputs.find(option);
        return found != options.outputs.end() && !found->second.empty();
    };
    if ((options.film_color != FilmColor::none || options.film_max) && !is_requested("--film") &&
        !is_requested("--gltf"))
        refuse(options.film_max ? "--film-max" : "--film-color", {}, "neither --film nor --gltf",
               "at least one of them, because this option sets their colours");
    return files;
}

}  // namespace

RunOutputs::RunOutputs(const RunOptions& options, Scene& scene, const RunStart& start, RunResult& result)
    : result_(result) {
    const std::vector<NamedFile> files = check_paths(options);
    for (const OutputFormat& format : output_formats())
        if (const std::filesystem::path path = path_of(format, options); !path.empty())
            outputs_.push_back({format.option, format.make({path, scene, options, result})});
    for (const Output& output : outputs_)
        for (const NamedFile& file : files)
            if (!file.file.empty() && output.writer->may_write(file.file))
                refuse_in(file.file.string(), file.name, {},
                          std::string("a file that ") + output.option + " also writes", "a different file",
                          "choose another file name");
    reserve(options, scene.name);
    for (const Output& output : outputs_) output.writer->open(scene.world, start);
    result_.frames = static_cast<int>(start.frames);
}

void RunOutputs::reserve(const RunOptions& options, const std::string& scene) {
    std::set<std::filesystem::path> reserved;
    const auto lock = [&](const char* option, const std::filesystem::path& output, std::string_view name) {
        std::error_code error;
        const std::filesystem::file_status found = std::filesystem::status(output, error);
        // a device such as /dev/null
        const bool is_stream = exists(found) && !is_regular_file(found) && !is_directory(found);
        if (output.empty() || is_stream) return;
        std::filesystem::path lock_file = real_path(output);
        if (!name.empty()) lock_file /= name;
        lock_file += ".lock";
        if (reserved.insert(lock_file).second)
            locks_.emplace_back(lock_file, Complaint{output.string(), option, {}, {}, {}, {}},
                                "skerry run " + std::filesystem::absolute(options.scene).string());
    };
    lock("--checkpoint", options.checkpoint, {});
    // Runs of scenes with different names may share a folder. A name that is not a file name is refused by open().
    const std::string name = std::filesystem::path(scene).filename().string();
    for (const OutputFormat& format : output_formats())
        lock(format.option, path_of(format, options), format.is_folder ? name : std::string_view());
}

void RunOutputs::for_each(FunctionRef<void(Writer&)> write) {
    for (Output& output : outputs_) {
        if (output.failed) continue;
        const Stopwatch watch;
        try {
            write(*output.writer);
        } catch (const std::exception& error) {
            output.failed = true;
            result_.outputs_failed.emplace_back(output.option, error.what());
            clear_bar();
            std::cerr << "skerry: " << output.option
                      << " could not be written, but the run and all other outputs continue: " << error.what()
                      << std::endl;
        }
        result_.seconds_output += watch.seconds();
    }
}

void RunOutputs::sample(const World& world) {
    for_each([&](Writer& writer) { writer.sample(world); });
}

void RunOutputs::add_frame(const World& world) {
    for_each([&](Writer& writer) { writer.add_frame(world); });
    ++result_.frames;
}

void RunOutputs::finish(const World& world) {
    for (const Output& output : outputs_) {
        result_.seconds_wall -= output.writer->seconds_in_steps();
        result_.seconds_output += output.writer->seconds_in_steps();
    }
    for_each([&](Writer& writer) { writer.close(world); });
    for (const Output& output : outputs_)
        if (!output.failed) result_.written.push_back(output.writer->written());
}

bool RunOutputs::all_failed() const {
    return !outputs_.empty() && std::ranges::all_of(outputs_, &Output::failed);
}

}  // namespace skerry
