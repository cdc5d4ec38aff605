// Cost and effect of the crossing test of a step's motion, in addition to the shots of tunnelling_test.cpp.
#include <catch2/catch.hpp>

#include "jobs/executor.h"
#include "tests/support/surfaces_cross.h"
#include "tests/support/worlds.h"

namespace skerry::test::crossing_test {

namespace {

Settings weightless() {
    Settings settings;
    settings.gravity = Vec3::Zero();
    return settings;
}

SurfaceView surface_of(const World& world, BodyHandle body) {
    return {world.positions(body), world.surface(body)};
}

std::vector<Index> rim_of(const Mesh& sheet) {
    Real half = 0;
    for (const Vec3& x : sheet.nodes) half = std::max(half, x.x());
    std::vector<Index> rim;
    for (std::size_t n = 0; n < sheet.nodes.size(); ++n)
        if (std::max(std::abs(sheet.nodes[n].x()), std::abs(sheet.nodes[n].y())) > 0.999 * half)
            rim.push_back(static_cast<Index>(n));
    return rim;
}

}  // namespace

TEST_CASE("a scene without fast pairs never tests the motion of a feature", "[scene][long]") {
    World world;
    const auto rubber = world.add_material({.young_modulus = 3e4, .friction = 0.5, .damping = 20});
    world.add_collider(Plane{});
    const Mesh ball = mesh::ball(0.05, 6);
    // Shells 2 mm thick and falls of 1 mm: the balls meet at 0.15 m/s and move less than 0.1 mm a step.
    for (int i = 0; i < 6; ++i)
        world.add_body(ball, {.material = rubber,
                              .position = {0.103 * (i % 3), 0.0, 0.052 + 0.104 * (i / 3)},
                              .contact_distance = 0.002});
    REQUIRE(world.advance(0.5).ok());  // later the upper balls roll down
    const WorldReport report = world.report();
    CHECK(report.max_contacts > 20);
    CHECK(report.crossing_tests == 0);
    CHECK(report.retried == 0);
}

TEST_CASE("a sheet pinched hard between two balls stays between them", "[scene]") {
    World world(weightless());
    const auto rubber = world.add_material({.young_modulus = 2e5, .poisson_ratio = 0.3, .damping = 50});
    const auto soft = world.add_material({.young_modulus = 5e4, .poisson_ratio = 0.3, .damping = 50});
    const Mesh thin = mesh::box({0.2, 0.2, 0.004}, {8, 8, 1});
    const auto sheet = world.add_body(thin, {.material = soft, .name = "sheet"});
    world.attach(sheet, rim_of(thin));
    const Mesh round = mesh::ball(0.04, 4);
    std::vector<BodyHandle> balls;
    for (Real side : {-1.0, 1.0}) {
        balls.push_back(world.add_body(
            round, {.material = rubber, .position = {0.003 * side, 0.002, 0.045 * side}, .name = "ball"}));
        std::vector<Index> cap;
        for (std::size_t n = 0; n < round.nodes.size(); ++n)
            if (side * round.nodes[n].z() > 0.02) cap.push_back(static_cast<Index>(n));
        // The caps stop 5 mm from where the balls would touch flat: both are squeezed to a half.
        world.attach(balls.back(), cap, {.velocity = {0, 0, -0.1 * side}});
    }
    int contacts = 0;
    for (int frame = 0; frame < 30; ++frame) {
        REQUIRE(world.advance(0.01).ok());
        for (BodyHandle ball : balls) CHECK(crossings(surface_of(world, ball), surface_of(world, sheet)) == 0);
        CHECK(crossings(surface_of(world, balls[0]), surface_of(world, balls[1])) == 0);
        contacts = std::max(contacts, static_cast<int>(world.contacts().size()));
    }
    CHECK(contacts > 10);
    CHECK(world.report().crossed == 0);
    CHECK(world.center_of_mass(balls[0]).z() < world.center_of_mass(balls[1]).z() - 0.03);
}

TEST_CASE("a body put half into another leaves it about as slowly as it is pushed", "[scene][long]") {
    Settings settings = weightless();
    settings.start_overlaps = StartOverlaps::ignore;
    World world(settings);
    const auto rubber = world.add_material({.young_modulus = 1e5, .poisson_ratio = 0.3});
    const auto lower = world.add_body(mesh::box({0.1, 0.1, 0.1}, {4, 4, 4}), {.material = rubber, .name = "lower"});
    // More than half of the upper body is inside, with its corners between the nodes of the lower one.
    const auto upper = world.add_body(mesh::box({0.04, 0.04, 0.04}, {2, 2, 2}),
                                      {.material = rubber, .position = {0.003, 0.004, 0.045}, .name = "upper"});
    REQUIRE(crossings(surface_of(world, lower), surface_of(world, upper)) > 0);
    Real most = 0;
    for (int frame = 0; frame < 700; ++frame) {
        REQUIRE(world.advance(0.01).ok());
        const Energy energy = world.energy();
        most = std::max(most, energy.kinetic + energy.elastic);
    }
    CHECK(crossings(surface_of(world, lower), surface_of(world, upper)) == 0);
    CHECK(world.center_of_mass(upper).z() > 0.069);  // it has left through the nearest face
    // The push moves positions only, at a hundredth of recovery_speed without gravity: 5 mm/s. The bodies spring back
    // from the bending. This is all of the energy, and less than both would have at twice that speed.
    const Vec3 before = world.center_of_mass(upper);
    REQUIRE(world.advance(0.01).ok());
    CHECK((world.center_of_mass(upper) - before).norm() < 0.01 * 0.01);
    CHECK(most < 0.5 * (world.mass(upper) + world.mass(lower)) * 0.01 * 0.01);
}

TEST_CASE("steps that are tried again are the same bits on any number of workers", "[scene][determinism]") {
    std::vector<std::uint64_t> hashes;
    for (int workers : {1, 2, 4}) {
        Settings settings = weightless();
        settings.threads = workers;
        World world(settings);
        const auto soft = world.add_material({.young_modulus = 1e5, .poisson_ratio = 0.3});
        const auto hard = world.add_material({.young_modulus = 1e7, .poisson_ratio = 0.3});
        const Mesh thin = mesh::box({0.2, 0.2, 0.004}, {10, 10, 1});
        for (int i = 0; i < 3; ++i) {
            const auto sheet = world.add_body(thin, {.material = soft, .position = {0.3 * i, 0, 0}});
            world.attach(sheet, rim_of(thin));
            world.add_body(mesh::box({0.03, 0.03, 0.03}, {2, 2, 2}), {.material = hard,
                                                                      .position = {0.3 * i, 0.01 * i, 0.03},
                                                                      .rotation = {0.5, 0.3 * i, 0.2},
                                                                      .velocity = {0, 3, -40}});
        }
        REQUIRE(world.advance(0.004).ok());
        CHECK(world.report().retried > 0);
        CHECK(world.report().crossed == 0);
        hashes.push_back(world.state_hash());
    }
    CHECK(hashes[0] == hashes[1]);
    CHECK(hashes[0] == hashes[2]);
}

}  // namespace skerry::test::crossing_test
