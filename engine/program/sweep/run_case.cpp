#include "engine/program/sweep/run_case.h"
#include "engine/base/separate_outputs.h"

#include <csignal>
#include <exception>
#include <iostream>

#include "engine/program/progress.h"
#include "skerry/error.h"

namespace skerry {

namespace {

RunOptions options_of(const CaseJob& job) {
    RunOptions options;
    options.scene = job.scene;
    options.overrides.assignments = job.head.assignments;
    options.overrides.threads = 1;
    options.overrides.backend = Backend::serial;
    options.quiet = true;
    options.series_figures = true;
    if (job.probes) options.outputs["--probes"] = unfinished_series_file(job.folder, job.index);
    return options;
}

int run_to_file(const CaseJob& job) {
    CaseResult result;
    Json report;
    try {
        RunRanks alone;
        const RunResult run = simulate(options_of(job), alone);
        if (run.stopped_by != 0) return exit_signal + run.stopped_by;
        if (!run.outputs_failed.empty()) return exit_output;
        result = result_of(run, cpu_seconds());
        report = statistics_of(run);
    } catch (const OutputReserved& reserved) {  // another process runs this case and writes its files
        std::cerr << "skerry: " << reserved.what() << std::endl;
        return exit_output;
    } catch (const SceneError& error) {
        result.status = CaseStatus::refused;
        result.message = error.what();
        result.figures = {{"seconds_cpu", cpu_seconds()}};
    }
    result.index = job.index;
    const std::filesystem::path unfinished = unfinished_series_file(job.folder, job.index);
    std::error_code error;
    if (job.probes && std::filesystem::exists(unfinished, error))
        std::filesystem::rename(unfinished, series_file(job.folder, job.index));
    try {
        write_case(case_file(job.folder, job.index), job.head, result, report);
    } catch (const SceneError& failure) {
        std::cerr << "skerry: " << failure.what() << std::endl;
        return exit_output;
    }
    return exit_ok;
}

}  // namespace

int run_case(const CaseJob& job) {
    // With SIGXFSZ ignored, exceeding the file size limit becomes an ordinary write error.
    std::signal(SIGXFSZ, SIG_IGN);
    try {
        return run_to_file(job);
    } catch (const std::exception& error) {
        std::cerr << "skerry: case " << job.index << ": " << error.what() << std::endl;
        return exit_failed;
    }
}

std::filesystem::path series_file(const std::filesystem::path& folder, int index) {
    return case_file(folder, index).replace_extension(".csv");
}

std::filesystem::path unfinished_series_file(const std::filesystem::path& folder, int index) {
    return case_file(folder, index).replace_extension(".part.csv");
}

}  // namespace skerry
