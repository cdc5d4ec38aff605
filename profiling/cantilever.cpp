// profile_cantilever: the period of a stiff cantilever that is let go under gravity, the amplitude that remains with
// implicit steps, and their cost, for several theta and step sizes.
#include <CLI/CLI.hpp>
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <vector>

#include "profiling/measure.h"
#include "skerry/world.h"

using namespace skerry;
using namespace skerry::profiling;

namespace {

struct Case {
    ElementKind element;
    BodyDynamics dynamics;
    Real modulus, theta, step;  // [Pa], [-], [s]
};

struct Swing {
    Real period = 0, peak = 0;  // [s], [m]
    Real left = 0;              // peak-to-peak amplitude of the fifth period over the first peak
    double cpu = 0;             // CPU time per simulated second [s]
};

/// Mean of four periods, in steps, between downward passages of half the peak. Returns `about` if the remaining
/// amplitude is too small to measure.
Real period_of(const std::vector<Real>& sag, Real peak, Real about) {
    std::vector<Real> passed;
    bool high = false;
    for (std::size_t k = 1; k < sag.size(); ++k) {
        if (sag[k] < 0.35 * peak) high = false;
        if (high || sag[k] < 0.5 * peak) continue;
        high = true;
        passed.push_back(static_cast<Real>(k) - (sag[k] - 0.5 * peak) / (sag[k] - sag[k - 1]));
    }
    return passed.size() < 5 ? about : (passed[4] - passed[0]) / 4;
}

Swing measure(const Case& test_case) {
    const Mesh mesh = mesh::box({1, 0.1, 0.1}, {20, 2, 2});
    Settings settings;
    settings.backend = Backend::serial;
    settings.step_size = test_case.step;
    settings.theta = test_case.theta;
    World world(settings);
    const auto material = world.add_material(
        {.young_modulus = test_case.modulus, .poisson_ratio = 0.3, .loss_factor = 0, .bulk_viscosity = 0});
    const auto body =
        world.add_body(mesh, {.material = material, .dynamics = test_case.dynamics, .element = test_case.element});
    std::vector<Index> held;
    std::size_t tip = 0;
    for (std::size_t n = 0; n < mesh.nodes.size(); ++n) {
        if (mesh.nodes[n].x() < -0.5 + 1e-9) held.push_back(static_cast<Index>(n));
        if ((mesh.nodes[n] - Vec3(0.5, 0, 0)).norm() < 1e-9) tip = n;
    }
    world.attach(body, held);
    world.advance(test_case.step);  // computes its factor, once
    std::vector<Real> sag{0, -world.positions(body)[tip].z()};
    const Real beam = 0.619 * std::sqrt(1e7 / test_case.modulus);  // period by the theory of beams [s]
    const auto steps = static_cast<std::size_t>(5.2 * beam / test_case.step);
    const double start = cpu_seconds();
    while (sag.size() < steps) {
        world.advance(test_case.step);
        sag.push_back(-world.positions(body)[tip].z());
    }
    Swing swing;
    swing.cpu = (cpu_seconds() - start) / (test_case.step * static_cast<Real>(steps - 2));
    const auto first =
        std::max_element(sag.begin(), sag.begin() + static_cast<std::ptrdiff_t>(0.65 * beam / test_case.step));
    swing.peak = *first;
    swing.period = period_of(sag, swing.peak, static_cast<Real>(2 * (first - sag.begin()))) * test_case.step;
    const auto at = [&](Real periods) {
        return sag.begin() + static_cast<std::ptrdiff_t>(std::lround(periods * swing.period / test_case.step));
    };
    const auto [low, high] = std::minmax_element(at(4), at(5) + 1);
    swing.left = (*high - *low) / swing.peak;
    return swing;
}

}  // namespace

int main(int argc, char** argv) {
    CLI::App app{"A cantilever of 20 x 2 x 2 cells, implicit and explicit, let go under gravity; one thread."};
    CLI11_PARSE(app, argc, argv);
    std::printf(
        "| E (Pa) | elements | bodies | theta | step (ms) | T1 (s) | peak (mm) | left | CPU s a simulated s |\n"
        "|---|---|---|---|---|---|---|---|---|\n");
    const auto print = [](const Case& test_case) {
        const Swing swing = measure(test_case);
        const bool implicit = test_case.dynamics == BodyDynamics::implicit_elastic;
        std::printf("| %.0e | %s | %s | %g | %.3g | %.5f | %.4g | %.3f | %.2f |\n", test_case.modulus,
                    test_case.element == ElementKind::linear ? "linear" : "smoothed",
                    implicit ? "implicit" : "explicit", test_case.theta, 1e3 * test_case.step, swing.period,
                    1e3 * swing.peak, swing.left, swing.cpu);
        std::fflush(stdout);
    };
    for (const Real modulus : {1e7, 1e9}) {
        const Real h = 0.01 * std::sqrt(1e7 / modulus);
        for (const ElementKind element : {ElementKind::linear, ElementKind::smoothed}) {
            for (const Real theta : {0.5, 0.51, 0.55, 1.0})
                print({element, BodyDynamics::implicit_elastic, modulus, theta, h});
            print({element, BodyDynamics::implicit_elastic, modulus, 0.55, h / 5});
            print({element, BodyDynamics::explicit_elastic, modulus, 1, h});
        }
    }
}
