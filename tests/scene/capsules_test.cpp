// Rigid capsules, whose contact shape is exactly round about their axes (docs/methods/rigid_bodies.md 6).
#include <Eigen/Dense>
#include <Eigen/Geometry>
#include <catch2/catch.hpp>

#include "skerry/query.h"
#include "systems/geometry/closest_points.h"
#include "systems/geometry/rotation.h"
#include "tests/support/capsules.h"
#include "tests/support/same_bits.h"

namespace skerry::test::capsules_test {

using namespace skerry::test::capsules;

namespace {

/// Distance from the axis to the nearest triangle of a surface, from its ends and where edges pass it [m]
Real distance_to_faces(const Vec3& a, const Vec3& b, std::span<const Vec3> x,
                       std::span<const std::array<Index, 3>> faces) {
    Real least = std::numeric_limits<Real>::infinity();
    for (const auto& face : faces) {
        const auto corner = [&](std::size_t k) { return x[static_cast<std::size_t>(face[k])]; };
        for (const Vec3& end : {a, b})
            least = std::min(least, closest_point_on_triangle(end, corner(0), corner(1), corner(2)).distance_squared);
        for (std::size_t k = 0; k < 3; ++k)
            least = std::min(least, closest_points_of_segments(a, b, corner(k), corner((k + 1) % 3)).distance_squared);
    }
    return std::sqrt(least);
}

}  // namespace

TEST_CASE("a capsule has the mass and the moments of the solid, not of its drawn mesh", "[scene]") {
    for (const Vec3& rotation : {Vec3(0, 0, 0), Vec3(0.3, -1.2, 0.7)}) {
        Capsules c(steps_of(1e-2, Vec3::Zero()));
        const Mat3 turned = rotation_matrix(rotation);
        const Vec3 spin(4, 5, 6);
        const BodyHandle body = c.add({0, 0, 1}, rotation, {1, 2, 3}, turned * spin);
        CHECK(c.world.mass(body) == Approx(mass).epsilon(1e-12));
        CHECK((c.world.center_of_mass(body) - Vec3(0, 0, 1)).norm() < 1e-14);
        const RigidBodyTable& table = WorldAccess::state_of(c.world).model.rigid_bodies;
        CHECK(table.moments[c.row(body)].x() == Approx(across).epsilon(1e-12));
        CHECK(table.moments[c.row(body)].y() == Approx(across).epsilon(1e-12));
        CHECK(table.moments[c.row(body)].z() == Approx(axial).epsilon(1e-12));
        const WorldReport report = c.world.report();
        const Vec3 own = report.angular_momentum - Vec3(0, 0, 1).cross(report.momentum);
        CHECK((own - turned * Vec3(across * 4, across * 5, axial * 6)).norm() < 1e-12 * own.norm());
        CHECK(c.world.energy().kinetic == Approx(mass * 14 / 2 + (across * (16 + 25) + axial * 36) / 2).epsilon(1e-12));
        MaterialSettings heavier = c.world.material(c.material);
        heavier.density *= 2;
        c.world.set_material(c.material, heavier);
        CHECK(c.world.mass(body) == Approx(2 * mass).epsilon(1e-12));
    }
}

TEST_CASE("a capsule that lies on a floor stays, half of its weight on either end", "[scene]") {
    for (const Floor floor : {plane, box, mesh_collider, rigid_slab}) {
        CAPTURE(floor);
        Capsules c(steps_of(5e-3));
        const Vec3 at(0.07, 0.03, radius + add_floor(c, floor));
        const BodyHandle body = c.add(at, along_y);
        REQUIRE(c.world.advance(1).ok());
        CHECK((c.middle(body) - at).norm() < 1e-9);
        CHECK(c.velocity(body).norm() + c.spin(body).norm() < 1e-9);
        Vec3 sum = Vec3::Zero(), moment = Vec3::Zero();
        for (const Contact& contact : c.world.contacts()) {
            const Vec3 impulse = (contact.first == body ? 1 : -1) * contact.impulse;
            sum += impulse;
            // Reported points are on the second body; impulses act on the surface of the capsule.
            const Vec3 point =
                contact.first == body ? Vec3(contact.point + contact.distance * contact.normal) : contact.point;
            moment += (point - c.middle(body)).cross(impulse);
            CHECK(contact.distance == Approx(at.z() - radius).epsilon(1e-6));
        }
        const Real weight = mass * g * 5e-3;
        CHECK((sum - Vec3(0, 0, weight)).norm() < 1e-8 * weight);
        CHECK(moment.norm() < 1e-8 * weight * length);
        if (floor != plane && floor != box) continue;
        REQUIRE(c.world.contacts().size() == 2);
        for (const Contact& contact : c.world.contacts())
            CHECK(contact.impulse.z() == Approx(weight / 2).epsilon(1e-8));
    }
}

TEST_CASE("a capsule slides along its axis as Coulomb's law has it", "[scene]") {
    constexpr Real degrees = 20, mu = 0.2, seconds = 0.5;
    const Real slope = degrees * pi / 180;
    for (const Floor floor : {plane, box, mesh_collider, rigid_slab}) {
        CAPTURE(floor);
        Capsules c(steps_of(5e-3, tilted_gravity(degrees)), mu);
        const Real z = radius + add_floor(c, floor);
        const BodyHandle body = c.add({-1, 0.03, z}, along_x);
        REQUIRE(c.world.advance(seconds).ok());
        CHECK(c.velocity(body).x() == Approx(g * (std::sin(slope) - mu * std::cos(slope)) * seconds).epsilon(1e-9));
        CHECK(c.middle(body).z() == Approx(z).epsilon(1e-9));
        CHECK(c.spin(body).norm() < 1e-8);
    }
}

TEST_CASE("a capsule rolls down a slope as its moment about the axis has it", "[scene]") {
    constexpr Real degrees = 10, seconds = 0.5;
    const Real law = g * std::sin(degrees * pi / 180) / (1 + axial / (mass * radius * radius)) * seconds;
    for (const Floor floor : {plane, box, mesh_collider, rigid_slab}) {
        CAPTURE(floor);
        Capsules c(steps_of(5e-3, tilted_gravity(degrees)));
        const Real z = radius + add_floor(c, floor);
        const BodyHandle body = c.add({-1, 0.03, z}, along_y);
        REQUIRE(c.world.advance(seconds).ok());
        INFO("error " << c.velocity(body).x() / law - 1);
        CHECK(c.velocity(body).x() == Approx(law).epsilon(1e-9));
        CHECK(c.spin(body).y() == Approx(law / radius).epsilon(1e-9));
        CHECK(std::abs(c.velocity(body).y()) + std::abs(c.velocity(body).z()) < 1e-9);
        CHECK(c.middle(body).z() == Approx(z).epsilon(1e-9));
        CHECK(std::abs(c.world.report().dissipated) < 1e-8);  // nothing slips
    }
}

TEST_CASE("two capsules that cross rest on each other at the sum of their radii", "[scene]") {
    Capsules c(steps_of(5e-3));
    c.world.add_collider(Plane{});
    const Real low = radius + kept / 2, high = low + 2 * radius + kept;
    const BodyHandle below = c.add({0, 0, low}, along_x), above = c.add({0, 0, high}, along_y);
    REQUIRE(c.world.advance(0.5).ok());
    CHECK(c.apart(below, above) == Approx(2 * radius + kept).epsilon(1e-9));
    CHECK((c.middle(above) - Vec3(0, 0, high)).norm() < 1e-8);
    int between = 0;
    for (const Contact& contact : c.world.contacts()) {
        if (!c.world.alive(contact.second) || contact.impulse.isZero(0)) continue;
        ++between;
        CHECK(contact.distance == Approx(kept).epsilon(1e-6));
        CHECK((contact.point - Vec3(0, 0, low + radius)).norm() < 1.001 * kept);  // on the surface of either capsule
        CHECK(contact.impulse.norm() == Approx(mass * g * 5e-3).epsilon(1e-8));
    }
    CHECK(between == 1);
}

TEST_CASE("a capsule thrown against another, a sphere or a block meets it on its surface", "[scene]") {
    enum Target { end_on, crossed, beside, sphere, block };
    for (const Target target : {end_on, crossed, beside, sphere, block}) {
        CAPTURE(target);
        Capsules c(steps_of(1e-3, Vec3::Zero()), 0, 1);
        const Real start = 1.5;
        const BodyHandle thrown = c.add({-start, 0, 0}, target == end_on ? along_x : along_y, {2, 0, 0});
        BodyHandle still;
        const Vec3 other = target == end_on ? along_x : target == beside ? along_y : Vec3::Zero();
        const Real same = target == sphere ? radius * std::cbrt(mass / ball) : radius;  // [m]
        if (target == sphere)
            still = c.world.add_body(Sphere{same}, c.placed({0, 0, 0}, Vec3::Zero()));
        else if (target == block)
            still = c.world.add_body(mesh::box({0.1, 0.3, 0.3}, {1, 3, 3}), c.placed({0, 0, 0}, Vec3::Zero()));
        else
            still = c.add({0, 0, 0}, other);
        const Real reach = target == end_on ? length + 2 * radius : target == block ? radius + 0.05 : radius + same;
        const Real arrives = (start - reach - kept) / 2;
        REQUIRE(c.world.advance(arrives - 2e-3).ok());
        CHECK(c.velocity(thrown).x() == Approx(2));
        REQUIRE(c.world.advance(0.1).ok());
        const Real heavy = c.world.mass(still), joint = 2 * mass / (mass + heavy);
        CHECK((c.velocity(still) - 2 * joint * Vec3::UnitX()).norm() < 1e-8);
        CHECK((c.velocity(thrown) - 2 * (joint * heavy / mass - 1) * -Vec3::UnitX()).norm() < 1e-8);
        CHECK(c.spin(thrown).norm() < 1e-8);
        CHECK(c.world.report().max_penetration == 0);
        CHECK(c.world.report().energy_error < 1e-8);
    }
}

TEST_CASE("friction between capsules keeps the angular momentum", "[scene]") {
    Capsules c(steps_of(1e-3, Vec3::Zero()), 0.3);
    const BodyHandle a = c.add({0, 0, 0}, {0.2, 0.1, 0}), b = c.add({-0.5, 0.1, 0.07}, along_y, {3, 0.3, 0.1});
    const Vec3 before = c.world.report().angular_momentum;
    REQUIRE(c.world.advance(0.3).ok());
    CHECK(c.spin(a).norm() > 0.5);
    CHECK(c.spin(b).norm() > 0.5);
    // The two surfaces are the contact distance apart. Friction bridges this gap without a balancing moment.
    CHECK((c.world.report().angular_momentum - before).norm() < 0.01 * before.norm());
    CHECK(c.world.report().momentum_error < 1e-12);
    CHECK(c.world.report().max_penetration == 0);
}

TEST_CASE("a capsule lies on two edges of meshes, along one, and over two corners", "[scene]") {
    constexpr Real between = 0.06;
    Capsules c(steps_of(5e-3));
    const SurfaceMesh slab = mesh::boundary(mesh::box({0.5, 2, 0.2}, {5, 11, 2}));
    for (const Real side : {-1.0, 1.0})
        c.world.add_collider(slab, {.position = {side * (0.25 + between), 0, -0.1}, .contact_distance = kept});
    const Real height = std::sqrt((radius + kept) * (radius + kept) - between * between);
    const BodyHandle body = c.add({0, 0.01, height + 1e-4}, along_y);
    // A capsule longer than the diagonal of the block lies over two corners.
    const SurfaceMesh block = mesh::boundary(mesh::box({0.2, 0.2, 0.2}, {2, 2, 2}));
    const Mat3 diagonal = Eigen::AngleAxis<Real>(pi / 4, Vec3::UnitZ()).toRotationMatrix() * rotation_matrix(along_x);
    c.world.add_collider(block, {.position = {3, 0, -0.1}, .contact_distance = kept});
    const BodyHandle over = c.add({3, 0, radius + kept}, rotation_vector(diagonal));
    // A capsule lies across a narrow ridge with its ends free.
    c.world.add_collider(mesh::boundary(mesh::box({0.2, 1, 0.2}, {1, 5, 1})),
                         {.position = {6, 0, -0.1}, .contact_distance = kept});
    const BodyHandle across_ridge = c.add({6.01, 0, radius + kept}, along_x);
    REQUIRE(c.world.advance(0.5).ok());
    CHECK(c.middle(body).z() == Approx(height).epsilon(1e-6));
    CHECK((c.middle(body).head<2>() - Vec3(0, 0.01, 0).head<2>()).norm() < 1e-8);
    CHECK((c.middle(over) - Vec3(3, 0, radius + kept)).norm() < 1e-7);
    CHECK(c.spin(over).norm() < 1e-8);
    CHECK((c.middle(across_ridge) - Vec3(6.01, 0, radius + kept)).norm() < 1e-7);
    CHECK(c.world.report().crossings_found == 0);
}

TEST_CASE("a capsule lies over the sides of colliders", "[scene]") {
    Capsules c(steps_of(5e-3));
    c.world.add_collider(Box{{0.2, 0.2, 0.2}}, {.position = {0, 0, -0.1}});
    const BodyHandle over_box = c.add({0.02, 0, radius + kept / 2}, along_x);
    c.world.add_collider(Cylinder{0.3, 1}, {.position = {3, 0, -0.3}, .rotation = along_y});
    const BodyHandle over_drum = c.add({3, 0, radius + kept / 2}, along_x);
    const BodyHandle upright = c.world.add_body(Capsule{radius, length}, c.placed({6, 0, 0.3 + kept / 2}, {0, 0, 0}));
    c.world.add_collider(Plane{});  // only for the upright capsule; it passes through the others
    c.world.set_collision(over_box, c.world.colliders().back(), false);
    c.world.set_collision(over_drum, c.world.colliders().back(), false);
    REQUIRE(c.world.advance(0.3).ok());
    CHECK((c.middle(over_box) - Vec3(0.02, 0, radius + kept / 2)).norm() < 1e-8);
    CHECK((c.middle(over_drum) - Vec3(3, 0, radius + kept / 2)).norm() < 1e-7);
    CHECK((c.middle(upright) - Vec3(6, 0, 0.3 + kept / 2)).norm() < 1e-8);
}

TEST_CASE("a capsule lies on a soft block, which does not come into it", "[scene][long]") {
    Capsules c({.step_size = 1e-3});
    c.world.add_collider(Plane{});
    const auto soft = c.world.add_material(
        {.young_modulus = 2e4, .poisson_ratio = 0.3, .density = 500, .friction = 0.5, .damping = 5});
    const BodyHandle pad = c.world.add_body(mesh::box({0.8, 0.6, 0.2}, {12, 9, 3}),
                                            {.material = soft, .position = {0, 0, 0.1005}, .contact_distance = kept});
    const BodyHandle body = c.add({0.013, 0.007, 0.2 + radius + 0.003}, {0.2, pi / 2, 0.3});
    for (int look = 0; look < 60; ++look) {
        REQUIRE(c.world.advance(0.025).ok());
        CHECK(distance_to_faces(c.end(body, 0), c.end(body, 1), c.world.positions(pad), c.world.surface(pad)) > radius);
    }
    // The capsule goes on oscillating for a while, so the impulses are summed over time.
    Vec3 carried = Vec3::Zero();
    Index most = 0;
    const Real before = c.world.time();
    c.world.watch_steps([&](const StepReport&) {
        Index touching = 0;
        for (const Contact& contact : c.world.contacts())
            if (contact.first == body || contact.second == body) {
                carried += (contact.first == body ? 1 : -1) * contact.impulse;
                ++touching;
            }
        most = std::max(most, touching);
    });
    const Vec3 gained = mass * c.velocity(body);
    REQUIRE(c.world.advance(0.5).ok());
    const Vec3 wanted = mass * c.velocity(body) - gained + Vec3(0, 0, mass * g * (c.world.time() - before));
    CHECK(most > 5);
    CHECK((carried - wanted).norm() < 1e-6 * wanted.norm());
    CHECK(c.world.report().max_penetration == 0);
}

TEST_CASE("capsules and spheres come to rest on each other in a bucket", "[scene]") {
    Capsules c({.step_size = 5e-3});
    c.world.add_collider(Bucket{.radius = 0.45, .height = 0.6, .thickness = 0.02});
    std::vector<BodyHandle> bodies, balls;
    for (int k = 0; k < 6; ++k)
        bodies.push_back(c.add({0.05 * std::cos(k * 2.2), 0.05 * std::sin(k * 2.2), 0.2 + 0.3 * k},
                               {0.3 * k, pi / 2 + 0.1, 0.7 * k}));
    for (int k = 0; k < 2; ++k)
        balls.push_back(c.world.add_body(Sphere{radius}, c.placed({0.1, 0.1 * k, 2.1 + 0.3 * k}, Vec3::Zero())));
    for (int look = 0; look < 80; ++look) {
        REQUIRE(c.world.advance(0.05).ok());
        for (const BodyHandle body : bodies)
            for (const BodyHandle other : bodies)
                if (body.slot < other.slot) CHECK(c.apart(body, other) > 2 * radius);
    }
    for (const BodyHandle body : bodies) {
        CHECK(c.velocity(body).norm() < 5e-3);
        for (std::size_t k = 0; k < 2; ++k) CHECK(c.end(body, k).z() > radius);
    }
    CHECK(c.world.report().max_penetration < 1e-9);
}

TEST_CASE("a fast capsule goes through nothing, whatever way it turns", "[scene]") {
    for (const Real speed : {3.0, 30.0, 100.0}) {
        CAPTURE(speed);
        Capsules c(steps_of(1.0 / 120, Vec3::Zero()));
        c.world.add_collider(Box{{0.02, 2, 2}}, {.position = {1, 0, 0}});
        c.world.add_collider(Plane{.normal = {0, 0, 1}, .point = {0, 0, -1}});
        c.world.add_collider(mesh::boundary(mesh::box({0.02, 2, 2}, {1, 4, 4})),
                             {.position = {-1, 0, 0}, .contact_distance = kept});
        const BodyHandle a = c.add({0.3, 0.02, 0.01}, along_y, {speed, 0, 0}, {0, 0, 20}),
                         b = c.add({-0.3, 0.3, 0.01}, {1, 0, 0}, {-speed, 0, 0}, {10, 0, 20});
        REQUIRE(c.world.advance(0.5).ok());
        for (std::size_t k = 0; k < 2; ++k) {
            CHECK(c.end(a, k).x() < 1);
            CHECK(c.end(b, k).x() > -1);
        }
        CHECK(c.world.report().max_penetration < 1e-9);
        CHECK(c.world.report().crossed == 0);
    }
}

TEST_CASE("the drawn mesh of a capsule moves with it", "[scene]") {
    Capsules c(steps_of(1e-3, Vec3::Zero()));
    const Vec3 spin(0, 0, 3), tilt(0.3, 0, 0);
    const BodyHandle body = c.add({0, 0, 1}, Vec3::Zero(), {1, 0, 0}, spin);
    const std::vector<Vec3> before(c.world.positions(body).begin(), c.world.positions(body).end());
    for (const Vec3& x : before) {
        const Vec3 arm = x - Vec3(0, 0, 1), axis(0, 0, std::clamp(arm.z(), -length / 2, length / 2));
        const Real out = (arm - axis).norm();
        CHECK((out == 0 || out == Approx(radius).epsilon(1e-12)));
    }
    REQUIRE(c.world.advance(0.2).ok());
    const Mat3 turned = rotation_matrix(0.2 * spin);
    const std::span<const Vec3> now = c.world.positions(body), velocity = c.world.velocities(body);
    REQUIRE(now.size() > capsule_step_nodes);
    for (std::size_t n = 0; n < now.size(); ++n) {
        const Vec3 arm = turned * (before[n] - Vec3(0, 0, 1));
        CHECK((now[n] - (Vec3(0.2, 0, 1) + arm)).norm() < 1e-12);
        CHECK((velocity[n] - (Vec3(1, 0, 0) + spin.cross(arm))).norm() < 1e-12);
    }
}

TEST_CASE("rays and nearest points meet the capsule, not the faces that draw it", "[scene]") {
    Capsules c(steps_of(1e-3));
    const Vec3 at(1, 2, 3), rotation(0.4, -0.9, 0.3);
    const BodyHandle body = c.add(at, rotation);
    const Mat3 turned = rotation_matrix(rotation);
    const Vec3 aside = turned * Vec3(0.6, 0.8, 0), place = at + turned * Vec3(0, 0, 0.13);
    const auto hit = c.world.cast_ray(place + 2 * aside, -aside, 10);
    REQUIRE(hit);
    CHECK(hit->body == body);
    CHECK(hit->distance == Approx(2 - radius).epsilon(1e-13));
    CHECK((hit->normal - aside).norm() < 1e-12);
    const Vec3 beyond = turned * Vec3(0.6, 0, 0.8), end = at + turned * Vec3(0, 0, length / 2);
    const auto nearest = c.world.nearest_point(end + 0.5 * beyond, 10);
    REQUIRE(nearest);
    CHECK(nearest->distance == Approx(0.5 - radius).epsilon(1e-13));
    CHECK((nearest->point - (end + radius * beyond)).norm() < 1e-12);
}

TEST_CASE("capsules that overlap at the start are refused or moved apart", "[scene]") {
    Settings settings = steps_of(1e-3);
    settings.start_overlaps = StartOverlaps::refuse;
    const auto overlapping = [&](const Settings& with) {
        Capsules c(with);
        c.world.add_collider(Plane{});
        c.add({0, 0, 0.15}, along_x, Vec3::Zero(), Vec3::Zero(), "below");
        c.add({0, 0.02, 0.33}, along_y, Vec3::Zero(), Vec3::Zero(), "above");
        c.world.add_body(Sphere{radius}, c.placed({0.1, 0, 0.33}, Vec3::Zero()));
        return c;
    };
    Capsules refused = overlapping(settings);
    CHECK_THROWS_WITH(refused.world.advance(1e-3), Catch::Contains("above") && Catch::Contains("below"));
    settings.start_overlaps = StartOverlaps::resolve;
    Capsules moved = overlapping(settings);
    REQUIRE(moved.world.advance(1e-3).ok());
    const auto bodies = moved.world.bodies();
    CHECK(moved.apart(bodies[0], bodies[1]) > 2 * radius);
    // The capsule is in a collider with an end of its axis or with its middle.
    for (const bool middle : {false, true}) {
        Capsules c(settings);
        c.world.add_collider(Box{{0.1, 0.1, 1}}, {.position = {0, 0, -0.5}});
        const BodyHandle body =
            middle ? c.add({0, 0, radius - 0.01}, along_x) : c.add({0, 0, length / 2 + radius - 0.01}, Vec3::Zero());
        REQUIRE(c.world.advance(1e-4).ok());
        CHECK(c.end(body, 0).z() > (middle ? radius : radius - 1e-12));
        CHECK(c.world.report().max_penetration == 0);
    }
}

TEST_CASE("invalid settings of a capsule are refused by name", "[scene]") {
    Capsules c(steps_of(1e-3));
    using Catch::Contains;
    const auto add = [&](const Capsule& capsule, BodyDynamics dynamics, const std::string& name) {
        return c.world.add_body(capsule, {.material = c.material, .dynamics = dynamics, .name = name});
    };
    CHECK_THROWS_WITH(add({radius, length}, BodyDynamics::explicit_elastic, "soft"),
                      Contains("'soft'") && Contains("dynamics") && Contains("capsule"));
    CHECK_THROWS_WITH(add({0, length}, BodyDynamics::rigid, "thin"), Contains("'thin'") && Contains("radius"));
    CHECK_THROWS_WITH(add({radius, 0}, BodyDynamics::rigid, "short"),
                      Contains("'short'") && Contains("length") && Contains("sphere"));
    const BodyHandle body = c.add({0, 0, 0}, along_x, Vec3::Zero(), Vec3::Zero(), "log");
    const std::uint64_t before = c.world.state_hash();
    CHECK_THROWS_WITH(c.world.set_dynamics(body, BodyDynamics::explicit_elastic), Contains("'log'"));
    CHECK_THROWS_WITH(c.world.attach(body, std::vector<Index>{0, 1, 2, 3}),
                      Contains("the capsule 'log'") && Contains("replace the capsule by a collider"));
    CHECK(c.world.state_hash() == before);
}

TEST_CASE("a capsule that spins about its axis does not come to rest, one that lies does", "[scene]") {
    Settings settings = steps_of(1e-3, Vec3::Zero());
    settings.sleep_time = 0.01;
    Capsules c(settings, 0.5, 0, {.sleep_speed = 0.1});
    const BodyHandle spins = c.add({0, 0, 1}, along_x, Vec3::Zero(), {2, 0, 0}),
                     still = c.add({1, 0, 1}, along_y, Vec3::Zero(), {0, 0.2, 0});
    REQUIRE(c.world.advance(0.1).ok());
    CHECK(!c.world.asleep(spins));
    CHECK(c.world.asleep(still));
}

TEST_CASE("capsules have the same bits on any number of threads, cloned, and from a file", "[determinism]") {
    const auto simulate = [](int threads) {
        Settings settings = steps_of(5e-3);
        settings.backend = Backend::threads;
        settings.threads = threads;
        Capsules c(settings);
        c.world.add_collider(Plane{});
        c.world.add_collider(Box{{0.3, 0.3, 0.1}}, {.position = {0.3, 0, 0.05}});
        for (int k = 0; k < 5; ++k) c.add({0.13 * (k % 2), 0.04 * k, 0.22 + 0.25 * k}, {0.3 * k, 1.3, 0.7 * k});
        c.world.add_body(Sphere{radius}, c.placed({0, 0.1, 1.6}, Vec3::Zero()));
        c.world.add_body(mesh::box({0.3, 0.3, 0.1}, {4, 4, 1}), {.material = c.material, .position = {0, 0, 1.9}});
        REQUIRE(c.world.advance(0.3).ok());
        return c;
    };
    check_same_bits(simulate, [](World& world) { REQUIRE(world.advance(0.3).ok()); });
}

}  // namespace skerry::test::capsules_test
