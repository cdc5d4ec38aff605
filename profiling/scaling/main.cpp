// profile_scaling: records the steps of scenes on one thread block by block, predicts their time on more cores, and
// measures it on the threads of this machine. profiling/plot_scaling.py draws the output.
#include <CLI/CLI.hpp>
#include <algorithm>
#include <cstdio>
#include <fstream>
#include <thread>

#include "profiling/scaling/pile.h"
#include "profiling/scaling/report.h"
#include "skerry/scene.h"

using namespace skerry;
using namespace skerry::profiling;

namespace {

struct ProgramOptions {
    std::vector<std::string> scenes;
    int pile = 0;        // number of balls along an edge; 0: no pile
    double seconds = 0;  // simulated time, 0: as set in the scene [s]
    int memory = 0;      // number of balls along an edge; 0: memory is not measured
    std::string ball = "scenes/meshes/drop_ball.msh";
    std::string out = "out/profiling/scaling";
    std::string record;
    StudyOptions study;
};

std::vector<int> threads_of_machine() {
    std::vector<int> threads{1};
    const int cores = std::max(2, static_cast<int>(std::thread::hardware_concurrency()));
    while (2 * threads.back() <= cores) threads.push_back(2 * threads.back());
    return threads;
}

void add_machine_options(CLI::App& app, MachineModel& machine) {
    const auto add = [&](const char* name, auto& value, const char* text) {
        app.add_option(name, value, text)->capture_default_str()->group("The machine that is predicted");
    };
    add("--join", machine.join, "s, until a worker that looks for work has its first block");
    add("--wake-up", machine.wake_up, "s, the same of a worker that sleeps");
    add("--patience", machine.patience, "s, that a worker looks for work before it sleeps");
    add("--barrier", machine.barrier, "s, a phase of a large region");
    add("--line-transfer", machine.line_transfer, "s, a cache line from core to core of a chiplet");
    add("--far-line-transfer", machine.far_line_transfer, "s, the same between chiplets");
    add("--cores-per-chiplet", machine.cores_per_chiplet, "cores that share a cache");
    add("--cache-per-chiplet", machine.cache_per_chiplet, "bytes, of it");
    add("--bandwidth", machine.bandwidth, "bytes/s, of all memory");
    add("--near-rate", machine.near_rate, "bytes/s, that a core gets from another of its chiplet");
    add("--far-rate", machine.far_rate, "bytes/s, that a core gets from another chiplet");
    add("--own-from-elsewhere", machine.own_from_elsewhere,
        "share of what blocks of a core's own share read that others have written");
}

void add_options(CLI::App& app, ProgramOptions& options) {
    StudyOptions& study = options.study;
    const auto scalar = [&](const char* name, auto& value, const char* text) {
        return app.add_option(name, value, text)->capture_default_str()->take_last();
    };
    app.add_option("scenes", options.scenes, "Scene files")->check(CLI::ExistingFile);
    scalar("--pile", options.pile, "Also a pile of N x N x N balls")->check(CLI::Range(0, 40));
    scalar("--ball", options.ball, "Mesh of its balls");
    scalar("--memory", options.memory, "Also what N x N x N balls take of the memory")->check(CLI::Range(0, 40));
    scalar("--seconds", options.seconds, "Simulated seconds of a scene; 0: what it says");
    scalar("--windows", study.windows, "Times at which steps are recorded")->check(CLI::PositiveNumber);
    scalar("--window-seconds", study.window, "That one thread takes for a window")->check(CLI::PositiveNumber);
    scalar("--repeats", study.repeats, "Recordings and runs of each, in turns")->check(CLI::PositiveNumber);
    scalar("--wait", study.wait, "s, for other programs to leave the cores alone, of each window");
    scalar("--workers", study.claimed_workers, "That work is cut for")->check(CLI::Range(2, 4096));
    scalar("--bytes-per-tetrahedron", study.bytes_per_tetrahedron, "That a step moves");
    app.add_option("--cores", study.cores, "Predicted; 1 is the base")->capture_default_str();
    app.add_option("--costs", study.costs, "Cores for which the cost of each stage is printed")->capture_default_str();
    app.add_option("--threads", study.threads, "Measured; 1 is the base")->capture_default_str();
    scalar("--record", options.record, "Also write all blocks of the last scene to this file (CSV)");
    scalar("--out", options.out, "Folder for the tables");
    add_machine_options(app, study.machine);
}

SceneStudy study_file(const std::string& file, const ProgramOptions& options) {
    Scene scene = load_scene(file, {});
    const double end = options.seconds > 0 ? options.seconds : scene.seconds;
    return study_scene(std::filesystem::path(file).stem().string(), scene.world, 0, end, options.study);
}

SceneStudy study_pile(const ProgramOptions& options) {
    constexpr double touching = 0.2, settled = 0.4;  // [s]
    World world = make_pile({.balls_per_edge = options.pile}, mesh::read(options.ball), 0);
    const int balls = options.pile * options.pile * options.pile;
    StudyOptions study = options.study;
    study.windows = (study.windows + 1) / 2;  // the pile changes little while it settles
    return study_scene("pile_" + std::to_string(balls), world, touching, settled, study);
}

void run(const ProgramOptions& options) {
    ScalingReport report;
    report.costs = measure_costs();
    print(report.costs, options.study.machine);
    if (options.memory > 0) {
        report.memory = measure_memory(mesh::read(options.ball), options.memory);
        print(*report.memory);
    }
    const auto add = [&](SceneStudy study) {
        print(study);
        report.studies.push_back(std::move(study));
        write(options.out, report, options.study);
    };
    for (const std::string& file : options.scenes) add(study_file(file, options));
    if (options.pile > 0) add(study_pile(options));
    write(options.out, report, options.study);
    if (!options.record.empty() && !report.studies.empty()) {
        std::ofstream file(options.record);
        write_csv(report.studies.back().recording, report.studies.back().stage_name, file);
    }
}

}  // namespace

int main(int argc, char** argv) {
    CLI::App app{
        "Records steps on one thread block by block, schedules them on more cores, and measures what the machine has."};
    ProgramOptions options;
    options.study.threads = threads_of_machine();
    add_options(app, options);
    CLI11_PARSE(app, argc, argv);
    try {
        run(options);
    } catch (const std::exception& error) {
        std::fprintf(stderr, "profile_scaling: %s\n", error.what());
        return 1;
    }
    return 0;
}
