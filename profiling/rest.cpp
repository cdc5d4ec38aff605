// profile_rest: cost of a step when all bodies rest, over its cost while they move. Prints the table of
// docs/methods/skipping.md 3.2.
#include <CLI/CLI.hpp>
#include <algorithm>
#include <cstdio>
#include <filesystem>
#include <map>
#include <string>
#include <vector>

#include "profiling/measure.h"
#include "skerry/scene.h"

using namespace skerry;
using namespace skerry::profiling;

namespace {

/// Mean CPU time of a step over `seconds`, advanced in frames of length `frame` [s].
double cost_of_step(World& world, double seconds, double frame) {
    const double end = world.time() + seconds;
    std::uint64_t steps = 0;
    const double begin = cpu_seconds();
    while (world.time() < end) {
        const StepReport report = world.advance(frame);
        if (!report.ok()) throw std::runtime_error(report.message());
        steps += static_cast<std::uint64_t>(report.steps);
    }
    return (cpu_seconds() - begin) / static_cast<double>(steps);
}

bool all_rest(const World& world) {
    for (const BodyHandle body : world.bodies())
        if (!world.asleep(body)) return false;
    return true;
}

/// Sum of the weight and the contact forces of a resting body, over its weight: of the worst body, and the mean.
struct Missing {
    double worst = 0, mean = 0;
};

Missing missing_weight(World& world) {
    world.advance(1e-3);
    std::map<std::uint32_t, Vec3> force;
    for (const BodyHandle body : world.bodies()) force[body.slot] = world.mass(body) * world.settings().gravity;
    for (const Contact& contact : world.contacts()) {
        if (world.alive(contact.first)) force[contact.first.slot] += contact.force();
        if (world.alive(contact.second)) force[contact.second.slot] -= contact.force();
    }
    Missing missing;
    for (const BodyHandle body : world.bodies()) {
        const double share = force[body.slot].norm() / (world.mass(body) * world.settings().gravity.norm());
        missing.worst = std::max(missing.worst, share);
        missing.mean += share / static_cast<double>(world.bodies().size());
    }
    return missing;
}

void print_row(const std::filesystem::path& file, double lively_until, double most, double frame) {
    SceneOverrides overrides;
    overrides.threads = 1;
    overrides.assignments = {"settings.sleep=true"};
    World world = load_scene(file, overrides).world;
    const double lively = cost_of_step(world, lively_until, frame);
    while (!all_rest(world) && world.time() < most) cost_of_step(world, 0.1, frame);
    const std::string name = file.stem().string();
    const std::size_t asleep = world.report().asleep, bodies = world.bodies().size();
    if (asleep < bodies) {
        std::printf("| %s | %zu of %zu rest after %.0f s |\n", name.c_str(), asleep, bodies, world.time());
        return;
    }
    const double since = world.time();
    std::vector<double> resting;
    for (int i = 0; i < 5; ++i) resting.push_back(cost_of_step(world, 1, frame));
    const Missing missing = missing_weight(world);
    std::printf("| %s | %zu | %zu | %zu | %.1f | %.1f | %.2f | %.2f %% | %.2g, %.2g |\n", name.c_str(), bodies,
                world.report().elements, world.contacts().size(), since, 1e6 * lively, 1e6 * median(resting),
                100 * median(resting) / lively, missing.mean, missing.worst);
    std::fflush(stdout);
}

}  // namespace

int main(int argc, char** argv) {
    CLI::App app{"What a step costs at rest, over what it costs while bodies move; CPU time of one thread."};
    std::vector<std::filesystem::path> scenes;
    double lively = 1, most = 60, frames = 60;
    app.add_option("scenes", scenes, "scene files")->required();
    app.add_option("--lively", lively, "s, from the start, that count as lively");
    app.add_option("--most", most, "s, after which what still moves is given up");
    app.add_option("--frames-per-second", frames, "which steps divide: other ones, another fall")
        ->check(CLI::PositiveNumber);
    CLI11_PARSE(app, argc, argv);
    std::printf(
        "| scene | bodies | tetrahedra | contacts at rest | all rest after, s | lively step, us | resting step, us "
        "| share | contacts miss the weight by (mean, worst body) |\n|---|---|---|---|---|---|---|---|---|\n");
    for (const std::filesystem::path& scene : scenes) print_row(scene, lively, most, 1 / frames);
}
