// profile_implicit_factor: what the factor of an implicit body costs, by its size: the table of
// docs/methods/implicit_bodies.md 3.
#include <CLI/CLI.hpp>
#include <cstdio>
#include <string>
#include <vector>

#include "profiling/measure.h"
#include "skerry/mesh.h"
#include "systems/dynamics/elements/build_elements.h"
#include "systems/dynamics/implicit/stiff_body.h"
#include "systems/material/material_law.h"

using namespace skerry;

namespace {

constexpr Real h = 1e-2;  // s

StiffBody stiff_cube(const Mesh& mesh) {
    const MaterialConstants material = material_constants(MaterialModel::corotational, 1e8, 0.3, 1000);
    std::vector<Real> mass(mesh.nodes.size(), 0);
    add_lumped_mass(mesh.tetrahedra, mesh.nodes, std::vector<Real>(mesh.tetrahedra.size(), material.density), mass);
    return StiffBody(elements_of({mesh.tetrahedra, mesh.nodes}, ElementKind::linear), {&material, 1}, mass, mesh.nodes);
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

}  // namespace

int main(int argc, char** argv) {
    CLI::App app{"The factor of an implicit body, for cubes of linear tetrahedra; median times of one thread."};
    int most = 22;
    app.add_option("--cells", most, "cells along an edge of the largest cube, up to 36")->check(CLI::PositiveNumber);
    CLI11_PARSE(app, argc, argv);
    std::printf("| tetrahedra | nodes | factor, ms | two triangular solves, ms |\n|---|---|---|---|\n");
    for (const int cells : {8, 11, 16, 22, 28, 36})
        if (cells <= most) print_row(cells);
}
