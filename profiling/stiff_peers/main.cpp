// profile_stiff_peers: compares stiff bodies of Skerry with those of MuJoCo and Drake where these are installed.
// Scenes: friction that holds and slides, a cantilever, a stack, a heavy ball on a soft block, a pile. Writes
// stiff_peers.csv; profiling/plot_stiff_peers.py prints tables of it and draws them.
//
// Every engine gets the same meshes, masses, material and gravity and runs on one thread. It is timed by the CPU time
// of its steps alone. It is measured from the motion of its nodes by the same rules (measures.h). Short runs are
// repeated in turns, one engine after the other.
#include <CLI/CLI.hpp>
#include <algorithm>
#include <array>
#include <cstdio>
#include <fstream>

#include "profiling/measure.h"
#include "profiling/stiff_peers/measures.h"
#include "profiling/stiff_peers/runners.h"
#include "profiling/stiff_peers/scenes.h"

using namespace skerry;
using namespace skerry::profiling;

namespace {

struct Options {
    std::vector<std::string> scenes{"holds", "slides", "cantilever", "stack", "ball on block", "pile"};
    std::vector<std::string> engines{"Skerry", "MuJoCo", "Drake"};
    std::filesystem::path out = "out/profiling/stiff";
    std::string mujoco = "python3", drake = "python3";
    double cap = 120;  // CPU time limit of a run [s]
    double once = 5;   // CPU time above which runs are not repeated [s]
    int repeat = 3;
    int finer = 1;
    std::string setting;  // only runs whose name contains this
};

std::vector<Real> moduli_of(const std::string& scene) {
    if (scene == "holds" || scene == "slides") return {1e6, 1e8, 1e10};
    if (scene == "cantilever") return {1e7, 1e9};
    return {scene == "ball on block" ? 1e5 : 1e8};
}

struct Timed {
    Runner runner;
    PrecisionScene scene;
    Record first{};
    std::vector<double> seconds{};
};

void write(Real modulus, const Timed& timed, std::ofstream& table) {
    const Measures m = measure(timed.scene, timed.first);
    std::vector<double> cpu = timed.seconds;
    for (double& seconds : cpu) seconds /= timed.scene.seconds;
    const auto [low, high] = std::minmax_element(cpu.begin(), cpu.end());
    table << timed.scene.name << ',' << modulus << ',' << timed.runner.engine << ",\"" << timed.runner.setting << "\","
          << timed.first.step << ',' << timed.scene.seconds << ',' << cpu.size() << ',' << median(cpu) << ',' << *low
          << ',' << *high << ',' << m.creep << ',' << m.acceleration_error << ',' << m.period << ',' << m.peak << ','
          << m.peak_time << ',' << m.left << ',' << m.speed << ',' << m.overlap << ',' << m.overlap_at_end << ','
          << m.below_planes << ',' << timed.first.finished << '\n'
          << std::flush;
}

/// Name of a runner with its step, for example "implicit, tolerance 1e-03, 10 ms".
std::string name_of(const Runner& runner) {
    std::array<char, 32> step;
    std::snprintf(step.data(), step.size(), ", %g ms", 1e3 * runner.step);
    return runner.setting + step.data();
}

void study(const std::string& name, Real modulus, const Options& options, std::ofstream& table) {
    const PrecisionScene scene = make_stiff_scene(name, modulus, options.finer);
    std::vector<Timed> all;
    for (const Runner& runner : make_runners(scene, options.mujoco, options.drake))
        if (std::ranges::count(options.engines, runner.engine) > 0 &&
            name_of(runner).find(options.setting) != std::string::npos)
            all.push_back({runner, runner.prepared(scene)});
    for (int r = 0; r < options.repeat; ++r)
        for (Timed& timed : all) {
            if (r > 0 && (!timed.first.finished || timed.seconds[0] > options.once)) continue;
            std::fprintf(stderr, "\r\033[K%s, %.0e Pa, %d of %d: %s %s, %g ms", name.c_str(), modulus, r + 1,
                         options.repeat, timed.runner.engine.c_str(), timed.runner.setting.c_str(),
                         1e3 * timed.runner.step);
            Record record = timed.runner.run(timed.scene, options.cap, options.out / "runs");
            timed.seconds.push_back(record.seconds);
            if (r == 0) timed.first = std::move(record);
        }
    for (const Timed& timed : all) write(modulus, timed, table);
}

}  // namespace

int main(int argc, char** argv) {
    CLI::App app{"Stiff bodies of ours beside MuJoCo's and Drake's where these are installed. Writes a CSV file."};
    Options options;
    bool quick = false;
    app.add_option("--scenes", options.scenes, "Only these")
        ->delimiter(',')
        ->check(CLI::IsMember(options.scenes))
        ->capture_default_str();
    app.add_option("--engines", options.engines, "Only these")
        ->delimiter(',')
        ->check(CLI::IsMember(options.engines))
        ->capture_default_str();
    app.add_option("--out", options.out, "Folder for the table")->capture_default_str();
    app.add_option("--mujoco", options.mujoco, "Python that may have MuJoCo")->capture_default_str();
    app.add_option("--drake", options.drake, "Python that may have Drake")->capture_default_str();
    app.add_option("--cap", options.cap, "CPU seconds of the longest run")->capture_default_str();
    app.add_option("--repeat", options.repeat, "Runs of which the median time counts, where they are short")
        ->capture_default_str();
    app.add_option("--finer", options.finer, "Into how many parts each edge of the meshes is cut")
        ->check(CLI::Range(1, 8))
        ->capture_default_str();
    app.add_option("--setting", options.setting, "Only runs in whose setting and step this is: '1e-03, 10 ms'");
    app.add_flag("--quick", quick, "Each run once and for 10 CPU seconds at most");
    CLI11_PARSE(app, argc, argv);
    if (quick) {
        options.repeat = 1;
        if (app.count("--cap") == 0) options.cap = 10;
    }
    try {
        std::filesystem::create_directories(options.out / "runs");
        if (!has_module(options.mujoco, "mujoco")) options.mujoco.clear();
        if (!has_module(options.drake, "pydrake")) options.drake.clear();
        const std::filesystem::path file = options.out / "stiff_peers.csv";
        std::ofstream table(file);
        table << "scene,modulus,engine,setting,step,simulated,runs,cpu_seconds,cpu_lowest,cpu_highest,creep,"
                 "acceleration_error,period,peak,peak_time,left,speed,overlap,overlap_at_end,below_planes,finished\n";
        for (const std::string& scene : options.scenes)
            for (const Real modulus : moduli_of(scene)) study(scene, modulus, options, table);
        std::fprintf(stderr, "\r\033[K");
        std::printf("%s\n", file.c_str());
    } catch (const std::exception& error) {
        std::fprintf(stderr, "\n%s\n", error.what());
        return 1;
    }
    return 0;
}
