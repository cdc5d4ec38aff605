// Creep of a block that friction can hold.
#include <string>

#include "profiling/work_precision/study.h"

namespace skerry::profiling {
namespace {

/// Mean tangential speed of the centre of mass after the settling [m/s].
Real creep_of(const PrecisionScene& scene, const Record& record) {
    const auto center = [&](std::size_t sample) {
        Vec3 moment = Vec3::Zero();
        Real mass = 0;
        const std::vector<Real>& m = scene.bodies[0].mass;
        for (std::size_t n = 0; n < m.size(); ++n) {
            moment += m[n] * record.positions[sample][n];
            mass += m[n];
        }
        return Vec3(moment / mass);
    };
    const auto settled = static_cast<std::size_t>(creep_settling / scene.seconds * scene.samples) - 1;
    const Vec3 creep = center(record.positions.size() - 1) - center(settled);
    return Vec3(creep.x(), creep.y(), 0).norm() / creep_measured;
}

}  // namespace

void study_creep(Study& study) {
    if (!study.options.wants("creep")) return;
    std::ofstream table(study.options.out / "creep.csv");
    table << "engine,variant,step,tolerance,fraction,creep,seconds,finished\n";
    for (const Real fraction : {0.5, 0.9, 0.99}) {
        const PrecisionScene scene = make_creep_scene(fraction);
        const auto write = [&](const std::string& engine, const std::string& variant, Real tolerance, Real step,
                               const Record& run) {
            table << engine << ',' << variant << ',' << step << ',' << tolerance << ',' << fraction << ','
                  << (run.finished ? creep_of(scene, run) : -1) << ',' << run.seconds << ',' << run.finished << '\n'
                  << std::flush;
        };
        for (const Real tolerance : {1e-3, 1e-8}) {
            SkerryVariant variant{.name = tolerance == 1e-3 ? "as delivered" : "tolerance 1e-8", .settings = {}};
            variant.settings.tolerance = tolerance;
            study.show("creep: ours, " + variant.name);
            const Record run = run_skerry(scene, variant, 0);
            write("Skerry", variant.name, tolerance, run.step, run);
        }
        for (const Peer& peer : study.peers)
            for (const Real step : {1.0 / 240, 1.0 / 960, 1.0 / 3840}) {
                if (peer.explicit_damping) continue;
                study.show("creep: " + peer.engine + ", " + peer.variant);
                write(peer.engine, peer.variant, 0, step,
                      run_peer(scene, peer, step, 1, 4 * study.options.cap, study.options.out / "runs"));
            }
    }
}

}  // namespace skerry::profiling
