// Rigid spheres, whose contact shape is exactly round (docs/methods/rigid_bodies.md 6).
#include <Eigen/Dense>
#include <catch2/catch.hpp>
#include <numbers>

#include "engine/world/tuning.h"
#include "engine/world/world_state.h"
#include "skerry/forces.h"
#include "skerry/query.h"
#include "systems/geometry/closest_points.h"
#include "systems/geometry/rotation.h"
#include "tests/support/same_bits.h"
#include "tests/support/worlds.h"

namespace skerry::test::spheres_test {

namespace {

constexpr Real radius = 0.1, density = 1000, g = standard_gravity;
const Real mass = 4 * std::numbers::pi / 3 * density * radius * radius * radius, moment = 0.4 * mass * radius * radius;

struct Spheres {
    World world;
    MaterialHandle material;

    explicit Spheres(const Settings& settings, Real mu = 0.5, Real restitution = 0, const Tuning& tuning = {})
        : world(tuned_world(settings, tuning)),
          material(world.add_material(
              {.young_modulus = 1e6, .density = density, .friction = mu, .restitution = restitution})) {}

    BodyHandle add(const Vec3& position, const Vec3& velocity = Vec3::Zero(), const Vec3& spin = Vec3::Zero(),
                   const std::string& name = "") {
        return world.add_body(Sphere{radius}, {.material = material,
                                               .position = position,
                                               .velocity = velocity,
                                               .angular_velocity = spin,
                                               .contact_distance = 0.001,
                                               .dynamics = BodyDynamics::rigid,
                                               .name = name});
    }
    Vec3 velocity(BodyHandle body) const {
        const Model& model = WorldAccess::state_of(world).model;
        const auto r = static_cast<std::size_t>(model.bodies.rigid[model.row(body, "test")].begin);
        return model.rigid_bodies.momentum[r] / model.rigid_bodies.mass[r];
    }
    Vec3 spin(BodyHandle body) const {
        const Model& model = WorldAccess::state_of(world).model;
        const auto r = static_cast<std::size_t>(model.bodies.rigid[model.row(body, "test")].begin);
        return model.rigid_bodies.angular_momentum[r] / model.rigid_bodies.moments[r][0];
    }
    Vec3 place(BodyHandle body) const { return world.positions(body)[0]; }
};

Settings steps_of(Real h, const Vec3& gravity = {0, 0, -g}) {
    Settings settings = accurate(gravity, 1e-10);
    settings.step_size = h;
    return settings;
}

}  // namespace

TEST_CASE("a sphere has the mass and the moments of the solid, not of its drawn mesh", "[scene]") {
    Spheres s(steps_of(1e-2, Vec3::Zero()));
    const BodyHandle ball = s.add({0, 0, 1}, {1, 2, 3}, {4, 5, 6});
    CHECK(s.world.mass(ball) == Approx(mass).epsilon(1e-14));
    CHECK((s.world.center_of_mass(ball) - Vec3(0, 0, 1)).norm() < 1e-14);
    CHECK(s.world.energy().kinetic == Approx(mass * 14 / 2 + moment * 77 / 2).epsilon(1e-13));
    MaterialSettings heavier = s.world.material(s.material);
    heavier.density *= 2;
    s.world.set_material(s.material, heavier);
    CHECK(s.world.mass(ball) == Approx(2 * mass).epsilon(1e-14));
    CHECK(s.world.energy().kinetic == Approx(mass * 14 + moment * 77).epsilon(1e-13));
}

TEST_CASE("a sphere rolls down a slope at five sevenths, on whatever the slope is made of", "[scene]") {
    constexpr Real degrees = 10, seconds = 0.5;
    const Real law = 5.0 / 7 * g * std::sin(degrees * std::numbers::pi / 180) * seconds;
    enum Floor { plane, box, mesh_collider, rigid_slab };
    for (const Floor floor : {plane, box, mesh_collider, rigid_slab}) {
        CAPTURE(floor);
        Settings settings = steps_of(5e-3, tilted_gravity(degrees));
        Spheres s(settings);
        const Mesh slab = mesh::box({4, 1, 0.2}, {16, 4, 1});
        if (floor == plane) s.world.add_collider(Plane{});
        if (floor == box) s.world.add_collider(Box{{4, 1, 0.2}}, {.position = {0, 0, -0.1}});
        if (floor == mesh_collider)
            s.world.add_collider(mesh::boundary(slab), {.position = {0, 0, -0.1}, .contact_distance = 0.001});
        if (floor == rigid_slab) {
            const BodyHandle held = s.world.add_body(slab, {.material = s.material,
                                                            .position = {0, 0, -0.1},
                                                            .contact_distance = 0.001,
                                                            .dynamics = BodyDynamics::rigid});
            std::vector<Index> all(slab.nodes.size());
            std::iota(all.begin(), all.end(), 0);
            s.world.attach(held, all);
        }
        const Real kept = floor == plane || floor == box ? 0.0005 : 0.001;
        const BodyHandle ball = s.add({-1, 0.03, radius + kept});
        REQUIRE(s.world.advance(seconds).ok());
        CHECK(s.velocity(ball).x() == Approx(law).epsilon(1e-9));
        CHECK(s.spin(ball).y() == Approx(law / radius).epsilon(1e-9));
        CHECK(std::abs(s.velocity(ball).y()) + std::abs(s.velocity(ball).z()) < 1e-9);
        CHECK(s.place(ball).z() == Approx(radius + kept).epsilon(1e-9));
        const WorldReport report = s.world.report();
        CHECK(std::abs(report.dissipated) < 1e-9);  // nothing slips
        for (const Contact& contact : s.world.contacts()) CHECK(contact.slip.norm() < 1e-8);
    }
}

TEST_CASE("a sphere that slides begins to roll at five sevenths of its speed", "[scene]") {
    constexpr Real mu = 0.2, speed = 2;
    Spheres s(steps_of(1e-3), mu);
    s.world.add_collider(Plane{});
    const BodyHandle ball = s.add({0, 0, radius + 0.0005}, {speed, 0, 0});
    REQUIRE(s.world.advance(0.1).ok());
    CHECK(s.velocity(ball).x() == Approx(speed - mu * g * 0.1).epsilon(1e-9));
    CHECK(s.spin(ball).y() == Approx(2.5 * mu * g * 0.1 / radius).epsilon(1e-9));
    REQUIRE(s.world.advance(0.4).ok());
    CHECK(s.velocity(ball).x() == Approx(5.0 / 7 * speed).epsilon(1e-9));
    CHECK(s.spin(ball).y() == Approx(5.0 / 7 * speed / radius).epsilon(1e-9));
    const WorldReport report = s.world.report();
    CHECK(report.dissipated == Approx(mass * speed * speed / 7).epsilon(1e-6));
    CHECK(report.energy_error < 1e-9);
}

TEST_CASE("the moment of friction on a sphere changes its spin", "[scene]") {
    constexpr Real mu = 0.2;
    Spheres s(steps_of(1e-3), mu);
    const auto floor = s.world.add_collider(Plane{});
    const BodyHandle ball = s.add({0, 0, radius + 0.0005}, {2, 0, 0});
    s.world.measure_forces(true, Vec3(0, 0, radius));
    REQUIRE(s.world.advance(1e-3).ok());
    const ForceReport on = s.world.forces().on(ball, floor);
    const Vec3 about = on.moment_about({0, 0, radius + 0.0005});
    CHECK(on.force().x() == Approx(-mu * mass * g).epsilon(1e-9));
    CHECK(about.y() == Approx(mu * mass * g * radius).epsilon(1e-9));
    CHECK(about.y() * 1e-3 / moment == Approx(s.spin(ball).y()).epsilon(1e-9));
}

TEST_CASE("the drawn mesh of a sphere moves with it", "[scene]") {
    for (const Integrator integrator : {Integrator::symplectic_euler, Integrator::leapfrog}) {
        Settings settings = steps_of(1e-3, Vec3::Zero());
        settings.integrator = integrator;
        Spheres s(settings);
        const Vec3 spin(0, 0, 3);
        const BodyHandle ball = s.add({0, 0, 1}, {1, 0, 0}, spin);
        const std::vector<Vec3> before(s.world.positions(ball).begin(), s.world.positions(ball).end());
        REQUIRE(s.world.advance(0.2).ok());
        const Mat3 turned = rotation_matrix(0.2 * spin);
        const std::span<const Vec3> now = s.world.positions(ball), velocity = s.world.velocities(ball);
        REQUIRE(now.size() > sphere_step_nodes);
        for (std::size_t n = 0; n < now.size(); ++n) {
            const Vec3 arm = turned * (before[n] - Vec3(0, 0, 1));
            CHECK((now[n] - (Vec3(0.2, 0, 1) + arm)).norm() < 1e-12);
            CHECK((velocity[n] - (Vec3(1, 0, 0) + spin.cross(arm))).norm() < 1e-12);
        }
    }
}

TEST_CASE("drawing a sphere within a call changes no bit", "[scene]") {
    const auto simulate = [](bool looks, bool may_rest) {
        Settings settings = steps_of(1e-3);
        settings.sleep = may_rest;
        settings.sleep_time = 1000;
        Spheres s(settings);
        s.world.add_collider(Plane{});
        const BodyHandle ball = s.add({0, 0, 0.11}, {1, 0, 0}, {2, -1, 3});
        int steps = 0;
        const auto look = [&](const StepReport&) {
            if (!looks || ++steps % 3 != 0) return;
            CHECK((s.world.positions(ball)[100] - s.place(ball)).norm() == Approx(radius));
            const Vec3 arm = s.world.positions(ball)[100] - s.place(ball);
            CHECK((s.world.velocities(ball)[100] - s.velocity(ball) - s.spin(ball).cross(arm)).norm() < 1e-12);
        };
        if (looks) s.world.watch_steps(look);
        REQUIRE(s.world.advance(0.1).ok());
        CHECK((steps > 50) == looks);
        return s.world.state_hash();
    };
    CHECK(simulate(true, false) == simulate(false, false));
    CHECK(simulate(true, true) == simulate(false, true));
}

TEST_CASE("loads on any of the nodes that draw a sphere move it", "[scene]") {
    constexpr Real h = 1e-3;
    Spheres s(steps_of(h, Vec3::Zero()));
    const BodyHandle ball = s.add({0, 0, 1});
    const std::size_t count = s.world.positions(ball).size(), last = count - 1;
    REQUIRE(last > sphere_step_nodes);
    std::vector<Vec3> load(count, Vec3::Zero());
    load[last] = {3, -1, 2};
    const Vec3 arm = s.world.positions(ball)[last] - Vec3(0, 0, 1);
    s.world.set_loads(ball, load);
    REQUIRE(s.world.advance(h).ok());
    CHECK((s.velocity(ball) - h / mass * load[last]).norm() < 1e-12);
    CHECK((s.spin(ball) - h / moment * arm.cross(load[last])).norm() < 1e-12);
    REQUIRE(s.world.advance(0.1).ok());
    const WorldReport report = s.world.report();
    CHECK(report.energy_error < 0.01 * report.energy.kinetic);
    CHECK(report.momentum_error < 1e-9);
}

TEST_CASE("a sphere that spins in one place moves, and does not come to rest", "[scene]") {
    Settings settings = steps_of(1e-3, Vec3::Zero());
    settings.sleep_time = 0.01;
    Spheres s(settings, 0.5, 0, {.sleep_speed = 0.1});
    const BodyHandle ball = s.add({0, 0, 1}, Vec3::Zero(), {2, 0, 0}),
                     still = s.add({1, 0, 1}, Vec3::Zero(), {0.5, 0, 0});
    std::vector<Vec3> before;
    for (const Vec3& node : s.world.positions(still)) before.push_back(node - Vec3(1, 0, 1));
    REQUIRE(s.world.advance(0.1).ok());
    CHECK(!s.world.asleep(ball));
    CHECK(s.world.asleep(still));
    CHECK(s.spin(ball).x() == Approx(2));
    // The drawn nodes have the orientation in which the sphere fell asleep.
    const std::span<const Vec3> x = s.world.positions(still);
    const Mat3 turned = rotation_matrix(s.world.pose(still).rotation);
    CHECK(s.world.pose(still).rotation.norm() > 1e-3);
    for (std::size_t n = 0; n < x.size(); ++n) CHECK((x[n] - s.place(still) - turned * before[n]).norm() < 1e-12);
}

TEST_CASE("a sphere stays what it is when bodies before it go", "[scene]") {
    Spheres s(steps_of(1e-3));
    const BodyHandle block =
        s.world.add_body(mesh::box({0.1, 0.1, 0.1}, {2, 2, 2}), {.material = s.material, .position = {3, 0, 0}});
    const BodyHandle below = s.add({0, 0, 0}), above = s.add({0, 0, 0.25}, {0, 0, -1});
    REQUIRE(s.world.advance(0.02).ok());
    s.world.remove(block);
    REQUIRE(s.world.advance(0.08).ok());
    CHECK(s.world.contacts().size() == 1);
    CHECK((s.place(above) - s.place(below)).norm() == Approx(2 * radius + 0.001).epsilon(1e-6));
}

TEST_CASE("two spheres meet along the line of their middles", "[scene]") {
    Spheres s(steps_of(1e-3, Vec3::Zero()), 0, 1);
    const Vec3 along = Vec3(1, 2, -0.5).normalized();
    const Real kept = 2 * radius + 0.001;
    const BodyHandle still = s.add({0, 0, 0}), thrown = s.add(-(kept + 0.05) * along, 2 * along);
    REQUIRE(s.world.advance(0.1).ok());
    CHECK((s.velocity(still) - 2 * along).norm() < 1e-9);
    CHECK(s.velocity(thrown).norm() < 1e-9);
    CHECK(s.world.report().max_penetration == 0);
    CHECK(s.world.report().energy_error < 1e-9);
}

TEST_CASE("friction spins two spheres that graze each other, and angular momentum stays", "[scene]") {
    Spheres s(steps_of(1e-3, Vec3::Zero()), 0.3);
    const BodyHandle a = s.add({0, 0, 0}), b = s.add({-0.3, 0.1, 0}, {3, 0, 0});
    const Vec3 before = s.world.report().angular_momentum;
    REQUIRE(s.world.advance(0.2).ok());
    CHECK(s.spin(a).norm() > 1);
    CHECK((s.spin(a) - s.spin(b)).norm() < 1e-9);
    const Vec3 after = s.world.report().angular_momentum;
    // The two surfaces are the contact distance apart. Friction bridges this gap without a balancing moment.
    CHECK((after - before).norm() < 0.01 * before.norm());
    CHECK(s.world.report().momentum_error < 1e-12);
}

TEST_CASE("a sphere lies in a soft body that closes around it, and is carried by all that it touches",
          "[scene][long]") {
    Spheres s({.step_size = 1e-3});
    s.world.add_collider(Plane{});
    const auto soft = s.world.add_material(
        {.young_modulus = 2e4, .poisson_ratio = 0.3, .density = 500, .friction = 0.5, .damping = 50});
    const BodyHandle pad = s.world.add_body(mesh::box({0.5, 0.5, 0.2}, {10, 10, 4}),
                                            {.material = soft, .position = {0, 0, 0.1005}, .contact_distance = 0.001});
    const BodyHandle ball = s.add({0.013, 0.007, 0.2 + radius + 0.003});
    REQUIRE(s.world.advance(1.5).ok());
    REQUIRE(s.world.advance(1e-4).steps == 1);
    const Real depth = 0.2 + radius - s.place(ball).z();
    CHECK(depth > 0.01);
    Vec3 carried = Vec3::Zero();
    Index touching = 0;
    for (const Contact& contact : s.world.contacts())
        if (contact.first == ball || contact.second == ball) {
            carried += (contact.first == ball ? 1 : -1) * contact.force();
            ++touching;
            CHECK(contact.distance > 0);
        }
    CHECK(touching > 5);
    CHECK(carried.z() == Approx(mass * g).epsilon(0.05));
    for (const Vec3& x : s.world.positions(pad)) CHECK((x - s.place(ball)).norm() > radius);
}

TEST_CASE("a sphere rests on two edges of meshes, and on one corner", "[scene]") {
    constexpr Real kept = 0.001, apart = 0.06;
    Spheres s(steps_of(5e-3));
    const SurfaceMesh slab = mesh::boundary(mesh::box({0.5, 2, 0.2}, {5, 11, 2}));
    for (const Real side : {-1.0, 1.0})
        s.world.add_collider(slab, {.position = {side * (0.25 + apart), 0, -0.1}, .contact_distance = kept});
    const Real height = std::sqrt((radius + kept) * (radius + kept) - apart * apart);
    const BodyHandle ball = s.add({0, 0.01, height + 1e-4});
    // A sphere on the tip of a spike, in unstable balance without friction.
    const SurfaceMesh spike{{{0, 0, 0.5}, {-0.2, -0.2, 0}, {0.2, -0.2, 0}, {0, 0.3, 0}},
                            {{0, 1, 2}, {0, 2, 3}, {0, 3, 1}, {1, 3, 2}}};
    s.world.add_collider(spike, {.position = {3, 0, 0}, .friction = 0, .contact_distance = kept});
    const BodyHandle above = s.add({3, 0, 0.5 + radius + kept});
    REQUIRE(s.world.advance(0.3).ok());
    CHECK(s.place(ball).z() == Approx(height).epsilon(1e-6));
    CHECK((s.place(ball).head<2>() - Vec3(0, 0.01, 0).head<2>()).norm() < 1e-9);
    CHECK((s.place(above) - Vec3(3, 0, 0.5 + radius + kept)).norm() < 1e-9);
}

TEST_CASE("spheres come to rest on each other in a bucket", "[scene]") {
    Spheres s({.step_size = 5e-3});
    s.world.add_collider(Bucket{.radius = 0.3, .height = 0.5, .thickness = 0.02});
    std::vector<BodyHandle> balls;
    for (int k = 0; k < 6; ++k)
        balls.push_back(s.add({0.11 * std::cos(k * 2.2), 0.11 * std::sin(k * 2.2), 0.15 + 0.25 * k}));
    REQUIRE(s.world.advance(4).ok());
    for (const BodyHandle ball : balls) {
        CHECK(s.velocity(ball).norm() < 1e-3);
        CHECK(s.place(ball).z() > radius);
        CHECK(s.place(ball).head<2>().norm() < 0.3 - radius);
        for (const BodyHandle other : balls)
            if (other != ball) CHECK((s.place(ball) - s.place(other)).norm() > 2 * radius);
    }
}

TEST_CASE("a fast sphere goes through nothing", "[scene]") {
    for (const Real speed : {3.0, 30.0, 100.0}) {
        CAPTURE(speed);
        Spheres s(steps_of(1.0 / 120, Vec3::Zero()));
        s.world.add_collider(Box{{0.02, 2, 2}}, {.position = {1, 0, 0}});
        s.world.add_collider(mesh::boundary(mesh::box({0.02, 2, 2}, {1, 4, 4})),
                             {.position = {-1, 0, 0}, .contact_distance = 0.001});
        const BodyHandle a = s.add({0.3, 0.02, 0.01}, {speed, 0, 0}), b = s.add({-0.3, 0.3, 0.01}, {-speed, 0, 0});
        REQUIRE(s.world.advance(0.5).ok());
        CHECK(s.place(a).x() < 1);
        CHECK(s.place(b).x() > -1);
        CHECK(s.world.report().max_penetration < 1e-9);
    }
}

TEST_CASE("balls that press soft faces over do not come into them", "[scene]") {
    Spheres s({.step_size = 1e-3});
    s.world.add_collider(Plane{});
    const auto soft =
        s.world.add_material({.young_modulus = 5e4, .poisson_ratio = 0.4, .density = 1000, .friction = 0.5});
    const auto steel = s.world.add_material({.young_modulus = 2e11, .density = 7800, .friction = 0.4});
    const BodyHandle bed = s.world.add_body(mesh::ball(0.08, 8), {.material = soft, .position = {0, 0, 0.081}});
    std::vector<BodyHandle> balls;
    for (const Vec3& at : {Vec3(0.02, 0.01, 0.21), Vec3(-0.05, 0.03, 0.23), Vec3(0, -0.05, 0.29)})
        balls.push_back(s.world.add_body(
            Sphere{0.04},
            {.material = steel, .position = at, .velocity = {0, 0, -4}, .dynamics = BodyDynamics::rigid}));
    for (int look = 0; look < 100; ++look) {
        REQUIRE(s.world.advance(1e-3).ok());
        const std::span<const Vec3> x = s.world.positions(bed);
        for (const auto& face : s.world.surface(bed))
            for (const BodyHandle ball : balls) {
                const auto corner = [&](std::size_t k) { return x[static_cast<std::size_t>(face[k])]; };
                const PointTriangle nearest = closest_point_on_triangle(s.place(ball), corner(0), corner(1), corner(2));
                CHECK(nearest.distance_squared > 0.04 * 0.04);
            }
    }
    CHECK(s.world.report().max_penetration == 0);
    CHECK(s.world.report().crossings_found > 0);
}

TEST_CASE("a sphere that strikes a sheet thinner than its shell meets the upper side alone", "[scene]") {
    Spheres s(steps_of(2e-3));
    const Mesh mesh = mesh::box({0.4, 0.4, 0.002}, {8, 8, 1});
    const BodyHandle sheet =
        s.world.add_body(mesh, {.material = s.material, .contact_distance = 0.005, .dynamics = BodyDynamics::rigid});
    const BodyHandle ball = s.add({0.013, 0.007, radius + 0.02}, {0, 0, -3});
    int seen = 0;
    for (int look = 0; look < 20; ++look) {
        REQUIRE(s.world.advance(1e-3).ok());
        for (const Contact& contact : s.world.contacts())
            for (std::size_t k = 0; k < 4; ++k) {
                if (contact.weight[k] == 0 || (contact.weight[k] > 0 ? contact.first : contact.second) != sheet)
                    continue;
                ++seen;
                CHECK(mesh.nodes[static_cast<std::size_t>(contact.node[k])].z() > 0);
            }
    }
    CHECK(seen > 10);
    CHECK(s.velocity(ball).z() > -3);
}

TEST_CASE("a ball that another strikes does not come into a third, nor into a wall", "[scene]") {
    Spheres s(steps_of(1.0 / 120, Vec3::Zero()), 0, 1);
    s.world.add_collider(Plane{});
    // The engine expects no contact between the resting balls before they are struck.
    const Real apart = 2 * radius + 0.002;
    s.add({0, 0, 2 * apart + 0.5}, {0, 0, -20});
    s.add({0, 0, radius + 0.002 + apart});
    s.add({0, 0, radius + 0.002});
    REQUIRE(s.world.advance(0.2).ok());
    CHECK(s.world.report().max_penetration == 0);
    CHECK(s.world.report().crossings_found > 0);
}

TEST_CASE("rays and nearest points meet the sphere, not the faces that draw it", "[scene]") {
    Spheres s(steps_of(1e-3));
    const BodyHandle ball = s.add({1, 2, 3});
    const Vec3 aside = Vec3(0.31, -0.2, 0.9).normalized();
    const auto hit = s.world.cast_ray(Vec3(1, 2, 3) + 2 * aside, -aside, 10);
    REQUIRE(hit);
    CHECK(hit->body == ball);
    CHECK(hit->distance == Approx(2 - radius).epsilon(1e-14));
    CHECK((hit->normal - aside).norm() < 1e-13);
    const auto nearest = s.world.nearest_point(Vec3(1, 2, 3) + 0.5 * aside, 10);
    REQUIRE(nearest);
    CHECK(nearest->distance == Approx(0.5 - radius).epsilon(1e-14));
    CHECK((nearest->point - (Vec3(1, 2, 3) + radius * aside)).norm() < 1e-13);
    for (const Vec3& x : s.world.positions(ball)) CHECK((x - Vec3(1, 2, 3)).norm() < radius + 1e-14);
}

TEST_CASE("spheres that overlap at the start are refused or moved apart", "[scene]") {
    Settings settings = steps_of(1e-3);
    settings.start_overlaps = StartOverlaps::refuse;
    const auto overlapping = [&](const Settings& with) {
        Spheres s(with);
        s.world.add_collider(Plane{});
        s.add({0, 0, 0.15}, Vec3::Zero(), Vec3::Zero(), "below");
        s.add({0, 0.02, 0.34}, Vec3::Zero(), Vec3::Zero(), "above");
        return s;
    };
    Spheres refused = overlapping(settings);
    CHECK_THROWS_WITH(refused.world.advance(1e-3), Catch::Contains("above") && Catch::Contains("below"));
    settings.start_overlaps = StartOverlaps::resolve;
    Spheres moved = overlapping(settings);
    REQUIRE(moved.world.advance(1e-3).ok());
    const auto bodies = moved.world.bodies();
    CHECK((moved.place(bodies[0]) - moved.place(bodies[1])).norm() > 2 * radius);
}

TEST_CASE("invalid settings of a sphere are refused by name", "[scene]") {
    Spheres s(steps_of(1e-3));
    using Catch::Contains;
    CHECK_THROWS_WITH(
        s.world.add_body(Sphere{radius},
                         {.material = s.material, .dynamics = BodyDynamics::explicit_elastic, .name = "soft"}),
        Contains("'soft'") && Contains("dynamics"));
    CHECK(s.world.dynamics(s.world.add_body(Sphere{radius}, {.material = s.material, .position = {9, 0, 0}})) ==
          BodyDynamics::rigid);
    CHECK_THROWS_WITH(
        s.world.add_body(Sphere{0}, {.material = s.material, .dynamics = BodyDynamics::rigid, .name = "none"}),
        Contains("'none'") && Contains("radius"));
    const BodyHandle ball = s.add({0, 0, 0}, Vec3::Zero(), Vec3::Zero(), "ball");
    const std::uint64_t before = s.world.state_hash();
    CHECK_THROWS_WITH(s.world.set_dynamics(ball, BodyDynamics::explicit_elastic), Contains("'ball'"));
    CHECK_THROWS_WITH(s.world.attach(ball, std::vector<Index>{0, 1, 2, 3}), Contains("'ball'"));
    CHECK(s.world.state_hash() == before);
}

TEST_CASE("spheres have the same bits on any number of threads, cloned, and from a file", "[determinism]") {
    const auto simulate = [](int threads) {
        Settings settings = steps_of(5e-3);
        settings.backend = Backend::threads;
        settings.threads = threads;
        Spheres s(settings);
        s.world.add_collider(Plane{});
        for (int k = 0; k < 5; ++k) s.add({0.13 * (k % 2), 0.04 * k, 0.12 + 0.21 * k});
        s.world.add_body(mesh::box({0.3, 0.3, 0.1}, {4, 4, 1}), {.material = s.material, .position = {0, 0, 1.5}});
        REQUIRE(s.world.advance(0.3).ok());
        return s;
    };
    check_same_bits(simulate, [](World& world) { REQUIRE(world.advance(0.3).ok()); });
}

}  // namespace skerry::test::spheres_test
