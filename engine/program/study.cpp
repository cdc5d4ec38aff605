// The command `skerry study`: error bars for the results of a scene.
#include <algorithm>
#include <array>
#include <iostream>
#include <ostream>
#include <system_error>

#include "engine/base/write_file.h"
#include "engine/program/commands.h"
#include "engine/program/csv_text.h"
#include "engine/program/require_writable.h"
#include "engine/program/signal_guard.h"
#include "engine/program/sweep/case_progress.h"
#include "engine/scene/case_hash.h"
#include "skerry/error.h"
#include "skerry/study.h"

namespace skerry {

namespace {

struct StudyFiles {
    std::filesystem::path json, csv, page, cheapest;
};

/// Returns the paths of the result files. Throws SceneError if one of them cannot be written, or is a file of the
/// scene.
StudyFiles study_files(const StudyOptions& options, const std::filesystem::path& folder) {
    const StudyFiles files{folder / "study.json", folder / "study.csv", folder / "study.html",
                           folder / "cheapest.json"};
    require_writable_folder(folder);
    for (const std::filesystem::path& file : {files.json, files.csv, files.page, files.cheapest})
        require_writable_file(file);
    const auto require_output = [&](const char* name, const std::filesystem::path& input) {
        require_distinct(std::array<NamedFile, 5>{{{name, input},
                                                   {"study.json", files.json},
                                                   {"study.csv", files.csv},
                                                   {"study.html", files.page},
                                                   {"cheapest.json", files.cheapest}}});
    };
    require_output("SCENE", options.scene);
    CaseHasher hasher(options.scene);
    hasher.hash(options.settings.assignments);
    for (const std::filesystem::path& input : hasher.files()) require_output("a file of SCENE", input);
    return files;
}

std::string quantities_csv(const StudyResult& result) {
    std::string csv;
    add_csv_line({"quantity", "unit", "value", "error", "mesh", "step", "contact", "noise", "scale", "best",
                  "best_error", "mesh_order", "expected_mesh_order", "step_order", "expected_step_order", "agree_until",
                  "verdict", "sentence"},
                 csv);
    for (const StudyQuantity& q : result.quantities) {
        std::vector<std::string> cells{q.name, q.unit};
        for (const Real number :
             {q.value, q.error, q.mesh, q.step, q.contact, q.noise, q.scale, q.best, q.best_error, q.mesh_order,
              q.expected_mesh_order, q.step_order, q.expected_step_order, q.agree_until})
            cells.push_back(csv_number(number));
        cells.insert(cells.end(), {std::string(name_of(q.verdict)), q.sentence});
        add_csv_line(cells, csv);
    }
    return csv;
}

std::vector<std::filesystem::path> write_results(const StudyOptions& options, const StudyFiles& files,
                                                 const StudyResult& result) {
    std::vector<std::filesystem::path> written{files.json, files.csv, files.page};
    std::error_code ignored;
    const bool earlier_study = std::filesystem::exists(files.json, ignored);
    write_file(files.json, [&](std::ostream& out) { out << study_json(result); });
    write_file(files.csv, [&](std::ostream& out) { out << quantities_csv(result); });
    write_file(files.page, [&](std::ostream& out) { out << study_page(result); });
    if (result.cheapest && result.cheapest->reaches) {
        write_cheapest_scene(options.scene, result, files.cheapest);
        written.push_back(files.cheapest);
    } else if (earlier_study) {
        std::filesystem::remove(files.cheapest, ignored);  // the file is that of an earlier study
    }
    return written;
}

StudyResult run_study(const StudyOptions& options, const std::filesystem::path& folder) {
    StudySettings settings = options.settings;
    settings.folder = folder;
    const SignalGuard guard;
    CaseProgress progress(!options.quiet, "runs");
    settings.go_on = [&](const StudyProgress& so_far) {
        progress.show(so_far.runs_done, so_far.runs_running, so_far.runs, so_far.share);
        return caught_signal == 0;
    };
    return study(options.scene, settings);
}

}  // namespace

int study(const StudyOptions& options) {
    const std::filesystem::path folder =
        options.out.empty() ? std::filesystem::path("out") / (options.scene.stem().string() + "_study") : options.out;
    const StudyFiles files = study_files(options, folder);
    const StudyResult result = run_study(options, folder);
    if (result.stopped) {
        if (!options.quiet)
            std::cout << "The study was stopped. Run the same command again"
                      << (options.settings.redo ? ", without --redo," : "")
                      << " to continue it: the finished runs are in " << folder.string() << "." << std::endl;
        return exit_signal + caught_signal;
    }
    try {
        const std::vector<std::filesystem::path> written = write_results(options, files, result);
        if (!options.quiet) {
            std::cout << study_text(result);
            for (const std::filesystem::path& file : written) std::cout << "wrote " << file.string() << "\n";
            std::cout << std::flush;
        }
    } catch (const SceneError& error) {  // the runs exist; only a result could not be written
        std::cerr << "skerry: " << error.what() << std::endl;
        return exit_output;
    }
    return result.runs.front().status == StudyRunStatus::ok ? exit_ok : exit_failed;
}

}  // namespace skerry
