// profile_control: a control loop at 1 kHz with a gripper. Every millisecond two fingers get new target positions, the
// world advances by a millisecond, and the force on the fingers is read from the contacts of its steps. The program
// measures how long these calls take, and how many take no longer than the time that they simulate.
#include <CLI/CLI.hpp>
#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <optional>
#include <string>
#include <vector>

#include "profiling/measure.h"
#include "skerry/world.h"

using namespace skerry;
using namespace skerry::profiling;

namespace {

constexpr Real dt = 1e-3;           // [s]
constexpr Real radius = 0.05;       // of the ball [m]
constexpr Real half = 0.01;         // half the thickness of a finger [m]
constexpr Real open = 0.0655;       // distance of a finger's centre from that of the ball at the start [m]
constexpr Real wanted = 4;          // [N]
constexpr int first_counted = 200;  // the fingers have closed by then [ms]

struct Options {
    std::vector<int> tetrahedra{1000, 3000, 10000};
    bool pads = false;  // true: deformable fingers, moved by attachments; false: colliders
    Real young_modulus = 5e4;
    ElementKind element = ElementKind::smoothed;
    bool losses = true;
    int threads = 1;
    int calls = 2000;
};

/// Both fingers, either as deformable pads or as colliders.
class Gripper {
public:
    Gripper(World& world, MaterialHandle rubber, const Options& options) : world_(world), pads_(options.pads) {
        const Vec3 size(2 * half, 0.04, 0.04);
        for (std::size_t i = 0; i < 2; ++i) {
            const Vec3 position(i == 0 ? -open : open, 0, radius);
            if (!pads_) {
                collider_[i] = world.add_collider(Box{size}, {.position = position});
                continue;
            }
            const Mesh pad = mesh::box(size, {2, 4, 4});
            body_[i] = world.add_body(pad, {.material = rubber, .position = position, .element = options.element});
            std::vector<Index> back;
            for (std::size_t n = 0; n < pad.nodes.size(); ++n)
                if ((i == 0 ? -1 : 1) * pad.nodes[n].x() > half - 1e-9) back.push_back(static_cast<Index>(n));
            attachment_[i] = world.attach(body_[i], back, {}, position);
        }
    }
    void move_to(Real apart, Real height) {
        for (std::size_t i = 0; i < 2; ++i) {
            const Pose pose{.position = {i == 0 ? -apart : apart, 0, radius + height}};
            if (pads_)
                world_.move_to(attachment_[i], pose, dt);
            else
                world_.move_to(collider_[i], pose, dt);
        }
    }
    /// Impulse on the right finger along x, from the contacts of the last step [N s].
    Real impulse() const {
        Real sum = 0;
        for (const Contact& contact : world_.contacts()) {
            if (pads_ && contact.first == body_[1]) sum += contact.impulse.x();
            if (pads_ ? contact.second == body_[1] : contact.collider == collider_[1]) sum -= contact.impulse.x();
        }
        return sum;
    }

private:
    World& world_;
    bool pads_;
    std::array<ColliderHandle, 2> collider_;
    std::array<BodyHandle, 2> body_;
    std::array<AttachmentHandle, 2> attachment_;
};

struct Outcome {
    std::size_t tetrahedra = 0;
    std::vector<double> seconds;  // times of the calls that count [s]
    double steps = 0;             // per call
    double contacts = 0;          // per step
    Real force = 0, height = 0;   // at the end [N], [m]
};

double at_fraction(const std::vector<double>& sorted, double fraction) {
    return sorted[std::min(sorted.size() - 1, static_cast<std::size_t>(fraction * static_cast<double>(sorted.size())))];
}

Outcome run(int tetrahedra, const Options& options) {
    World world({.backend = options.threads == 1 ? Backend::serial : Backend::automatic, .threads = options.threads});
    MaterialSettings material{.young_modulus = options.young_modulus, .density = 500, .friction = 0.8, .damping = 20};
    if (!options.losses) material.loss_factor = material.bulk_viscosity = 0;
    const MaterialHandle rubber = world.add_material(material);
    constexpr Real of_resolution = 2.5;  // a ball of even resolution n has 2.5 n^3 tetrahedra
    int resolution = 2;
    while (of_resolution * std::pow(resolution + 1, 3) < tetrahedra) resolution += 2;
    const BodyHandle ball = world.add_body(
        mesh::ball(radius, resolution),
        {.material = rubber, .position = {0, 0, radius + 0.002}, .element = options.element, .name = "ball"});
    world.add_collider(Plane{});
    Gripper gripper(world, rubber, options);

    Outcome outcome;
    for (const BodyHandle body : world.bodies()) outcome.tetrahedra += world.tetrahedra(body).size();
    Real impulse = 0, mean = 0, apart = open, lift = 0;
    std::size_t steps = 0, contacts = 0;
    world.watch_steps([&](const StepReport& report) {
        impulse += gripper.impulse();
        ++steps;
        contacts += static_cast<std::size_t>(report.contacts);
    });
    for (int ms = 0; ms < options.calls; ++ms) {
        apart -= dt * std::clamp(0.02 * (wanted - mean), -0.05, 0.05);
        lift += ms > 700 && ms < 1700 ? 0.1 * dt : 0;
        impulse = 0;
        const double start = wall_seconds();
        gripper.move_to(apart, lift);
        const StepReport report = world.advance(dt);
        if (ms >= first_counted) outcome.seconds.push_back(wall_seconds() - start);
        if (!report.ok()) throw SceneError(report.message());
        mean += 0.05 * (impulse / dt - mean);
    }
    outcome.steps = static_cast<double>(steps) / options.calls;
    outcome.contacts = static_cast<double>(contacts) / static_cast<double>(steps);
    outcome.force = mean;
    outcome.height = world.center_of_mass(ball).z();
    std::ranges::sort(outcome.seconds);
    return outcome;
}

void print(const Outcome& outcome) {
    const auto met = std::ranges::upper_bound(outcome.seconds, dt) - outcome.seconds.begin();
    const auto ms = [&](double fraction) { return 1e3 * at_fraction(outcome.seconds, fraction); };
    std::printf("| %zu | %.1f | %.0f | %.3f | %.3f | %.3f | %.1f %% | %.2f | %.0f |\n", outcome.tetrahedra,
                outcome.steps, outcome.contacts, ms(0.5), ms(0.99), ms(0.999),
                100 * static_cast<double>(met) / static_cast<double>(outcome.seconds.size()), outcome.force,
                1e3 * outcome.height);
    std::fflush(stdout);
}

}  // namespace

int main(int argc, char** argv) {
    Options options;
    CLI::App app("A gripper that lifts a ball, controlled a thousand times a second: the time of each call.");
    std::string element(name_of(options.element));
    bool no_losses = false;
    app.add_option("--tetrahedra", options.tetrahedra, "about how many the ball has")->capture_default_str();
    app.add_flag("--pads", options.pads, "fingers are deformable pads that attachments lead, not colliders");
    app.add_option("--young-modulus", options.young_modulus, "Pa")->capture_default_str();
    app.add_option("--element", element, "kind of element")->capture_default_str();
    app.add_flag("--no-losses", no_losses, "loss_factor and bulk_viscosity 0");
    app.add_option("--threads", options.threads)->capture_default_str()->check(CLI::PositiveNumber);
    app.add_option("--calls", options.calls, "of a millisecond each")
        ->capture_default_str()
        ->check(CLI::Range(first_counted + 1, 1000000));
    CLI11_PARSE(app, argc, argv);
    try {
        const std::optional<ElementKind> kind = from_name<ElementKind>(element);
        if (!kind) Complaint{{}, "--element", {}, element, "the name of a kind of element", {}}.raise();
        options.element = *kind;
        options.losses = !no_losses;
        std::printf(
            "| tetrahedra | steps a call | contacts | median, ms | 99 %%, ms | 99.9 %%, ms | within 1 ms | force, "
            "N | height, mm |\n|---|---|---|---|---|---|---|---|---|\n");
        for (const int tetrahedra : options.tetrahedra) print(run(tetrahedra, options));
    } catch (const SceneError& error) {
        std::fprintf(stderr, "profile_control: %s\n", error.what());
        return 1;
    }
    return 0;
}
