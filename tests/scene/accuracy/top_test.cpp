// Rigid tops, free and on a point (docs/accuracy.md, items 52 to 54).
#include <Eigen/Geometry>
#include <algorithm>
#include <catch2/catch.hpp>
#include <cmath>
#include <vector>

#include "skerry/joint.h"
#include "tests/support/accuracy.h"
#include "tests/support/worlds.h"

namespace skerry::test::top_test {

using accuracy::Tolerance;

namespace {

const Vec3 edges(0.3, 0.2, 0.1);  // of the free top; its principal moments ascend with x, y, z [m]

Mat3 attitude(const World& world, BodyHandle body) {
    const Vec3 turn = world.pose(body).rotation;
    const Real angle = turn.norm();
    return angle > 0 ? Eigen::AngleAxis<Real>(angle, turn / angle).toRotationMatrix() : Mat3::Identity();
}

/// A freely rotating box of 6 kg.
struct FreeTop {
    World world;
    BodyHandle body;
    Vec3 moments;  // kg m^2

    FreeTop(const Vec3& spin, Real h)
        : world([h] {
              Settings settings = accurate(Vec3::Zero());
              settings.step_size = h;
              return settings;
          }()),
          body(world.add_body(
              mesh::box(edges, {3, 2, 1}),
              {.material = world.add_material({}), .angular_velocity = spin, .dynamics = BodyDynamics::rigid})) {
        const Vec3 squares = edges.cwiseProduct(edges);
        moments = world.mass(body) / 12 * (Vec3::Constant(squares.sum()) - squares);
    }
};

/// Largest tilt within five seconds of a cube of 0.1 m that spins about its axis above a ball joint 0.1 m below its
/// centre. The initial tilt is 1e-3 [rad].
Real largest_tilt(Real share) {
    constexpr Real side = 0.1, reach = 0.1, tilt = 1e-3;  // m, m, rad
    Settings settings = accurate({0, 0, -standard_gravity}, 1e-12);
    settings.step_size = 1e-3;
    World world(settings);
    const Real mass = 1000 * side * side * side, own = mass * side * side / 6, about = own + mass * reach * reach;
    const Real spin = share * std::sqrt(4 * about * mass * standard_gravity * reach) / own;
    const Vec3 axis(std::sin(tilt), 0, std::cos(tilt));
    const auto top = world.add_body(mesh::box({side, side, side}, {1, 1, 1}), {.material = world.add_material({}),
                                                                               .position = reach * axis,
                                                                               .rotation = {0, tilt, 0},
                                                                               .angular_velocity = spin * axis,
                                                                               .dynamics = BodyDynamics::rigid});
    Joints(world).add({.kind = JointKind::ball, .first = top});
    Real largest = 0;
    for (int k = 0; k < 2500; ++k) {
        REQUIRE(world.advance(2e-3).ok());
        const Vec3 center = world.center_of_mass(top);
        largest = std::max(largest, std::atan2(std::hypot(center.x(), center.y()), center.z()));
    }
    return largest;
}

}  // namespace

TEST_CASE("attitudes of a free rigid top are of second order in the step", "[scene][accuracy]") {
    const auto turned = [](Real h) {
        FreeTop top({0.3, 5, 0.2}, h);
        REQUIRE(top.world.advance(2).ok());
        return attitude(top.world, top.body);
    };
    const Mat3 reference = turned(1.0 / 8192);
    accuracy::check(
        {.item = 52,
         .name = "free rigid top, order of the attitude after 2 s, steps of 1/128 and 1/256 s",
         .formula = "2",
         .expected = 2,
         .found = std::log2((turned(1.0 / 128) - reference).norm() / (turned(1.0 / 256) - reference).norm()),
         .tolerance = 0.1,
         .kind = Tolerance::absolute});
}

TEST_CASE("a rigid wing nut turns over in the time of elliptic functions, over and over", "[scene][accuracy]") {
    constexpr Real h = 1e-3;
    FreeTop top({0.01, 5, 0.01}, h);
    const Vec3 spin(0.01, 5, 0.01), start = top.moments.cwiseProduct(spin), j = top.moments;
    const Real squared = start.squaredNorm(), twice = start.dot(spin);
    REQUIRE(squared > twice * j[1]);
    const Real p = std::sqrt((j[2] - j[1]) * (squared - twice * j[0]) / j.prod());
    const Real k = std::sqrt((j[1] - j[0]) * (twice * j[2] - squared) / ((j[2] - j[1]) * (squared - twice * j[0])));
    const Real period = 4 * std::comp_ellint_1(k) / p;
    std::vector<Real> passages;  // times at which the momentum passes the plane normal to the middle axis [s]
    Real before = start.y(), energy = 0, momentum = 0;
    while (top.world.time() < 3 * period) {
        REQUIRE(top.world.advance(h).ok());
        const WorldReport report = top.world.report();
        const Real now = (attitude(top.world, top.body).transpose() * report.angular_momentum).y();
        if (before * now < 0) passages.push_back(top.world.time() - h * now / (now - before));
        before = now;
        energy = std::max(energy, std::abs(2 * report.energy.kinetic / twice - 1));
        momentum = std::max(momentum, (report.angular_momentum - start).norm() / start.norm());
    }
    REQUIRE(passages.size() >= 5);
    accuracy::check({.item = 53,
                     .name = "rigid wing nut, two periods of its turning over (s), h = 1/1000 s",
                     .formula = "8 K(k) / p",
                     .expected = 2 * period,
                     .found = passages[4] - passages[0],
                     .tolerance = 1e-3});
    accuracy::check({.item = 53,
                     .name = "the same, worst change of energy over itself",
                     .formula = "0",
                     .found = energy,
                     .tolerance = 1e-5,
                     .kind = Tolerance::absolute});
    accuracy::check({.item = 53,
                     .name = "the same, worst change of angular momentum over itself",
                     .formula = "0",
                     .found = momentum,
                     .tolerance = 1e-12,
                     .kind = Tolerance::absolute});
}

TEST_CASE("a rigid top sleeps upright iff it spins fast enough", "[scene][accuracy]") {
    accuracy::check({.item = 54,
                     .name = "rigid top let go at a tilt of 1e-3, 1.05 of the spin that it needs, largest tilt in 5 s",
                     .formula = "tilt / sqrt(1 - 4 I1 m g l / (I3 omega)^2)",
                     .expected = 1e-3 / std::sqrt(1 - 1 / (1.05 * 1.05)),
                     .found = largest_tilt(1.05),
                     .tolerance = 5e-3});
    accuracy::check({.item = 54,
                     .name = "the same, 0.95 of that spin, it tilted by more than 0.3, 1 = yes",
                     .formula = "(I3 omega)^2 < 4 I1 m g l",
                     .expected = 1,
                     .found = largest_tilt(0.95) > 0.3 ? 1.0 : 0.0,
                     .tolerance = 0,
                     .kind = Tolerance::absolute});
}

}  // namespace skerry::test::top_test
