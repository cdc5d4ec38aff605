// Work against precision of the contact solver: decreasing tolerances at one step size, by several methods, with and
// without warm start.
#include <string>

#include "profiling/work_precision/study.h"

namespace skerry::profiling {
namespace {

constexpr Real reference_tolerance = 1e-12;
constexpr int most_sweeps = 20000;

SkerryVariant variant_of(SolverMethod method, Real tolerance, WarmStart warm_start) {
    SkerryVariant variant{.name = std::string(name_of(method)), .settings = {}, .tuning = {.warm_start = warm_start}};
    variant.settings.method = method;
    variant.settings.tolerance = tolerance;
    variant.settings.max_iterations = most_sweeps;
    if (warm_start == WarmStart::off) variant.name += " cold";
    return variant;
}

void study_scene(Study& study, const std::string& name) {
    PrecisionScene scene = make_scene(name, usual_level(name));
    // Only the first third is used: the instability of the motion must not amplify a difference of the solver's size.
    scene.seconds /= 3;
    scene.samples = std::max(1, scene.samples / 3);
    const auto samples = static_cast<std::size_t>(scene.samples);
    const Real step = stable_step_of(scene) / 4;
    study.show(name + ": reference of the solver");
    const Record reference =
        run_skerry(scene, variant_of(SolverMethod::automatic, reference_tolerance, WarmStart::on), step);
    const Record other = run_skerry(scene, variant_of(SolverMethod::pgs, reference_tolerance, WarmStart::on), step);
    const Real reference_error = mean_distance(scene, reference, other, samples);

    const auto write = [&](SolverMethod method, WarmStart warm_start) {
        for (const Real tolerance : {1e-1, 1e-2, 1e-3, 1e-4, 1e-5, 1e-6, 1e-8, 1e-10}) {
            if (study.options.quick && tolerance < 1e-6) break;
            const SkerryVariant variant = variant_of(method, tolerance, warm_start);
            study.show(name + ": " + variant.name + ", tolerance " + std::to_string(tolerance));
            const Record run = study.run(scene, variant, step);
            const Real error = mean_distance(scene, run, reference, samples);
            study.write(scene,
                        {.axis = "solver",
                         .engine = "Skerry",
                         .variant = variant.name,
                         .tolerance = tolerance,
                         .error = error,
                         .error_own = error,
                         .reference_error = reference_error,
                         .own_reference_error = reference_error},
                        run);
        }
    };
    for (const SolverMethod method : {SolverMethod::automatic, SolverMethod::pgs, SolverMethod::pcg_pgs})
        write(method, WarmStart::on);
    write(SolverMethod::automatic, WarmStart::off);
}

}  // namespace

void study_solver(Study& study) {
    for (const char* name : {"stack", "skittles"})
        if (study.options.wants(name)) study_scene(study, name);
}

}  // namespace skerry::profiling
