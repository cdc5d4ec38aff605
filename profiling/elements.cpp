// profile_elements: nanoseconds per tetrahedron of the elastic kernels, in cache and from memory, beside a bound given
// by the machine.
//
// The bound is the larger of bytes / bandwidth and flops / flop rate, both measured in the same run on as many workers
// and for the instruction set of the kernels (profiling/roofline). Bandwidth is that of a triad in the smallest level
// of memory that holds the data of the mesh. The flop rate is that of separate multiplications and additions, because
// the project compiles without contraction and so has no fused multiply-add. Set SKERRY_INSTRUCTION_SET to choose the
// kernels.
#include <CLI/CLI.hpp>
#include <algorithm>
#include <cstdio>
#include <fstream>
#include <limits>
#include <nlohmann/json.hpp>

#include "engine/world/kernels.h"
#include "jobs/executor.h"
#include "profiling/measure.h"
#include "profiling/roofline/roofline.h"
#include "systems/material/relaxation.h"
#include "systems/material/with_law.h"
#include "tests/support/elastic_body.h"

namespace {

using namespace skerry;
using profiling::Roofline;

/// Numbers of elements, of their nodes, and of slots of the patches, per tetrahedron.
struct Density {
    double elements, nodes, slots;
};

/// Cost of one tetrahedron, counted in the source. Bytes per node of an element: gradient (except for the first node)
/// 24, slot 4. Bytes per slot: node 4, position and force 32 each for the store and 32 each for the fetch before it.
/// Bytes per element: volume 8, material 0.5, and with a frame 32 + 32 + 32 for the quaternions. Positions: 4 bytes
/// (0.18 nodes per tetrahedron). Flops per node except the first: edge 3, F 18, force 15; per node: sum 3; per element:
/// 9, and the law. A frame takes 172 flops in each of two passes (division and root count as one) and 24 more.
struct Cost {
    double bytes = 0, flops = 0, single_flops = 0;
};
Cost operator+(const Cost& a, const Cost& b) {
    return {a.bytes + b.bytes, a.flops + b.flops, a.single_flops + b.single_flops};
}
Cost element_cost(MaterialModel model, const Density& density) {
    const double others = density.nodes - density.elements;
    const Cost shared{24 * others + 4 * density.nodes + 132 * density.slots + 8.5 * density.elements + 4,
                      36 * others + 3 * density.nodes + 9 * density.elements};
    return with_law(model, [&](auto law) -> Cost {
        if constexpr (law.has_frame)
            return {shared.bytes + 96 * density.elements,
                    shared.flops + (2 * 172 + 24 + law.stress_flops) * density.elements};
        return {shared.bytes, shared.flops + law.stress_flops * density.elements};
    });
}
/// Additional cost of losses. Bytes: strains of the springs 104 for the load, 104 for the store and 104 for the fetch
/// before it; frequency 8. Flops in double precision: strain 33, sum of the stresses 39, others 10. Flops in single
/// precision: 41 for each spring, 14 for their sums, 30 others.
Cost loss_cost(const Density& density) {
    return {320 * density.elements, 82 * density.elements, (41 * maxwell_count + 44) * density.elements};
}
/// Cost of the gather with its kick (velocity update). Per slot: force 32 and number 4 bytes, 3 additions. Per
/// tetrahedron: 0.18 nodes of 92 bytes and 15 flops.
Cost gather_cost(const Density& density) {
    return {36 * density.slots + 17, 3 * density.slots + 3};
}

/// The shortest time of all repeats, because other programs can only make a run slower [s].
template <class Work>
double least_seconds(int repeats, Work&& work) {
    work(0);  // warms up
    double least = std::numeric_limits<double>::infinity();
    for (int r = 1; r <= repeats; ++r) {
        const double start = profiling::wall_seconds();
        work(r);
        least = std::min(least, profiling::wall_seconds() - start);
    }
    return least;
}

struct Row {
    std::string mesh, element, model;
    bool losses;
    std::string pass, level;
    double nanoseconds, bound;  // per tetrahedron [ns]
};

/// Gathers forces and updates the velocities with them (kick).
void kick(Executor& executor, test::ElasticBody& body, std::span<Vec3> velocity_next) {
    std::vector<Index> begin, end;
    const auto count = static_cast<Index>(body.position.size());
    for (Index n = 0; n < count; n += nodes_per_block) {
        begin.push_back(n);
        end.push_back(std::min(n + nodes_per_block, count));
    }
    const std::vector<Index> of_body(begin.size(), 0);
    kernels().predict_velocity(
        executor,
        {begin, end, of_body, body.patches.slots_of_node.view(), body.patches.force, body.mass, body.inverse_mass},
        body.velocity, 1e-6, body.force, velocity_next);
}

/// Gives the springs of the elements the rates and the stiffness of a loss factor of 0.05.
void add_losses(test::ElasticBody& body, Real highest_rate) {
    constexpr Real loss_factor = 0.05, span = 1000;
    body.constants[0].loss_factor = loss_factor;
    std::ranges::fill(body.elements.relaxation_rate, relaxation_rates(highest_rate, span));
    for (ElementLane& frequency : body.elements.own_frequency) std::ranges::fill(frequency.lane, highest_rate);
    std::ranges::fill(body.elements.relaxing_share, relaxing_share(loss_factor, span));
}

/// Measures linear elements with every law, and all kinds of elements with the default law with and without losses.
void measure(Executor& executor, const test::TetMesh& mesh, const std::string& name, const Roofline& roofline,
             int repeats, std::vector<Row>& rows) {
    const double count = static_cast<double>(mesh.tetrahedra.size());
    const auto measure_one = [&](ElementKind element, MaterialModel model, bool losses) {
        test::ElasticBody body(mesh, material_constants(model, 1e5, 0.4, 1000), Mat3::Identity(), element);
        constexpr Real h = 1e-4;
        if (losses) add_losses(body, 1 / h);
        Density density{};
        for (std::size_t b = 0; b < body.elements.volume.size(); ++b)
            for (const Real v : body.elements.volume[b].lane) {
                density.elements += v > 0 ? 1 / count : 0;
                density.nodes += v > 0 ? body.elements.count[b] / count : 0;
            }
        density.slots = static_cast<double>(body.patches.node.size()) / count;
        // Two shapes alternate. They are deformed by a tenth and rotated by 1e-4 rad against each other, like in a fast
        // step. The frame then needs two passes.
        std::vector<Vec3> shape[2] = {body.position, body.position};
        const Eigen::AngleAxis<Real> turn(1e-4, Vec3(1, 2, 3).normalized());
        for (std::size_t n = 0; n < shape[0].size(); ++n) {
            shape[0][n] += 0.1 * Vec3(shape[0][n].y(), -0.5 * shape[0][n].z(), shape[0][n].x());
            shape[1][n] = turn * shape[0][n];
        }
        std::vector<Vec3> velocity_next = body.velocity;
        const double elements = least_seconds(repeats, [&](int r) {
            test::ElasticBody& of = body;
            kernels().compute_element_forces(executor, of.inputs(), shape[r % 2], of.velocity, h, of.elements.rotation,
                                             {of.elements.rotation_next, of.elements.spring_strain_next},
                                             of.patch_forces());
            swap(of.elements.rotation, of.elements.rotation_next);
            swap(of.elements.spring_strain, of.elements.spring_strain_next);
        });
        const double gather = least_seconds(repeats, [&](int) { kick(executor, body, velocity_next); });
        const std::string of_element(name_of(element)), of_model(name_of(model));
        const auto add = [&](const char* pass, double seconds, const Cost& cost) {
            const profiling::MemoryLevel& level = level_of(roofline.levels, cost.bytes * count);
            const double flops = cost.flops / roofline.separate_double + cost.single_flops / roofline.separate_single;
            const double bound = std::max(cost.bytes / level.triad, flops);
            rows.push_back({name, of_element, of_model, losses, pass, level.name, 1e9 * seconds / count, 1e9 * bound});
        };
        add("elements", elements, element_cost(model, density) + (losses ? loss_cost(density) : Cost{}));
        if (!losses) add("gather", gather, gather_cost(density));
    };
    for (const auto& [model, model_name] : EnumNames<MaterialModel>::table)
        measure_one(ElementKind::linear, model, false);
    measure_one(ElementKind::linear, MaterialModel::stable_neo_hookean, true);
    for (const ElementKind element : {ElementKind::edge_smoothed, ElementKind::edge_node_smoothed})
        for (const bool losses : {false, true}) measure_one(element, MaterialModel::stable_neo_hookean, losses);
}

void print(const Roofline& roofline, const std::vector<Row>& rows, int threads) {
    std::printf("instruction set %s, threads %d\n\n", kernels().instruction_set, threads);
    std::printf("%-22s %8s %8s\n", "GF/s", "double", "single");
    std::printf("%-22s %8.1f %8.1f\n", "multiply and add", roofline.separate_double / 1e9,
                roofline.separate_single / 1e9);
    std::printf("%-22s %8.1f %8.1f  (not used: no contraction)\n\n", "fused multiply-add", roofline.fused_double / 1e9,
                roofline.fused_single / 1e9);
    std::printf("%-22s %8s %8s\n", "GB/s", "read", "triad");
    for (const profiling::MemoryLevel& level : roofline.levels)
        std::printf("%-22s %8.1f %8.1f\n", level.name.c_str(), level.read / 1e9, level.triad / 1e9);
    std::printf("\n%-7s %-19s %-19s %-7s %-9s %-7s %10s %10s %10s\n", "mesh", "elements", "model", "losses", "pass",
                "level", "ns/tet", "bound", "of bound");
    for (const Row& row : rows)
        std::printf("%-7s %-19s %-19s %-7s %-9s %-7s %10.2f %10.2f %9.0f%%\n", row.mesh.c_str(), row.element.c_str(),
                    row.model.c_str(), row.losses ? "yes" : "no", row.pass.c_str(), row.level.c_str(), row.nanoseconds,
                    row.bound, 100 * row.bound / row.nanoseconds);
}

void write_json(const std::string& file, const Roofline& roofline, const std::vector<Row>& rows, int threads) {
    nlohmann::json json{{"threads", threads},
                        {"instruction_set", kernels().instruction_set},
                        {"flops_per_second", roofline.separate_double},
                        {"flops_fused_per_second", roofline.fused_double},
                        {"flops_single_per_second", roofline.separate_single},
                        {"flops_single_fused_per_second", roofline.fused_single},
                        {"levels", nlohmann::json::array()},
                        {"rows", nlohmann::json::array()}};
    for (const profiling::MemoryLevel& level : roofline.levels)
        json["levels"].push_back(
            {{"level", level.name}, {"read_bytes_per_second", level.read}, {"triad_bytes_per_second", level.triad}});
    for (const Row& row : rows)
        json["rows"].push_back({{"mesh", row.mesh},
                                {"elements", row.element},
                                {"model", row.model},
                                {"losses", row.losses},
                                {"pass", row.pass},
                                {"level", row.level},
                                {"ns_per_tetrahedron", row.nanoseconds},
                                {"bound_ns_per_tetrahedron", row.bound},
                                {"fraction_of_bound", row.bound / row.nanoseconds}});
    std::ofstream(file) << json.dump(2) << '\n';
}

}  // namespace

int main(int argc, char** argv) {
    CLI::App app{"Times the elastic kernels and compares them with the machine's bandwidth and flop rate."};
    int threads = 1, cached_cells = 4, large_cells = 55, repeats = 15;
    std::string json;
    app.add_option("--threads", threads, "workers")->capture_default_str()->check(CLI::PositiveNumber);
    app.add_option("--json", json, "write the figures to this file");
    app.add_option("--cached-cells", cached_cells, "cells along an edge of the small mesh, six tetrahedra each")
        ->capture_default_str();
    app.add_option("--large-cells", large_cells, "cells along an edge of the large mesh")->capture_default_str();
    app.add_option("--repeats", repeats, "repeats of the large mesh; the small one gets 20 times as many")
        ->capture_default_str()
        ->check(CLI::PositiveNumber);
    CLI11_PARSE(app, argc, argv);

    const Backend backend = threads == 1 ? Backend::serial : available_backends().front();
    const auto executor = make_executor(backend, threads);
    const auto mesh_of = [](Index n) { return test::jittered_box({n, n, n}, 1.0 / n, 0.1, 1); };
    const test::TetMesh cached = mesh_of(cached_cells), large = mesh_of(large_cells);
    const Roofline roofline = profiling::measure_roofline(profiling::peak_loops_for(kernels().instruction_set),
                                                          profiling::cache_sizes(), threads, 20);
    std::vector<Row> rows;
    measure(*executor, cached, "cached", roofline, 20 * repeats, rows);
    measure(*executor, large, "large", roofline, repeats, rows);
    print(roofline, rows, threads);
    if (!json.empty()) write_json(json, roofline, rows, threads);
    return 0;
}
