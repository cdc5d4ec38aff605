// Ties of the mean point of a set (docs/methods/ties.md), against closed forms.
#include <algorithm>
#include <catch2/catch.hpp>
#include <cmath>
#include <numbers>

#include "skerry/joint.h"
#include "skerry/tie.h"
#include "tests/support/temporary_folder.h"
#include "tests/support/two_halves.h"
#include "tests/support/worlds.h"

namespace skerry::test::ball_ties_test {

namespace {

using two_halves::rubber, two_halves::without_gravity;

const Mesh box = mesh::box({0.2, 0.1, 0.1}, {3, 2, 2});
constexpr Real box_mass = 1000 * 0.2 * 0.1 * 0.1;  // [kg]

std::vector<Index> nodes_with(auto&& inside) {
    std::vector<Index> list;
    for (std::size_t n = 0; n < box.nodes.size(); ++n)
        if (inside(box.nodes[n])) list.push_back(static_cast<Index>(n));
    return list;
}

/// Two boxes side by side. The mean point of the face of the left one is tied to the right one.
struct Pair {
    World world;
    BodyHandle left, right;
    TieHandle tie;

    explicit Pair(BodyDynamics of_left, BodyDynamics of_right, const Settings& settings = without_gravity(1e-12),
                  Real break_force = infinity)
        : world(settings) {
        const MaterialHandle material = world.add_material(rubber);
        left = world.add_body(box, {.material = material, .dynamics = of_left});
        right = world.add_body(box, {.material = material, .position = {0.2, 0, 0}, .dynamics = of_right});
        tie = Ties(world).add({.kind = TieKind::ball,
                               .body = left,
                               .nodes = nodes_with([](const Vec3& x) { return x.x() > 0.099; }),
                               .to_body = right,
                               .break_force = break_force});
    }
    TieState state() const { return Ties(const_cast<World&>(world)).state(tie); }
};

constexpr std::array deforming{BodyDynamics::explicit_elastic, BodyDynamics::implicit_elastic};
constexpr std::array all_kinds{BodyDynamics::explicit_elastic, BodyDynamics::implicit_elastic, BodyDynamics::rigid};

}  // namespace

TEST_CASE("a body that is tied at its centre of mass by a ball keeps its spin, and the tie carries its weight",
          "[scene][ties]") {
    for (const BodyDynamics dynamics : deforming) {
        CAPTURE(static_cast<int>(dynamics));
        World world(accurate({0, 0, -standard_gravity}, 1e-12));
        const BodyHandle body = world.add_body(box, {.material = world.add_material(rubber), .dynamics = dynamics});
        const TieHandle tie = Ties(world).add(
            {.kind = TieKind::ball, .body = body, .nodes = nodes_with([](const Vec3&) { return true; })});
        world.set_velocity(body, Vec3::Zero(), {0, 0, 5});
        const Vec3 before = world.report().angular_momentum;
        REQUIRE(world.advance(0.2).ok());
        CHECK((world.report().angular_momentum - before).norm() < 1e-11 * before.norm());
        CHECK(world.center_of_mass(body).norm() < 1e-11);
        const TieState state = Ties(world).state(tie);
        CHECK(state.error < 1e-11);
        CHECK((state.force - Vec3(0, 0, box_mass * standard_gravity)).norm() < 1e-9 * box_mass * standard_gravity);
        CHECK(state.moment.norm() < 1e-12);
        CHECK(world.report().energy_error_share < 1e-3);
    }
}

TEST_CASE("a plate that a ball holds at the middle of its upper edge swings with the period of a pendulum",
          "[scene][ties]") {
    constexpr Real density = 1000, width = 0.1, thickness = 0.02, height = 0.2;  // [kg/m^3], [m]
    Settings settings = accurate({0, 0, -standard_gravity}, 1e-12);
    settings.step_size = 1e-3;
    World world(settings);
    const Mesh mesh = mesh::box({width, thickness, height}, {2, 1, 4});
    const BodyHandle plate =
        world.add_body(mesh, {.material = world.add_material({.young_modulus = 1e9, .density = density}),
                              .dynamics = BodyDynamics::implicit_elastic});
    std::vector<Index> edge;
    for (std::size_t n = 0; n < mesh.nodes.size(); ++n)
        if (mesh.nodes[n].z() > 0.49 * height) edge.push_back(static_cast<Index>(n));
    const TieHandle tie = Ties(world).add({.kind = TieKind::ball, .body = plate, .nodes = edge});
    const Vec3 pivot = Ties(world).state(tie).point, arm = world.center_of_mass(plate) - pivot;
    world.set_gravity(standard_gravity * arm.normalized());  // the masses of the nodes are not symmetric
    const Vec3 axis = Vec3::UnitY();
    constexpr Real mass = density * width * thickness * height;                                              // [kg]
    const Real inertia = mass * ((width * width + height * height) / 12 + axis.cross(arm).squaredNorm());    // [kg m^2]
    const Real period = 2 * std::numbers::pi * std::sqrt(inertia / (mass * standard_gravity * arm.norm()));  // [s]
    const Vec3 spin = 0.05 * axis, along = axis.cross(arm).normalized();
    world.set_velocity(plate, spin.cross(arm), spin);
    const Real amplitude = spin.norm() * arm.norm() * period / (2 * std::numbers::pi);  // [m]
    for (const Real quarters : {1, 0, -1, 0}) {
        REQUIRE(world.advance(period / 4).ok());
        CHECK(along.dot(world.center_of_mass(plate) - pivot - arm) ==
              Approx(quarters * amplitude).margin(2e-3 * amplitude));
    }
    const TieState state = Ties(world).state(tie);
    CHECK((state.point - pivot).norm() < 1e-9);
    CHECK(state.moment.norm() < 1e-10 * mass * standard_gravity * arm.norm());
}

TEST_CASE("bodies that a ball ties conserve momentum and angular momentum", "[scene][ties]") {
    for (const BodyDynamics of_left : deforming)
        for (const BodyDynamics of_right : all_kinds) {
            CAPTURE(static_cast<int>(of_left), static_cast<int>(of_right));
            Pair pair(of_left, of_right);
            pair.world.set_velocity(pair.left, {0.1, 0.2, -0.1}, {1, 2, 3});
            pair.world.set_velocity(pair.right, {-0.1, 0.1, 0.2}, {-2, 1, 2});
            const WorldReport before = pair.world.report();
            REQUIRE(pair.world.advance(0.1).ok());
            const WorldReport after = pair.world.report();
            CHECK((after.momentum - before.momentum).norm() < 1e-12);
            // On explicit bodies the impulse acts at the place of the mean point, which is up to 1e-6 m from it.
            const Real apart = of_right == BodyDynamics::explicit_elastic ? 1e-6 : 0;  // [m]
            constexpr Real impulse = 1;                                                // [N s]
            CHECK((after.angular_momentum - before.angular_momentum).norm() < 1e-13 + apart * impulse);
            CHECK(after.momentum_error_share < 1e-12);
            CHECK(after.energy_error_share < 0.01);
            const TieState state = pair.state();
            CHECK(state.force.norm() > 0.01);
            // The error of one step of 7 ms is of third order.
            CHECK(state.error < 1e-6);
        }
}

TEST_CASE("a ball passes on no rotation about its point", "[scene][ties]") {
    for (const BodyDynamics dynamics : deforming) {
        Pair pair(dynamics, BodyDynamics::rigid);
        pair.world.set_velocity(pair.right, Vec3::Zero(), {4, 0, 0});
        REQUIRE(pair.world.advance(0.1).ok());
        CHECK(std::abs(pair.world.velocity(pair.left).angular_velocity.x()) < 1e-9);
        CHECK(pair.world.velocity(pair.right).angular_velocity.x() == Approx(4));
    }
}

TEST_CASE("the mean point of a ring follows a collider in its middle", "[scene][ties]") {
    World world(without_gravity(1e-12));
    const BodyHandle body = world.add_body(box, {.material = world.add_material(rubber)});
    const ColliderHandle shaft =
        world.add_collider(Sphere{0.01}, {.position = {0, 0, 0.2}, .motion = {.velocity = {0.1, 0, 0.05}}});
    const TieHandle tie = Ties(world).add({.kind = TieKind::ball,
                                           .body = body,
                                           .nodes = nodes_with([](const Vec3& x) { return std::abs(x.y()) > 0.049; }),
                                           .to_collider = shaft});
    const Vec3 start = Ties(world).state(tie).point;
    REQUIRE(world.advance(0.1).ok());
    const TieState state = Ties(world).state(tie);
    CHECK((state.point - start - 0.1 * Vec3(0.1, 0, 0.05)).norm() < 1e-9);
    CHECK(world.report().momentum_error_share < 1e-12);
}

TEST_CASE("a ball breaks as a whole at its greatest force", "[scene][ties]") {
    constexpr Real limit = 3;  // [N]
    World world(without_gravity(1e-12));
    const BodyHandle body =
        world.add_body(box, {.material = world.add_material(rubber), .dynamics = BodyDynamics::implicit_elastic});
    const TieHandle tie = Ties(world).add({.kind = TieKind::ball,
                                           .body = body,
                                           .nodes = nodes_with([](const Vec3& x) { return x.x() > 0.099; }),
                                           .break_force = limit});
    Real most = 0;
    for (int k = 1; k <= 100 && Ties(world).state(tie).nodes[0].broken == std::nullopt; ++k) {
        std::vector<Vec3> load(box.nodes.size(), Vec3(0.05 * k / static_cast<Real>(box.nodes.size()), 0, 0));
        world.set_loads(body, load);
        REQUIRE(world.advance(0.01).ok());
        most = std::max(most, Ties(world).state(tie).largest_force);
    }
    CHECK(most == Approx(limit).epsilon(0.05));
    CHECK(most >= limit);
    const TieState state = Ties(world).state(tie);
    for (const TiedNode& node : state.nodes) CHECK(node.broken == state.nodes[0].broken);
    REQUIRE(world.advance(0.1).ok());
    CHECK(Ties(world).state(tie).force.norm() == 0);
    CHECK(world.velocity(body).velocity.x() > 0);
}

TEST_CASE("a world with balls goes on bitwise from files and with any number of threads", "[scene][ties]") {
    const auto make = [](int threads) {
        Settings settings = without_gravity();
        settings.threads = threads;
        Pair pair(BodyDynamics::explicit_elastic, BodyDynamics::rigid, settings);
        pair.world.add_collider(Plane{.normal = {0, 0, 1}}, {.position = {0, 0, -0.06}});
        pair.world.set_velocity(pair.left, {0, 0, -1}, {0, 1, 0});
        return pair;
    };
    Pair one = make(1), three = make(3);
    for (Pair* pair : {&one, &three}) REQUIRE(pair->world.advance(0.1).ok());
    CHECK(one.world.report().max_contacts > 0);
    TemporaryFolder folder;
    one.world.save(folder.path() / "ball");
    World loaded = World::load(folder.path() / "ball"), copy = one.world.clone();
    for (World* world : {&one.world, &three.world, &loaded, &copy}) REQUIRE(world->advance(0.1).ok());
    for (const World* world : {&three.world, &loaded, &copy}) CHECK(world->state_hash() == one.world.state_hash());
}

TEST_CASE("a ball to a surface that deforms must be near it", "[scene][ties]") {
    Pair pair(BodyDynamics::explicit_elastic, BodyDynamics::explicit_elastic);
    CHECK_THROWS_WITH(Ties(pair.world)
                          .add({.kind = TieKind::ball,
                                .body = pair.left,
                                .nodes = nodes_with([](const Vec3& x) { return x.x() < -0.099; }),
                                .to_body = pair.right}),
                      Catch::Contains("nodes: found nodes whose mean point is 0.2 m from the surface"));
}

}  // namespace skerry::test::ball_ties_test
