#include <cstdio>
#include <fstream>
#include <functional>
#include <map>
#include <string>
#include <utility>

#include "engine/world/tuning.h"
#include "profiling/measure.h"
#include "profiling/separation.h"
#include "skerry/world.h"

namespace skerry::profiling {
namespace {

/// Handling of the contacts of a run. The paper uses its combined solver without warm start, since it keeps nothing
/// from one step to the next.
struct Handling {
    const char* name;
    SolverMethod method;
    WarmStart warm_start;
};
const Handling handlings[] = {
    {"as in the paper", SolverMethod::pcg_pgs, WarmStart::off},
    {"default settings", Settings{}.method, Tuning{}.warm_start},
};
constexpr ContactRegions modes[] = {ContactRegions::separate, ContactRegions::global};

World empty_world(const Handling& handling, ContactRegions mode) {
    Settings settings;
    settings.backend = Backend::serial;
    settings.contact_regions = mode;
    settings.method = handling.method;
    settings.sleep = false;  // settled bodies are to be solved
    return tuned_world(settings, {.warm_start = handling.warm_start});
}

World balls_in_bucket(World world, int balls) {
    const auto rubber = world.add_material(
        {.young_modulus = 5e4, .poisson_ratio = 0.35, .density = 500, .friction = 0.5, .damping = 8});
    world.add_collider(Bucket{.radius = 0.3, .height = 0.5, .thickness = 0.05}, {.friction = 0.5});
    const Mesh ball = mesh::ball(0.05, 4);
    for (int i = 0; i < balls; ++i) {
        // Layers of four by four. Every second layer is shifted a little so that no ball stands on the top of another.
        const int layer = i / 16, row = i / 4 % 4, column = i % 4;
        const Real shift = 0.02 * (layer % 2) - 0.165;
        world.add_body(
            ball, {.material = rubber, .position = {0.11 * column + shift, 0.11 * row + shift, 0.055 + 0.1 * layer}});
    }
    return world;
}

World ball_and_skittles(World world) {
    const auto wood = world.add_material(
        {.young_modulus = 6e4, .poisson_ratio = 0.35, .density = 300, .friction = 0.4, .damping = 4});
    const auto rubber =
        world.add_material({.young_modulus = 8e4, .poisson_ratio = 0.4, .density = 900, .friction = 0.4, .damping = 2});
    world.add_collider(Plane{}, {.friction = 0.4});
    const Mesh skittle = mesh::skittle(0.38, 4);
    for (int row = 0; row < 4; ++row)
        for (int k = 0; k <= row; ++k)
            world.add_body(skittle, {.material = wood, .position = {0.1645 * row, 0.19 * (k - 0.5 * row), 0.001}});
    world.add_body(
        mesh::ball(0.12, 7),
        {.material = rubber, .position = {-0.6, 0.02, 0.121}, .velocity = {4, 0, 0}, .angular_velocity = {0, 33.3, 0}});
    return world;
}

double stage_seconds(const WorldReport& report, const char* name) {
    for (const StageReport& stage : report.stages)
        if (stage.name == name) return stage.seconds;
    return 0;
}

/// Advances by `frame` and writes the mean contact counts and times of its steps.
void measure_frame(World& world, Real frame, const std::string& labels, std::ofstream& csv) {
    const WorldReport before = world.report();
    const StepReport step = world.advance(frame);
    if (!step.ok()) throw std::runtime_error(labels + ": " + step.message());
    const WorldReport after = world.report();
    const double steps = static_cast<double>(after.steps - before.steps);
    const auto mean = [&](double sum_after, double sum_before) { return (sum_after - sum_before) / steps; };
    const auto seconds = [&](const char* stage) {
        return mean(stage_seconds(after, stage), stage_seconds(before, stage));
    };
    const double after_steps = static_cast<double>(after.steps), before_steps = static_cast<double>(before.steps);
    csv << labels << ',' << after.time << ','
        << mean(after.mean_contacts * after_steps, before.mean_contacts * before_steps) << ','
        << mean(after.mean_regions * after_steps, before.mean_regions * before_steps) << ',' << step.largest_region
        << ',' << seconds("contact/separate_regions") << ',' << seconds("solver/solve_regions") << '\n';
}

/// Measures two worlds in turns. They differ only in how contacts are grouped.
void compare(const std::string& scene, int bodies, Real settle, Real seconds, Real frame,
             const std::function<World(World)>& build, std::ofstream& csv) {
    for (const Handling& handling : handlings) {
        std::vector<World> worlds;
        for (const ContactRegions mode : modes) worlds.push_back(build(empty_world(handling, mode)));
        std::fprintf(stderr, "\r\033[K%s, %d bodies, %s", scene.c_str(), bodies, handling.name);
        for (World& world : worlds)
            if (settle > 0) world.advance(settle);
        for (Real time = 0; time < seconds - frame / 2; time += frame)
            for (std::size_t m = 0; m < worlds.size(); ++m)
                measure_frame(
                    worlds[m], frame,
                    scene + ',' + std::to_string(bodies) + ',' + handling.name + ',' + std::string(name_of(modes[m])),
                    csv);
    }
}

/// Adds the contact problem of every `every`-th step of a scene, after it has settled for `settle` [s].
void take_problems(World world, Real settle, Real seconds, std::uint64_t every, const std::string& name,
                   std::vector<StepProblem>& steps) {
    if (settle > 0) world.advance(settle);
    world.watch_contact_problems(
        [&](const StepProblem& step) {
            steps.push_back(step);
            steps.back().problem.name = name + "-" + std::to_string(step.step);
        },
        every);
    world.advance(seconds);
}

/// Returns the problem with a block for every pair of contacts, mostly zeros: solve_problem then takes all for one
/// region.
ContactProblem filled(const ContactProblem& problem) {
    const Index contacts = problem.contacts();
    ContactProblem full;
    full.name = problem.name;
    full.q = problem.q;
    full.mu = problem.mu;
    full.block.assign(static_cast<std::size_t>(contacts) * static_cast<std::size_t>(contacts), Mat3::Zero());
    full.row_offset.push_back(0);
    for (Index i = 0; i < contacts; ++i) {
        for (Index j = 0; j < contacts; ++j) full.column.push_back(j);
        full.row_offset.push_back(static_cast<Index>(full.column.size()));
        for (Index k = problem.row_offset[i]; k < problem.row_offset[i + 1]; ++k)
            full.block[static_cast<std::size_t>(i) * static_cast<std::size_t>(contacts) +
                       static_cast<std::size_t>(problem.column[k])] = problem.block[k];
    }
    return full;
}

std::vector<ContactProblem> filled_regions(const StepProblem& step) {
    std::map<Index, std::vector<Index>> members;
    for (std::size_t c = 0; c < step.region.size(); ++c) members[step.region[c]].push_back(static_cast<Index>(c));
    std::vector<ContactProblem> regions;
    for (const auto& [region, contacts] : members) regions.push_back(filled(part_of(step.problem, contacts)));
    return regions;
}

}  // namespace

std::vector<StepProblem> profile_scenes(const SeparationOptions& options) {
    std::ofstream csv(options.out / "scenes.csv");
    csv << "scene,bodies,handling,mode,time,contacts,regions,largest_region,seconds_separate,seconds_solve\n";
    const std::vector<int> counts = options.quick ? std::vector<int>{1, 2, 6, 16}
                                                  : std::vector<int>{1, 2, 3, 4, 6, 8, 12, 16, 18, 20, 24, 32, 48, 64};
    const Real settle = options.quick ? 0.15 : 0.3;  // [s]
    std::vector<StepProblem> steps;
    for (const int balls : counts) {
        const auto build = [&](World empty) { return balls_in_bucket(std::move(empty), balls); };
        compare("bucket", balls, settle, options.quick ? 0.05 : 0.1, 0.01, build, csv);
        take_problems(build(empty_world(handlings[1], ContactRegions::separate)), settle, 0.05,
                      options.quick ? 100 : 25, "bucket", steps);
    }
    compare("skittles", 11, 0, options.quick ? 0.4 : 1.2, 1.0 / 120, ball_and_skittles, csv);
    take_problems(ball_and_skittles(empty_world(handlings[1], ContactRegions::separate)), 0, options.quick ? 0.4 : 0.8,
                  options.quick ? 50 : 20, "skittles", steps);
    return steps;
}

void profile_dense(const SeparationOptions& options, const std::vector<StepProblem>& steps) {
    std::ofstream csv(options.out / "dense.csv");
    csv << "scene,problem,contacts,regions,seconds_global,seconds_separate,seconds_sparse\n";
    const ProblemSettings settings{.method = SolverMethod::pcg_pgs, .tolerance = 1e-3, .max_iterations = 200};
    constexpr Index most_contacts = 1000;  // limits the matrix to 72 MB
    for (const StepProblem& step : steps) {
        if (step.problem.contacts() > most_contacts) continue;
        std::fprintf(stderr, "\r\033[K%s, dense, %d contacts", step.problem.name.c_str(), step.problem.contacts());
        const std::vector<ContactProblem> regions = filled_regions(step);
        double separate = 0;
        for (const ContactProblem& region : regions) separate += solve_problem(region, settings).seconds;
        csv << step.problem.name.substr(0, step.problem.name.find('-')) << ',' << step.problem.name << ','
            << step.problem.contacts() << ',' << regions.size() << ','
            << solve_problem(filled(step.problem), settings).seconds << ',' << separate << ','
            << solve_problem(step.problem, settings).seconds << '\n';
    }
}

}  // namespace skerry::profiling
