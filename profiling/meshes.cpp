// profile_meshes: cost of meshes as users have them, beside good ones. Each mesh is dropped alone, in turns with a box
// of about as many tetrahedra and the same mean edge. Prints a table of docs/step_length.md.
#include <CLI/CLI.hpp>
#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <filesystem>
#include <limits>
#include <stdexcept>
#include <string>
#include <utility>
#include <vector>

#include "profiling/measure.h"
#include "skerry/world.h"

using namespace skerry;
using namespace skerry::profiling;

namespace {

struct Fall {
    Real size = 0.3;     // longest extent of a mesh [m]
    Real modulus = 1e6;  // [Pa]
    Real velocity = 5;   // downwards [m/s]
    Real seconds = 1;    // simulated time [s]
    bool linear = false, clusters = true;
};

struct Outcome {
    std::string name;
    std::vector<double> search, rest;  // CPU time of each round until clusters are found, and from then on [s]
    WorldReport at_start, report;
};

/// Scales a mesh and moves its lowest point to z = 0.
Mesh placed(Mesh mesh, Real scale) {
    Real lowest = std::numeric_limits<Real>::infinity();
    for (Vec3& node : mesh.nodes) lowest = std::min(lowest, (node *= scale).z());
    for (Vec3& node : mesh.nodes) node.z() -= lowest;
    return mesh;
}

/// Returns a box that is nearly a cube, with about `tetrahedra` tetrahedra and the given mean edge [m].
Mesh box_like(std::size_t tetrahedra, Real mean_edge) {
    const Real cells = static_cast<Real>(tetrahedra) / 6;
    const int most = std::max(1, static_cast<int>(std::ceil(std::cbrt(cells))));
    std::array<int, 3> best{1, 1, 1};
    const auto miss = [&](const std::array<int, 3>& of) { return std::abs(of[0] * of[1] * of[2] - cells); };
    for (int x = std::max(1, most - 2); x <= most; ++x)
        for (int y = x; y <= most + 1; ++y)
            for (int z = y; z <= most + 2; ++z)
                if (const std::array<int, 3> of{x, y, z}; miss(of) < miss(best)) best = of;
    const Mesh unit = mesh::box({Real(best[0]), Real(best[1]), Real(best[2])}, best);
    return placed(unit, mean_edge / inspect(unit).mean_edge);
}

void run(const Mesh& mesh, const Fall& fall, Outcome& outcome) {
    World world({.clusters = fall.clusters, .threads = 1});
    const auto rubber =
        world.add_material({.young_modulus = fall.modulus, .poisson_ratio = 0.45, .density = 900, .friction = 0.4});
    world.add_collider(Plane{});
    const double begin = cpu_seconds(CLOCK_PROCESS_CPUTIME_ID);
    world.add_body(mesh, {.material = rubber,
                          .position = {0, 0, 0.01},
                          .velocity = {0, 0, -fall.velocity},
                          .dynamics = BodyDynamics::explicit_elastic,
                          .element = fall.linear ? ElementKind::linear : ElementKind::smoothed});
    outcome.at_start = world.report();  // clusters are found now, not in the first step
    const double found = cpu_seconds(CLOCK_PROCESS_CPUTIME_ID);
    const StepReport report = world.advance(fall.seconds);
    if (!report.ok()) throw std::runtime_error(report.message());
    outcome.search.push_back(found - begin);
    outcome.rest.push_back(cpu_seconds(CLOCK_PROCESS_CPUTIME_ID) - found);
    outcome.report = world.report();
}

double cpu(const Outcome& outcome) {
    return median(outcome.search) + median(outcome.rest);
}

void print(const Outcome& outcome, double others) {
    const WorldReport& report = outcome.report;
    std::uint64_t given_up = 0;
    std::string bounds;
    for (const StepLimitReport& limit : report.step_limits) {
        given_up += limit.tries;
        if (limit.steps == 0) continue;
        bounds += (bounds.empty() ? "" : ", ") + std::to_string(limit.steps) + " " + std::string(name_of(limit.limit));
    }
    std::printf("| %s | %zu | %zu | %zu -> %zu | %.0f us | %llu | %s | %llu | %d | %.2f %% | %.3f | %.3f | %.2f |\n",
                outcome.name.c_str(), report.elements, outcome.at_start.implicit_elements,
                outcome.at_start.cluster_nodes, report.cluster_nodes, 1e6 * outcome.at_start.stable_step,
                static_cast<unsigned long long>(report.steps), bounds.c_str(),
                static_cast<unsigned long long>(given_up), static_cast<int>(report.inverted),
                100 * report.energy_error_share, median(outcome.search), cpu(outcome), others);
}

void compare(const std::string& path, const Fall& fall, int rounds) {
    Mesh mesh = mesh::read(path);
    const MeshReport found = inspect(mesh);
    const Real scale = fall.size / (found.upper - found.lower).maxCoeff();
    mesh = placed(std::move(mesh), scale);
    const Mesh box = box_like(mesh.tetrahedra.size(), found.mean_edge * scale);
    Outcome real{.name = std::filesystem::path(path).stem(), .search = {}, .rest = {}, .at_start = {}, .report = {}};
    Outcome good{.name = "box", .search = {}, .rest = {}, .at_start = {}, .report = {}};
    for (int round = 0; round < rounds; ++round) {
        run(mesh, fall, real);
        run(box, fall, good);
    }
    const double element = cpu(good) / static_cast<double>(box.tetrahedra.size());
    print(real, cpu(real) / static_cast<double>(mesh.tetrahedra.size()) / element);
    print(good, 1);
}

}  // namespace

int main(int argc, char** argv) {
    CLI::App app{
        "What meshes cost beside a box of as many tetrahedra of the same mean edge: dropped alone, one thread."};
    Fall fall;
    int rounds = 3;
    std::vector<std::string> files;
    app.add_option("files", files, "meshes")->required()->check(CLI::ExistingFile);
    app.add_option("--size", fall.size, "m, their longest extent");
    app.add_option("--modulus", fall.modulus, "Pa, Young's modulus");
    app.add_option("--velocity", fall.velocity, "m/s, down");
    app.add_option("--seconds", fall.seconds, "s, simulated");
    app.add_flag("--linear", fall.linear, "linear elements");
    app.add_flag("!--no-clusters", fall.clusters, "without the setting clusters");
    app.add_option("--rounds", rounds, "runs of each, in turns; the median counts");
    CLI11_PARSE(app, argc, argv);
    std::printf(
        "| mesh | tetrahedra | implicit elements | nodes in clusters | stable step | steps | of these by | tries "
        "given up | inverted | energy is off by | until "
        "clusters are found, CPU s | all, CPU s | over box, a "
        "tetrahedron |\n"
        "|---|---|---|---|---|---|---|---|---|---|---|---|---|---|\n");
    for (const std::string& file : files) compare(file, fall, rounds);
}
