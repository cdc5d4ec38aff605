#include <cstdlib>
#include <fstream>
#include <nlohmann/json.hpp>

#include "profiling/work_precision/runs.h"

namespace skerry::profiling {
namespace {

using Json = nlohmann::json;

std::string in_quotes(const std::filesystem::path& path) {
    return "'" + path.string() + "'";
}

std::vector<std::vector<Vec3>> vectors_of(const Json& samples) {
    std::vector<std::vector<Vec3>> all;
    for (const Json& sample : samples) {
        const auto values = sample.get<std::vector<Real>>();
        std::vector<Vec3>& positions = all.emplace_back(values.size() / 3);
        for (std::size_t n = 0; n < positions.size(); ++n)
            positions[n] = Vec3(values[3 * n], values[3 * n + 1], values[3 * n + 2]);
    }
    return all;
}

bool works(const std::string& command) {
    return std::system((command + " >/dev/null 2>&1").c_str()) == 0;
}

}  // namespace

bool has_module(const std::string& python, const std::string& module) {
    return works(in_quotes(python) + " -c 'import " + module + "'");
}

std::string script_command(const std::string& python, const std::string& script) {
    return in_quotes(python) + " " +
           in_quotes(std::filesystem::path(SKERRY_PROFILING_FOLDER) / "work_precision" / script);
}

std::vector<Peer> find_peers(const std::filesystem::path& programs, const std::string& python) {
    std::vector<Peer> peers;
    const auto bullet = [&](const char* program, const char* variant, const char* options, bool explicit_step) {
        const std::filesystem::path file = std::filesystem::absolute(programs) / program;
        if (std::filesystem::exists(file))
            peers.push_back({.engine = "Bullet",
                             .variant = variant,
                             .command = in_quotes(file) + options,
                             .explicit_step = explicit_step});
    };
    // The contact settings are those of Bullet's own examples; docs/work_precision.md has others.
    bullet("work_precision_bullet_double", "explicit double", "", true);
    bullet("work_precision_bullet", "explicit single", "", true);
    bullet("work_precision_bullet_double", "implicit double", " --implicit --projection", false);
    if (has_module(python, "mujoco"))
        for (const std::string integrator : {"Euler", "RK4", "discrete"})
            peers.push_back({.engine = "MuJoCo",
                             .variant = integrator,
                             .command = script_command(python, "mujoco_peer.py") + " --integrator " + integrator,
                             .explicit_step = integrator != "discrete",
                             .explicit_damping = integrator != "discrete"});
    return peers;
}

Record run_peer(const PrecisionScene& scene, const Peer& peer, Real step, int repeat, double cap,
                const std::filesystem::path& folder) {
    const std::filesystem::path path = std::filesystem::absolute(folder);
    const std::filesystem::path scene_file = path / "scene.json", result_file = path / "result.json";
    write_scene(scene, scene_file);
    std::filesystem::remove(result_file);
    char numbers[128];
    std::snprintf(numbers, sizeof numbers, " --step %.17g --repeat %d --cap %g", step, repeat, cap);
    // Messages of a peer, on its outputs or in files, are discarded. Only the lack of a result is reported.
    const std::string command = "exec " + peer.command + " " + in_quotes(scene_file) + " " + in_quotes(result_file) +
                                numbers + " >/dev/null 2>&1";
    Record record;
    if (std::system(command.c_str()) != 0 || !std::filesystem::exists(result_file)) return record;
    // a number that is not finite is written as null and read as a failure
    const Json result = Json::parse(std::ifstream(result_file));
    record.finished = result["finished"].get<bool>();
    record.seconds = result["seconds"].get<double>();
    record.steps = result["steps"].get<double>();
    record.step = result["step"].get<Real>();
    if (!record.finished) return record;
    record.positions = vectors_of(result["positions"]);
    record.velocities = vectors_of(result["velocities"]);
    return record;
}

}  // namespace skerry::profiling
