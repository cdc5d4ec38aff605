// Ties in whole steps, against closed forms (docs/methods/ties.md).
#include "skerry/tie.h"

#include <Eigen/Geometry>
#include <catch2/catch.hpp>
#include <cmath>
#include <numbers>

#include "skerry/joint.h"
#include "tests/support/same_bits.h"
#include "tests/support/worlds.h"

namespace skerry::test::ties_test {

namespace {

constexpr Real side = 0.1, half = 0.2;  // width and half of the length of a bar along x [m]

/// Numbers of the nodes of a mesh whose coordinate x is `x`.
std::vector<Index> nodes_at(const Mesh& mesh, Real x) {
    std::vector<Index> found;
    for (std::size_t n = 0; n < mesh.nodes.size(); ++n)
        if (std::abs(mesh.nodes[n].x() - x) < 1e-9) found.push_back(static_cast<Index>(n));
    return found;
}

Settings without_gravity(Real tolerance = 1e-10) {
    return accurate(Vec3::Zero(), tolerance);
}

const Mesh coarse = mesh::box({half, side, side}, {4, 2, 2}), fine = mesh::box({half, side, side}, {6, 3, 3});
constexpr MaterialSettings rubber{.young_modulus = 1e6, .poisson_ratio = 0.3, .loss_factor = 0, .bulk_viscosity = 0};

/// Two halves of a bar, whose meshes do not match. The fine one is tied to the coarse one.
struct TwoHalves {
    World world;
    BodyHandle left, right;
    TieHandle tie;
    std::vector<Index> tied = nodes_at(fine, -half / 2);

    explicit TwoHalves(const Settings& settings = without_gravity(), const TieSettings& with = {},
                       BodyDynamics of_left = BodyDynamics::explicit_elastic,
                       BodyDynamics of_right = BodyDynamics::explicit_elastic, const MaterialSettings& material = rubber)
        : world(settings) {
        const MaterialHandle of = world.add_material(material);
        const auto add = [&](const Mesh& mesh, Real x, BodyDynamics dynamics) {
            return world.add_body(mesh, {.material = of, .position = {x, 0, 0}, .dynamics = dynamics});
        };
        left = add(coarse, -half / 2, of_left);
        right = add(fine, half / 2, of_right);
        TieSettings tie_settings = with;
        tie_settings.body = right;
        tie_settings.nodes = tied;
        tie_settings.to_body = left;
        tie = Ties(world).add(tie_settings);
    }
};

struct Momenta {
    Vec3 linear = Vec3::Zero(), angular = Vec3::Zero();  // angular: about the origin
};

Momenta momenta(const World& world, BodyHandle body, const Mesh& mesh, Real density = 1000) {
    const std::vector<Real> mass = node_masses(world, body, mesh, density);
    Momenta sum;
    for (std::size_t n = 0; n < mass.size(); ++n) {
        const Vec3 momentum = mass[n] * world.velocities(body)[n];
        sum.linear += momentum;
        sum.angular += world.positions(body)[n].cross(momentum);
    }
    return sum;
}

Momenta operator+(const Momenta& a, const Momenta& b) {
    return {a.linear + b.linear, a.angular + b.angular};
}

}  // namespace

TEST_CASE("two tied halves conserve momentum and angular momentum", "[scene][ties]") {
    TwoHalves bar;
    bar.world.set_velocity(bar.left, {0.3, 0.2, -0.1}, {1, 2, 3});
    bar.world.set_velocity(bar.right, {-0.3, 0.1, 0.2}, {-2, 1, 4});
    const auto sum = [&] { return momenta(bar.world, bar.left, coarse) + momenta(bar.world, bar.right, fine); };
    const Momenta before = sum();
    REQUIRE(bar.world.advance(0.05).ok());
    const Momenta after = sum();
    CHECK((after.linear - before.linear).norm() < 1e-12);
    CHECK((after.angular - before.angular).norm() < 1e-12);
    const TieState state = Ties(bar.world).state(bar.tie);
    CHECK(state.error < 1e-9);
    CHECK(state.force.norm() > 0);
    CHECK(bar.world.report().energy_error_share < 1e-3);
    CHECK(bar.world.report().momentum_error_share < 1e-12);
}

TEST_CASE("a tie stays exact for ten thousand steps", "[scene][ties]") {
    for (const BodyDynamics dynamics : {BodyDynamics::explicit_elastic, BodyDynamics::implicit_elastic, BodyDynamics::rigid}) {
        Settings settings = without_gravity(1e-6);
        TwoHalves bar(settings, {}, dynamics);
        bar.world.set_velocity(bar.left, Vec3::Zero(), {0, 0, 3});
        const Real h = bar.world.stable_step();
        Real worst = 0;
        for (int k = 0; k < 100; ++k) {
            REQUIRE(bar.world.advance(20 * h).ok());
            worst = std::max(worst, Ties(bar.world).state(bar.tie).error);
        }
        CAPTURE(static_cast<int>(dynamics));
        CHECK(worst < 1e-9 * half);
        CHECK(bar.world.report().energy_error_share < 0.01);
    }
}

TEST_CASE("a node breaks off at its greatest force", "[scene][ties]") {
    constexpr Real limit = 2, rate = 10;  // [N], [N/s]
    Settings settings = without_gravity();
    World world(settings);
    const MaterialHandle of = world.add_material(rubber);
    const Mesh cube = mesh::box({side, side, side}, {1, 1, 1});
    const BodyHandle body = world.add_body(cube, {.material = of, .dynamics = BodyDynamics::implicit_elastic});
    Ties ties(world);
    const TieHandle tie = ties.add({.body = body, .nodes = {0}, .break_force = limit});
    Real most = 0;
    const Real h = 1e-4;
    while (!ties.state(tie).nodes[0].broken && world.time() < 1) {
        std::vector<Vec3> load(cube.nodes.size(), Vec3::Zero());
        load[0] = {rate * world.time(), 0, 0};
        world.set_loads(body, load);
        REQUIRE(world.advance(h).ok());
        most = std::max(most, ties.state(tie).force.norm());
    }
    const TieState broken = ties.state(tie);
    REQUIRE(broken.nodes[0].broken);
    CHECK(*broken.nodes[0].broken == Approx(limit / rate).epsilon(1e-3));
    CHECK(*broken.nodes[0].broken == world.time());
    CHECK(most == Approx(limit).epsilon(1e-3));
    REQUIRE(world.advance(h).ok());
    CHECK(ties.state(tie).force == Vec3::Zero());
    CHECK(world.center_of_mass(body).x() > 0);
}

TEST_CASE("a tie follows a moving collider and keeps its bodies awake", "[scene][ties]") {
    Settings settings = accurate();
    settings.sleep = true;
    settings.sleep_time = 0.05;
    for (const BodyDynamics dynamics : {BodyDynamics::explicit_elastic, BodyDynamics::implicit_elastic}) {
        World world(settings);
        const MaterialHandle of = world.add_material({.young_modulus = 1e6, .damping = 50});
        const ColliderHandle box = world.add_collider(Box{{side, side, side}}, {.position = {0, 0, side + 0.02}});
        const Mesh cube = mesh::box({side, side, side}, {2, 2, 2});
        const BodyHandle body = world.add_body(cube, {.material = of, .dynamics = dynamics});
        std::vector<Index> top;
        for (std::size_t n = 0; n < cube.nodes.size(); ++n)
            if (cube.nodes[n].z() > 0.049) top.push_back(static_cast<Index>(n));
        Ties ties(world);
        const TieHandle tie = ties.add({.body = body, .nodes = top, .to_collider = box});
        REQUIRE(world.advance(2).ok());
        CHECK(world.asleep(body));
        CHECK(ties.state(tie).force.z() == Approx(9.81).epsilon(1e-2));
        world.set_velocity(box, {0.2, 0, 0}, {0, 0, 1});
        REQUIRE(world.advance(1).ok());
        CHECK_FALSE(world.asleep(body));
        CHECK(ties.state(tie).error < 1e-7);
        const Vec3 expected = Vec3(0.2, 0, 0);
        CHECK((world.center_of_mass(body).head<2>() - expected.head<2>()).norm() < 2e-3);
    }
}

}  // namespace skerry::test::ties_test
