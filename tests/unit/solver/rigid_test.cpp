// Contacts on rigid bodies (docs/methods/rigid_bodies.md 3).
#include <Eigen/Dense>
#include <array>
#include <catch2/catch.hpp>
#include <cmath>
#include <random>

#include "tests/support/contact_scene.h"

namespace skerry::test::solver_rigid_test {

namespace {

const Mat3 of_cube = 1.0 / 6 * Mat3::Identity();  // inertia of a cube of 1 kg with edges of 1 m [kg m^2]

/// The lower corners of a cube with edges of 1 m and centre `at`.
std::array<Vec3, 4> lower_corners(const Vec3& at) {
    return {at + Vec3(-0.5, -0.5, -0.5), at + Vec3(0.5, -0.5, -0.5), at + Vec3(-0.5, 0.5, -0.5),
            at + Vec3(0.5, 0.5, -0.5)};
}

/// A cube with four nodes at its lower corners.
Index add_cube(ContactScene& scene, const Vec3& at, Real mass, const Vec3& velocity, const Vec3& spin = Vec3::Zero()) {
    const std::array<Vec3, 4> places = lower_corners(at);
    Index first = no_index;
    for (const Vec3& place : places) {
        const Index node = scene.add_node(mass / 4, velocity + spin.cross(place - at));
        if (first == no_index) first = node;
    }
    scene.rigid.add(scene.inverse_mass.size(), first, places, at, mass, mass * of_cube);
    scene.rigid.momentum.back() = mass * velocity;
    scene.rigid.angular_momentum.back() = mass * of_cube * spin;
    return first;
}

/// Velocity of a node from the motion of its rigid body after the contact impulses.
Vec3 expected_velocity(const ContactScene& scene, const SolvedScene& solved, std::size_t r, Index node) {
    const RigidScene& rigid = scene.rigid;
    const Vec3 velocity = (rigid.momentum[r] + solved.contact_impulse[r]) / rigid.mass[r];
    const Vec3 spin = rigid.inverse_inertia[r] * (rigid.angular_momentum[r] + solved.contact_moment[r]);
    return velocity + spin.cross(rigid.position[static_cast<std::size_t>(node)] - rigid.center[r]);
}

void check_coulomb(const ContactScene& scene, const SolvedScene& solved, Real margin) {
    for (std::size_t i = 0; i < scene.stencil.size(); ++i) {
        const Vec3 u = scene.relative_velocity(i, solved.velocity), &r = solved.impulse[i], &n = scene.normal[i];
        const Vec3 slip = u - u.dot(n) * n, friction = r - r.dot(n) * n;
        const Real limit = scene.dynamic_friction[i] * r.dot(n);
        CHECK(u.dot(n) > -margin);
        CHECK(r.dot(n) >= -margin);
        CHECK(std::abs(r.dot(n) * u.dot(n)) < margin);
        CHECK(friction.norm() <= limit + margin);
        // Friction opposes the slip where the contact slides.
        CHECK((slip.norm() * friction + limit * slip).norm() < margin);
    }
}

}  // namespace

TEST_CASE("a rigid cube that lands flat stops", "[solver][rigid]") {
    ContactScene scene;
    const Index first = add_cube(scene, {0, 0, 0.5}, 2, {0, 0, -1});
    for (Index n = first; n < first + 4; ++n) scene.touch_floor(n, 0.3);
    const SolvedScene solved = scene.solve({.tolerance = 1e-12, .max_iterations = 5000});
    REQUIRE(solved.regions.size() == 1);
    CHECK((solved.contact_impulse[0] - Vec3(0, 0, 2)).norm() < 1e-10);
    CHECK(solved.contact_moment[0].norm() < 1e-10);
    for (Index n = first; n < first + 4; ++n) CHECK(solved.velocity[static_cast<std::size_t>(n)].norm() < 1e-10);
}

TEST_CASE("a rigid cube hit at a corner turns by its inertia", "[solver][rigid]") {
    ContactScene scene;
    scene.gravity = 0;
    const Index first = add_cube(scene, {0, 0, 0.5}, 1, {0, 0, -1});
    scene.touch_floor(first, 0);
    const SolvedScene solved = scene.solve({.tolerance = 1e-13});
    // 1/W = 1 / (1/m + |n x a|^2 / I)
    const Real effective = 1 / (1 + 0.5 * 6);
    CHECK(solved.impulse[0].z() == Approx(effective).epsilon(1e-10));
    CHECK((solved.contact_moment[0] - Vec3(-0.5, -0.5, -0.5).cross(Vec3(0, 0, effective))).norm() < 1e-10);
    CHECK(solved.velocity[0].z() == Approx(0).margin(1e-10));
}

TEST_CASE("contacts on rigid bodies obey Coulomb's law by every method", "[solver][rigid]") {
    for (const SolverMethod method :
         {SolverMethod::automatic, SolverMethod::pgs, SolverMethod::ags, SolverMethod::newton}) {
        CAPTURE(name_of(method));
        ContactScene scene;
        const Index lower = add_cube(scene, {0, 0, 0.5}, 1, {0.8, 0.3, -1}, {0.5, -0.3, 1});
        const Index upper = add_cube(scene, {0.2, 0.1, 1.5}, 3, {-0.3, 0.1, -1.5}, {0.1, 0.4, -0.6});
        const Index point = scene.add_node(0.2, {0, 0, 1});
        scene.rigid.node_body.resize(scene.inverse_mass.size(), 0);
        scene.rigid.position.resize(scene.inverse_mass.size(), Vec3(0.5, 0.5, 0));
        for (Index n = lower; n < lower + 4; ++n) scene.touch_floor(n, 0.4);
        // The upper corners touch three nodes of the lower cube, in the plane of its floor: any weights are valid.
        for (Index n = upper; n < upper + 4; ++n)
            scene.touch({{n, lower, lower + 1, lower + 2}, {1, -0.3, -0.3, -0.4}}, {0.05, 0, 1}, 0.3);
        scene.touch_node(point, lower + 3, {0.2, -0.1, -1}, 0.5);
        const SolvedScene solved = scene.solve({.method = method, .tolerance = 1e-9, .max_iterations = 20000});
        REQUIRE(solved.regions.size() == 1);
        CHECK(solved.regions.status[0] == RegionStatus::converged);
        check_coulomb(scene, solved, 1e-6);
        for (Index n = lower; n < lower + 4; ++n)
            CHECK((solved.velocity[static_cast<std::size_t>(n)] - expected_velocity(scene, solved, 0, n)).norm() <
                  1e-12);
        for (Index n = upper; n < upper + 4; ++n)
            CHECK((solved.velocity[static_cast<std::size_t>(n)] - expected_velocity(scene, solved, 1, n)).norm() <
                  1e-12);
        // The momentum that all bodies gain equals the impulse of the floor.
        Vec3 floor = Vec3::Zero();
        for (std::size_t i = 0; i < 4; ++i) floor += solved.impulse[i];
        const auto p = static_cast<std::size_t>(point);
        const Vec3 gained = solved.contact_impulse[0] + solved.contact_impulse[1] +
                            (solved.velocity[p] - scene.velocity[p]) / scene.inverse_mass[p];
        CHECK((gained - floor).norm() < 1e-12);
        // Contacts dissipate energy.
        CHECK(solved.regions.dissipated[0] > 0);
    }
}

TEST_CASE("Newton steps solve towers of rigid bodies and nodes that sweeps do not", "[solver][rigid]") {
    ContactScene scene;
    Index below = no_index;
    for (int k = 0; k < 12; ++k) {
        const Index cube = add_cube(scene, {0.01 * k, 0, 0.5 + k}, 1, {0.02, 0.001 * k, -0.1});
        for (Index n = 0; n < 4; ++n) {
            if (below == no_index)
                scene.touch_floor(cube + n, 0.4);
            else
                scene.touch_node(cube + n, below + n, {0, 0, 1}, 0.4);
        }
        below = cube;
    }
    const Index point = scene.add_node(0.2, {0, 0, -0.3});
    scene.rigid.node_body.resize(scene.inverse_mass.size(), 0);
    scene.rigid.position.resize(scene.inverse_mass.size(), Vec3(0.5, 0.5, 12));
    scene.touch_node(point, below + 3, {0.1, 0, 1}, 0.4);

    const SolvedScene swept = scene.solve({.method = SolverMethod::ags, .tolerance = 1e-8, .max_iterations = 300});
    REQUIRE(swept.regions.size() == 1);
    CHECK(swept.regions.status[0] == RegionStatus::iteration_limit);
    const SolvedScene solved = scene.solve({.tolerance = 1e-8, .max_iterations = 300});
    CHECK(solved.regions.status[0] == RegionStatus::converged);
    CHECK(solved.regions.error[0] <= 1e-8);
    check_coulomb(scene, solved, 1e-5);
}

TEST_CASE("a heavy rigid body and a light node join no regions beyond themselves", "[solver][rigid]") {
    ContactScene scene;
    const Index cube = add_cube(scene, {0, 0, 0.5}, 1, {0, 0, -1});
    const Index far = scene.add_node(1, {0, 0, -1}), near = scene.add_node(1, {0, 0, 2});
    scene.rigid.node_body.resize(scene.inverse_mass.size(), 0);
    scene.rigid.position.resize(scene.inverse_mass.size(), Vec3::Zero());
    scene.touch_floor(cube, 0.3);
    scene.touch_floor(far, 0.3);
    scene.touch_node(cube + 3, near, {0, 0, 1}, 0.3);
    const SolvedScene solved = scene.solve();
    CHECK(solved.regions.size() == 2);
}

TEST_CASE("regions without a rigid body keep their bits beside one", "[solver][rigid]") {
    ContactScene scene;
    for (int n = 0; n < 8; ++n) scene.add_node(1, {0.2, 0.1 * n, -1});
    for (Index n = 0; n + 1 < 8; n += 2) scene.touch_node(n, n + 1, {0, 0.1, n % 4 == 0 ? 1.0 : -1.0}, 0.3);
    for (Index n = 0; n < 8; ++n) scene.touch_floor(n, 0.3);
    const SolvedScene plain = scene.solve();
    const Index cube = add_cube(scene, {0, 0, 0.5}, 1, {0, 0, -1});
    scene.touch_floor(cube, 0.3);
    const SolvedScene solved = scene.solve();
    REQUIRE(solved.regions.size() == plain.regions.size() + 1);
    for (std::size_t n = 0; n < 8; ++n) CHECK(plain.velocity[n] == solved.velocity[n]);
}

TEST_CASE("a rigid body that is pressed in is pushed out as a whole", "[solver][rigid]") {
    ContactScene scene;
    scene.h = 1e-2;
    const Index first = add_cube(scene, {0, 0, 0.4}, 1, Vec3::Zero());
    for (Index n = first; n < first + 4; ++n) scene.gap[scene.touch_floor(n, 0.3)] = -0.1;
    const SolvedScene solved = scene.solve({.tolerance = 1e-8, .max_iterations = 5000});
    CHECK(solved.push_velocity[0].z() > 0.01);
    CHECK(solved.push_velocity[0].head<2>().norm() < 1e-6);
    CHECK(solved.push_spin[0].norm() < 1e-5);
    CHECK(solved.velocity[0].norm() < 1e-12);
}

}  // namespace skerry::test::solver_rigid_test
