// profile_multirate: CPU time against error of one step for all elements and of multirate steps, on a mesh with slivers
// and on a stiff body beside a soft one. profiling/plot_multirate.py draws the table.
#include <CLI/CLI.hpp>
#include <cmath>
#include <cstdio>
#include <filesystem>
#include <fstream>
#include <optional>
#include <string>
#include <vector>

#include "profiling/measure.h"
#include "skerry/world.h"
#include "tests/support/sliver_box.h"

using namespace skerry;
using namespace skerry::profiling;

namespace {

struct Case {
    std::string scene;
    int cells = 0;
    Real seconds = 0;
};

struct Variant {
    Integrator integrator = Integrator::symplectic_euler;
    bool multirate = false;
    Real safety = 1;  // fraction of the stable step
};

struct Outcome {
    double cpu = 0;  // s, of the thread that steps
    std::vector<Vec3> position;
    WorldReport report;
    Real energy_start = 0, energy_end = 0;  // J
};

/// A box that turns and is strained by some per cent; 1 % of its elements are flat, and their stable step is a
/// sixteenth of the others'.
void add_slivers(World& world, int cells) {
    constexpr Real size = 0.1, flatness = 0.0349;
    const Mesh mesh = test::sliver_box(size, cells, 0.01, flatness);
    const auto material = world.add_material({.young_modulus = 1e5, .poisson_ratio = 0.3});
    const auto body = world.add_body(mesh, {.material = material, .element = ElementKind::linear});
    std::vector<Vec3> velocity;
    for (const Vec3& x : mesh.nodes)
        velocity.push_back(0.3 * Vec3(std::sin(30 * x.y()), 20 * x.z(), std::cos(25 * x.x())) + Vec3(1, 2, 3).cross(x));
    world.set_velocities(body, velocity);
}

/// A stiff ball on a soft block: the elements of the block would stand steps more than sixteen times as long.
void add_stiff_and_soft(World& world, int cells) {
    const auto soft = world.add_material({.young_modulus = 2e4, .poisson_ratio = 0.3, .friction = 0.4});
    const auto stiff = world.add_material({.young_modulus = 1e7, .poisson_ratio = 0.3, .friction = 0.4});
    world.add_collider(Plane{});
    world.add_body(mesh::box({0.2, 0.2, 0.1}, {cells, cells, cells / 2}),
                   {.material = soft, .position = {0, 0, 0.0505}, .element = ElementKind::linear});
    world.add_body(
        mesh::ball(0.03, cells / 4),
        {.material = stiff, .position = {0.01, 0, 0.135}, .velocity = {0, 0, -0.5}, .element = ElementKind::linear});
}

Outcome run(const Case& one, const Variant& variant) {
    Settings settings;
    settings.backend = Backend::serial;
    settings.threads = 1;
    settings.integrator = variant.integrator;
    settings.multirate = variant.multirate;
    settings.step_safety = variant.safety;
    settings.tolerance = 1e-6;  // below what the step leaves
    settings.clusters = false;  // one step for all elements, or levels
    if (one.scene == "slivers") settings.gravity = Vec3::Zero();
    World world(settings);
    one.scene == "slivers" ? add_slivers(world, one.cells) : add_stiff_and_soft(world, one.cells);
    const auto mechanical = [&world] {
        const Energy energy = world.energy();
        return energy.kinetic + energy.elastic + energy.potential;
    };
    Outcome outcome;
    outcome.energy_start = mechanical();
    const double start = cpu_seconds();
    const StepReport step = world.advance(one.seconds);
    outcome.cpu = cpu_seconds() - start;
    if (!step.ok()) throw std::runtime_error(one.scene + ": " + step.message());
    outcome.energy_end = mechanical();
    for (const BodyHandle body : world.bodies())
        outcome.position.insert(outcome.position.end(), world.positions(body).begin(), world.positions(body).end());
    outcome.report = world.report();
    return outcome;
}

Real rms_distance(const std::vector<Vec3>& a, const std::vector<Vec3>& b) {
    Real sum = 0;
    for (std::size_t n = 0; n < a.size(); ++n) sum += (a[n] - b[n]).squaredNorm();
    return std::sqrt(sum / static_cast<Real>(a.size()));
}

void measure(const Case& one, Real reference_safety, const std::vector<Variant>& variants, int repeats,
             std::ofstream& table) {
    const std::vector<Vec3> reference = run(one, {Integrator::leapfrog, false, reference_safety}).position;
    std::vector<std::vector<double>> cpu(variants.size());
    std::vector<std::optional<Outcome>> outcome(variants.size());
    for (int repeat = 0; repeat < repeats; ++repeat)  // in turns: what disturbs the machine disturbs all
        for (std::size_t v = 0; v < variants.size(); ++v) {
            outcome[v] = run(one, variants[v]);
            cpu[v].push_back(outcome[v]->cpu);
        }
    for (std::size_t v = 0; v < variants.size(); ++v) {
        const WorldReport& report = outcome[v]->report;
        const double share = report.element_steps > 0 ? static_cast<double>(report.element_impulses) /
                                                            static_cast<double>(report.element_steps)
                                                      : 1;
        const Real drift = (outcome[v]->energy_end - outcome[v]->energy_start) / outcome[v]->report.energy.kinetic;
        const auto line = [&](auto&& print) {
            print(one.scene, name_of(variants[v].integrator), variants[v].multirate ? "multirate" : "one step",
                  variants[v].safety, report.steps, median(cpu[v]), rms_distance(outcome[v]->position, reference),
                  share, drift);
        };
        line([&](const auto& scene, const auto& integrator, const auto& mode, auto... number) {
            table << scene << ',' << integrator << ',' << mode;
            ((table << ',' << number), ...);
            table << '\n' << std::flush;
        });
    }
}

}  // namespace

int main(int argc, char** argv) {
    CLI::App app{"CPU time against error of multirate steps and of one step for all elements. Writes multirate.csv."};
    std::string out = "out/profiling/multirate";
    int cells = 28, repeats = 3;
    bool quick = false;
    app.add_option("--out", out, "Folder for the table")->capture_default_str();
    app.add_option("--cells", cells, "Cells along an edge of the mesh with slivers")
        ->check(CLI::Range(8, 64))
        ->capture_default_str();
    app.add_option("--repeats", repeats, "Runs of each, taken in turns; medians are written")
        ->check(CLI::PositiveNumber)
        ->capture_default_str();
    app.add_flag("--quick", quick, "A small mesh, once");
    CLI11_PARSE(app, argc, argv);
    try {
        if (quick) cells = 12, repeats = 1;
        std::filesystem::create_directories(out);
        std::ofstream table(std::filesystem::path(out) / "multirate.csv");
        table << "scene,integrator,mode,safety,steps,cpu_seconds,error,impulse_share,energy_change\n";
        std::vector<Variant> variants;
        for (const Integrator integrator : {Integrator::symplectic_euler, Integrator::leapfrog})
            for (const bool multirate : {false, true})
                for (const Real safety : {1.0, 0.5, 0.25}) variants.push_back({integrator, multirate, safety});
        measure({"slivers", cells, 0.1 / cells}, 1.0 / 16, variants, repeats, table);
        measure({"stiff on soft", quick ? 8 : 20, 0.03}, 1.0 / 16, variants, repeats, table);
        std::printf("%s\n", out.c_str());
    } catch (const std::exception& error) {
        std::fprintf(stderr, "%s\n", error.what());
        return 1;
    }
    return 0;
}
