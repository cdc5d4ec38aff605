// profile_stiff: cost of stiff bodies as explicit, implicit and rigid bodies, and how well they stand still. Scenes: a
// block on an incline, a stack of blocks, a heavy ball on a soft block, a pile of cubes, and thirty soft boxes on one
// slab or on a tile each. The stiffness is multiplied by 1, 100 and 10,000. profiling/plot_stiff.py draws the table.
#include <CLI/CLI.hpp>
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <filesystem>
#include <fstream>
#include <numbers>
#include <string>
#include <vector>

#include "profiling/measure.h"
#include "profiling/stiff_pile.h"
#include "skerry/world.h"

using namespace skerry;
using namespace skerry::profiling;

namespace {

constexpr Real g = 9.81;

struct Case {
    std::string scene;
    Real modulus;  // [Pa]
    BodyDynamics dynamics;
    Real step;       // largest step size [s]
    Real tolerance;  // tolerance of regions
    Real seconds;
    SolverMethod method;
};

/// Results of a scene. A result without meaning in it is NaN.
struct Outcome {
    double cpu = 0;                                                // CPU time per simulated second [s]
    Real speed = 0;                                                // root mean square over all nodes at the end [m/s]
    Real creep = std::nan(""), acceleration_error = std::nan("");  // speed [m/s], relative error [-]
    Real depth = 0;                                                // largest overlap [m]
    Index unconverged = 0;                                         // number of regions
    std::uint64_t steps = 0;
    std::string failed;
};

Settings settings_of(const Case& test_case, const Vec3& gravity) {
    Settings settings;
    settings.backend = Backend::serial;
    settings.threads = 1;
    settings.gravity = gravity;
    settings.step_size = test_case.step;
    settings.sleep = false;  // static bodies are compared more closely than the error of sleep, a thousandth
    settings.tolerance = test_case.tolerance;
    settings.method = test_case.method;
    return settings;
}
MaterialSettings stiff(const Case& test_case, Real friction) {
    return {.young_modulus = test_case.modulus, .poisson_ratio = 0.3, .friction = friction};
}

void add_stack(World& world, const Case& test_case) {
    const auto material = world.add_material(stiff(test_case, 0.5));
    world.add_collider(Plane{});
    const Mesh block = mesh::box({0.2, 0.2, 0.1}, {4, 4, 2});
    for (int k = 0; k < 8; ++k)
        world.add_body(block,
                       {.material = material, .position = {0, 0, 0.06 + 0.11 * k}, .dynamics = test_case.dynamics});
}

/// Adds a ball with the given dynamics on a soft, explicit block.
void add_ball_on_block(World& world, const Case& test_case) {
    MaterialSettings heavy = stiff(test_case, 0.5);
    heavy.density = 8000;
    const auto steel = world.add_material(heavy);
    const auto soft = world.add_material({.young_modulus = 1e5, .poisson_ratio = 0.3, .friction = 0.5});
    world.add_collider(Plane{});
    world.add_body(mesh::box({1, 1, 0.3}, {10, 10, 3}), {.material = soft, .position = {0, 0, 0.151}});
    world.add_body(mesh::ball(0.1, 4), {.material = steel, .position = {0, 0, 0.701}, .dynamics = test_case.dynamics});
}

void add_pile(World& world, const Case& test_case) {
    const auto material = world.add_material(stiff(test_case, 0.5));
    world.add_collider(Plane{});
    for (const Vec3& inward : {Vec3(1, 0, 0), Vec3(-1, 0, 0), Vec3(0, 1, 0), Vec3(0, -1, 0)})
        world.add_collider(Plane{.normal = inward, .point = -0.22 * inward});
    for (const PiledCube& cube : piled_cubes())
        world.add_body(mesh::box({0.1, 0.1, 0.1}, {2, 2, 2}), {.material = material,
                                                               .position = cube.position,
                                                               .rotation = cube.rotation,
                                                               .dynamics = test_case.dynamics});
}

/// Thirty soft, explicit boxes are let go just above one slab, in one region with it, or above a tile each, in thirty
/// regions. Slab and tiles have the given dynamics.
enum class Under { slab, tiles };
void add_boxes(World& world, const Case& test_case, Under under) {
    const auto material = world.add_material(stiff(test_case, 0.5));
    const auto soft = world.add_material({.young_modulus = 2e5, .poisson_ratio = 0.3, .friction = 0.5});
    world.add_collider(Plane{});
    const auto add_under = [&](const Mesh& mesh, Real x, Real y) {
        world.add_body(mesh, {.material = material, .position = {x, y, 0.05}, .dynamics = test_case.dynamics});
    };
    if (under == Under::slab) add_under(mesh::box({1.2, 1, 0.1}, {12, 10, 1}), 0, 0);
    const Mesh tile = mesh::box({0.18, 0.18, 0.1}, {2, 2, 1}), box = mesh::box({0.1, 0.1, 0.1}, {2, 2, 2});
    for (int k = 0; k < 30; ++k) {
        const Real x = -0.5 + 0.2 * (k / 5), y = -0.4 + 0.2 * (k % 5);
        if (under == Under::tiles) add_under(tile, x, y);
        world.add_body(box, {.material = soft, .position = {x + 0.003 * (k % 7), y, 0.1515 + 0.0002 * (k % 3)}});
    }
}

Real rms_speed(const World& world) {
    Real sum = 0;
    std::size_t count = 0;
    for (const BodyHandle body : world.bodies())
        for (const Vec3& v : world.velocities(body)) {
            sum += v.squaredNorm();
            ++count;
        }
    return std::sqrt(sum / static_cast<Real>(count));
}

/// Advances by `seconds` and adds to the outcome. Returns false if the advance failed.
bool advance(World& world, Real seconds, double& cpu, Outcome& outcome) {
    const double start = cpu_seconds();
    const StepReport report = world.advance(seconds);
    cpu += cpu_seconds() - start;
    outcome.depth = std::max(outcome.depth, report.max_penetration);
    outcome.unconverged += report.unconverged;
    outcome.steps += static_cast<std::uint64_t>(report.steps);
    if (!report.ok()) outcome.failed = report.message();
    return report.ok();
}

/// Runs a block half a degree below the friction angle, which should not creep, and one two degrees above it, which
/// should slide by Coulomb's law.
Outcome run_incline(const Case& test_case) {
    constexpr Real mu = 0.3;
    const auto on_slope = [&](Real degrees, double& cpu, Outcome& outcome) {
        const Real a = std::atan(mu) + degrees * std::numbers::pi / 180;
        World world(settings_of(test_case, g * Vec3(std::sin(a), 0, -std::cos(a))));
        const auto material = world.add_material(stiff(test_case, mu));
        world.add_collider(Plane{});
        const auto body = world.add_body(mesh::box({0.2, 0.2, 0.1}, {4, 4, 2}), {.material = material,
                                                                                 .position = {0, 0, 0.051},
                                                                                 .contact_distance = 1e-3,
                                                                                 .dynamics = test_case.dynamics});
        if (!advance(world, test_case.seconds, cpu, outcome)) return;
        const Vec3 at = world.center_of_mass(body);
        const Real before = world.report().momentum.x() / world.mass(body);
        if (!advance(world, test_case.seconds, cpu, outcome)) return;
        if (degrees < 0) {
            outcome.creep = (world.center_of_mass(body) - at).norm() / test_case.seconds;
            outcome.speed = rms_speed(world);
        } else {
            const Real law = g * (std::sin(a) - mu * std::cos(a));
            const Real found = (world.report().momentum.x() / world.mass(body) - before) / test_case.seconds;
            outcome.acceleration_error = found / law - 1;
        }
    };
    Outcome outcome;
    double cpu = 0;
    on_slope(-0.5, cpu, outcome);
    on_slope(2, cpu, outcome);
    outcome.cpu = cpu / (4 * test_case.seconds);
    return outcome;
}

Outcome run(const Case& test_case) {
    if (test_case.scene == "incline") return run_incline(test_case);
    World world(settings_of(test_case, {0, 0, -g}));
    if (test_case.scene == "stack") add_stack(world, test_case);
    if (test_case.scene == "ball on block") add_ball_on_block(world, test_case);
    if (test_case.scene == "pile") add_pile(world, test_case);
    if (test_case.scene == "boxes on slab") add_boxes(world, test_case, Under::slab);
    if (test_case.scene == "boxes on tiles") add_boxes(world, test_case, Under::tiles);
    Outcome outcome;
    double cpu = 0;
    advance(world, test_case.seconds, cpu, outcome);
    outcome.cpu = cpu / test_case.seconds;
    outcome.speed = rms_speed(world);
    return outcome;
}

void write(const Case& test_case, const Outcome& outcome, std::ofstream& table) {
    table << test_case.scene << ',' << test_case.modulus << ',' << name_of(test_case.dynamics) << ',' << test_case.step
          << ',' << test_case.tolerance << ',' << outcome.steps << ',' << outcome.cpu << ',' << outcome.speed << ','
          << outcome.creep << ',' << outcome.acceleration_error << ',' << outcome.depth << ',' << outcome.unconverged
          << '\n'
          << std::flush;
    std::printf("| %s | %.0e | %s | %g | %.0e | %.3f | %.1e | %.1e | %.2g | %.1e | %d |%s\n", test_case.scene.c_str(),
                test_case.modulus, std::string(name_of(test_case.dynamics)).c_str(), 1000 * test_case.step,
                test_case.tolerance, outcome.cpu, outcome.speed, outcome.creep, 100 * outcome.acceleration_error,
                1000 * outcome.depth, outcome.unconverged, outcome.failed.c_str());
    std::fflush(stdout);
}

}  // namespace

int main(int argc, char** argv) {
    CLI::App app{"What stiff bodies cost as explicit, implicit and rigid ones. Writes stiff.csv, prints a table."};
    std::string out = "out/profiling/stiff";
    std::string only;
    bool quick = false, sweeps = false;
    app.add_option("--out", out, "Folder for the table")->capture_default_str();
    app.add_flag("--quick", quick, "Half a second of each, explicit bodies at the lowest stiffness only");
    app.add_option("--scene", only,
                   "incline, stack, ball on block, pile, boxes on slab or boxes on tiles; else all of them");
    app.add_flag("--sweeps_alone", sweeps, "Regions are solved without Newton steps");
    CLI11_PARSE(app, argc, argv);
    try {
        std::filesystem::create_directories(out);
        std::ofstream table(std::filesystem::path(out) / "stiff.csv");
        table << "scene,modulus,dynamics,step,tolerance,steps,cpu_seconds,speed,creep,acceleration_error,depth,"
                 "unconverged\n";
        std::printf(
            "| scene | E (Pa) | bodies | step (ms) | tolerance | CPU s a simulated s | speed at the end (m/s) | "
            "creep (m/s) | acceleration error (%%) | depth (mm) | not converged |\n"
            "|---|---|---|---|---|---|---|---|---|---|---|\n");
        for (const std::string scene : {"incline", "stack", "ball on block", "pile", "boxes on slab", "boxes on tiles"})
            for (const Real modulus : {1e6, 1e8, 1e10})
                for (const BodyDynamics dynamics :
                     {BodyDynamics::explicit_elastic, BodyDynamics::implicit_elastic, BodyDynamics::rigid})
                    for (const Real tolerance : {1e-3, 1e-6}) {
                        if (!only.empty() && only != scene) continue;
                        // The boxes show the cost of forming one region, not how still they lie.
                        if (scene.starts_with("boxes") && tolerance != 1e-3) continue;
                        // Stiffness has no effect on rigid bodies.
                        if (dynamics == BodyDynamics::rigid && modulus != 1e8) continue;
                        if (dynamics == BodyDynamics::explicit_elastic && (modulus > (quick ? 1e6 : 1e8))) continue;
                        const Case test_case{scene,
                                             modulus,
                                             dynamics,
                                             0.01,
                                             tolerance,
                                             quick ? 0.5 : 1,
                                             sweeps ? SolverMethod::ags : SolverMethod::automatic};
                        write(test_case, run(test_case), table);
                    }
        std::printf("%s\n", out.c_str());
    } catch (const std::exception& error) {
        std::fprintf(stderr, "%s\n", error.what());
        return 1;
    }
    return 0;
}
