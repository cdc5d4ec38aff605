// profile_first_scene: the first scene of a newcomer, an explicit body on a slope. Does it hold below the
// critical angle, and slide above it by Coulomb's law? Prints the tables of docs/slope.md and more.
#include <CLI/CLI.hpp>
#include <cmath>
#include <cstdio>
#include <filesystem>
#include <limits>
#include <numbers>
#include <optional>
#include <string>
#include <vector>

#include "engine/world/tuning.h"
#include "profiling/measure.h"
#include "profiling/work_precision/runs.h"
#include "skerry/world.h"

using namespace skerry;

namespace {

constexpr Real gravity = 9.81;                                 // [m/s^2]
constexpr int samples_a_second = 100;                          // rate at which the motion is sampled [1/s]
constexpr Real offsets[] = {-2, -0.5, -0.1, 0.1, 0.5, 2, 10};  // offsets from the critical angle [degrees]

struct Subject {
    Mesh mesh;  // its lowest point is at z = 0 [m]
    Real friction = 0.3;
    bool rolls = false;         // true for a ball: its contact slips at none of these angles
    std::vector<Index> sole{};  // nodes that it stands on
};

Subject standing(Mesh mesh, Real friction = 0.3) {
    Subject subject{.mesh = std::move(mesh), .friction = friction};
    Real lowest = std::numeric_limits<Real>::infinity(), highest = -lowest;
    for (const Vec3& node : subject.mesh.nodes) {
        lowest = std::min(lowest, node.z());
        highest = std::max(highest, node.z());
    }
    for (Vec3& node : subject.mesh.nodes) node.z() -= lowest;
    for (std::size_t n = 0; n < subject.mesh.nodes.size(); ++n)
        if (subject.mesh.nodes[n].z() < 1e-3 * (highest - lowest)) subject.sole.push_back(static_cast<Index>(n));
    return subject;
}

Subject block(int cells = 1) {
    return standing(mesh::box({0.4, 0.4, 0.2}, {4 * cells, 4 * cells, 2 * cells}));
}

struct Case {
    Subject subject;
    MaterialSettings material{.young_modulus = 1e5, .poisson_ratio = 0.3};
    Real height = 0;  // initial height of the lowest point above the plane [m]
    Real step_safety = 1;
};

/// Motion of a body, sample by sample.
struct Motion {
    std::vector<Vec3> center;  // centre of mass [m]
    std::vector<Real> sole;    // mean of the sole nodes, down the slope [m]
    Real hop = 0;              // largest height of the centre of mass above its position at the contact distance [m]
    Real energy_share = 0;     // relative error of the energy balance
    double cpu = 0;            // [s]

    void add(const Subject& subject, std::span<const Vec3> position, const Vec3& at) {
        center.push_back(at);
        Real sum = 0;
        for (const Index node : subject.sole) sum += position[static_cast<std::size_t>(node)].x();
        sole.push_back(sum / static_cast<Real>(subject.sole.size()));
    }
    // Averages over 20 ms, so that vibrations of the body do not count as motion.
    Real speed_about(Real time) const {
        const auto middle = static_cast<std::size_t>(std::lround(time * samples_a_second)) - 1;
        return (center[middle + 1].x() - center[middle - 1].x()) * samples_a_second / 2;
    }
    Real acceleration() const { return (speed_about(0.9) - speed_about(0.3)) / 0.6; }
    Real slip() const {
        const std::size_t half = sole.size() / 2;
        return (sole.back() - sole[half - 1]) * samples_a_second / static_cast<Real>(sole.size() - half);
    }
};

Real angle_of(const Subject& subject, Real offset) {
    return std::atan(subject.friction) + offset * std::numbers::pi / 180;
}

Vec3 gravity_at(Real angle) {
    return gravity * Vec3(std::sin(angle), 0, -std::cos(angle));
}

/// Acceleration of a rigid body that starts to move [m/s^2].
Real expected_acceleration(const Subject& subject, Real angle) {
    return subject.rolls ? gravity * std::sin(angle) * 5 / 7
                         : gravity * (std::sin(angle) - subject.friction * std::cos(angle));
}

Motion run(const Case& test_case, Real offset, Real seconds) {
    Settings settings;
    settings.gravity = gravity_at(angle_of(test_case.subject, offset));
    settings.backend = Backend::serial;
    settings.threads = 1;
    World world = tuned_world(settings, {.step_safety = test_case.step_safety});
    MaterialSettings material = test_case.material;
    material.friction = test_case.subject.friction;
    world.add_collider(Plane{});
    const auto body = world.add_body(test_case.subject.mesh, {.material = world.add_material(material),
                                                              .position = {0, 0, test_case.height},
                                                              .dynamics = BodyDynamics::explicit_elastic});
    const Real shell = world.contact_distance(body) / 2;  // a plane contributes nothing to the distance
    const Real at_shell = world.center_of_mass(body).z() - test_case.height + shell;

    Motion motion;
    const double start = profiling::cpu_seconds();
    const int samples = static_cast<int>(std::lround(seconds * samples_a_second));
    for (int k = 1; k <= samples; ++k) {
        const Real time = static_cast<Real>(k) / samples_a_second;
        if (const StepReport report = world.advance(time - world.time()); !report.ok())
            throw std::runtime_error(report.message());
        const Vec3 center = world.center_of_mass(body);
        motion.hop = std::max(motion.hop, center.z() - at_shell);
        motion.add(test_case.subject, world.positions(body), center);
    }
    motion.cpu = profiling::cpu_seconds() - start;
    motion.energy_share = world.report().energy_error_share;
    return motion;
}

/// Runs a peer. Returns nothing if it does not reach the end.
std::optional<Motion> run(const Case& test_case, Real offset, Real seconds, const profiling::Peer& peer, Real step,
                          const std::filesystem::path& folder) {
    World world;
    const auto handle = world.add_body(test_case.subject.mesh, {.material = world.add_material(test_case.material)});
    profiling::PrecisionScene scene;
    scene.material = test_case.material;
    scene.material.friction = test_case.subject.friction;
    scene.contact_distance = world.contact_distance(handle) / 2;
    scene.gravity = {{.time = 0, .gravity = gravity_at(angle_of(test_case.subject, offset))}};
    scene.planes = {{}};
    scene.seconds = seconds;
    scene.samples = static_cast<int>(std::lround(seconds * samples_a_second));
    profiling::PrecisionBody body{.mesh = test_case.subject.mesh, .velocity = {}, .fixed = {}, .mass = {}};
    for (Vec3& node : body.mesh.nodes) node.z() += test_case.height;
    body.velocity.assign(body.mesh.nodes.size(), Vec3::Zero());
    scene.bodies.push_back(std::move(body));
    profiling::set_masses(scene);
    constexpr double cap = 20;  // CPU time limit of a run [s]
    const profiling::Record record = profiling::run_peer(scene, peer, step, 1, cap, folder);
    if (!record.finished) return std::nullopt;
    const std::vector<Real>& masses = scene.bodies[0].mass;
    Motion motion;
    for (const std::vector<Vec3>& position : record.positions) {
        Vec3 sum = Vec3::Zero();
        Real mass = 0;
        for (std::size_t n = 0; n < position.size(); ++n) {
            sum += masses[n] * position[n];
            mass += masses[n];
        }
        motion.add(test_case.subject, position, sum / mass);
    }
    motion.cpu = record.seconds;
    return motion;
}

std::string number(const char* format, Real value) {
    char text[32];
    std::snprintf(text, sizeof text, format, value);
    return text;
}

/// Prints a row: slip speeds below the critical angle and errors of the acceleration above it. Bodies that roll have
/// only errors of the acceleration.
template <class Run>
void print_row(const std::string& head, const Subject& subject, Real seconds, Run&& run_at) {
    std::string row = "| " + head + " |";
    Motion worst;
    int ended = 0;
    for (const Real offset : offsets) {
        const std::optional<Motion> motion = run_at(offset);
        if (!motion) {
            row += " - |";
            continue;
        }
        ++ended;
        const Real angle = angle_of(subject, offset);
        if (subject.rolls || offset > 0)
            row += number(" %.2f |", 100 * (motion->acceleration() - expected_acceleration(subject, angle)) / gravity);
        else
            row += std::abs(motion->slip()) < 1e-9 ? " 0 |" : number(" %.1e |", motion->slip());
        if (offset < 0) worst.hop = std::max(worst.hop, motion->hop);
        worst.energy_share = std::max(worst.energy_share, motion->energy_share);
        worst.cpu += motion->cpu;
    }
    row += number(" %.2f |", 1e3 * worst.hop) + number(" %.2f |", 100 * worst.energy_share) +
           number(" %.3f |", worst.cpu / (std::max(1, ended) * seconds));
    std::printf("%s\n", row.c_str());
    std::fflush(stdout);
}

void print_row(const std::string& head, const Case& test_case, Real seconds) {
    print_row(head, test_case.subject, seconds,
              [&](Real offset) { return std::optional(run(test_case, offset, seconds)); });
}

void print_head(const char* first) {
    std::printf("| %s | -2 | -0.5 | -0.1 | +0.1 | +0.5 | +2 | +10 | hop | energy | CPU |\n", first);
    std::printf("|---|---:|---:|---:|---:|---:|---:|---:|---:|---:|---:|\n");
}

std::string start_name(Real height) {
    return height == 0 ? "on the plane" : number("%.0f mm above", 1e3 * height);
}

void print_starts(const Subject& subject, const MaterialSettings& material, const std::vector<Real>& moduli,
                  Real seconds) {
    print_head("E, start");
    for (const Real modulus : moduli)
        for (const Real height : {0.0, 0.003}) {
            Case test_case{.subject = subject, .material = material, .height = height};
            test_case.material.young_modulus = modulus;
            print_row(number("%.0e, ", modulus) + start_name(height), test_case, seconds);
        }
}

void print_peers(Real seconds, const std::vector<profiling::Peer>& peers, const std::filesystem::path& folder) {
    print_head("E, engine, step");
    for (const Real modulus : {1e5, 1e6}) {
        Case test_case{.subject = block(), .height = 0.003};
        test_case.material.young_modulus = modulus;
        print_row(number("%.0e, ", modulus) + "Skerry, its own", test_case, seconds);
        for (const profiling::Peer& peer : peers)
            for (const Real step : {2e-3, 5e-4}) {
                if (peer.explicit_step) continue;
                const std::string head =
                    number("%.0e, ", modulus) + peer.engine + ", " + peer.variant + number(", %g s", step);
                print_row(head, test_case.subject, seconds,
                          [&](Real offset) { return run(test_case, offset, seconds, peer, step, folder); });
            }
    }
}

}  // namespace

int main(int argc, char** argv) {
    CLI::App app{"An explicit body on a slope: what it does below and above the critical angle."};
    Real seconds = 2;
    std::vector<Real> moduli{1e4, 1e5, 1e6, 1e8, 1e10, 1e11};
    std::string mesh_file, python = "python3";
    std::filesystem::path folder = "build/first_scene";
    app.add_option("--seconds", seconds, "Simulated seconds of a run")
        ->check(CLI::Range(1.0, 100.0))
        ->capture_default_str();
    app.add_option("--moduli", moduli, "Young's moduli, Pa")->check(CLI::PositiveNumber)->capture_default_str();
    app.add_option("--mesh", mesh_file, "This mesh alone, as it lies in its file")->check(CLI::ExistingFile);
    app.add_option("--python", python, "Python that may have MuJoCo")->capture_default_str();
    app.add_option("--out", folder, "Folder for what is handed to other engines")->capture_default_str();
    CLI11_PARSE(app, argc, argv);
    try {
        const MaterialSettings usual{.poisson_ratio = 0.3};
        if (!mesh_file.empty()) {
            print_starts(standing(mesh::read(mesh_file)), usual, moduli, seconds);
            return 0;
        }
        const auto section = [](const std::string& title) { std::printf("\n## %s\n\n", title.c_str()); };
        const auto with_losses = [&](Real loss_factor, Real viscosity) {
            MaterialSettings material = usual;
            material.loss_factor = loss_factor;
            material.bulk_viscosity = viscosity;
            return material;
        };
        section("A block");
        print_starts(block(), usual, moduli, seconds);
        section("A skittle on its foot, friction 0.1");
        print_starts(standing(mesh::skittle(0.38, 3), 0.1), usual, {1e5, 1e6, 1e8, 1e10}, seconds);
        section("A ball, which rolls: errors of the acceleration in all columns");
        Subject ball = standing(mesh::ball(0.1, 4));
        ball.rolls = true;
        print_starts(ball, usual, {1e5, 1e6, 1e8, 1e10}, seconds);
        section("The block without losses");
        print_starts(block(), with_losses(0, 0), moduli, seconds);
        section("The block with the losses of a soft solid: loss factor 0.2");
        print_starts(block(), with_losses(0.2, 0.06), moduli, seconds);
        section("The block beside other engines, from 3 mm above");
        std::filesystem::create_directories(folder);
        const auto peers = profiling::find_peers(std::filesystem::path(argv[0]).parent_path(), python);
        print_peers(seconds, peers, folder);
        section("Is it the mesh, or the step? The block at 1e5 Pa, from the plane");
        print_head("mesh, step");
        for (const int cells : {1, 2, 4})
            print_row(std::to_string(4 * cells) + " x " + std::to_string(4 * cells) + " x " +
                          std::to_string(2 * cells) + ", stable",
                      Case{.subject = block(cells)}, seconds);
        for (const Real safety : {0.5, 0.1})
            print_row("4 x 4 x 2, stable / " + number("%.0f", 1 / safety),
                      Case{.subject = block(), .step_safety = safety}, seconds);
    } catch (const std::exception& error) {
        std::fprintf(stderr, "%s\n", error.what());
        return 1;
    }
    return 0;
}
