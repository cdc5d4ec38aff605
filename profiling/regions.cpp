// profile_regions: one large region of two sheets in contact, swept in order by one thread and in its coloured order by several: what a
// sweep costs, how long it takes to a given error, and what ordering and loading cost beside it.
#include <CLI/CLI.hpp>
#include <array>
#include <cmath>
#include <cstdio>
#include <map>
#include <memory>
#include <string>
#include <type_traits>
#include <vector>

#include "profiling/measure.h"
#include "systems/solver/coloured/coloured_operator.h"
#include "systems/solver/coloured/load_coloured.h"
#include "systems/solver/coloured/push_out_coloured.h"
#include "systems/solver/methods/run_method.h"
#include "tests/support/contact_scene.h"

using namespace skerry;
using namespace skerry::profiling;

namespace {

/// The region of a scene, loaded in the coloured order, or in its own where `coloured` is false.
struct Problem {
    Problem(const ContactScene& scene, Executor& executor, Team& team, bool coloured)
        : source{scene.inputs(), scene.velocity, settings, scene.h} {
        for (std::size_t k = 0; k < scene.stencil.size(); ++k) row.push_back(static_cast<Index>(k));
        place.resize(scene.velocity.size());
        contact.resize(row.size());
        impulse.resize(row.size());
        push_impulse.resize(row.size());
        push_bias.resize(row.size());
        for (std::size_t k = 0; k < row.size(); ++k) gap.push_back(k % 3 == 0 ? -1e-3 : 0);
        for (auto& slot : workspace) slot.resize(row.size());
        team.gather(executor, [&] {
            order_region(source.inputs, row, team, place.span(), region);
            if (!coloured)
                for (std::size_t k = 0; k < row.size(); ++k) region.order.contact[k] = static_cast<Index>(k);
            velocity.resize(region.node.size());
            scratch.resize(region.node.size());
            load(team);
        });
    }
    void load(Team& team) {
        const LoadSums sums = load_coloured({source.inputs, source.velocity_next, settings, source.h}, row, team, region, contact.span(),
                                            impulse.span(), velocity.span());
        scale = error_scale(sums, source.inputs.gravity, source.h, settings.tolerance);
    }
    LumpedOperator::Memory memory() {
        LumpedOperator::Memory all{.contact = contact.span(),
                                   .impulse = impulse.span(),
                                   .velocity = velocity.span(),
                                   .node = region.node.span(),
                                   .free_velocity = source.velocity_next,
                                   .scratch = scratch.span(),
                                   .workspace = {}};
        for (std::size_t slot = 0; slot < workspace.size(); ++slot) all.workspace[slot] = workspace[slot].span();
        return all;
    }

    /// The split impulse, as if every third contact were pressed in.
    void push_out(Team& team, bool with_team) {
        const PushMemory push{push_impulse.span(), push_bias.span(), scratch.span()};
        if (with_team) {
            push_out_coloured(team, {region.order, contact.span(), velocity.span(), region.partial.span()}, row, gap, source.inputs.gravity,
                              settings, source.h, push);
        } else {
            push_out_region(contact.span(), row, gap, velocity.span(), source.inputs.gravity, settings, source.h, push);
        }
    }

    struct Source {
        RegionInputs inputs;
        std::span<const Vec3> velocity_next;
        const SolverSettings& settings;
        Real h;
    };
    SolverSettings settings{};
    Source source;
    std::vector<Index> row;
    Column<Index> place;
    ColouredRegion region;
    std::vector<Real> gap;  // m, by row
    Column<Real> push_impulse, push_bias;
    Column<LumpedContact> contact;
    Column<Vec4> impulse, velocity, scratch;
    std::array<Column<Vec4>, workspace_limit> workspace;
    Real scale = 0;
};

struct Times {
    std::vector<double> sweep, solve, push, order, load;  // s
    Index sweeps = 0;                                     // of the solve
};

/// Milliseconds by the wall clock: of a sweep, the acceleration included, and of a solve.
template <class Op>
void measure(Problem& problem, Team& team, Op op, const SolveLimits& limits, Times& times) {
    op.remember();
    constexpr double long_enough = 20e-3;  // s, also for the system to find a core for each worker
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
    problem.push_out(team, std::is_same_v<Op, ColouredOperator>);
    times.push.push_back(wall_seconds() - start);
}

void print(const std::string& name, const Times& times, const Times& base) {
    const auto ratio = [](const std::vector<double>& of, const std::vector<double>& to) { return median(of) / median(to); };
    std::printf(
        "  %-20s sweep %8.4f ms (%.2f x), solve %8.3f ms in %2d sweeps (%.2f x), push %7.3f ms (%.2f x), order %.3f ms, load %.3f ms\n",
        name.c_str(), 1e3 * median(times.sweep), ratio(base.sweep, times.sweep), 1e3 * median(times.solve), times.sweeps,
        ratio(base.solve, times.solve), 1e3 * median(times.push), ratio(base.push, times.push), 1e3 * median(times.order),
        1e3 * median(times.load));
}

void profile(Index contacts, const std::vector<int>& threads, const std::vector<Backend>& backends, int repeats, double tolerance) {
    ContactScene scene;
    add_sheets(scene, 2 + static_cast<int>(std::lround(std::sqrt(contacts / 2.0))), 0.5, 1);
    const SolveLimits limits{.tolerance = tolerance, .max_iterations = 20000};
    std::map<std::string, Times> all;
    const auto serial = make_executor(Backend::serial, 1);
    Team team;
    Problem in_order(scene, *serial, team, false), coloured(scene, *serial, team, true);
    const ColouredOrder& order = coloured.region.order;
    std::printf("\n%zu contacts, %zu nodes: %d colours, %d phases of hubs, %d contacts in the tail, %zu blocks\n", scene.stencil.size(),
                coloured.region.node.size(), order.colour_count, order.hub_phase_count, order.tail_size, order.block_offset.size() - 1);
    struct Case {
        std::string name;
        std::unique_ptr<Executor> executor;
    };
    std::vector<Case> cases;
    for (const Backend backend : backends)
        for (const int count : threads)
            cases.push_back({"coloured, " + std::string(name_of(backend)) + " " + std::to_string(count), make_executor(backend, count)});
    for (int repeat = 0; repeat < repeats; ++repeat) {
        Times& base = all["in order"];
        measure(in_order, team, LumpedOperator(in_order.memory(), Friction::cone, in_order.scale), limits, base);
        for (const Case& each : cases) {
            Times& times = all[each.name];
            team.gather(*each.executor, [&] {
                coloured.region.moving[0][0] ^= 1;  // not the nodes that were there: to be ordered again
                const double start = wall_seconds();
                order_region(coloured.source.inputs, coloured.row, team, coloured.place.span(), coloured.region);
                times.order.push_back(wall_seconds() - start);
                const ColouredOperator op(coloured.memory(), order, team, coloured.region.partial.span(), Friction::cone, coloured.scale);
                coloured.load(team);
                measure(coloured, team, op, limits, times);
            });
        }
    }
    print("in order", all["in order"], all["in order"]);
    for (const Case& each : cases) print(each.name, all[each.name], all[cases.front().name]);
}

}  // namespace

int main(int argc, char** argv) {
    CLI::App app{"Times one large region: in order and coloured, on several numbers of threads taken in turns. Medians."};
    std::vector<Index> contacts{2000, 10000, 40000};
    std::vector<int> threads{1, 2};
    std::vector<std::string> names{"tbb", "threads"};
    int repeats = 11;
    double tolerance = 1e-3;
    app.add_option("contacts", contacts, "Contacts of the region")->capture_default_str();
    app.add_option("--threads", threads, "Numbers of threads, the first is the base of the ratios")->capture_default_str();
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
