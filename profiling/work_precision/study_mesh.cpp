// Work against precision as the mesh gets finer, with both kinds of element. The material points are identical on every
// mesh, and the step is a fixed part of the stable step of the mesh.
#include <cmath>
#include <limits>

#include "profiling/work_precision/study.h"

namespace skerry::profiling {
namespace {

constexpr int points_per_body = 64;

/// Step size over the stable step. The error in time is then well below that of the mesh.
constexpr Real step_fraction = 0.5;

/// Run of a mesh with one kind of element.
struct MeshRun {
    PrecisionScene scene;
    Record record;
    std::vector<std::vector<Vec3>> path;  // positions of the material points, by sample
};

MeshRun run_mesh(const Study& study, const std::string& name, int level, ElementKind element) {
    MeshRun run{.scene = make_scene(name, level), .record = {}, .path = {}};
    run.scene.element = element;
    study.show(name + ": " + std::string(name_of(element)) + ", mesh of level " + std::to_string(level));
    run.record = study.run(run.scene, time_variants().back(), step_fraction * stable_step_of(run.scene));
    run.path = Probes(run.scene, points_per_body).follow(run.record);
    return run;
}

void study_scene(Study& study, const std::string& name) {
    // The reference is the finest mesh with smoothed elements. Its error is its distance from the next coarser mesh.
    const bool several = make_scene(name, 1).bodies.size() > 1;
    std::vector<int> levels{1, 2, 3, 4};
    if (!study.options.quick) levels.insert(levels.end(), {6, 8});
    if (!study.options.quick && !several) levels.push_back(12);
    std::vector<MeshRun> smoothed, linear;
    for (const int level : levels) {
        smoothed.push_back(run_mesh(study, name, level, ElementKind::smoothed));
        if (level != levels.back()) linear.push_back(run_mesh(study, name, level, ElementKind::linear));
    }
    const MeshRun reference = std::move(smoothed.back());
    smoothed.pop_back();
    const Real length = reference.scene.length;
    const Real reference_error = mean_distance(reference.path, smoothed.back().path, length);
    const auto write = [&](const std::string& engine, const std::string& variant, const PrecisionScene& scene,
                           const Record& run, Real error) {
        study.write(scene,
                    {.axis = "mesh",
                     .engine = engine,
                     .variant = variant,
                     .tolerance = engine == "Skerry" ? time_variants().back().settings.tolerance : 0,
                     .error = error,
                     .error_own = std::nan(""),
                     .reference_error = reference_error,
                     .own_reference_error = std::nan("")},
                    run);
    };
    for (const auto* runs : {&smoothed, &linear})
        for (const MeshRun& run : *runs)
            write("Skerry", std::string(name_of(run.scene.element)), run.scene, run.record,
                  mean_distance(run.path, reference.path, length));
    for (const Peer& peer : study.peers) {
        if (!peer.explicit_step || peer.engine != "Bullet") continue;  // the other peers have other material laws
        for (const MeshRun& ours : linear) {
            study.show(name + ": " + peer.engine + ", mesh of level " + std::to_string(ours.scene.level));
            const Record run = run_peer(ours.scene, peer, step_fraction * stable_step_of(ours.scene), 1,
                                        4 * study.options.cap, study.options.out / "runs");
            if (!run.finished) break;
            write(peer.engine, peer.variant, ours.scene, run,
                  mean_distance(Probes(ours.scene, points_per_body).follow(run), reference.path, length));
            if (run.seconds > study.options.cap) break;
        }
    }
}

}  // namespace

void study_mesh(Study& study) {
    for (const std::string& name : mesh_scenes())
        if (study.options.wants(name)) study_scene(study, name);
}

}  // namespace skerry::profiling
