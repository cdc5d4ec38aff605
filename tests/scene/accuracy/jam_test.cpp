// Systems held together by friction and weight: stacks, wedges, belts, and Painleve's rod (docs/accuracy.md, items 22,
// 23 and 27).
#include <algorithm>
#include <catch2/catch.hpp>
#include <cstdio>

#include "tests/support/accuracy.h"
#include "tests/support/worlds.h"

namespace skerry::test::jam_test {

using accuracy::Tolerance;

namespace {

constexpr Real g = standard_gravity;

/// A wedge of half angle a, point down, between two walls. Its weight is turned on slowly.
struct Wedge {
    static constexpr Real mu = 0.3, height = 0.2, width = 0.2;  // [-, m, m]; the width is that at half the height
    World world;
    BodyHandle body;
    Real angle;  // rad

    explicit Wedge(Real tangent) : world(accurate(Vec3::Zero())), angle(std::atan(tangent)) {
        const auto material =
            world.add_material({.young_modulus = 2e5, .poisson_ratio = 0.3, .friction = mu, .damping = 300});
        constexpr Real shell = 0.002;
        for (int side : {-1, 1}) {
            const Vec3 normal(-side * std::cos(angle), 0, std::sin(angle));
            world.add_collider(Plane{.normal = normal, .point = Vec3(side * width / 2, 0, 0) - shell / 2 * normal});
        }
        Mesh mesh = mesh::box({width, 0.1, height}, {4, 2, 4});
        for (Vec3& x : mesh.nodes) x.x() *= 1 + 2 * x.z() * tangent / width;
        body = world.add_body(mesh, {.material = material, .contact_distance = shell});
    }
    void pull_down(Real from, Real to, Real seconds) {
        constexpr int turns = 1000;
        for (int i = 1; i <= turns; ++i) {
            world.set_gravity({0, 0, -from - (to - from) * i / turns});
            REQUIRE(world.advance(seconds / turns).ok());
        }
    }
    /// Normal force of the wall at x > 0 [N]
    Real pressing() {
        world.advance(1e-4);
        Real sum = 0;
        for (const Contact& contact : world.contacts())
            if (contact.point.x() > 0) sum += contact.force().dot(contact.normal);
        return sum;
    }
};

}  // namespace

TEST_CASE("a stack of bricks carries its weight brick by brick", "[scene][accuracy]") {
    Settings settings = accurate({0, 0, -g});
    // 86 contacts, most of them redundant: while the stack sways, sweeps stall at 1e-7 of the region's energy.
    settings.tolerance = 1e-6;
    World world(settings);
    const auto material =
        world.add_material({.young_modulus = 5e5, .poisson_ratio = 0.3, .friction = 0.5, .damping = 500});
    world.add_collider(Plane{});
    constexpr Real thick = 0.05, shell = 0.001;
    std::vector<BodyHandle> brick;
    for (int i = 0; i < 6; ++i)
        brick.push_back(world.add_body(mesh::box({0.2, 0.1, thick}, {2, 1, 1}),
                                       {.material = material,
                                        .position = {0, 0, thick / 2 + shell / 2 + i * (thick + shell)},
                                        .contact_distance = shell}));
    REQUIRE(world.advance(6).ok());
    world.advance(1e-4);
    const Real weight = world.mass(brick[0]) * g;
    Real worst = 0, sideways = 0;
    for (std::size_t i = 0; i < brick.size(); ++i) {
        // Force between this brick and the one below it, or the floor
        Vec3 force = Vec3::Zero();
        for (const Contact& c : world.contacts()) {
            const bool floor = !world.alive(c.second);
            if (i == 0 ? floor
                       : (!floor && ((c.first == brick[i] && c.second == brick[i - 1]) ||
                                     (c.second == brick[i] && c.first == brick[i - 1]))))
                force += (floor || c.first == brick[i] ? 1 : -1) * c.force();
        }
        const Real carried = static_cast<Real>(brick.size() - i) * weight;
        worst = std::max(worst, std::abs(force.z() / carried - 1));
        sideways = std::max(sideways, force.head<2>().norm() / weight);
    }
    accuracy::check({.item = 22,
                     .name = "stack of 6 bricks, force of an interface over the weight above it - 1, worst",
                     .formula = "0",
                     .found = worst,
                     .tolerance = 1e-3,
                     .kind = Tolerance::absolute});
    accuracy::check({.item = 22,
                     .name = "the same, friction of an interface over the weight of a brick, worst",
                     .formula = "0",
                     .found = sideways,
                     .tolerance = 1e-3,
                     .kind = Tolerance::absolute});
}

TEST_CASE("a wedge is held by its walls, and stays if tan(a) <= mu", "[scene][accuracy]") {
    for (Real tangent : {0.27, 0.33}) {
        Wedge wedge(tangent);
        constexpr Real pull = 5 * g;
        wedge.pull_down(0, pull, 1);
        const Real weight = wedge.world.mass(wedge.body) * pull;
        char name[100];
        std::snprintf(name, sizeof name, "wedge, tan(a) = %.2f, force of a wall while driven in (N)", tangent);
        accuracy::check({.item = 23,
                         .name = name,
                         .formula = "W / (2 (sin a + mu cos a))",
                         .expected = weight / (2 * (std::sin(wedge.angle) + Wedge::mu * std::cos(wedge.angle))),
                         .found = wedge.pressing(),
                         .tolerance = 0.01});
        wedge.pull_down(pull, 0, 1);
        REQUIRE(wedge.world.advance(0.5).ok());  // until parts that were still sliding up stick
        const Real before = wedge.world.center_of_mass(wedge.body).z();
        REQUIRE(wedge.world.advance(1).ok());
        const Real rise = wedge.world.center_of_mass(wedge.body).z() - before;
        std::snprintf(name, sizeof name, "the same, without weight: it stays, 1 = yes (mu = 0.3)");
        accuracy::check({.item = 23,
                         .name = name,
                         .formula = "tan a <= mu",
                         .expected = tangent <= Wedge::mu ? 1.0 : 0.0,
                         .found = std::abs(rise) < 1e-6 && wedge.pressing() > 0.01 * weight ? 1.0 : 0.0,
                         .tolerance = 0,
                         .kind = Tolerance::absolute});
    }
}

TEST_CASE("a belt on a turning drum multiplies its tension by exp(mu phi)", "[scene][accuracy][slow]") {
    constexpr Real radius = 0.5, thick = 0.005, wide = 0.04, shell = 0.001, mu = 0.3, pull = 0.5;  // m, -, N
    constexpr int segments = 40;
    World world(accurate(Vec3::Zero()));
    ColliderSettings turning;
    turning.motion.angular_velocity = {0, 0, -1};  // from the held end, at x < 0, over the top to the loaded end
    world.add_collider(Cylinder{radius, 1}, turning);
    const auto material = world.add_material({.young_modulus = 1e6, .poisson_ratio = 0, .friction = mu, .damping = 20});
    // Both ends leave the drum along its tangent. If a belt were held where it touches, the contacts next to the held
    // nodes would lever it.
    constexpr int straight = 4;
    constexpr Real half = std::numbers::pi / 2, end = half * (1 + 2.0 * straight / segments);
    Mesh mesh = mesh::box({2 * end, thick, wide}, {segments + 2 * straight, 1, 1});
    std::vector<Index> held, loaded;
    for (std::size_t n = 0; n < mesh.nodes.size(); ++n) {
        Vec3& x = mesh.nodes[n];
        if (x.x() < -end + 1e-9) held.push_back(static_cast<Index>(n));
        if (x.x() > end - 1e-9) loaded.push_back(static_cast<Index>(n));
        const Real along = std::clamp(x.x(), -half, half), angle = half - along;
        const Real r = radius + shell / 2 + thick / 2 + x.y();
        x = Vec3(r * std::cos(angle), r * std::sin(angle) - radius * std::abs(x.x() - along), x.z());
    }
    const auto belt = world.add_body(mesh, {.material = material, .contact_distance = shell});
    world.attach(belt, held);
    std::vector<Vec3> load(mesh.nodes.size(), Vec3::Zero());
    for (Index n : loaded) load[static_cast<std::size_t>(n)] = Vec3(0, -pull / static_cast<Real>(loaded.size()), 0);
    world.set_loads(belt, load);
    REQUIRE(world.advance(6).ok());
    // Both ends pull along -y. The tension of the held end is the force on the drum minus the load.
    Real carried = 0;
    int touching = 0;
    constexpr int steps = 200;
    for (int k = 0; k < steps; ++k) {
        world.advance(world.stable_step());
        touching = 0;
        for (const Contact& c : world.contacts()) {
            carried += c.force().y() / steps;
            touching += c.impulse.squaredNorm() > 0;
        }
    }
    REQUIRE(touching > segments);
    accuracy::check({.item = 27,
                     .name = "belt over half a drum, 41 rows of contacts, ratio of tensions",
                     .formula = "exp(mu phi)",
                     .expected = std::exp(mu * std::numbers::pi),
                     .found = (carried - pull) / pull,
                     .tolerance = 0.02});
}

TEST_CASE("Painleve's rod gets an impulse", "[scene][accuracy]") {
    // A rigid rod at tan(a) = 2, whose tip slides towards -x while its middle is at +x of the tip, has no forces that
    // satisfy Coulomb's law for mu > 4/3.
    constexpr Real length = 1, width = 0.05, mu = 1.6, speed = 2;
    Real refused = 0, gain = 0;
    for (Real direction : {-1.0, 1.0}) {
        World world(accurate({0, 0, -g}));
        const auto material = world.add_material({.young_modulus = 1e7, .poisson_ratio = 0.3, .friction = mu});
        world.add_collider(Plane{});
        const Real angle = std::atan(2.0);
        const auto rod =
            world.add_body(mesh::box({length, width, width}, {10, 1, 1}),
                           {.material = material,
                            .position = {0, 0, 0.5 * length * std::sin(angle) + 0.5 * width * std::cos(angle) + 0.0021},
                            .rotation = {0, -angle, 0},
                            .velocity = {direction * speed, 0, 0},
                            .contact_distance = 0.004});
        const Energy start = world.energy();
        const Real before = start.kinetic + start.potential;
        for (int frame = 0; frame < 100; ++frame) {
            const StepReport report = world.advance(0.01);
            refused += !report.ok() || report.unconverged > 0;
            const Energy now = world.energy();
            gain = std::max(gain, (now.kinetic + now.potential + now.elastic) / before - 1);
        }
        REQUIRE(world.report().max_contacts > 0);
        for (const Vec3& v : world.velocities(rod)) REQUIRE(v.allFinite());
    }
    accuracy::check({.item = 33,
                     .name = "Painleve's rod, mu = 1.6, either direction: calls that were refused or not converged",
                     .formula = "0",
                     .found = refused,
                     .tolerance = 0,
                     .kind = Tolerance::absolute,
                     .note = "Painleve's rod. The paradox needs a rigid body: here friction reaches the rod through "
                             "the nodes that touch, "
                             "whose own mass resists "
                             "alike in all directions, so that a contact alone always has exactly one solution."});
    accuracy::check({.item = 33,
                     .name = "the same, largest gain of energy over the energy at the start",
                     .formula = "<= 0",
                     .found = gain,
                     .tolerance = 1e-3,
                     .kind = Tolerance::absolute});
}

}  // namespace skerry::test::jam_test
