// profile_step: cost of a step of each scene: nanoseconds per tetrahedron and per contact, the share of each stage, CPU
// seconds per simulated second, and two threads against one, in turns.
#include <CLI/CLI.hpp>
#include <algorithm>
#include <cstdio>
#include <filesystem>
#include <fstream>
#include <map>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "profiling/measure.h"
#include "skerry/scene.h"

using namespace skerry;
using namespace skerry::profiling;

namespace {

struct Run {
    double wall = 0;  // [s]
    double cpu = 0;   // of all threads [s]
    WorldReport report;
};

Run run(const std::filesystem::path& scene_file, int threads, double seconds, double frame) {
    SceneOverrides overrides;
    overrides.threads = threads;
    Scene scene = load_scene(scene_file, overrides);
    if (seconds <= 0) seconds = scene.seconds;
    Run result;
    const double begin = wall_seconds();
    const double cpu_begin = cpu_seconds(CLOCK_PROCESS_CPUTIME_ID);
    for (double left = seconds; left > 1e-12; left -= frame) {
        const StepReport step = scene.world.advance(std::min(left, frame));
        if (!step.ok()) throw std::runtime_error(scene_file.string() + ": " + step.message());
    }
    result.cpu = cpu_seconds(CLOCK_PROCESS_CPUTIME_ID) - cpu_begin;
    result.wall = wall_seconds() - begin;
    result.report = scene.world.report();
    return result;
}

bool starts_with_any(const std::string& name, std::initializer_list<const char*> parts) {
    return std::any_of(parts.begin(), parts.end(), [&](const char* part) { return name.rfind(part, 0) == 0; });
}

double stage_seconds(const WorldReport& report, std::initializer_list<const char*> parts) {
    double sum = 0;
    for (const StageReport& stage : report.stages)
        if (starts_with_any(stage.name, parts)) sum += stage.seconds;
    return sum;
}

template <class Value>
double median_of(const std::vector<Run>& runs, Value value) {
    std::vector<double> values;
    for (const Run& r : runs) values.push_back(value(r));
    return median(std::move(values));
}

nlohmann::json print_scene(const std::string& name, const std::map<int, std::vector<Run>>& runs) {
    const std::vector<Run>& single = runs.begin()->second;
    const WorldReport& report = single.front().report;
    const double steps = static_cast<double>(report.steps), elements = static_cast<double>(report.elements);
    const double contacts = report.mean_contacts * steps;
    const auto per_tet = [&](const Run& r) {
        return 1e9 * stage_seconds(r.report, {"dynamics/compute_element_forces", "dynamics/predict_velocity"}) /
               (steps * elements);
    };
    const auto per_contact = [&](const Run& r) {
        return contacts > 0 ? 1e9 * stage_seconds(r.report, {"collision/", "contact/", "solver/"}) / contacts : 0.0;
    };
    std::printf(
        "\n%s: %zu tetrahedra, %zu bodies, %llu steps of %.3g s, %.1f contacts and %.1f regions a step, largest region "
        "%d\n",
        name.c_str(), report.elements, report.bodies, static_cast<unsigned long long>(report.steps),
        report.time / steps, report.mean_contacts, report.mean_regions, report.largest_region);
    std::printf(
        "  one thread: %.1f ns per tetrahedron and step, %.0f ns per contact and step (detection, separation and "
        "solve)\n",
        median_of(single, per_tet), median_of(single, per_contact));
    nlohmann::json json{{"scene", name},
                        {"elements", report.elements},
                        {"steps", report.steps},
                        {"seconds_simulated", report.time},
                        {"mean_contacts", report.mean_contacts},
                        {"mean_regions", report.mean_regions},
                        {"max_penetration", report.max_penetration},
                        {"max_gap_violation", report.max_gap_violation},
                        {"worst_volume_ratio", report.worst_volume_ratio},
                        {"ns_per_tetrahedron", median_of(single, per_tet)},
                        {"ns_per_contact", median_of(single, per_contact)}};
    for (const auto& [threads, list] : runs) {
        const double wall = median_of(list, [](const Run& r) { return r.wall; }) / report.time;
        const double cpu = median_of(list, [](const Run& r) { return r.cpu; }) / report.time;
        const double speedup = median_of(single, [](const Run& r) { return r.wall; }) / report.time / wall;
        std::printf("  %d thread%s: %.3f s wall and %.3f s CPU per simulated second (%.2f x)\n", threads,
                    threads == 1 ? "" : "s", wall, cpu, speedup);
        json["threads"][std::to_string(threads)] = {
            {"wall_per_second", wall}, {"cpu_per_second", cpu}, {"speedup", speedup}};
    }
    std::printf(
        "  overlap of surfaces at most %.3g mm, into the contact shell %.3g mm, smallest element volume ratio now "
        "%.3f, worst region error "
        "%.2g, "
        "%llu of %llu regions not converged\n",
        1e3 * report.max_penetration, 1e3 * report.max_gap_violation, report.worst_volume_ratio, report.worst_error,
        static_cast<unsigned long long>(report.unconverged), static_cast<unsigned long long>(report.solved));
    double all = 0;
    for (const StageReport& stage : report.stages) all += stage.seconds;
    for (const StageReport& stage : report.stages) {
        if (stage.seconds < 0.002 * all) continue;
        std::printf("    %5.1f %%  %-34s %8.2f us a run, %5.1f %% of runs skipped\n", 100 * stage.seconds / all,
                    stage.name.c_str(),
                    1e6 * stage.seconds / static_cast<double>(std::max<std::uint64_t>(stage.runs, 1)),
                    100.0 * static_cast<double>(stage.skipped) /
                        static_cast<double>(std::max<std::uint64_t>(stage.runs + stage.skipped, 1)));
        json["stages"][stage.name] = {{"seconds", stage.seconds}, {"runs", stage.runs}, {"skipped", stage.skipped}};
    }
    return json;
}

}  // namespace

int main(int argc, char** argv) {
    CLI::App app{"Times whole steps of scenes: per tetrahedron, per contact, per stage, one thread against several."};
    std::vector<std::string> scenes;
    std::vector<int> threads{1, 2};
    double seconds = 0;
    int repeats = 3;
    std::string json_file;
    app.add_option("scenes", scenes, "Scene files")->required()->check(CLI::ExistingFile);
    app.add_option("--threads", threads, "Numbers of threads to compare, the first is the base")->capture_default_str();
    app.add_option("--seconds", seconds, "Simulated seconds; 0: what the scene says")->capture_default_str();
    app.add_option("--repeats", repeats, "Runs of each, taken in turns; medians are printed")
        ->check(CLI::PositiveNumber)
        ->capture_default_str();
    app.add_option("--json", json_file, "Also write the figures to this file");
    CLI11_PARSE(app, argc, argv);
    try {
        nlohmann::json all = nlohmann::json::array();
        for (const std::string& file : scenes) {
            std::map<int, std::vector<Run>> runs;
            for (int repeat = 0; repeat < repeats; ++repeat)
                for (int count : threads) runs[count].push_back(run(file, count, seconds, 1.0 / 60));
            all.push_back(print_scene(std::filesystem::path(file).stem().string(), runs));
            std::fflush(stdout);
        }
        if (!json_file.empty()) std::ofstream(json_file) << all.dump(1) << '\n';
    } catch (const std::exception& error) {
        std::fprintf(stderr, "%s\n", error.what());
        return 1;
    }
    return 0;
}
