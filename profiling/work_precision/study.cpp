#include "profiling/work_precision/study.h"

#include <algorithm>
#include <cmath>
#include <cstdio>

namespace skerry::profiling {

bool StudyOptions::wants(const std::string& scene) const {
    return scenes.empty() || std::ranges::find(scenes, scene) != scenes.end();
}

void Study::write(const PrecisionScene& scene, const Row& row, const Record& record) {
    table << row.axis << ',' << scene.name << ',' << row.engine << ',' << row.variant << ',' << scene.level << ','
          << scene.tetrahedra() << ',' << scene.seconds << ',' << record.step << ',' << row.tolerance << ','
          << record.seconds << ',' << record.steps << ',' << row.error << ',' << row.error_own << ','
          << row.reference_error << ',' << row.own_reference_error << ',' << record.finished << '\n'
          << std::flush;
}

void Study::show(const std::string& name) const {
    std::fprintf(stderr, "\r\033[K%s", name.c_str());
}

Record Study::run(const PrecisionScene& scene, const SkerryVariant& variant, Real step) const {
    Record record = run_skerry(scene, variant, step);
    if (record.finished && record.seconds < 0.5 && options.repeat > 1) {
        const Record again = run_skerry(scene, variant, step, options.repeat);
        record.seconds = again.seconds;
    }
    return record;
}

std::vector<Record> Study::run_ladder(const PrecisionScene& scene, const Peer& peer) const {
    std::vector<Record> runs;
    const std::filesystem::path folder = options.out / "runs";
    // The longest step is a sample interval. Peers with explicit steps begin near the stable step of the mesh, since a
    // run that blows up takes long for all its contacts.
    Real step = scene.seconds / scene.samples;
    while (peer.explicit_step && step > 1.2 * stable_step_of(scene)) step /= 2;
    for (; runs.size() < 20; step /= 2) {
        const double last = runs.empty() ? 0 : runs.back().seconds;
        if (2 * last > 4 * options.cap) break;
        show(scene.name + ": " + peer.engine + ", " + peer.variant + ", step " + std::to_string(step));
        const Record run = run_peer(scene, peer, step, last < 0.1 ? options.repeat : 1, 4 * options.cap, folder);
        runs.push_back(run);
        runs.back().step = step;
        if (!run.finished && run.seconds > options.cap) break;
    }
    return runs;
}

}  // namespace skerry::profiling
