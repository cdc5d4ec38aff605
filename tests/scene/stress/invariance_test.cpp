// Stress suite, problems that users report of other engines: results that depend on the order of nodes and elements or
// on the units.
#include <catch2/catch.hpp>
#include <numeric>
#include <random>

#include "tests/support/stress.h"
#include "tests/support/worlds.h"

namespace skerry::test::invariance_test {

using namespace skerry::test::stress;

namespace {

struct Shuffled {
    Mesh mesh;
    std::vector<std::size_t> place;  // new index of each node of the original
};

/// Reorders a mesh: nodes, elements, and the corners of each element by an even permutation.
Shuffled shuffled(const Mesh& mesh, unsigned seed) {
    std::mt19937 random(seed);
    Shuffled out;
    out.place.resize(mesh.nodes.size());
    std::iota(out.place.begin(), out.place.end(), 0);
    std::shuffle(out.place.begin(), out.place.end(), random);
    out.mesh.nodes.resize(mesh.nodes.size());
    for (std::size_t n = 0; n < mesh.nodes.size(); ++n) out.mesh.nodes[out.place[n]] = mesh.nodes[n];
    for (auto t : mesh.tetrahedra) {
        for (Index& n : t) n = static_cast<Index>(out.place[static_cast<std::size_t>(n)]);
        const int turns = static_cast<int>(random() % 3);
        std::rotate(t.begin() + 1, t.begin() + 1 + turns, t.end());  // cyclic permutation of three, which is even
        out.mesh.tetrahedra.push_back(t);
    }
    std::shuffle(out.mesh.tetrahedra.begin(), out.mesh.tetrahedra.end(), random);
    return out;
}

/// Units of length, mass and time in metres, kilograms and seconds.
struct Units {
    const char* name;
    Real length, mass, time;
};

/// Drops two boxes on a slope. Returns the positions of the upper one's nodes [m].
std::vector<Vec3> drop_in(const Units& u, Real seconds) {
    const Real modulus = u.mass / (u.length * u.time * u.time), acceleration = u.length / (u.time * u.time);
    Settings settings;
    settings.gravity = tilted_gravity(20) / acceleration;
    settings.recovery_speed /= u.length / u.time;
    settings.tolerance = 1e-10;
    settings.max_iterations = 10000;
    World world(settings);
    world.add_collider(Plane{});
    const auto material = world.add_material({.young_modulus = 5e4 / modulus,
                                              .poisson_ratio = 0.3,
                                              .density = 1000 / (u.mass / (u.length * u.length * u.length)),
                                              .friction = 0.3,
                                              .damping = 20 * u.time});
    Mesh mesh = mesh::box({0.1, 0.1, 0.1}, {3, 3, 3});
    for (Vec3& x : mesh.nodes) x /= u.length;
    world.add_body(mesh, {.material = material, .position = Vec3(0, 0, 0.06) / u.length});
    const auto upper = world.add_body(mesh, {.material = material,
                                             .position = Vec3(0.013, 0.007, 0.175) / u.length,
                                             .velocity = Vec3(0.2, 0, 0) / (u.length / u.time)});
    const StepReport report = world.advance(seconds / u.time);
    INFO(u.name << ": " << report.message());
    REQUIRE(report.ok());
    REQUIRE(world.report().max_contacts > 10);
    std::vector<Vec3> positions(world.positions(upper).begin(), world.positions(upper).end());
    for (Vec3& x : positions) x *= u.length;
    return positions;
}

}  // namespace

TEST_CASE("the order of nodes and elements does not matter", "[scene][stress]") {
    // With friction and exactly parallel faces Coulomb's law has several solutions, and the order selects one. In that
    // case the upper box is turned a little.
    struct Case {
        const char* name;
        Real degrees, friction;
        Vec3 turn;
    };
    for (const Case& c : {Case{"parallel boxes without friction on a slope of 5 degrees", 5, 0, {0, 0, 0}},
                          Case{"boxes with friction on a slope of 5 degrees", 5, 0.3, {0.05, -0.03, 0.4}},
                          Case{"boxes with friction on a slope of 30 degrees", 30, 0.3, {0.05, -0.03, 0.4}}}) {
        std::vector<std::vector<Vec3>> upper;
        Real edge = 0;
        const Mesh mesh = mesh::box({0.1, 0.1, 0.1}, {3, 3, 3});
        for (unsigned seed = 0; seed < 4; ++seed) {
            Settings settings;
            settings.gravity = tilted_gravity(c.degrees);
            settings.tolerance = 1e-10;
            settings.max_iterations = 100000;
            World world(settings);
            world.add_collider(Plane{});
            const auto material =
                world.add_material({.young_modulus = 5e4, .poisson_ratio = 0.3, .friction = c.friction, .damping = 20});
            const Shuffled one = shuffled(mesh, 2 * seed), two = shuffled(mesh, 2 * seed + 1);
            world.add_body(seed == 0 ? mesh : one.mesh, {.material = material, .position = {0, 0, 0.06}});
            const auto body =
                world.add_body(seed == 0 ? mesh : two.mesh,
                               {.material = material, .position = {0.013, 0.007, 0.175}, .rotation = c.turn});
            const StepReport report = world.advance(0.3);
            INFO(report.message());
            REQUIRE(report.ok());
            edge = world.mean_edge(body);
            const auto x = world.positions(body);
            upper.emplace_back(x.size());
            for (std::size_t n = 0; n < x.size(); ++n) upper.back()[n] = x[seed == 0 ? n : two.place[n]];
        }
        Real apart = 0;
        for (const auto& other : upper)
            for (std::size_t n = 0; n < other.size(); ++n) apart = std::max(apart, (other[n] - upper[0][n]).norm());
        // Rounding in solves to 1e-10, grown over some hundred steps of impacts.
        at_most(0, "node and element order: two " + std::string(c.name) + ", 0.3 s, three shuffles",
                "positions apart / edge", apart / edge, 1e-5);
    }
}

TEST_CASE("units do not matter", "[scene][stress]") {
    const Real seconds = 0.3;
    const std::vector<Vec3> si = drop_in({"m, kg, s", 1, 1, 1}, seconds);
    for (const Units& units :
         {Units{"mm, g, ms", 1e-3, 1e-3, 1e-3}, Units{"cm, g, s", 1e-2, 1e-3, 1}, Units{"mm, t, s", 1e-3, 1e3, 1}}) {
        const std::vector<Vec3> other = drop_in(units, seconds);
        Real apart = 0;
        for (std::size_t n = 0; n < si.size(); ++n) apart = std::max(apart, (other[n] - si[n]).norm());
        at_most(0, "units: two boxes dropped on a slope of 20 degrees in " + std::string(units.name) + ", 0.3 s",
                "positions apart / edge", apart / 0.04, 1e-6);
    }
}

}  // namespace skerry::test::invariance_test
