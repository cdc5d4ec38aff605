#include "profiling/stiff_peers/runners.h"

#include <cmath>

#include "profiling/stiff_peers/scenes.h"

namespace skerry::profiling {
namespace {

std::string number(const char* format, Real value) {
    char text[32];
    std::snprintf(text, sizeof text, format, value);
    return text;
}

Runner skerry(BodyDynamics dynamics, Real step, Real tolerance) {
    Runner runner{.engine = "Skerry", .setting = std::string(name_of(dynamics)), .step = step};
    runner.setting += ", tolerance " + number("%.0e", tolerance);
    runner.ours.dynamics = dynamics;
    runner.ours.settings.tolerance = tolerance;
    return runner;
}

void add_skerry(const PrecisionScene& scene, std::vector<Runner>& runners) {
    using enum BodyDynamics;
    if (scene.name == "cantilever") {
        const Real h = scene.seconds / scene.samples;
        const auto add = [&](ElementKind element, Real theta, Real step) {
            Runner one = skerry(implicit_elastic, step, 1e-3);
            one.element = element;
            one.setting = std::string(element == ElementKind::linear ? "linear" : "smoothed") + " implicit, theta " +
                          number("%g", theta);
            one.ours.settings.theta = theta;
            runners.push_back(one);
        };
        for (const Real theta : {1.0, 0.55, 0.51})
            for (const Real step : {h, h / 5, h / 20}) add(ElementKind::linear, theta, step);
        add(ElementKind::smoothed, 0.51, h);
        return;
    }
    if (scene.name == "ball on block") {
        // The block is strongly compressed, and implicit bodies are meant for small strain.
        for (const Real step : {0.0, 5e-4}) runners.push_back(skerry(explicit_elastic, step, 1e-3));
        runners.push_back(skerry(explicit_elastic, 1e-4, 1e-8));
        runners.back().setting = "reference";
        return;
    }
    for (const Real step : {0.01, 0.002})
        for (const Real tolerance : {1e-3, 1e-6}) runners.push_back(skerry(implicit_elastic, step, tolerance));
    for (const Real tolerance : {1e-3, 1e-6})
        if (scene.material.young_modulus == 1e8) runners.push_back(skerry(rigid, 0.01, tolerance));
}

void add_peer(const std::string& engine, const std::string& setting, Real step, const std::string& command,
              std::vector<Runner>& runners) {
    runners.push_back({.engine = engine,
                       .setting = setting,
                       .step = step,
                       .peer = Peer{.engine = engine, .variant = setting, .command = command},
                       .keeps_distance = engine != "Drake"});
}

/// Adds MuJoCo with its implicit integrator ("discrete"), its default tolerance and, unless stated otherwise, its
/// default softness of contacts.
void add_mujoco(const PrecisionScene& scene, const std::string& python, std::vector<Runner>& runners) {
    const std::string command = script_command(python, "mujoco_peer.py") + " --integrator discrete --tolerance 1e-8";
    const auto add = [&](const std::string& setting, Real step, const std::string& options) {
        add_peer("MuJoCo", setting, step, command + options, runners);
    };
    const std::string own = " --contact own", elliptic = own + " --impratio 100";
    const Real h = scene.seconds / scene.samples;
    if (scene.name == "cantilever") {
        for (const Real step : {h, h / 5, h / 20}) add("discrete", step, "");
    } else if (scene.name == "ball on block") {
        const std::string neo_hookean = elliptic + " --law neo_hookean";
        for (const Real step : {0.01, 0.002, 0.0005}) add("neo-Hooke", step, neo_hookean);
        add("neo-Hooke, solref 0.004", 0.002, neo_hookean + " --solref 0.004");
        add("its own law", 0.002, elliptic);
    } else {
        for (const Real step : {0.01, 0.002}) add("elliptic, impratio 100", step, elliptic);
        if (scene.name == "holds" || scene.name == "slides") {
            add("elliptic, impratio 100", 0.0005, elliptic);
            add("elliptic, impratio 1e4", 0.002, own + " --impratio 1e4");
            add("all its own (pyramid)", 0.002, own + " --cone pyramidal");
        } else {
            add("elliptic, impratio 100, solref 0.004", 0.002, elliptic + " --solref 0.004");
        }
    }
}

/// Adds Drake with its convex solver and its default "lagged" friction. The usual dissipation is that of Drake's own
/// torus example [s/m].
void add_drake(const PrecisionScene& scene, const std::string& python, std::vector<Runner>& runners) {
    const std::string command = script_command(python, "drake_peer.py");
    const auto add = [&](const std::string& setting, Real step, const std::string& options) {
        add_peer("Drake", setting, step, command + options, runners);
    };
    const std::string torus = " --dissipation 10";
    const Real h = scene.seconds / scene.samples;
    if (scene.name == "cantilever") {
        for (const Real step : {h, h / 5, h / 20}) add("lagged", step, "");
        return;
    }
    for (const Real step : {0.01, 0.002}) add("dissipation 10", step, torus);
    if (scene.name == "holds" || scene.name == "slides") {
        add("its own dissipation", 0.01, "");
        add("dissipation 0", 0.002, " --dissipation 0");
        add("dissipation 10, stiction 1e-7", 0.01, torus + " --stiction 1e-7");
    }
}

}  // namespace

PrecisionScene Runner::prepared(const PrecisionScene& scene) const {
    PrecisionScene mine = keeps_distance ? scene : without_distance(scene);
    mine.element = element;
    return mine;
}

Record Runner::run(const PrecisionScene& scene, double cap, const std::filesystem::path& folder) const {
    return peer ? run_peer(scene, *peer, step, 1, cap, folder) : run_skerry(scene, ours, step, 1, cap);
}

std::vector<Runner> make_runners(const PrecisionScene& scene, const std::string& mujoco, const std::string& drake) {
    std::vector<Runner> runners;
    add_skerry(scene, runners);
    if (!mujoco.empty()) add_mujoco(scene, mujoco, runners);
    if (!drake.empty()) add_drake(scene, drake, runners);
    return runners;
}

}  // namespace skerry::profiling
