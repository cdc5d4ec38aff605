// profile_drop: CPU time of Skerry on several instruction sets, beside other engines, for balls that are dropped into a
// box (scenes/drop). Bullet and MuJoCo take part if they are installed. Any other engine takes part with --peer.
//
// Every engine gets the same meshes, masses, material and gravity, runs on one thread, and is timed by the CPU time of
// its steps alone. The engines run in turn, round after round. A pile is chaotic, so results are compared by the height
// of the centre of mass and the speed at the end, by overlaps, and by inverted tetrahedra.
#include <CLI/CLI.hpp>
#include <Eigen/Geometry>
#include <algorithm>
#include <cstdio>
#include <filesystem>
#include <fstream>
#include <nlohmann/json.hpp>
#include <stdexcept>
#include <string>
#include <tuple>
#include <vector>

#include "profiling/measure.h"
#include "profiling/stiff_peers/measures.h"
#include "profiling/work_precision/runs.h"

namespace {

using namespace skerry;
using namespace skerry::profiling;
using Json = nlohmann::json;

constexpr int samples_per_second = 20;
/// Damping of Bullet and MuJoCo: like Skerry's default loss factor at the lowest frequency of a ball [s].
constexpr Real peer_damping = 1e-4;

struct Options {
    std::vector<std::string> scenes{"scenes/drop/drop_8.json", "scenes/drop/drop_27.json"};
    std::vector<std::string> sets{"x86-64-v4", "x86-64-v3"};
    std::vector<std::tuple<std::string, std::string, double, std::string>> peers;  // engine, setting, step, command
    std::filesystem::path out = "out/profiling/drop";
    std::string python = "python3";  // Python that may have MuJoCo
    int rounds = 3;
    double cap = 120;  // CPU time limit of a run [s]
};

Vec3 vector_of(const Json& json) {
    return {json[0].get<Real>(), json[1].get<Real>(), json[2].get<Real>()};
}

/// Reads a scene of scenes/drop.
PrecisionScene read_drop(const std::filesystem::path& file) {
    std::ifstream stream(file);
    if (!stream) throw std::runtime_error("cannot open the scene " + file.string());
    const Json json = Json::parse(stream), &material = json["materials"]["drop"];
    PrecisionScene scene;
    scene.name = file.stem();
    scene.seconds = json["seconds"].get<Real>();
    scene.samples = static_cast<int>(samples_per_second * scene.seconds);
    scene.gravity = {{.time = 0, .gravity = vector_of(json["settings"]["gravity"])}};
    scene.material = {.young_modulus = material["young_modulus"].get<Real>(),
                      .poisson_ratio = material["poisson_ratio"].get<Real>(),
                      .density = material["density"].get<Real>(),
                      .friction = material["friction"].get<Real>()};
    scene.stiffness_damping = peer_damping;
    for (const Json& collider : json["colliders"]) {
        const Json& plane = collider["shape"]["plane"];
        scene.planes.push_back({.normal = vector_of(plane["normal"]), .point = vector_of(plane["point"])});
    }
    for (const Json& body : json["bodies"]) {
        PrecisionBody& ball = scene.bodies.emplace_back();
        ball.mesh = mesh::read((file.parent_path() / body["mesh"]["file"].get<std::string>()).string());
        Mat3 rotation;
        for (int row = 0; row < 3; ++row)
            rotation.row(row) = vector_of(body["rotation"][static_cast<std::size_t>(row)]);
        for (Vec3& node : ball.mesh.nodes) node = rotation * node + vector_of(body["position"]);
        ball.velocity.assign(ball.mesh.nodes.size(), Vec3::Zero());
    }
    set_masses(scene);
    return scene;
}

/// Options of a process that runs Skerry once, in the form of a peer. The instruction set of a process is fixed.
struct SkerryRun {
    std::string drop, scene, result;
    bool linear = false;
    double step = 0, cap = 0;
    int repeat = 1;
};

Json numbers_of(const std::vector<std::vector<Vec3>>& vectors) {
    Json samples = Json::array();
    for (const std::vector<Vec3>& sample : vectors) {
        Json& numbers = samples.emplace_back(Json::array());
        for (const Vec3& v : sample)
            for (const Real number : v) numbers.push_back(number);
    }
    return samples;
}

void run_skerry_process(const SkerryRun& run) {
    PrecisionScene scene = read_drop(run.drop);
    scene.element = run.linear ? ElementKind::linear : ElementKind::smoothed;
    const Record record =
        run_skerry(scene, {.name = {}, .dynamics = BodyDynamics::automatic}, run.step, run.repeat, run.cap);
    std::ofstream(run.result) << Json{{"finished", record.finished},
                                      {"seconds", record.seconds},
                                      {"steps", record.steps},
                                      {"step", record.step},
                                      {"positions", numbers_of(record.positions)},
                                      {"velocities", numbers_of(record.velocities)}};
}

/// An engine with one setting, and its results.
struct Contestant {
    Peer peer;
    Real step = 0;                // 0: chosen by the engine [s]
    std::string set = "its own";  // instruction set
    Record first{};
    std::vector<double> seconds{};  // CPU time of each round [s]
};

std::vector<Contestant> contestants_of(const std::string& scene, const std::filesystem::path& self,
                                       const Options& options) {
    std::vector<Contestant> contestants;
    const auto add = [&](const std::string& engine, const std::string& setting, Real step, const std::string& command) {
        contestants.push_back({.peer = {.engine = engine, .variant = setting, .command = command}, .step = step});
    };
    for (const bool linear : {false, true})
        for (const std::string& set : options.sets) {
            add("Skerry", linear ? "linear elements" : "default elements", 0,
                "env SKERRY_INSTRUCTION_SET=" + set + " '" + self.string() + "' skerry " + (linear ? "--linear " : "") +
                    "--drop '" + std::filesystem::absolute(scene).string() + "'");
            contestants.back().set = set;
        }
    for (const auto& [engine, setting, step, command] : options.peers) add(engine, setting, step, command);
    for (const Peer& peer : find_peers(self.parent_path(), options.python))
        for (const double rate : {60.0, 240.0})
            if (!peer.explicit_step) contestants.push_back({.peer = peer, .step = 1 / rate});
    return contestants;
}

/// Greatest number of inverted tetrahedra in a sample.
int inverted_of(const PrecisionScene& scene, const Record& record) {
    int most = 0;
    for (const std::vector<Vec3>& places : record.positions) {
        int count = 0;
        std::size_t first = 0;
        for (const PrecisionBody& body : scene.bodies) {
            for (const auto& t : body.mesh.tetrahedra) {
                const auto at = [&](std::size_t k) { return places[first + static_cast<std::size_t>(t[k])]; };
                count += (at(1) - at(0)).cross(at(2) - at(0)).dot(at(3) - at(0)) <= 0 ? 1 : 0;
            }
            first += body.mesh.nodes.size();
        }
        most = std::max(most, count);
    }
    return most;
}

/// Height of the centre of mass at the end. The y axis points up [m].
Real height_of(const PrecisionScene& scene, const Record& record) {
    Real sum = 0, mass = 0;
    std::size_t n = 0;
    for (const PrecisionBody& body : scene.bodies)
        for (const Real m : body.mass) {
            sum += m * record.positions.back()[n++].y();
            mass += m;
        }
    return sum / mass;
}

/// Prints a row and writes it to the table. `reference`: CPU times of the contestant that the ratio is relative to.
void write(const PrecisionScene& scene, const Contestant& contestant, const std::vector<double>& reference,
           std::ofstream& table) {
    const Peer& peer = contestant.peer;
    if (!contestant.first.finished) {
        std::printf("%-8s %-7s %-22s %-10s did not finish\n", scene.name.c_str(), peer.engine.c_str(),
                    peer.variant.c_str(), contestant.set.c_str());
        return;
    }
    std::vector<double> cpu, ratio;
    for (std::size_t r = 0; r < contestant.seconds.size(); ++r) {
        cpu.push_back(contestant.seconds[r] / scene.seconds);
        ratio.push_back(contestant.seconds[r] / reference[r]);
    }
    const auto [low, high] = std::ranges::minmax(cpu);
    const Measures m = measure(scene, contestant.first);
    const Real height = height_of(scene, contestant.first);
    const int inverted = inverted_of(scene, contestant.first);
    std::printf("%-8s %-7s %-22s %-10s %8.3f %8.3f %6.2f %8.1f %8.4f %8.2f %8d\n", scene.name.c_str(),
                peer.engine.c_str(), peer.variant.c_str(), contestant.set.c_str(), 1e3 * contestant.first.step,
                median(cpu), median(ratio), 1e3 * height, m.speed, 1e3 * m.overlap, inverted);
    table << scene.name << ',' << peer.engine << ",\"" << peer.variant << "\"," << contestant.set << ','
          << contestant.first.step << ',' << cpu.size() << ',' << median(cpu) << ',' << low << ',' << high << ','
          << median(ratio) << ',' << height << ',' << m.speed << ',' << m.overlap << ',' << m.overlap_at_end << ','
          << inverted << '\n'
          << std::flush;
}

void compare(const std::string& file, const std::filesystem::path& self, const Options& options, std::ofstream& table) {
    const PrecisionScene scene = read_drop(file);
    std::vector<Contestant> contestants = contestants_of(file, self, options);
    for (int r = 0; r < options.rounds; ++r)
        for (Contestant& contestant : contestants) {
            if (r > 0 && !contestant.first.finished) continue;
            std::fprintf(stderr, "\r\033[K%s, %d of %d: %s, %s", scene.name.c_str(), r + 1, options.rounds,
                         contestant.peer.engine.c_str(), contestant.peer.variant.c_str());
            Record record = run_peer(scene, contestant.peer, contestant.step, 1, options.cap, options.out / "runs");
            contestant.seconds.push_back(record.seconds);
            if (r == 0) contestant.first = std::move(record);
        }
    std::fprintf(stderr, "\r\033[K");
    if (!contestants.front().first.finished)
        throw std::runtime_error(scene.name + ": Skerry with the instruction set " + contestants.front().set +
                                 " did not finish; does this machine have the set (--sets)?");
    for (const Contestant& contestant : contestants) write(scene, contestant, contestants.front().seconds, table);
}

}  // namespace

int main(int argc, char** argv) {
    CLI::App app{"Balls that are dropped into a box: CPU time of Skerry, by instruction set, and of other engines."};
    Options options;
    SkerryRun run;
    app.add_option("--scenes", options.scenes, "Files of scenes/drop")->delimiter(',')->capture_default_str();
    app.add_option("--sets", options.sets, "Instruction sets of Skerry; ratios are relative to the first")
        ->delimiter(',')
        ->capture_default_str();
    app.add_option("--peer", options.peers,
                   "Another engine: name, setting, step (s), command; the command gets the arguments of "
                   "profiling/work_precision/peer.py");
    app.add_option("--python", options.python, "Python that may have MuJoCo")->capture_default_str();
    app.add_option("--rounds", options.rounds, "Runs of each engine")
        ->check(CLI::PositiveNumber)
        ->capture_default_str();
    app.add_option("--cap", options.cap, "CPU seconds of the longest run")->capture_default_str();
    app.add_option("--out", options.out, "Folder for the table")->capture_default_str();
    CLI::App& skerry = *app.add_subcommand("skerry", "Runs Skerry in the form of a peer");
    skerry.add_option("--drop", run.drop)->required();
    skerry.add_flag("--linear", run.linear);
    skerry.add_option("scene", run.scene);
    skerry.add_option("result", run.result);
    skerry.add_option("--step", run.step);
    skerry.add_option("--repeat", run.repeat);
    skerry.add_option("--cap", run.cap);
    CLI11_PARSE(app, argc, argv);
    try {
        if (skerry) {
            run_skerry_process(run);
            return 0;
        }
        std::filesystem::create_directories(options.out / "runs");
        std::ofstream table(options.out / "drop.csv");
        table << "scene,engine,setting,instruction_set,step,runs,cpu_seconds,cpu_lowest,cpu_highest,ratio,height,speed,"
                 "overlap,overlap_at_end,inverted\n";
        std::printf("%-8s %-7s %-22s %-10s %8s %8s %6s %8s %8s %8s %8s\n", "scene", "engine", "setting", "set",
                    "step ms", "CPU s/s", "ratio", "high mm", "speed", "overlap", "inverted");
        for (const std::string& scene : options.scenes)
            compare(scene, std::filesystem::canonical("/proc/self/exe"), options, table);
    } catch (const std::exception& error) {
        std::fprintf(stderr, "\n%s\n", error.what());
        return 1;
    }
    return 0;
}
