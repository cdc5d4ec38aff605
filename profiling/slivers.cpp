// profile_slivers: cost of a few flat tetrahedra. Boxes fall onto each other, with slivers and without, in turns.
// Prints a table of docs/step_length.md.
#include <CLI/CLI.hpp>
#include <algorithm>
#include <cstdio>
#include <stdexcept>
#include <string>
#include <vector>

#include "profiling/measure.h"
#include "skerry/world.h"
#include "tests/support/sliver_box.h"

using namespace skerry;
using namespace skerry::profiling;

namespace {

struct Pile {
    int bodies = 12, cells = 6;
    Real share = 0.01, flatness = 0.02;
    Real seconds = 0.3;
    bool linear = false, clusters = true;
};

struct Outcome {
    std::string name;
    std::vector<double> cpu;  // CPU time of each round [s]
    WorldReport report;
};

World make_world(const Pile& pile, bool slivers) {
    constexpr Real size = 0.1;
    World world({.clusters = pile.clusters, .threads = 1});
    const auto rubber = world.add_material({.young_modulus = 1e5, .poisson_ratio = 0.4, .friction = 0.4});
    world.add_collider(Plane{});
    for (int i = 0; i < pile.bodies; ++i) {
        const auto seed = static_cast<std::uint64_t>(1 + i % 4);
        const Mesh mesh = slivers ? test::sliver_box(size, pile.cells, pile.share, pile.flatness, seed)
                                  : test::mirrored_box(size, pile.cells);
        const Vec3 place(0.3 * size * (i % 3), 0.3 * size * (i / 3 % 2), size * (1 + 1.4 * i));
        world.add_body(mesh, {.material = rubber,
                              .position = place,
                              .velocity = {0, 0, -0.5 * i},
                              .dynamics = BodyDynamics::explicit_elastic,
                              .element = pile.linear ? ElementKind::linear : ElementKind::smoothed});
    }
    return world;
}

void run(const Pile& pile, bool slivers, Outcome& outcome) {
    World world = make_world(pile, slivers);
    const double begin = cpu_seconds(CLOCK_PROCESS_CPUTIME_ID);
    const StepReport report = world.advance(pile.seconds);
    if (!report.ok()) throw std::runtime_error(report.message());
    outcome.cpu.push_back(cpu_seconds(CLOCK_PROCESS_CPUTIME_ID) - begin);
    outcome.report = world.report();
}

void print(const Outcome& outcome, double without) {
    const WorldReport& report = outcome.report;
    std::uint64_t given_up = 0, for_inversions = 0;
    for (const StepLimitReport& limit : report.step_limits) {
        given_up += limit.tries;
        if (limit.limit == StepLimit::inversion) for_inversions += limit.tries;
    }
    const double cpu = median(outcome.cpu);
    std::printf("| %s | %llu | %llu | %llu | %.2f %% | %.2f | %.2f |\n", outcome.name.c_str(),
                static_cast<unsigned long long>(report.steps), static_cast<unsigned long long>(given_up),
                static_cast<unsigned long long>(for_inversions), 100 * report.energy_error_share, cpu, cpu / without);
}

}  // namespace

int main(int argc, char** argv) {
    CLI::App app{"What a few flat tetrahedra cost: boxes that fall onto each other, with and without, one thread."};
    Pile pile;
    int rounds = 3;
    app.add_option("--bodies", pile.bodies, "how many boxes");
    app.add_option("--cells", pile.cells, "along an edge of a box, six tetrahedra each");
    app.add_option("--share", pile.share, "of the tetrahedra that become flat");
    app.add_option("--flatness", pile.flatness, "their altitude over what it was");
    app.add_option("--seconds", pile.seconds, "s, simulated");
    app.add_flag("--linear", pile.linear, "linear elements");
    app.add_flag("!--no-clusters", pile.clusters, "without the setting clusters");
    app.add_option("--rounds", rounds, "runs of each, in turns; the median counts");
    CLI11_PARSE(app, argc, argv);
    Outcome without{"without", {}, {}}, with{"with", {}, {}};
    for (int round = 0; round < rounds; ++round) {
        run(pile, false, without);
        run(pile, true, with);
    }
    std::printf(
        "| slivers | steps | tries given up | of these for inversions | energy is off by | CPU s | over without |\n"
        "|---|---|---|---|---|---|---|\n");
    print(without, median(without.cpu));
    print(with, median(without.cpu));
}
