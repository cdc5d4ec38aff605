// profile_first_scene: what a newcomer builds first, a block on a slope, with default settings: does it hold below the
// critical angle, and slide above it as Coulomb says? Prints docs/first_scene.md.
#include <CLI/CLI.hpp>
#include <cmath>
#include <cstdio>
#include <numbers>
#include <string>
#include <vector>

#include "profiling/measure.h"
#include "skerry/world.h"

using namespace skerry;

namespace {

constexpr Real gravity = 9.81, friction = 0.3, height = 0.2;  // m/s^2, 1, m

struct Case {
    Real young_modulus = 1e5;  // Pa
    Real above = 0;            // m, the lower face above the plane
    Real offset = 0;           // degrees from the critical angle
    Real loss_factor = 0, bulk_viscosity = 0;
    Real step_safety = 1;
    int cells = 1;  // of the mesh, times 4 x 4 x 2
};

struct Outcome {
    Real slip = 0;          // m/s, of the lower face, mean of the second half
    Real acceleration = 0;  // m/s^2, of the centre of mass, between 0.3 and 0.9 s
    Real expected = 0;      // m/s^2, by Coulomb's law
    Real hop = 0;           // m, highest place of the centre of mass above where the lower face at the shell has it
    Real energy_share = 0;  // by which energy does not add up
    double cpu = 0;         // s
};

Outcome run(const Case& one, Real seconds) {
    const Real angle = std::atan(friction) + one.offset * std::numbers::pi / 180;
    Settings settings;
    settings.gravity = gravity * Vec3(std::sin(angle), 0, -std::cos(angle));
    settings.backend = Backend::serial;
    settings.threads = 1;
    settings.step_safety = one.step_safety;
    World world(settings);
    const auto material = world.add_material({.young_modulus = one.young_modulus,
                                              .poisson_ratio = 0.3,
                                              .friction = friction,
                                              .loss_factor = one.loss_factor,
                                              .bulk_viscosity = one.bulk_viscosity});
    world.add_collider(Plane{});
    const Mesh mesh = mesh::box({0.4, 0.4, height}, {4 * one.cells, 4 * one.cells, 2 * one.cells});
    const auto block = world.add_body(mesh, {.material = material, .position = {0, 0, height / 2 + one.above}});
    const Real at_shell = height / 2 + world.contact_distance(block) / 2;  // a plane has no part in it

    Outcome outcome;
    const auto advance_to = [&](Real time) {
        while (world.time() < time - 1e-9) {
            if (const StepReport report = world.advance(std::min(0.01, time - world.time())); !report.ok())
                throw std::runtime_error(report.message());
            outcome.hop = std::max(outcome.hop, world.center_of_mass(block).z() - at_shell);
        }
    };
    const auto lower_face = [&] {
        Real sum = 0;
        int count = 0;
        for (std::size_t n = 0; n < mesh.nodes.size(); ++n)
            if (mesh.nodes[n].z() < -0.499 * height) {
                sum += world.positions(block)[n].x();
                ++count;
            }
        return sum / count;
    };
    // over 20 ms: vibrations of the body are no motion of it
    const auto speed_about = [&](Real time) {
        constexpr Real half = 0.01;
        advance_to(time - half);
        const Real before = world.center_of_mass(block).x();
        advance_to(time + half);
        return (world.center_of_mass(block).x() - before) / (2 * half);
    };
    const double start = profiling::cpu_seconds();
    const Real early = speed_about(0.3), late = speed_about(0.9);
    outcome.acceleration = (late - early) / 0.6;
    outcome.expected = gravity * (std::sin(angle) - friction * std::cos(angle));
    advance_to(seconds / 2);
    const Real middle = lower_face();
    advance_to(seconds);
    outcome.slip = (lower_face() - middle) / (seconds / 2);
    outcome.cpu = profiling::cpu_seconds() - start;
    outcome.energy_share = world.report().energy_error_share;
    return outcome;
}

std::string number(const char* format, Real value) {
    char text[32];
    std::snprintf(text, sizeof text, format, value);
    return text;
}

/// A row: slips below the critical angle, errors of the acceleration above it.
void print_row(const std::string& head, Case one, Real seconds) {
    std::string row = "| " + head + " |";
    Outcome worst;
    for (const Real offset : {-2.0, -0.5, -0.1}) {
        one.offset = offset;
        const Outcome outcome = run(one, seconds);
        row += std::abs(outcome.slip) < 1e-9 ? " 0 |" : number(" %.1e |", outcome.slip);
        worst.hop = std::max(worst.hop, outcome.hop);
        worst.energy_share = std::max(worst.energy_share, outcome.energy_share);
        worst.cpu += outcome.cpu;
    }
    for (const Real offset : {0.1, 0.5, 2.0, 10.0}) {
        one.offset = offset;
        const Outcome outcome = run(one, seconds);
        row += number(" %.2f |", 100 * (outcome.acceleration - outcome.expected) / gravity);
        worst.energy_share = std::max(worst.energy_share, outcome.energy_share);
        worst.cpu += outcome.cpu;
    }
    row += number(" %.2f |", 1e3 * worst.hop) + number(" %.2f |", 100 * worst.energy_share) +
           number(" %.3f |", worst.cpu / (7 * seconds));
    std::printf("%s\n", row.c_str());
    std::fflush(stdout);
}

void print_head(const char* first) {
    std::printf("| %s | -2 | -0.5 | -0.1 | +0.1 | +0.5 | +2 | +10 | hop | energy | CPU |\n", first);
    std::printf("|---|---:|---:|---:|---:|---:|---:|---:|---:|---:|---:|\n");
}

std::string start_name(Real above) {
    return above == 0 ? "on the plane" : number("%.0f mm above", 1e3 * above);
}

}  // namespace

int main(int argc, char** argv) {
    CLI::App app{"A block on a slope with default settings: what it does below and above the critical angle."};
    Real seconds = 2;
    std::vector<Real> moduli{1e4, 1e5, 1e6, 1e8, 1e10};
    app.add_option("--seconds", seconds, "Simulated seconds of a run")
        ->check(CLI::Range(1.0, 100.0))
        ->capture_default_str();
    app.add_option("--moduli", moduli, "Young's moduli, Pa")->check(CLI::PositiveNumber)->capture_default_str();
    CLI11_PARSE(app, argc, argv);
    try {
        for (const auto& [loss_factor, viscosity] : {std::pair{0.0, 0.0}, {0.05, 0.06}, {0.2, 0.06}}) {
            std::printf("\n## Loss factor %g, bulk viscosity %g%s\n\n", loss_factor, viscosity,
                        loss_factor == 0 ? " (default)" : "");
            print_head("E, start");
            for (const Real modulus : moduli)
                for (const Real above : {0.0, 0.003})
                    print_row(number("%.0e, ", modulus) + start_name(above),
                              {.young_modulus = modulus,
                               .above = above,
                               .loss_factor = loss_factor,
                               .bulk_viscosity = viscosity},
                              seconds);
        }
        std::printf(
            "\n## Is it the mesh, or the step?\n\nE = 1e5, loss factor 0.05, bulk viscosity 0.06, started on the "
            "plane.\n\n");
        print_head("mesh, step");
        for (const int cells : {1, 2, 4})
            print_row(std::to_string(4 * cells) + " x " + std::to_string(4 * cells) + " x " +
                          std::to_string(2 * cells) + ", stable",
                      {.loss_factor = 0.05, .bulk_viscosity = 0.06, .cells = cells}, seconds);
        for (const Real safety : {0.5, 0.1})
            print_row("4 x 4 x 2, stable / " + number("%.0f", 1 / safety),
                      {.loss_factor = 0.05, .bulk_viscosity = 0.06, .step_safety = safety}, seconds);
    } catch (const std::exception& error) {
        std::fprintf(stderr, "%s\n", error.what());
        return 1;
    }
    return 0;
}
