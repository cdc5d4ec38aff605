// Rigid cylinders, whose contact shape has flat ends and sharp rims (docs/methods/rigid_bodies.md 6.3).
#include <Eigen/Dense>
#include <Eigen/Geometry>
#include <catch2/catch.hpp>

#include "skerry/query.h"
#include "systems/geometry/rotation.h"
#include "tests/support/cylinders.h"
#include "tests/support/same_bits.h"

namespace skerry::test::cylinders_test {

using namespace skerry::test::cylinders;
using capsules::box, capsules::mesh_collider, capsules::plane, capsules::rigid_slab;

namespace {

constexpr Floor floors[] = {plane, box, mesh_collider, rigid_slab};

}  // namespace

TEST_CASE("a cylinder has the mass and the moments of the solid, not of its drawn mesh", "[scene]") {
    for (const Vec3& rotation : {Vec3(0, 0, 0), Vec3(0.3, -1.2, 0.7)}) {
        Cylinders c(steps_of(1e-2, Vec3::Zero()));
        const Mat3 turned = rotation_matrix(rotation);
        const BodyHandle body = c.add({0, 0, 1}, rotation, {1, 2, 3}, turned * Vec3(4, 5, 6));
        CHECK(c.world.mass(body) == Approx(mass).epsilon(1e-12));
        CHECK((c.world.center_of_mass(body) - Vec3(0, 0, 1)).norm() < 1e-14);
        const RigidBodyTable& table = WorldAccess::state_of(c.world).model.rigid_bodies;
        CHECK(table.moments[c.row(body)].x() == Approx(across).epsilon(1e-12));
        CHECK(table.moments[c.row(body)].y() == Approx(across).epsilon(1e-12));
        CHECK(table.moments[c.row(body)].z() == Approx(axial).epsilon(1e-12));
        CHECK(c.world.energy().kinetic == Approx(mass * 14 / 2 + (across * (16 + 25) + axial * 36) / 2).epsilon(1e-12));
        MaterialSettings heavier = c.world.material(c.material);
        heavier.density *= 2;
        c.world.set_material(c.material, heavier);
        CHECK(c.world.mass(body) == Approx(2 * mass).epsilon(1e-12));
        CHECK(table.moments[c.row(body)].x() == Approx(2 * across).epsilon(1e-12));
    }
}

TEST_CASE("a cylinder stands on its end and lies on its side", "[scene]") {
    for (const Floor floor : floors)
        for (const Vec3& rotation : {Vec3(0, 0, 0), Vec3(pi, 0, 0), along_y, along_x}) {
            CAPTURE(floor, rotation.transpose());
            Cylinders c(steps_of(5e-3));
            const bool stands = rotation == Vec3::Zero() || rotation.x() == pi;
            const Vec3 at(0.07, 0.03, (stands ? height / 2 : radius) + add_floor(c, floor));
            const BodyHandle body = c.add(at, rotation);
            const Vec3 axis = c.axis(body);
            REQUIRE(c.world.advance(1).ok());
            CHECK((c.middle(body) - at).norm() < 1e-9);
            CHECK((c.axis(body) - axis).norm() < 1e-9);
            CHECK(c.velocity(body).norm() + c.spin(body).norm() < 1e-9);
            Vec3 sum = Vec3::Zero(), moment = Vec3::Zero();
            for (const Contact& contact : c.world.contacts()) {
                const Vec3 impulse = (contact.first == body ? 1 : -1) * contact.impulse;
                sum += impulse;
                const Vec3 point =
                    contact.first == body ? Vec3(contact.point + contact.distance * contact.normal) : contact.point;
                moment += (point - c.middle(body)).cross(impulse);
                CHECK(std::abs(c.distance(body, point)) < 1e-9);
            }
            const Real weight = mass * g * 5e-3;
            CHECK((sum - Vec3(0, 0, weight)).norm() < 1e-8 * weight);
            CHECK(moment.norm() < 1e-7 * weight * height);
            CHECK(c.world.report().crossings_found == 0);
        }
}

TEST_CASE("a cylinder slides on its end as Coulomb's law has it, and stays below the angle of friction", "[scene]") {
    constexpr Real degrees = 15, seconds = 0.5;
    const Real slope = degrees * pi / 180;
    for (const Floor floor : floors)
        for (const Real mu : {0.1, 0.3}) {
            CAPTURE(floor, mu);
            Cylinders c(steps_of(5e-3, tilted_gravity(degrees)), mu);
            const Real z = height / 2 + add_floor(c, floor);
            const BodyHandle body = c.add({-1, 0.03, z}, {0, 0, 0.2});
            REQUIRE(c.world.advance(seconds).ok());
            const Real law = std::max(0.0, g * (std::sin(slope) - mu * std::cos(slope)) * seconds);
            CHECK(c.velocity(body).x() == Approx(law).epsilon(1e-8).margin(1e-9));
            CHECK(c.middle(body).z() == Approx(z).epsilon(1e-9));
            CHECK(c.spin(body).norm() < 1e-7);
        }
}

TEST_CASE("a cylinder rolls down a slope at two thirds of its pull, without a bump", "[scene][long]") {
    constexpr Real degrees = 10, seconds = 0.5;
    const Real law = 2.0 / 3 * g * std::sin(degrees * pi / 180) * seconds;
    for (const Floor floor : floors) {
        CAPTURE(floor);
        Cylinders c(steps_of(5e-3, tilted_gravity(degrees)));
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

TEST_CASE("a cylinder that rolls on its side keeps its speed for ten turns", "[scene][long]") {
    constexpr Real speed = 3;
    for (const Floor floor : {plane, box, mesh_collider}) {
        CAPTURE(floor);
        Cylinders c(steps_of(1.0 / 120));
        const Real distance = 20 * pi * radius;
        Real z = radius + kept / 2;
        if (floor == plane) c.world.add_collider(Plane{});
        if (floor == box) c.world.add_collider(Box{{10, 1, 0.2}}, {.position = {0, 0, -0.1}});
        if (floor == mesh_collider) {
            c.world.add_collider(mesh::boundary(mesh::box({10, 1, 0.2}, {97, 11, 1})),
                                 {.position = {0, 0, -0.1}, .contact_distance = kept});
            z = radius + kept;
        }
        const BodyHandle body = c.add({-4, 0.03, z}, along_y, {speed, 0, 0}, {0, speed / radius, 0});
        Real highest = 0;
        for (int look = 0; look * 0.05 < distance / speed; ++look) {
            REQUIRE(c.world.advance(0.05).ok());
            highest = std::max(highest, std::abs(c.middle(body).z() - z));
        }
        const Real energy = c.world.energy().kinetic, whole = 0.75 * mass * speed * speed;
        INFO("lost " << 1 - energy / whole);
        CHECK(std::abs(1 - energy / whole) < 1e-9);
        CHECK(highest < 1e-9);
    }
}

TEST_CASE("a cylinder tips over its rim where its middle has passed the rim", "[scene][long]") {
    // On a slope too rough for sliding it tips over from tan(a) = 2 r / height on.
    const Real falls = std::atan(2 * radius / height) * 180 / pi;
    for (const Floor floor : floors)
        for (const Real turn : {0.0, 0.3, pi / 8})  // angles of the rim points that are lowest
            for (const Real beyond : {-0.1, 0.1}) {
                CAPTURE(floor, turn, beyond);
                Cylinders c(steps_of(5e-3, tilted_gravity(falls + beyond)), 2);
                const BodyHandle body = c.add({-1, 0.03, height / 2 + add_floor(c, floor)}, {0, 0, turn});
                REQUIRE(c.world.advance(beyond < 0 ? 1 : 2).ok());
                if (beyond < 0)  // it stands on rim points at 45 degrees until the lowest one carries
                    CHECK(c.axis(body).head<2>().norm() < 1e-4);
                else
                    CHECK(c.axis(body).z() < 0.9);
            }
}

TEST_CASE("cylinders stand on each other, and on a box, and lie in a row", "[scene]") {
    for (const Vec3& aside : {Vec3(0, 0, 0), Vec3(0.04, 0.02, 0)}) {
        CAPTURE(aside.transpose());
        Cylinders c(steps_of(5e-3));
        c.world.add_collider(Plane{});
        c.world.add_collider(Box{{0.15, 0.15, 0.2}}, {.position = {2, 0, 0.1}});
        std::vector<BodyHandle> stack;
        std::vector<Vec3> at;
        for (int k = 0; k < 4; ++k) {
            at.push_back(Vec3(0, 0, kept / 2 + height / 2 + k * (height + kept)) + (k % 2) * aside);
            stack.push_back(c.add(at.back(), {0, 0, 0.4 * k}));
        }
        at.emplace_back(2.03, 0.01, 0.2 + kept / 2 + height / 2);  // wider than the box at two sides
        stack.push_back(c.add(at.back(), {0, 0, 0.1}));
        at.emplace_back(4, 0, radius + kept / 2);
        stack.push_back(c.add(at.back(), along_y));
        at.emplace_back(4, 0.05, radius + kept / 2 + 2 * radius + kept);
        stack.push_back(c.add(at.back(), along_x));
        REQUIRE(c.world.advance(0.5).ok());
        for (std::size_t k = 0; k < stack.size(); ++k) {
            CAPTURE(k);
            CHECK((c.middle(stack[k]) - at[k]).norm() < (k + 1 == stack.size() ? 1e-6 : 1e-8));
        }
        CHECK(c.world.report().max_penetration == 0);
    }
}

TEST_CASE("a cylinder lies in a groove, against a wall and in a bucket", "[scene][long]") {
    Cylinders c(steps_of(5e-3), 0.2);
    c.world.add_collider(Bucket{.radius = 0.5, .height = 0.6, .thickness = 0.02});
    std::vector<BodyHandle> bodies;
    for (int k = 0; k < 6; ++k)
        bodies.push_back(
            c.add({0.05 * std::cos(k * 2.2), 0.05 * std::sin(k * 2.2), 0.25 + 0.4 * k}, {0.3 * k, 1.3, 0.7 * k}));
    const BodyHandle ball = c.world.add_body(Sphere{radius}, c.placed({0.1, 0.1, 2.9}, Vec3::Zero()));
    const BodyHandle capsule = c.world.add_body(Capsule{radius, 0.2}, c.placed({0, 0.1, 3.3}, along_x));
    for (int look = 0; look < 80; ++look) {
        REQUIRE(c.world.advance(0.05).ok());
        CHECK(c.world.report().max_penetration < 1e-9);
        for (const BodyHandle body : bodies) CHECK(c.distance(body, c.world.positions(ball)[0]) > radius - 1e-9);
    }
    for (const BodyHandle body : bodies) {
        CHECK(c.velocity(body).norm() < 5e-3);
        CHECK(c.lowest(body) > 0);
        CHECK(c.middle(body).head<2>().norm() < 0.5);
    }
    CHECK(c.world.positions(capsule)[0].z() > radius);
}

TEST_CASE("a cylinder thrown against another, a sphere, a capsule or a block keeps momentum and energy", "[scene]") {
    enum Target { end_on, crossed, beside, sphere, capsule, block };
    for (const Target target : {end_on, crossed, beside, sphere, capsule, block}) {
        CAPTURE(target);
        Cylinders c(steps_of(1e-3, Vec3::Zero()), 0, 1);
        const BodyHandle thrown = c.add({-1.5, 0, 0}, target == end_on ? along_x : along_y, {2, 0, 0});
        BodyHandle still;
        Real reach = 0;
        if (target == sphere) still = c.world.add_body(Sphere{radius}, c.placed({0, 0, 0}, Vec3::Zero()));
        if (target == capsule) still = c.world.add_body(Capsule{radius, 0.3}, c.placed({0, 0, 0}, Vec3::Zero()));
        if (target == block)
            still = c.world.add_body(mesh::box({0.2, 0.3, 0.3}, {1, 3, 3}), c.placed({0, 0, 0}, Vec3::Zero()));
        if (target == end_on) still = c.add({0, 0, 0}, along_x);
        if (target == crossed) still = c.add({0, 0, 0}, Vec3::Zero());
        if (target == beside) still = c.add({0, 0, 0}, along_y);
        reach = target == end_on ? height : 2 * radius;
        const Real arrives = (1.5 - reach - kept) / 2;
        REQUIRE(c.world.advance(arrives - 2e-3).ok());
        CHECK(c.velocity(thrown).x() == Approx(2));
        REQUIRE(c.world.advance(0.1).ok());
        const Real heavy = c.world.mass(still), joint = 2 * mass / (mass + heavy);
        CHECK((c.velocity(still) - 2 * joint * Vec3::UnitX()).norm() < 1e-7);
        CHECK(c.spin(thrown).norm() < 1e-6);
        CHECK(c.world.report().max_penetration == 0);
        CHECK(c.world.report().momentum_error < 1e-12);
    }
}

TEST_CASE("friction between cylinders keeps the angular momentum", "[scene]") {
    Cylinders c(steps_of(1e-3, Vec3::Zero()), 0.3);
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

TEST_CASE("a soft block holds a cylinder that stands and one that lies on it, and does not come into them",
          "[scene][long]") {
    for (const Vec3& rotation : {Vec3(0.05, 0, 0.3), Vec3(0.2, pi / 2, 0.3)}) {
        CAPTURE(rotation.transpose());
        Cylinders c({.step_size = 1e-3});
        c.world.add_collider(Plane{});
        const auto soft = c.world.add_material(
            {.young_modulus = 2e4, .poisson_ratio = 0.3, .density = 500, .friction = 0.5, .damping = 5});
        const BodyHandle pad =
            c.world.add_body(mesh::box({0.8, 0.6, 0.2}, {12, 9, 3}),
                             {.material = soft, .position = {0, 0, 0.1005}, .contact_distance = kept});
        const BodyHandle body = c.add({0.013, 0.007, 0.2 + (rotation.y() > 1 ? radius + 0.04 : 0.17)}, rotation);
        for (int look = 0; look < 60; ++look) {
            REQUIRE(c.world.advance(0.025).ok());
            Real nearest = 1;
            const auto x = c.world.positions(pad);
            for (const auto& face : c.world.surface(pad))
                for (int i = 0; i <= 6; ++i)
                    for (int k = 0; i + k <= 6; ++k) {
                        const Vec3 p =
                            (i * x[static_cast<std::size_t>(face[0])] + k * x[static_cast<std::size_t>(face[1])] +
                             (6 - i - k) * x[static_cast<std::size_t>(face[2])]) /
                            6;
                        nearest = std::min(nearest, c.distance(body, p));
                    }
            CHECK(nearest > 0);
        }
        Vec3 carried = Vec3::Zero();
        const Real before = c.world.time();
        c.world.watch_steps([&](const StepReport&) {
            for (const Contact& contact : c.world.contacts())
                if (contact.first == body || contact.second == body)
                    carried += (contact.first == body ? 1 : -1) * contact.impulse;
        });
        const Vec3 gained = mass * c.velocity(body);
        REQUIRE(c.world.advance(0.5).ok());
        const Vec3 wanted = mass * c.velocity(body) - gained + Vec3(0, 0, mass * g * (c.world.time() - before));
        CHECK((carried - wanted).norm() < 1e-6 * wanted.norm());
        CHECK(c.world.report().max_penetration == 0);
    }
}

TEST_CASE("the drawn mesh of a cylinder moves with it", "[scene]") {
    Cylinders c(steps_of(1e-3, Vec3::Zero()));
    const Vec3 spin(0, 0, 3);
    const BodyHandle body = c.add({0, 0, 1}, Vec3::Zero(), {1, 0, 0}, spin);
    const std::vector<Vec3> before(c.world.positions(body).begin(), c.world.positions(body).end());
    for (const Vec3& x : before) CHECK(c.distance(body, x) < 1e-15);
    REQUIRE(c.world.advance(0.2).ok());
    const Mat3 turned = rotation_matrix(0.2 * spin);
    for (std::size_t n = 0; n < before.size(); ++n) {
        const Vec3 arm = turned * (before[n] - Vec3(0, 0, 1));
        CHECK((c.world.positions(body)[n] - (Vec3(0.2, 0, 1) + arm)).norm() < 1e-12);
        CHECK((c.world.velocities(body)[n] - (Vec3(1, 0, 0) + spin.cross(arm))).norm() < 1e-12);
    }
}

TEST_CASE("rays and nearest points meet the cylinder, not the faces that draw it", "[scene]") {
    Cylinders c(steps_of(1e-3));
    const Vec3 at(1, 2, 3), rotation(0.4, -0.9, 0.3);
    const BodyHandle body = c.add(at, rotation);
    const Mat3 turned = rotation_matrix(rotation);
    const Vec3 aside = turned * Vec3(std::cos(0.13), std::sin(0.13), 0), place = at + turned * Vec3(0, 0, 0.1);
    const auto hit = c.world.cast_ray(place + 2 * aside, -aside, 10);
    REQUIRE(hit);
    CHECK(hit->body == body);
    CHECK(hit->distance == Approx(2 - radius).epsilon(1e-13));
    CHECK((hit->normal - aside).norm() < 1e-12);
    const auto nearest = c.world.nearest_point(at + turned * Vec3(0, 0.03, 0.5), 10);
    REQUIRE(nearest);
    CHECK(nearest->distance == Approx(0.5 - height / 2).epsilon(1e-13));
}

TEST_CASE("cylinders that overlap at the start are refused or moved apart", "[scene]") {
    Settings settings = steps_of(1e-3);
    settings.start_overlaps = StartOverlaps::refuse;
    const auto overlapping = [&](const Settings& with) {
        Cylinders c(with);
        c.world.add_collider(Plane{});
        c.add({0, 0, 0.16}, Vec3::Zero(), Vec3::Zero(), Vec3::Zero(), "below");
        c.add({0, 0.02, 0.43}, Vec3::Zero(), Vec3::Zero(), Vec3::Zero(), "above");
        c.world.add_body(Sphere{radius}, c.placed({0.17, 0, 0.15}, Vec3::Zero()));
        return c;
    };
    Cylinders refused = overlapping(settings);
    CHECK_THROWS_WITH(refused.world.advance(1e-3), Catch::Contains("above") && Catch::Contains("below"));
    settings.start_overlaps = StartOverlaps::resolve;
    Cylinders moved = overlapping(settings);
    REQUIRE(moved.world.advance(1e-3).ok());
    const auto bodies = moved.world.bodies();
    CHECK(moved.middle(bodies[1]).z() - moved.middle(bodies[0]).z() > height - 1e-9);
    CHECK(moved.distance(bodies[0], moved.world.positions(bodies[2])[0]) > radius - 1e-9);
    CHECK(moved.lowest(bodies[0]) > 0);
}

TEST_CASE("a peg goes into a hole with a clearance of a hundredth of its radius, of whatever it is", "[scene]") {
    constexpr Real clearance = radius / 100, wall = 0.05;
    for (const bool bucket : {true, false}) {
        CAPTURE(bucket);
        Cylinders c(steps_of(2e-3), 0.1);
        if (bucket) {
            c.world.add_collider(Bucket{radius + clearance, 0.2, wall}, {});
        } else {
            for (const Real side : {-1.0, 1.0}) {
                const Real at = side * (radius + clearance + wall);
                c.world.add_collider(Box{{2 * wall, 1, 0.2}}, {.position = {at, 0, 0.1}});
                c.world.add_collider(mesh::boundary(mesh::box({2 * (radius + clearance), 2 * wall, 0.2}, {3, 2, 4})),
                                     {.position = {0, at, 0.1}, .contact_distance = 1e-4});
            }
            c.world.add_collider(Plane{});
        }
        BodySettings peg = c.placed({0, 0, 0.22 + height / 2}, Vec3::Zero());
        peg.contact_distance = 1e-4;
        const BodyHandle body = c.world.add_body(Cylinder{radius, height}, peg);
        REQUIRE(c.world.advance(1.5).ok());
        CHECK(c.lowest(body) < 1e-3);
        CHECK(c.lowest(body) > 0);
        CHECK(c.world.report().max_penetration == 0);
    }
}

TEST_CASE("invalid settings of a cylinder are refused by name", "[scene]") {
    Cylinders c(steps_of(1e-3));
    using Catch::Contains;
    const auto add = [&](const Cylinder& cylinder, BodyDynamics dynamics, const std::string& name) {
        return c.world.add_body(cylinder, {.material = c.material, .dynamics = dynamics, .name = name});
    };
    CHECK_THROWS_WITH(add({radius, height}, BodyDynamics::explicit_elastic, "soft"),
                      Contains("'soft'") && Contains("dynamics") && Contains("cylinder"));
    CHECK_THROWS_WITH(add({0, height}, BodyDynamics::rigid, "thin"), Contains("'thin'") && Contains("radius"));
    CHECK_THROWS_WITH(add({radius, 0}, BodyDynamics::rigid, "flat"), Contains("'flat'") && Contains("height"));
    CHECK_THROWS_WITH(add({radius, std::nan("")}, BodyDynamics::rigid, "odd"), Contains("'odd'") && Contains("height"));
    const BodyHandle body = c.add({0, 0, 0}, along_x, Vec3::Zero(), Vec3::Zero(), "can");
    const std::uint64_t before = c.world.state_hash();
    CHECK_THROWS_WITH(c.world.set_dynamics(body, BodyDynamics::explicit_elastic), Contains("'can'"));
    CHECK_THROWS_WITH(c.world.attach(body, std::vector<Index>{0, 1, 2, 3}),
                      Contains("the cylinder 'can'") && Contains("replace the cylinder by a collider"));
    CHECK(c.world.state_hash() == before);
}

TEST_CASE("cylinders have the same bits on any number of threads, cloned, and from a file", "[determinism][long]") {
    const auto simulate = [](int threads) {
        Settings settings = steps_of(5e-3);
        settings.backend = Backend::threads;
        settings.threads = threads;
        Cylinders c(settings);
        c.world.add_collider(Plane{});
        c.world.add_collider(Box{{0.3, 0.3, 0.1}}, {.position = {0.3, 0, 0.05}});
        for (int k = 0; k < 5; ++k) c.add({0.13 * (k % 2), 0.04 * k, 0.32 + 0.4 * k}, {0.3 * k, 1.3, 0.7 * k});
        c.world.add_body(Sphere{radius}, c.placed({0, 0.1, 2.4}, Vec3::Zero()));
        c.world.add_body(mesh::box({0.3, 0.3, 0.1}, {4, 4, 1}), {.material = c.material, .position = {0, 0, 2.7}});
        REQUIRE(c.world.advance(0.3).ok());
        return c;
    };
    check_same_bits(simulate, [](World& world) { REQUIRE(world.advance(0.3).ok()); });
}

}  // namespace skerry::test::cylinders_test
