// profile_step_bounds: the step that the bound allows over the longest stable step, by kind of element. Prints a table
// for docs/methods/stable_step.md 2.1. Meshes are given by file; without any, built-in ones are used.
#include <CLI/CLI.hpp>
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <filesystem>
#include <string>
#include <vector>

#include "jobs/executor.h"
#include "skerry/mesh.h"
#include "systems/dynamics/stability/frame_masses.h"
#include "systems/dynamics/stability/mass_forms.h"
#include "systems/dynamics/stability/stable_step.h"
#include "tests/support/elastic_body.h"
#include "tests/support/element_kinds.h"

using namespace skerry;

namespace {

constexpr Real safety = 0.9;  // safety factor of stable_step: its result over the bound

/// Lower estimate of the highest circular frequency at rest [rad/s], by power iteration. `body` has the linear
/// material, whose forces are proportional to the displacements.
Real highest_frequency(test::ElasticBody& body) {
    constexpr int iterations = 3000;
    const auto executor = make_executor(Backend::serial, 1);
    const std::vector<Vec3> rest = body.position;
    std::vector<Vec3> u(rest.size());
    // No symmetry of the mesh makes this start vector orthogonal to the highest mode.
    for (std::size_t n = 0; n < u.size(); ++n)
        u[n] = Vec3(std::sin(12.9898 * static_cast<Real>(n + 1)), std::sin(78.233 * static_cast<Real>(n + 1)),
                    std::sin(37.719 * static_cast<Real>(n + 1)));
    Real squared = 0;
    for (int i = 0; i < iterations; ++i) {
        for (std::size_t n = 0; n < u.size(); ++n) body.position[n] = rest[n] + u[n];
        body.compute_forces(*executor);
        Real energy = 0, size = 0, largest = 0;
        for (std::size_t n = 0; n < u.size(); ++n) {
            energy -= u[n].dot(body.force[n]);
            size += body.mass[n] * u[n].squaredNorm();
            u[n] = -body.force[n] / body.mass[n];
            largest = std::max(largest, u[n].cwiseAbs().maxCoeff());
        }
        squared = energy / size;
        for (Vec3& x : u) x /= largest;
    }
    body.position = rest;
    return std::sqrt(squared);
}

void print_rows(const std::string& name, const Mesh& mesh) {
    Real of_linear = 0;
    for (const ElementKind kind : test::element_kinds) {
        test::ElasticBody body({mesh.nodes, mesh.tetrahedra}, material_constants(MaterialModel::linear, 1e5, 0.3, 1000),
                               Mat3::Identity(), kind);
        std::vector<Real> sums(body.position.size());
        const auto bound = [&] {
            return stable_step(body.inputs(), body.blocks, body.position, body.mass, sums).step / safety;
        };
        const Real limit = 2 / highest_frequency(body);
        const Real before = bound();
        find_mass_shares(body.inputs(), body.blocks, body.position, body.mass, sums, body.elements.mass_share.span());
        if (of_linear == 0) of_linear = limit;
        const Real shared = bound();
        find_mass_forms(body.inputs(), body.blocks, body.position, body.mass, products_of_group,
                        body.elements.mass_form.span());
        const Real by_forms = bound();
        find_frame_masses(body.inputs(), body.blocks, body.position, body.mass, products_of_frame,
                          body.elements.frame_mass.span(), body.elements.frame_bound.span());
        std::printf("| %s, %zu | %s | %.2f | %.2f | %.2f | %.2f | %.2f |\n", name.c_str(), mesh.tetrahedra.size(),
                    std::string(name_of(kind)).c_str(), limit / of_linear, before / limit, shared / limit,
                    by_forms / limit, bound() / limit);
        std::fflush(stdout);
    }
}

}  // namespace

int main(int argc, char** argv) {
    CLI::App app{"The bound on the stable step over the step that is stable, for meshes at rest."};
    std::vector<std::string> files;
    app.add_option("MESH", files, "mesh files; none: built-in meshes")->check(CLI::ExistingFile);
    CLI11_PARSE(app, argc, argv);
    try {
        std::printf(
            "| mesh, tetrahedra | element | limit over that of linear | bound over limit | shared in 4 rounds | by "
            "forms | in the frame |\n");
        std::printf("|---|---|---:|---:|---:|---:|---:|\n");
        if (files.empty()) {
            print_rows("bar", mesh::box({1, 0.1, 0.1}, {20, 2, 2}));
            print_rows("cube", mesh::box({1, 1, 1}, {8, 8, 8}));
            print_rows("ball", mesh::ball(1, 10));
            print_rows("skittle", mesh::skittle(0.38, 4));
        }
        for (const std::string& file : files) print_rows(std::filesystem::path(file).stem().string(), mesh::read(file));
    } catch (const std::exception& error) {
        std::fprintf(stderr, "%s\n", error.what());
        return 1;
    }
    return 0;
}
