// Work against precision as the mesh gets finer: the same material points on every mesh, each at the step that its mesh
// stands.
#include <cmath>
#include <limits>

#include "profiling/work_precision/study.h"

namespace skerry::profiling {
namespace {

constexpr int points_per_body = 64;

/// Of the stable step; the error in time is then well below that of the mesh.
constexpr Real step_fraction = 0.5;

void study_scene(Study& study, const std::string& name) {
    const std::vector<int> levels =
        study.options.quick ? std::vector<int>{1, 2, 3, 4} : std::vector<int>{1, 2, 3, 4, 6, 8, 12};
    const SkerryVariant variant = time_variants().back();
    std::vector<PrecisionScene> scenes;
    std::vector<Record> runs;
    std::vector<std::vector<std::vector<Vec3>>> paths;
    for (const int level : levels) {
        scenes.push_back(make_scene(name, level));
        study.show(name + ": mesh of level " + std::to_string(level));
        runs.push_back(study.run(scenes.back(), variant, step_fraction * stable_step_of(scenes.back())));
        paths.push_back(Probes(scenes.back(), points_per_body).follow(runs.back()));
    }
    const auto& reference = paths.back();
    const Real length = scenes.back().length;
    const Real reference_error = mean_distance(reference, paths[paths.size() - 2], length);
    const auto write = [&](const std::string& engine, const std::string& by, std::size_t k, const Record& run,
                           Real error) {
        study.write(scenes[k],
                    {.axis = "mesh",
                     .engine = engine,
                     .variant = by,
                     .tolerance = engine == "Skerry" ? variant.settings.tolerance : 0,
                     .error = error,
                     .error_own = std::nan(""),
                     .reference_error = reference_error,
                     .own_reference_error = std::nan("")},
                    run);
    };
    for (std::size_t k = 0; k + 1 < levels.size(); ++k)
        write("Skerry", variant.name, k, runs[k], mean_distance(paths[k], reference, length));
    for (const Peer& peer : study.peers) {
        if (!peer.explicit_step || peer.engine != "Bullet") continue;  // the others have other laws
        for (std::size_t k = 0; k + 1 < levels.size(); ++k) {
            study.show(name + ": " + peer.engine + ", mesh of level " + std::to_string(levels[k]));
            const Real step = step_fraction * stable_step_of(scenes[k]);
            const Record run = run_peer(scenes[k], peer, step, 1, 4 * study.options.cap, study.options.out / "runs");
            if (!run.finished) break;
            write(peer.engine, peer.variant, k, run,
                  mean_distance(Probes(scenes[k], points_per_body).follow(run), reference, length));
            if (run.seconds > study.options.cap) break;
        }
    }
}

}  // namespace

void study_mesh(Study& study) {
    for (const char* name : {"twist", "bounce", "slide"})
        if (study.options.wants(name)) study_scene(study, name);
}

}  // namespace skerry::profiling
