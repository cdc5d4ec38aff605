// Work against precision as the step gets shorter, for the integrators of Skerry and for the peers.
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <limits>

#include "profiling/work_precision/study.h"

namespace skerry::profiling {
namespace {

constexpr Real infinite = std::numeric_limits<Real>::infinity();

/// The reference of Skerry may take `reference_share` times as long as the longest run of a peer that is compared. Runs
/// of Skerry are compared down to a step 2^reference_halvings times longer than that of the reference.
constexpr double reference_share = 10;
constexpr int reference_halvings = 3;

/// A scene is compared up to half its divergence time. From then on two runs that began `first_distance` apart are
/// further apart than `diverged`.
constexpr Real first_distance = 1e-12;  // [m]
constexpr Real diverged = 1e-4;         // in units of the scene's length

/// Cuts the scene off at half its divergence time; does nothing if it does not diverge.
void cut_at_divergence(Study& study, PrecisionScene& scene, const SkerryVariant& variant, Real step) {
    if (scene.bodies.size() < 2) return;
    study.show(scene.name + ": divergence");
    PrecisionScene moved = scene;
    perturb(moved, 1, first_distance);
    SkerryVariant exact = variant;
    exact.settings.tolerance = 1e-12;  // otherwise the residual of the solver dominates the difference of the runs
    const Record a = run_skerry(scene, exact, step), b = run_skerry(moved, exact, step);
    for (std::size_t s = 0; s < std::min(a.positions.size(), b.positions.size()); ++s) {
        if (distance_at(scene, a, b, s) < diverged) continue;
        const int kept = std::max(1, static_cast<int>(s + 1) / 2);
        std::fprintf(stderr, "\r\033[K%s: runs begun %g m apart part at %.3f s; compared up to %.3f s\n",
                     scene.name.c_str(), first_distance, static_cast<double>(s + 1) * scene.seconds / scene.samples,
                     kept * scene.seconds / scene.samples);
        scene.seconds *= static_cast<Real>(kept) / scene.samples;
        scene.samples = kept;
        return;
    }
    std::fprintf(stderr, "\r\033[K%s: runs begun %g m apart are %.2g L apart at its end\n", scene.name.c_str(),
                 first_distance, distance_at(scene, a, b, a.positions.size() - 1));
}

void write_peers(Study& study, const PrecisionScene& scene, const Record& reference, Real reference_error) {
    const auto samples = static_cast<std::size_t>(scene.samples);
    for (const Peer& peer : study.peers) {
        const std::vector<Record> runs = study.run_ladder(scene, peer);
        const auto last = std::find_if(runs.rbegin(), runs.rend(), [](const Record& run) { return run.finished; });
        if (last == runs.rend()) continue;
        const auto own = static_cast<std::size_t>(runs.rend() - last) - 1;
        const Real own_error = own > 0 ? mean_distance(scene, runs[own], runs[own - 1], samples) : infinite;
        for (std::size_t k = 0; k <= own; ++k) {
            if (!runs[k].finished) continue;
            // The own reference and the run next to it are not compared with the reference.
            const Real error_own = k + 2 <= own ? mean_distance(scene, runs[k], runs[own], samples) : std::nan("");
            study.write(scene,
                        {.axis = "time",
                         .engine = peer.engine,
                         .variant = peer.variant,
                         .tolerance = 0,
                         .error = mean_distance(scene, runs[k], reference, samples),
                         .error_own = error_own,
                         .reference_error = reference_error,
                         .own_reference_error = own_error},
                        runs[k]);
        }
    }
}

void study_scene(Study& study, const std::string& name) {
    PrecisionScene scene = make_scene(name, usual_level(name));
    const std::vector<SkerryVariant> variants = time_variants();
    const Real longest = 0.95 * stable_step_of(scene);  // the stable step of a deformed body may be shorter
    cut_at_divergence(study, scene, variants.back(), longest / 8);
    const auto samples = static_cast<std::size_t>(scene.samples);
    const double first = run_skerry(scene, variants.back(), longest).seconds;
    const int affordable = static_cast<int>(std::log2(reference_share * study.options.cap / first));
    const int halvings = std::clamp(affordable - reference_halvings, 2, 8);

    study.show(name + ": reference");
    const SkerryVariant& best = variants.back();
    const Real shortest = longest / std::exp2(halvings + reference_halvings);
    const Record reference = run_skerry(scene, best, shortest), coarser = run_skerry(scene, best, 2 * shortest);
    const Real reference_error = mean_distance(scene, reference, coarser, samples);

    const auto write = [&](const SkerryVariant& variant, Real step) {
        study.show(name + ": ours, " + variant.name + ", step " + std::to_string(step));
        const Record run = study.run(scene, variant, step);
        const Real error = run.finished ? mean_distance(scene, run, reference, samples) : infinite;
        study.write(scene,
                    {.axis = "time",
                     .engine = "Skerry",
                     .variant = variant.name,
                     .tolerance = variant.settings.tolerance,
                     .error = error,
                     .error_own = error,
                     .reference_error = reference_error,
                     .own_reference_error = reference_error},
                    run);
    };
    write({.name = "as delivered", .settings = {}}, 0);
    for (const SkerryVariant& variant : variants)
        for (int k = 0; k <= halvings; ++k) write(variant, longest / std::exp2(k));
    write_peers(study, scene, reference, reference_error);
}

}  // namespace

void study_time(Study& study) {
    for (const std::string& name : trajectory_scenes())
        if (study.options.wants(name)) study_scene(study, name);
}

}  // namespace skerry::profiling
