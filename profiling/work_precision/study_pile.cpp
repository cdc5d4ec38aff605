// Statistics of piles. A pile is chaotic: the position of a ball cannot be compared, only properties that many piles
// have in common. Writes one row per run; the plot computes the statistics.
#include <algorithm>
#include <numbers>
#include <string>

#include "profiling/work_precision/study.h"

namespace skerry::profiling {
namespace {

constexpr Real placement = 1e-4;  // largest random offset of a ball per component [m]

struct PileState {
    Real height = 0;   // of the centre of mass [m]
    Real top = 0;      // height below which 95 % of the nodes are [m]
    Real kinetic = 0;  // [J]
};

/// Means over the last third of the run.
PileState state_of(const PrecisionScene& scene, const Record& record) {
    PileState mean;
    const std::size_t count = record.positions.size(), first = count - count / 3;
    for (std::size_t s = first; s < count; ++s) {
        Real mass = 0, moment = 0, kinetic = 0;
        std::vector<Real> heights;
        std::size_t n = 0;
        for (const PrecisionBody& body : scene.bodies)
            for (const Real m : body.mass) {
                mass += m;
                moment += m * record.positions[s][n].z();
                kinetic += m * record.velocities[s][n].squaredNorm() / 2;
                heights.push_back(record.positions[s][n].z());
                ++n;
            }
        const auto quantile = heights.begin() + static_cast<std::ptrdiff_t>(0.95 * static_cast<double>(heights.size()));
        std::ranges::nth_element(heights, quantile);
        const auto weight = 1 / static_cast<Real>(count - first);
        mean.height += weight * moment / mass;
        mean.top += weight * *quantile;
        mean.kinetic += weight * kinetic;
    }
    return mean;
}

}  // namespace

void study_pile(Study& study) {
    if (!study.options.wants("pile")) return;
    const int runs = study.options.quick ? 4 : 20, peer_runs = study.options.quick ? 2 : 5;
    std::ofstream table(study.options.out / "pile.csv");
    table << "engine,variant,step,seed,seconds,height,top,kinetic,finished\n";
    const auto write = [&](const std::string& engine, const std::string& variant, int seed, const PrecisionScene& scene,
                           const Record& run) {
        const PileState state = run.finished ? state_of(scene, run) : PileState{};
        table << engine << ',' << variant << ',' << run.step << ',' << seed << ',' << run.seconds << ',' << state.height
              << ',' << state.top << ',' << state.kinetic << ',' << run.finished << '\n'
              << std::flush;
    };
    const auto placed = [&](int seed) {
        PrecisionScene scene = make_scene("pile", usual_level("pile"));
        perturb(scene, static_cast<std::uint32_t>(seed), placement);
        return scene;
    };
    const Real stable = stable_step_of(placed(0));
    SkerryVariant fine{.name = "reference", .settings = {}}, delivered{.name = "as delivered", .settings = {}};
    fine.settings.tolerance = 1e-5;
    fine.settings.max_iterations = 2000;
    for (int seed = 0; seed < runs; ++seed) {
        const PrecisionScene scene = placed(seed);
        study.show("pile: ours, run " + std::to_string(seed + 1) + " of " + std::to_string(runs));
        write("Skerry", "as delivered", seed, scene, run_skerry(scene, delivered, 0));
        write("Skerry", "reference", seed, scene, run_skerry(scene, fine, stable / 8));
    }
    for (const Peer& peer : study.peers)
        for (const Real step : {1.0 / 480, 1.0 / 1920})
            for (int seed = 0; seed < peer_runs; ++seed) {
                const PrecisionScene scene = placed(seed);
                study.show("pile: " + peer.engine + ", " + peer.variant + ", step " + std::to_string(step));
                Record run = run_peer(scene, peer, step, 1, 4 * study.options.cap, study.options.out / "runs");
                run.step = step;
                write(peer.engine, peer.variant, seed, scene, run);
                if (!run.finished) break;
            }
}

}  // namespace skerry::profiling
