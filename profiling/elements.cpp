// profile_elements: nanoseconds per tetrahedron of the elastic kernels, in cache and from memory, beside a bound given
// by the machine.
//
// The bound is the larger of bytes / bandwidth and flops / flop rate, both measured in the same run on as many workers.
// Bandwidth is that of a triad a = b + s c over a working set of the same size as the mesh, counting the line that a
// store fetches first. The flop rate is that of separate multiplications and additions: the project compiles without
// contraction, so a fused multiply-add is not available.
#include <CLI/CLI.hpp>
#include <algorithm>
#include <chrono>
#include <cstdio>
#include <fstream>
#include <nlohmann/json.hpp>
#include <thread>

#include "jobs/executor.h"
#include "jobs/parallel_for.h"
#include "systems/dynamics/motion/predict_velocity.h"
#include "systems/material/lane_math.h"
#include "systems/material/with_law.h"
#include "tests/support/elastic_body.h"

namespace {

using namespace skerry;

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
    double bytes, flops;
};
Cost element_cost(MaterialModel model, const Density& of) {
    const double others = of.nodes - of.elements;
    const Cost shared{24 * others + 4 * of.nodes + 132 * of.slots + 8.5 * of.elements + 4,
                      36 * others + 3 * of.nodes + 9 * of.elements};
    return with_law(model, [&](auto law) -> Cost {
        if constexpr (law.has_frame)
            return {shared.bytes + 96 * of.elements, shared.flops + (2 * 172 + 24 + law.stress_flops) * of.elements};
        return {shared.bytes, shared.flops + law.stress_flops * of.elements};
    });
}
/// Cost of the gather with its kick (velocity update). Per slot: force 32 and number 4 bytes, 3 additions. Per
/// tetrahedron: 0.18 nodes of 92 bytes and 15 flops.
Cost gather_cost(const Density& of) {
    return {36 * of.slots + 17, 3 * of.slots + 3};
}

template <class Work>
double median_seconds(int repeats, Work&& work) {
    std::vector<double> seconds;
    for (int r = 0; r < repeats + 1; ++r) {
        const auto start = std::chrono::steady_clock::now();
        work(r);
        seconds.push_back(std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count());
    }
    seconds.erase(seconds.begin());  // the first warms up
    std::nth_element(seconds.begin(), seconds.begin() + repeats / 2, seconds.end());
    return seconds[static_cast<std::size_t>(repeats / 2)];
}

/// Bandwidth of a triad whose three arrays fill `bytes` [bytes/s].
double triad_bandwidth(Executor& executor, std::size_t bytes, int repeats) {
    const std::size_t count = bytes / (3 * sizeof(Real));
    Column<Real> a, b, c;
    for (auto* column : {&a, &b, &c}) column->resize(count, 1);
    const int inner = bytes < (std::size_t{16} << 20) ? 20 : 1;
    const double seconds = median_seconds(repeats, [&](int r) {
        for (int i = 0; i < inner; ++i)
            parallel_for(executor, count, 32768, [&](std::size_t begin, std::size_t end) {
                const Real s = r + i;
                Real* to = a.data();
                const Real *x = b.data(), *y = c.data();
#pragma omp simd
                for (std::size_t k = begin; k < end; ++k) to[k] = x[k] + s * y[k];
            });
    });
    return 4.0 * sizeof(Real) * static_cast<double>(count) * inner / seconds;
}

constexpr int chains = 12;  // registers of 8 reals: enough to hide the latency
constexpr int rounds = 20000;

#define SKERRY_ROUNDS                                                                                             \
    Real8 x0 = x, x1 = x + 1, x2 = x + 2, x3 = x + 3, x4 = x + 4, x5 = x + 5, x6 = x + 6, x7 = x + 7, x8 = x + 8, \
          x9 = x + 9, xa = -x, xb = 2 * x;                                                                        \
    for (int i = 0; i < rounds; ++i) {                                                                            \
        x0 = x0 * a + b, x1 = x1 * a + b, x2 = x2 * a + b, x3 = x3 * a + b, x4 = x4 * a + b, x5 = x5 * a + b;     \
        x6 = x6 * a + b, x7 = x7 * a + b, x8 = x8 * a + b, x9 = x9 * a + b, xa = xa * a + b, xb = xb * a + b;     \
    }                                                                                                             \
    x = x0 + x1 + x2 + x3 + x4 + x5 + x6 + x7 + x8 + x9 + xa + xb

[[gnu::noinline]] void multiply_and_add(Real8& x, const Real8& a, const Real8& b) {
    SKERRY_ROUNDS;
}
/// Contracted version of multiply_and_add: the only place in the project that allows contraction.
[[gnu::noinline, gnu::optimize("fp-contract=fast")]] void fused_multiply_add(Real8& x, const Real8& a, const Real8& b) {
    SKERRY_ROUNDS;
}
#undef SKERRY_ROUNDS

/// Rate of independent multiplications and additions on one worker [flops/s].
double flop_rate(void (*work)(Real8&, const Real8&, const Real8&), int repeats) {
    Real8 x = Real8{} + 1.0;
    const Real8 a = Real8{} + (1 - 1e-9), b = Real8{} + 1e-9;
    const double seconds = median_seconds(repeats, [&](int) { work(x, a, b); });
    return 2.0 * element_lanes * chains * rounds / seconds;
}

struct Machine {
    double triad_cached, triad_large;  // [B/s]
    double flops, flops_fused;         // of all workers [1/s]
};

struct Row {
    std::string mesh, element, model, pass;
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
    predict_velocity(
        executor,
        {begin, end, of_body, body.patches.slots_of_node.view(), body.patches.force, body.mass, body.inverse_mass},
        body.velocity, 1e-6, body.force, velocity_next);
}

/// Measures linear elements with every law, and smoothed ones with the default law.
void measure(Executor& executor, const test::TetMesh& mesh, const std::string& name, double bandwidth, double flops,
             int repeats, std::vector<Row>& rows) {
    const double count = static_cast<double>(mesh.tetrahedra.size());
    const auto bound = [&](const Cost& cost) { return 1e9 * std::max(cost.bytes / bandwidth, cost.flops / flops); };
    const auto measure_one = [&](ElementKind element, MaterialModel model) {
        test::ElasticBody body(mesh, material_constants(model, 1e5, 0.4, 1000), Mat3::Identity(), element);
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
        const double elements = median_seconds(repeats, [&](int r) {
            compute_element_forces(executor, body.inputs(), shape[r % 2], body.velocity, 0, body.elements.rotation,
                                   {.rotation = body.elements.rotation_next}, body.patch_forces());
            swap(body.elements.rotation, body.elements.rotation_next);
        });
        const double gather = median_seconds(repeats, [&](int) { kick(executor, body, velocity_next); });
        const std::string of_element(name_of(element)), of_model(name_of(model));
        rows.push_back(
            {name, of_element, of_model, "elements", 1e9 * elements / count, bound(element_cost(model, density))});
        rows.push_back({name, of_element, of_model, "gather", 1e9 * gather / count, bound(gather_cost(density))});
    };
    for (const auto& [model, model_name] : EnumNames<MaterialModel>::table) measure_one(ElementKind::linear, model);
    for (const ElementKind element : {ElementKind::edge_smoothed, ElementKind::edge_node_smoothed})
        measure_one(element, MaterialModel::stable_neo_hookean);
}

void print(const Machine& machine, const std::vector<Row>& rows, int threads) {
    std::printf("threads %d\n", threads);
    std::printf("triad, in cache      %8.1f GB/s\ntriad, from memory   %8.1f GB/s\n", machine.triad_cached / 1e9,
                machine.triad_large / 1e9);
    std::printf("multiply and add     %8.1f GF/s\nfused multiply-add   %8.1f GF/s (not used: no contraction)\n\n",
                machine.flops / 1e9, machine.flops_fused / 1e9);
    std::printf("%-7s %-19s %-19s %-9s %10s %10s %10s\n", "mesh", "elements", "model", "pass", "ns/tet", "bound",
                "of bound");
    for (const Row& row : rows)
        std::printf("%-7s %-19s %-19s %-9s %10.2f %10.2f %9.0f%%\n", row.mesh.c_str(), row.element.c_str(),
                    row.model.c_str(), row.pass.c_str(), row.nanoseconds, row.bound, 100 * row.bound / row.nanoseconds);
}

void write_json(const std::string& file, const Machine& machine, const std::vector<Row>& rows, int threads) {
    nlohmann::json json{{"threads", threads},
                        {"triad_cached_bytes_per_second", machine.triad_cached},
                        {"triad_large_bytes_per_second", machine.triad_large},
                        {"flops_per_second", machine.flops},
                        {"flops_fused_per_second", machine.flops_fused},
                        {"rows", nlohmann::json::array()}};
    for (const Row& row : rows)
        json["rows"].push_back({{"mesh", row.mesh},
                                {"elements", row.element},
                                {"model", row.model},
                                {"pass", row.pass},
                                {"ns_per_tetrahedron", row.nanoseconds},
                                {"bound_ns_per_tetrahedron", row.bound},
                                {"fraction_of_bound", row.bound / row.nanoseconds}});
    std::ofstream(file) << json.dump(2) << '\n';
}

}  // namespace

int main(int argc, char** argv) {
    CLI::App app{"Times the elastic kernels and compares them with the machine's bandwidth and flop rate."};
    int threads = 1, cached_cells = 12, large_cells = 55, repeats = 15;
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
    // The small mesh with its forces takes about 200 bytes per tetrahedron. The triad in cache covers the same size.
    const Machine machine{.triad_cached = triad_bandwidth(*executor, 200 * cached.tetrahedra.size(), 20 * repeats),
                          .triad_large = triad_bandwidth(*executor, std::size_t{256} << 20, repeats),
                          .flops = threads * flop_rate(multiply_and_add, repeats),
                          .flops_fused = threads * flop_rate(fused_multiply_add, repeats)};
    std::vector<Row> rows;
    measure(*executor, cached, "cached", machine.triad_cached, machine.flops, 20 * repeats, rows);
    measure(*executor, large, "large", machine.triad_large, machine.flops, repeats, rows);
    print(machine, rows, threads);
    if (!json.empty()) write_json(json, machine, rows, threads);
    return 0;
}
