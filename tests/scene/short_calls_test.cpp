// Forces of calls of advance of any length: right, or marked as not measured.
#include <catch2/catch.hpp>

#include "tests/support/worlds.h"

namespace skerry::test::short_calls_test {

namespace {

/// A bar whose left end is held.
struct Bar {
    World world;
    BodyHandle bar;
    AttachmentHandle held;

    explicit Bar(BodyDynamics dynamics, Real young_modulus, const Motion& motion = {}) {
        const auto material = world.add_material({.young_modulus = young_modulus, .poisson_ratio = 0.3});
        bar = world.add_body(mesh::box({1, 0.1, 0.1}, {10, 1, 1}), {.material = material, .dynamics = dynamics});
        std::vector<Index> root;
        for (std::size_t n = 0; n < world.positions(bar).size(); ++n)
            if (world.positions(bar)[n].x() < -0.499) root.push_back(static_cast<Index>(n));
        held = world.attach(bar, root, motion);
        world.measure_forces(true);
    }
};

bool is_nan(const Vec3& v) {
    return v.array().isNaN().all();
}

constexpr Real lengths[] = {1e-3, 1e-4, 1e-5, 1e-6, 1e-7, 1e-8, 1e-9, 1e-11, 1e-13};

}  // namespace

TEST_CASE("the reaction of a swinging bar is right after calls of any length", "[scene]") {
    struct Case {
        BodyDynamics dynamics;
        Real young_modulus;
    };
    // The softer bar bends so far that Newton's method solves the steps of the implicit body.
    for (const Case& test_case : {Case{BodyDynamics::explicit_elastic, 1e6}, Case{BodyDynamics::implicit_elastic, 1e6},
                                  Case{BodyDynamics::implicit_elastic, 1e8}}) {
        INFO(name_of(test_case.dynamics) << " " << test_case.young_modulus);
        Bar bar(test_case.dynamics, test_case.young_modulus);
        for (int k = 0; k < 40; ++k) REQUIRE(bar.world.advance(0.01).ok());
        World next = bar.world.clone();
        REQUIRE(next.advance(1e-5).ok());
        const Vec3 expected = next.forces().by(bar.held).force();
        for (const Real seconds : lengths) {
            INFO(seconds);
            World world = bar.world.clone();
            REQUIRE(world.advance(seconds).ok());
            const ForceReport report = world.forces().by(bar.held);
            CHECK(report.measured);
            // During the longest of these calls the force changes by some per cent.
            CHECK((report.force() - expected).norm() < 0.05 * expected.norm());
            CHECK(report.moment().allFinite());
        }
    }
}

TEST_CASE("the reaction of moving nodes is right or not measured", "[scene]") {
    Bar bar(BodyDynamics::explicit_elastic, 1e6, {.velocity = {0.1, 0.2, 0.3}});
    REQUIRE(bar.world.advance(0.3).ok());
    World next = bar.world.clone();
    REQUIRE(next.advance(1e-5).ok());
    const Vec3 expected = next.forces().by(bar.held).force();
    bool none = false;
    for (const Real seconds : lengths) {
        INFO(seconds);
        World world = bar.world.clone();
        REQUIRE(world.advance(seconds).ok());
        const ForceReport report = world.forces().by(bar.held);
        none = none || !report.measured;
        if (report.measured)
            CHECK((report.force() - expected).norm() < 0.1 * expected.norm());
        else
            CHECK((is_nan(report.force()) && is_nan(report.moment()) && is_nan(report.moment_about({1, 0, 0}))));
        CHECK((report.measured || seconds < 1e-6));
    }
    CHECK(none);
}

TEST_CASE("contact forces on a resting body are right or not measured", "[scene]") {
    for (const BodyDynamics dynamics :
         {BodyDynamics::explicit_elastic, BodyDynamics::implicit_elastic, BodyDynamics::rigid}) {
        INFO(name_of(dynamics));
        World world(Settings{.sleep = false});
        const auto material = world.add_material({.young_modulus = 1e6, .damping = 50});
        const auto floor = world.add_collider(Plane{});
        const auto body = world.add_body(mesh::box({0.1, 0.1, 0.1}, {2, 2, 2}),
                                         {.material = material, .position = {0, 0, 0.0501}, .dynamics = dynamics});
        world.measure_forces(true);
        for (int k = 0; k < 100; ++k) REQUIRE(world.advance(0.01).ok());
        const Real weight = 9.81 * world.mass(body);
        for (const Real seconds : lengths) {
            INFO(seconds);
            World copy = world.clone();
            REQUIRE(copy.advance(seconds).ok());
            const ForceReport on_body = copy.forces().on(body), on_floor = copy.forces().on(floor),
                              of_pair = copy.forces().on(body, floor);
            CHECK(on_body.measured == on_floor.measured);
            CHECK(on_body.measured == of_pair.measured);
            if (!on_body.measured) {
                CHECK(seconds < 1e-4);
                CHECK((is_nan(on_body.force()) && is_nan(on_floor.force()) && is_nan(of_pair.force())));
                continue;
            }
            CHECK(on_body.force().z() == Approx(weight).epsilon(0.05));
            CHECK(on_floor.force().z() == Approx(-weight).epsilon(0.05));
        }
        // Short calls one after the other are measured again.
        for (int k = 0; k < 3; ++k) REQUIRE(world.advance(1e-6).ok());
        CHECK(world.forces().on(body).measured);
        REQUIRE(world.advance(0).ok());
        CHECK_FALSE(world.forces().on(body).measured);
        CHECK(is_nan(world.forces().on(body).force()));
    }
}

TEST_CASE("forces on sleeping bodies are measured by calls of any length", "[scene]") {
    World world;
    const auto floor = world.add_collider(Plane{});
    const auto body = world.add_body(
        Sphere{0.1}, {.material = world.add_material({}), .position = {0, 0, 0.1}, .dynamics = BodyDynamics::rigid});
    world.measure_forces(true);
    REQUIRE(world.advance(3).ok());
    REQUIRE(world.asleep(body));
    REQUIRE(world.advance(1e-9).ok());
    const Real weight = 9.81 * world.mass(body);
    CHECK(world.forces().on(body).force().z() == Approx(weight).epsilon(0.01));
    CHECK(world.forces().on(floor).force().z() == Approx(-weight).epsilon(0.01));
    CHECK(world.forces().on(body, floor).measured);
}

}  // namespace skerry::test::short_calls_test
