// profile_regions: one large region of two sheets in contact, swept in order by one thread and in its coloured order by
// several. Measures the time of a sweep and of a solve to a given error, and the cost of ordering and loading.
#include <CLI/CLI.hpp>
#include <array>
#include <cmath>
#include <cstdio>
#include <map>
#include <memory>
#include <string>
#include <vector>

#include "profiling/measure.h"
#include "systems/solver/methods/run_method.h"
#include "systems/solver/regions/solve_large_regions.h"
#include "tests/support/contact_scene.h"

using namespace skerry;
using namespace skerry::profiling;

namespace {

/// The region of a scene, loaded in the coloured order, or in its own order if `coloured` is false.
struct Problem {
    Problem(const ContactScene& scene, Executor& executor, Team& team, bool coloured)
        : velocity_next(scene.velocity),
          impulse_out(scene.impulse),
          push_out(scene.velocity.size()),
          gap(scene.gap.size()),
          inputs(scene.inputs()),
          out{impulse_out, velocity_next, push_out},
          stage{inputs, settings, scene.h, out, data} {
        for (std::size_t k = 0; k < scene.stencil.size(); ++k) row.push_back(static_cast<Index>(k));
        for (std::size_t k = 0; k < row.size(); ++k) gap[k] = k % 3 == 0 ? -1e-3 : 0;
        data.make_room_for(row.size(), 4 * row.size(), velocity_next.size(), settings);
        team.gather(executor, [&] {
            order_region(inputs, row, team, data.node_index.span(), kept);
            if (!coloured)
                for (std::size_t k = 0; k < row.size(); ++k) kept.order.contact[k] = static_cast<Index>(k);
            load(team);
        });
    }
    void load(Team& team) {
        const RegionByColour loaded = load_by_colour(stage, row, 0, team, kept);
        memory = loaded.memory;
        scale = loaded.scale;
    }

    /// Solves the split impulse with gaps of -1e-3 m at every third contact.
    template <class Traversal>
    void push(const Traversal& traversal) {
        RegionInputs pressed = inputs;
        pressed.gap = gap;
        const RegionStage of_pressed{pressed, settings, stage.h, out, data};
        const LumpedRegion<Traversal> region{
            .row = row, .traversal = traversal, .memory = memory, .scale = scale, .tolerance = settings.tolerance};
        solve_push(of_pressed, region, operator_of(of_pressed, region));
    }

    std::vector<Vec3> velocity_next, impulse_out, push_out;
    std::vector<Real> gap;  // by row [m]
    SolverSettings settings{.method = SolverMethod::ags};
    RegionInputs inputs;
    RegionOutputs out;
    RegionMemory data;
    RegionStage stage;
    std::vector<Index> row;
    ColouredRegion kept;
    LumpedMemory memory;
    Real scale = 0;
};

struct Times {
    std::vector<double> sweep, solve, push, order, load;  // [s]
    Index sweeps = 0;                                     // number of sweeps of the solve
};

/// Measures wall times of a sweep (with acceleration), of loading, of a solve and of the split impulse [s].
template <class Traversal>
void measure(Problem& problem, Team& team, const Traversal& traversal, const SolveLimits& limits, Times& times) {
    LumpedOperatorBy<Traversal> op(problem.memory, Friction::cone, problem.scale, traversal);
    op.remember();
    constexpr double long_enough = 20e-3;  // also enough for the system to find a core for each worker [s]
    std::vector<double> sweeps;
    double start = wall_seconds();
    for (const double begin = start; start < begin + long_enough;) {
        op.accelerated_sweep(1);
        op.extrapolate(sweeps.size() < 3 ? 0 : 0.5);
        const double end = wall_seconds();
        sweeps.push_back(end - start);
        start = end;
    }
    times.sweep.push_back(median(std::move(sweeps)));
    op.impulse();
    start = wall_seconds();
    problem.load(team);
    times.load.push_back(wall_seconds() - start);
    start = wall_seconds();
    times.sweeps = run_method(SolverMethod::ags, op, limits).iterations;
    times.solve.push_back(wall_seconds() - start);
    start = wall_seconds();
    problem.push(traversal);
    times.push.push_back(wall_seconds() - start);
}

void print(const std::string& name, const Times& times, const Times& base) {
    const auto ratio = [](const std::vector<double>& numerator, const std::vector<double>& denominator) {
        return median(numerator) / median(denominator);
    };
    std::printf(
        "  %-20s sweep %8.4f ms (%.2f x), solve %8.3f ms in %2d sweeps (%.2f x), push %7.3f ms (%.2f x), order %.3f "
        "ms, load %.3f ms\n",
        name.c_str(), 1e3 * median(times.sweep), ratio(base.sweep, times.sweep), 1e3 * median(times.solve),
        times.sweeps, ratio(base.solve, times.solve), 1e3 * median(times.push), ratio(base.push, times.push),
        1e3 * median(times.order), 1e3 * median(times.load));
}

void profile(Index contacts, const std::vector<int>& threads, const std::vector<Backend>& backends, int repeats,
             double tolerance) {
    ContactScene scene;
    add_sheets(scene, 2 + static_cast<int>(std::lround(std::sqrt(contacts / 2.0))), 0.5, 1);
    const SolveLimits limits{.tolerance = tolerance, .max_iterations = 20000};
    std::map<std::string, Times> all;
    const auto serial = make_executor(Backend::serial, 1);
    Team team;
    Problem in_order(scene, *serial, team, false), coloured(scene, *serial, team, true);
    const ColouredOrder& order = coloured.kept.order;
    std::printf("\n%zu contacts, %zu nodes: %d colours, %d phases of hubs, %d contacts in the tail, %zu blocks\n",
                scene.stencil.size(), coloured.kept.node.size(), order.colour_count, order.hub_phase_count,
                order.tail_size, order.block_offset.size() - 1);
    struct Case {
        std::string name;
        std::unique_ptr<Executor> executor;
    };
    std::vector<Case> cases;
    for (const Backend backend : backends)
        for (const int count : threads)
            cases.push_back({"coloured, " + std::string(name_of(backend)) + " " + std::to_string(count),
                             make_executor(backend, count)});
    for (int repeat = 0; repeat < repeats; ++repeat) {
        Times& base = all["in order"];
        measure(in_order, team, InOrder{}, limits, base);
        for (const Case& each : cases) {
            Times& times = all[each.name];
            team.gather(*each.executor, [&] {
                coloured.kept.moving[0][0] ^= 1;  // marks the nodes as changed, so that the region is ordered again
                const double start = wall_seconds();
                order_region(coloured.inputs, coloured.row, team, coloured.data.node_index.span(), coloured.kept);
                times.order.push_back(wall_seconds() - start);
                coloured.load(team);
                measure(coloured, team, coloured.kept.traversal(team), limits, times);
            });
        }
    }
    print("in order", all["in order"], all["in order"]);
    for (const Case& each : cases) print(each.name, all[each.name], all[cases.front().name]);
}

}  // namespace

int main(int argc, char** argv) {
    CLI::App app{
        "Times one large region: in order and coloured, on several numbers of threads taken in turns. Medians."};
    std::vector<Index> contacts{2000, 10000, 40000};
    std::vector<int> threads{1, 2};
    std::vector<std::string> names{"tbb", "threads"};
    int repeats = 11;
    double tolerance = 1e-3;
    app.add_option("contacts", contacts, "Contacts of the region")->capture_default_str();
    app.add_option("--threads", threads, "Numbers of threads, the first is the base of the ratios")
        ->capture_default_str();
    app.add_option("--backends", names, "Backends")->capture_default_str();
    app.add_option("--repeats", repeats, "Runs of each")->check(CLI::PositiveNumber)->capture_default_str();
    app.add_option("--tolerance", tolerance, "Error to solve to")->capture_default_str();
    CLI11_PARSE(app, argc, argv);
    try {
        std::vector<Backend> backends;
        for (const std::string& name : names) {
            const auto backend = from_name<Backend>(name);
            if (!backend) throw std::invalid_argument("there is no backend '" + name + "'");
            backends.push_back(*backend);
        }
        for (const Index count : contacts) profile(count, threads, backends, repeats, tolerance);
    } catch (const std::exception& error) {
        std::fprintf(stderr, "%s\n", error.what());
        return 1;
    }
    return 0;
}
