// profile_implicit_factor: cost of the factor of an implicit body by its size, and of whole steps of such bodies beside
// explicit ones. Prints the tables of docs/methods/implicit_bodies.md 3, 6 and 8.
#include <CLI/CLI.hpp>
#include <cstdio>
#include <string>
#include <vector>

#include "profiling/measure.h"
#include "skerry/world.h"
#include "systems/dynamics/elements/build_elements.h"
#include "systems/dynamics/implicit/stiff_body.h"
#include "systems/material/material_law.h"

using namespace skerry;

namespace {

constexpr Real h = 1e-2;  // [s]

StiffBody stiff_cube(const Mesh& mesh) {
    const MaterialConstants material = material_constants(MaterialModel::corotational, 1e8, 0.3, 1000);
    std::vector<Real> mass(mesh.nodes.size(), 0);
    add_lumped_mass(mesh.tetrahedra, mesh.nodes, std::vector<Real>(mesh.tetrahedra.size(), material.density), mass);
    std::vector<Real> tetrahedron_mass;
    for (const auto& corners : mesh.tetrahedra)
        tetrahedron_mass.push_back(material.density * six_volumes(corners, mesh.nodes) / 6);
    return StiffBody(elements_of({mesh.tetrahedra, mesh.nodes}, ElementKind::linear), {&material, 1}, mass, mesh.nodes,
                     mesh.tetrahedra, tetrahedron_mass);
}

void print_row(int cells) {
    const Mesh mesh = mesh::box({1, 1, 1}, {cells, cells, cells});
    StiffBody body = stiff_cube(mesh);
    int made = 0;
    const double factor = 1e3 * profiling::timed([] {}, [&] { body.prepare(1, h * h * ++made); });
    std::vector<Vec3> impulse(body.size(), Vec3(1, 2, 3));
    const double solve = 1e3 * profiling::timed([] {}, [&] { body.respond(impulse); });
    std::printf("| %zu | %zu | %.1f | %.2f |\n", mesh.tetrahedra.size(), mesh.nodes.size(), factor, solve);
    std::fflush(stdout);
}

struct Steps {
    double first = 0, later = 0;  // CPU time of the first step, and median of the next ones [s]
};

/// Times steps of a cube of smoothed elements that lies on a floor. The steps are short, so that explicit ones are
/// stable, too.
Steps time_steps(int cells, BodyDynamics dynamics) {
    constexpr Real step = 1e-5;  // [s]
    constexpr int steps = 20;
    Settings settings;
    settings.step_size = step;
    settings.backend = Backend::serial;
    settings.clusters = false;
    World world(settings);
    const MaterialHandle material = world.add_material({.young_modulus = 3e7});
    world.add_body(mesh::box(Vec3::Constant(0.1), {cells, cells, cells}),
                   {.material = material, .position = {0, 0, 0.05}, .dynamics = dynamics});
    world.add_collider(Plane{});
    Steps took;
    const double start = profiling::cpu_seconds();
    world.advance(step);
    took.first = profiling::cpu_seconds() - start;
    std::vector<double> later;
    for (int i = 0; i < steps; ++i) {
        const double before = profiling::cpu_seconds();
        world.advance(step);
        later.push_back(profiling::cpu_seconds() - before);
    }
    took.later = profiling::median(later);
    return took;
}

struct LargeSteps {
    double each = 0;                 // CPU time of a step, median [s]
    double newton = 0, factors = 0;  // per step of large strain
};

/// Times steps of a cube of smoothed elements that is so soft that it sinks in by a third of its height, while it does.
LargeSteps time_large_steps(int cells, BodyDynamics dynamics) {
    const Real step = dynamics == BodyDynamics::implicit_elastic ? 1.0 / 240 : 1e-4;  // [s]
    Settings settings;
    settings.step_size = step;
    settings.backend = Backend::serial;
    settings.clusters = false;
    World world(settings);
    const MaterialHandle material = world.add_material({.young_modulus = 3e3, .poisson_ratio = 0.3});
    world.add_body(mesh::box(Vec3::Constant(0.1), {cells, cells, cells}),
                   {.material = material, .position = {0, 0, 0.05}, .dynamics = dynamics});
    world.add_collider(Plane{});
    world.advance(0.04);
    const WorldReport before = world.report();
    std::vector<double> later;
    for (int i = 0; i < 20; ++i) {
        const double start = profiling::cpu_seconds();
        world.advance(step);
        later.push_back(profiling::cpu_seconds() - start);
    }
    const WorldReport after = world.report();
    const auto solved = static_cast<double>(after.large_strain_steps - before.large_strain_steps);
    return {profiling::median(later), static_cast<double>(after.newton_steps - before.newton_steps) / solved,
            static_cast<double>(after.tangent_factors - before.tangent_factors) / solved};
}

void print_large_steps(int cells) {
    const LargeSteps as_explicit = time_large_steps(cells, BodyDynamics::explicit_elastic);
    const LargeSteps as_implicit = time_large_steps(cells, BodyDynamics::implicit_elastic);
    std::printf("| %d | %d | %.3f | %.2f | %.1f | %.1f | %.0f |\n", 6 * cells * cells * cells,
                (cells + 1) * (cells + 1) * (cells + 1), 1e3 * as_explicit.each, 1e3 * as_implicit.each,
                as_implicit.newton, as_implicit.factors, as_implicit.each / as_explicit.each);
    std::fflush(stdout);
}

void print_steps(int cells) {
    const Steps as_explicit = time_steps(cells, BodyDynamics::explicit_elastic);
    const Steps as_implicit = time_steps(cells, BodyDynamics::implicit_elastic);
    std::printf("| %d | %d | %.3f | %.3f | %.1f | %.1f |\n", 6 * cells * cells * cells,
                (cells + 1) * (cells + 1) * (cells + 1), 1e3 * as_explicit.later, 1e3 * as_implicit.later,
                1e3 * as_implicit.first, as_implicit.later / as_explicit.later);
    std::fflush(stdout);
}

}  // namespace

int main(int argc, char** argv) {
    CLI::App app{"The factor of an implicit body, for cubes of linear tetrahedra; median times of one thread."};
    int most = 22;
    app.add_option("--cells", most, "cells along an edge of the largest cube, up to 36")->check(CLI::PositiveNumber);
    bool steps = false;
    app.add_flag("--steps", steps,
                 "instead: whole steps of cubes of smoothed elements on a floor, explicit and implicit");
    bool large = false;
    app.add_flag("--large", large, "instead: the same of cubes that are pressed flat");
    CLI11_PARSE(app, argc, argv);
    if (large) {
        std::printf(
            "| tetrahedra | nodes | explicit step, ms | implicit step, ms | Newton steps | factors "
            "| implicit over explicit |\n|---|---|---|---|---|---|---|\n");
        for (const int cells : {2, 4, 8})
            if (cells <= most) print_large_steps(cells);
        return 0;
    }
    if (steps) {
        std::printf(
            "| tetrahedra | nodes | explicit step, ms | implicit step, ms | first one, ms | implicit over explicit |\n"
            "|---|---|---|---|---|---|\n");
        for (const int cells : {2, 4, 8, 12})
            if (cells <= most) print_steps(cells);
        return 0;
    }
    std::printf("| tetrahedra | nodes | factor, ms | two triangular solves, ms |\n|---|---|---|---|\n");
    for (const int cells : {8, 11, 16, 22, 28, 36})
        if (cells <= most) print_row(cells);
}
