#include "engine/program/run_outputs.h"

#include <algorithm>
#include <array>
#include <exception>
#include <iostream>
#include <ostream>

#include "engine/output/vtk/vtk_series.h"
#include "engine/output/write_file.h"
#include "engine/program/progress.h"
#include "engine/program/require_writable.h"
#include "skerry/error.h"

namespace skerry {

namespace {

/// Refuses a file that could be replaced by a frame of --out, or could replace one.
void require_no_frame(const NamedFile& file, const RunOptions& options, const std::string& scene) {
    if (file.file.empty() || options.out.empty()) return;
    std::error_code error;
    const auto folder = [&](const std::filesystem::path& place) {
        return std::filesystem::weakly_canonical(std::filesystem::absolute(place), error);
    };
    const std::filesystem::path place = folder(file.file);
    if (place.parent_path() != folder(options.out / "frame").parent_path() ||
        !is_series_file(place.filename().string(), scene))
        return;
    Complaint{.file = file.file.string(),
              .object = std::string(file.name),
              .field = {},
              .found = "a file that --out writes, too",
              .expected = "one of its own",
              .hint = {}}
        .raise();
}

void check_places(const RunOptions& options, const std::string& scene) {
    for (const auto* folder : {&options.out, &options.problems})
        if (!folder->empty()) require_writable_folder(*folder);
    for (const auto* file : {&options.stats, &options.page, &options.trace, &options.probes, &options.checkpoint})
        if (!file->empty()) require_writable_file(*file);
    // a checkpoint may replace the one that the run resumes from
    std::error_code error;
    const bool goes_on = std::filesystem::equivalent(options.restart, options.checkpoint, error);
    const std::array<NamedFile, 7> files{{{"the scene", options.scene},
                                          {"--restart", goes_on ? std::filesystem::path() : options.restart},
                                          {"--checkpoint", options.checkpoint},
                                          {"--page", options.page},
                                          {"--probes", options.probes},
                                          {"--stats", options.stats},
                                          {"--trace", options.trace}}};
    require_distinct(files);
    for (const NamedFile& file : files) require_no_frame(file, options, scene);
}

bool is_csv(const std::filesystem::path& file) {
    return file.extension() == ".csv";
}

void check_probes(const RunOptions& options, const Scene& scene) {
    if (options.probes.empty()) return;
    const auto refuse = [&](const std::string& found, const std::string& expected, const std::string& hint) {
        Complaint{.file = options.probes.string(),
                  .object = "--probes",
                  .field = {},
                  .found = found,
                  .expected = expected,
                  .hint = hint}
            .raise();
    };
    const std::string extension = options.probes.extension().string();
    if (!is_csv(options.probes) && extension != ".h5" && extension != ".hdf5")
        refuse(extension.empty() ? "a name without extension" : "the extension " + extension, ".csv, .h5 or .hdf5", {});
    if (scene.recorded.empty())
        refuse("a scene without a probe that has a series", "one in \"probes\" with a quantity",
               "motion, force, reaction, energy, stress or volume; docs/outputs.md");
}

}  // namespace

RunOutputs::RunOutputs(const RunOptions& options, const Scene& scene)
    : out_{"--out", options.out},
      page_file_{"--page", options.page},
      probes_{"--probes", options.probes},
      trace_{"--trace", options.trace},
      problem_folder_{"--export-problems", options.problems},
      stats_{"--stats", options.stats},
      problems_(options, scene.name) {
    check_places(options, scene.name);
    check_probes(options, scene);
    if (out_.open()) {
        vtk_ = std::make_unique<VtkWriter>(out_.place, scene.name);
        vtk_->name_materials(scene.materials);
    }
    if (page_file_.open()) page_ = std::make_unique<PageWriter>(page_file_.place, scene.name);
}

void RunOutputs::attempt(Output& output, FunctionRef<void()> write) {
    if (!output.open()) return;
    try {
        write();
    } catch (const std::exception& error) {
        output.failure = error.what();
        clear_bar();
        std::cerr << "skerry: " << error.what() << "; " << output.option << " ends here, the rest goes on" << std::endl;
    }
}

void RunOutputs::watch(World& world, double steps_to_come) {
    if (!problem_folder_.open()) return;
    const auto take = [this, &world](const StepProblem& step) {
        attempt(problem_folder_, [&] { problems_.write_step(step); });
        if (!problem_folder_.open()) world.watch_contact_problems({});
    };
    world.watch_contact_problems(take, problems_.every(steps_to_come));
}

void RunOutputs::record(Scene& scene, bool go_on) {
    if (!probes_.open()) return;
    recorder_ = std::make_unique<Recorder>(scene.world, scene.recorded);
    attempt(probes_, [&] {
        if (is_csv(probes_.place))
            recorder_->stream_csv(probes_.place, go_on ? std::optional(scene.world.time()) : std::nullopt);
        if (!go_on) recorder_->sample(scene.world);
    });
}

void RunOutputs::sample(const World& world) {
    const Stopwatch watch;
    attempt(probes_, [&] { recorder_->sample(world); });
    seconds_ += watch.seconds();
}

void RunOutputs::add_frame(const World& world) {
    const Stopwatch watch;
    attempt(out_, [&] { vtk_->write_frame(world); });
    if (vtk_ && !out_.open()) {
        try {
            vtk_->close();  // makes the frames so far readable if there is space for the index
        } catch (const SceneError&) {
        }
        vtk_.reset();
    }
    attempt(page_file_, [&] { page_->add_frame(world); });
    ++frames_;
    seconds_ += watch.seconds();
}

void RunOutputs::go_on(const World& world, const RunMemory& memory) {
    frames_ = static_cast<int>(memory.frame) + 1;
    attempt(out_, [&] { vtk_->go_on(world, static_cast<std::size_t>(frames_), memory.frame_step); });
    attempt(page_file_, [&] { page_->add_frame(world); });
}

void RunOutputs::finish(const World& world, RunResult& result) {
    const Stopwatch watch;
    attempt(out_, [&] { vtk_->close(); });
    attempt(page_file_, [&] { page_->close(world); });
    attempt(probes_, [&] {
        if (!is_csv(probes_.place)) recorder_->write_hdf5(probes_.place);
    });
    attempt(trace_, [&] { write_file(trace_.place, [&](std::ostream& out) { world.write_trace(out); }); });
    result.seconds_output += seconds_ + watch.seconds() + problems_.seconds();
    result.frames = frames_;
    const auto note_failures = [&] {
        result.outputs_failed.clear();
        for (const Output* output : all())
            if (!output->failure.empty()) result.outputs_failed.emplace_back(output->option, output->failure);
    };
    note_failures();
    attempt(stats_, [&] {
        write_file(stats_.place, [&](std::ostream& out) { out << statistics_of(result).dump(1) << "\n"; });
    });
    note_failures();
}

bool RunOutputs::all_failed() const {
    const std::vector<const Output*> outputs = all();
    const auto is_open = [](const Output* output) { return output->open(); };
    const auto has_failed = [](const Output* output) { return !output->failure.empty(); };
    return std::ranges::none_of(outputs, is_open) && std::ranges::any_of(outputs, has_failed);
}

std::string RunOutputs::summary() const {
    std::string text;
    const auto add = [&](const std::string& line) { text += "  wrote         " + line + "\n"; };
    for (const Output* output : {&out_, &page_file_, &probes_, &stats_, &trace_})
        if (output->open()) add(output->place.string());
    if (!problem_folder_.place.empty())
        add(std::to_string(problems_.files()) + " contact problems of " + std::to_string(problems_.steps()) +
            " steps to " + problem_folder_.place.string());
    for (const Output* output : all())
        if (!output->failure.empty())
            text += "  NOT WRITTEN   " + std::string(output->option) + ": " + output->failure + "\n";
    return text;
}

}  // namespace skerry
