// A bar of two tied halves moves and is stressed like a whole bar (docs/methods/ties.md).
#include <Eigen/Geometry>
#include <algorithm>
#include <catch2/catch.hpp>
#include <cmath>
#include <numbers>

#include "tests/support/two_halves.h"

namespace skerry::test::tied_bars_test {

using namespace two_halves;

namespace {

/// Tetrahedra of a mesh on one side of x = 0.
Mesh part_of(const Mesh& whole, bool right) {
    Mesh part;
    std::vector<Index> now(whole.nodes.size(), -1);
    for (const auto& t : whole.tetrahedra) {
        Real x = 0;
        for (const Index n : t) x += whole.nodes[static_cast<std::size_t>(n)].x() / 4;
        if ((x > 0) != right) continue;
        auto& corners = part.tetrahedra.emplace_back();
        for (std::size_t k = 0; k < 4; ++k) {
            Index& row = now[static_cast<std::size_t>(t[k])];
            if (row < 0) {
                row = static_cast<Index>(part.nodes.size());
                part.nodes.push_back(whole.nodes[static_cast<std::size_t>(t[k])]);
            }
            corners[k] = row;
        }
    }
    return part;
}

}  // namespace

TEST_CASE("two halves with matching meshes move like the whole bar", "[scene][ties]") {
    Settings settings = without_gravity(1e-12);
    settings.step_size = 2e-5;
    settings.clusters = false;
    const Mesh mesh = mesh::box({2 * half, side, side}, {8, 2, 2});
    const std::array<Mesh, 2> part{part_of(mesh, false), part_of(mesh, true)};
    World whole(settings), tied(settings);
    const auto add = [&](World& world, const Mesh& bar_mesh) {
        return world.add_body(bar_mesh, {.material = world.add_material(rubber),
                                         .dynamics = BodyDynamics::explicit_elastic,
                                         .element = ElementKind::linear});
    };
    const BodyHandle bar = add(whole, mesh);
    const std::array<BodyHandle, 2> body{add(tied, part[0]), add(tied, part[1])};
    const TieHandle tie = Ties(tied).add({.body = body[1], .nodes = nodes_at(part[1], 0), .to_body = body[0]});
    // all modes at once: stretching, bending and twisting
    const auto velocity = [](const Vec3& x) {
        return Vec3(0.1 * std::sin(8 * x.x()), 0.2 * std::cos(9 * x.x()) + x.x() * x.z(), -x.x() * x.y());
    };
    const auto start = [&](World& world, BodyHandle moved, const Mesh& nodes) {
        std::vector<Vec3> v;
        for (const Vec3& x : nodes.nodes) v.push_back(velocity(x));
        world.set_velocities(moved, v);
    };
    start(whole, bar, mesh);
    start(tied, body[0], part[0]);
    start(tied, body[1], part[1]);
    REQUIRE(whole.advance(0.03).ok());
    REQUIRE(tied.advance(0.03).ok());
    Real worst = 0, moved = 0;
    for (std::size_t side_of = 0; side_of < 2; ++side_of)
        for (std::size_t n = 0; n < part[side_of].nodes.size(); ++n) {
            const Vec3& x = part[side_of].nodes[n];
            for (std::size_t m = 0; m < mesh.nodes.size(); ++m) {
                if (mesh.nodes[m] != x) continue;
                worst = std::max(worst, (tied.positions(body[side_of])[n] - whole.positions(bar)[m]).norm());
                moved = std::max(moved, (whole.positions(bar)[m] - x).norm());
            }
        }
    CHECK(moved > 1e-3);
    CHECK(worst < 1e-8 * moved);
    CHECK(Ties(tied).state(tie).error < 1e-12);
}

/// Angular frequency of the strongest oscillation of a signal near `expected`, sampled every h seconds [rad/s].
Real strongest_frequency(std::span<const Real> sample, Real h, Real expected) {
    const auto strength = [&](Real omega) {
        Real cosine = 0, sine = 0;
        for (std::size_t n = 0; n < sample.size(); ++n) {
            const Real phase = 2 * std::numbers::pi * (static_cast<Real>(n) + 0.5) / static_cast<Real>(sample.size());
            const Real weight = (1 - std::cos(phase)) * sample[n];  // Hann's window
            cosine += weight * std::cos(omega * h * static_cast<Real>(n));
            sine += weight * std::sin(omega * h * static_cast<Real>(n));
        }
        return cosine * cosine + sine * sine;
    };
    Real best = expected, width = 0.2 * expected;
    for (int round = 0; round < 4; ++round, width /= 8)
        for (const Real start = best; const int k : {-8, -7, -6, -5, -4, -3, -2, -1, 0, 1, 2, 3, 4, 5, 6, 7, 8})
            if (const Real omega = start + k * width / 8; strength(omega) > strength(best)) best = omega;
    return best;
}

TEST_CASE("two halves pass the patch test of constant stress away from the interface", "[scene][ties]") {
    constexpr Real traction = 1000;  // [Pa]
    TwoHalves bar(without_gravity(1e-9), {}, BodyDynamics::implicit_elastic, BodyDynamics::implicit_elastic,
                  {.young_modulus = 1e6, .poisson_ratio = 0.3});
    const auto pull = [&](BodyHandle body, const Mesh& mesh, Real end, Real direction) {
        std::vector<Vec3> load(mesh.nodes.size(), Vec3::Zero());
        const auto at = [&](Index n) -> const Vec3& { return mesh.nodes[static_cast<std::size_t>(n)]; };
        for (const auto& [a, b, c] : bar.world.surface(body)) {
            if (std::max({std::abs(at(a).x() - end), std::abs(at(b).x() - end), std::abs(at(c).x() - end)}) > 1e-9)
                continue;
            const Real area = (at(b) - at(a)).cross(at(c) - at(a)).norm() / 2;
            for (const Index n : {a, b, c}) load[static_cast<std::size_t>(n)].x() += direction * traction * area / 3;
        }
        bar.world.set_loads(body, load);
    };
    pull(bar.left, coarse, -half / 2, -1);
    pull(bar.right, fine, half / 2, 1);
    REQUIRE(bar.world.advance(3).ok());
    Real far = 0, near = 0;  // greatest errors of a stress component, as fractions of the traction
    for (const auto& [body, mesh] : {std::pair(bar.left, &coarse), std::pair(bar.right, &fine)}) {
        const std::vector<Mat3> stress = bar.world.stress(body);
        const auto positions = bar.world.positions(body);
        for (std::size_t t = 0; t < stress.size(); ++t) {
            Real x = 0;
            for (const Index n : mesh->tetrahedra[t]) x += positions[static_cast<std::size_t>(n)].x() / 4;
            Mat3 wanted = Mat3::Zero();
            wanted(0, 0) = traction;
            const Real error = (stress[t] - wanted).cwiseAbs().maxCoeff() / traction;
            (std::abs(x) > side ? far : near) = std::max(std::abs(x) > side ? far : near, error);
        }
    }
    CAPTURE(far, near);
    const TieState state = Ties(bar.world).state(bar.tie);
    CHECK(state.force.x() == Approx(-traction * side * side).epsilon(1e-3));
    CHECK(far < 0.01);
    CHECK(near < 0.3);
}

/// A whole bar of two halves with the mesh `part`.
Mesh whole_of(const Mesh& part) {
    Mesh whole;
    for (const Real x : {-half / 2, half / 2}) {
        std::vector<Index> row;  // of each node of the half in the whole bar
        for (const Vec3& node : part.nodes) {
            const Vec3 at = node + x * Vec3::UnitX();
            const auto same = std::ranges::find_if(whole.nodes, [&](const Vec3& n) { return (n - at).norm() < 1e-9; });
            row.push_back(static_cast<Index>(same - whole.nodes.begin()));
            if (same == whole.nodes.end()) whole.nodes.push_back(at);
        }
        for (const auto& t : part.tetrahedra) {
            auto& corners = whole.tetrahedra.emplace_back();
            for (std::size_t k = 0; k < 4; ++k) corners[k] = row[static_cast<std::size_t>(t[k])];
        }
    }
    return whole;
}

TEST_CASE("two halves with meshes that do not match have the first frequency of whole bars", "[scene][ties]") {
    Settings settings = without_gravity(1e-8);
    settings.step_size = 1e-4;
    const Real of_rod = std::numbers::pi / (2 * half) * std::sqrt(rubber.young_modulus / rubber.density);
    // Natural frequency of the longitudinal vibration of the shape cos(pi x / L) about the left end.
    const auto frequency = [&](World& world, const std::vector<std::pair<BodyHandle, const Mesh*>>& parts) {
        std::vector<std::vector<Real>> weight;
        for (const auto& [body, mesh] : parts) {
            std::vector<Vec3> v;
            weight.emplace_back();
            const std::vector<Real> mass = node_masses(world, body, *mesh, 1000);
            for (std::size_t n = 0; n < mass.size(); ++n) {
                const Real at = -std::sin(std::numbers::pi * world.positions(body)[n].x() / (2 * half));
                v.push_back({1e-3 * at, 0, 0});
                weight.back().push_back(mass[n] * at);
            }
            world.set_velocities(body, v);
        }
        std::vector<Real> sample;
        for (int i = 0; i < 1500; ++i) {
            REQUIRE(world.advance(settings.step_size.value()).ok());
            Real sum = 0;
            for (std::size_t b = 0; b < parts.size(); ++b)
                for (std::size_t n = 0; n < weight[b].size(); ++n)
                    sum += weight[b][n] * world.velocities(parts[b].first)[n].x();
            sample.push_back(sum);
        }
        return strongest_frequency(sample, *settings.step_size, of_rod);
    };
    Real squares = 0;  // of the frequencies of whole bars with the mesh of either half
    for (const Mesh& part : {coarse, fine}) {
        const Mesh mesh = whole_of(part);
        World world(settings);
        const BodyHandle body = world.add_body(mesh, {.material = world.add_material(rubber),
                                                      .dynamics = BodyDynamics::explicit_elastic,
                                                      .element = ElementKind::linear});
        squares += std::pow(frequency(world, {{body, &mesh}}), 2);
    }
    TwoHalves bar(settings, {}, BodyDynamics::explicit_elastic, BodyDynamics::explicit_elastic, rubber,
                  ElementKind::linear);
    // Each half contributes half of the stiffness and of the mass.
    CHECK(frequency(bar.world, {{bar.left, &coarse}, {bar.right, &fine}}) ==
          Approx(std::sqrt(squares / 2)).epsilon(0.004));
}

}  // namespace skerry::test::tied_bars_test
