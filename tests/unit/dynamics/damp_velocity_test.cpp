#include "systems/dynamics/motion/damp_velocity.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <catch2/catch.hpp>
#include <cmath>
#include <cstring>

#include "tests/support/jittered_box.h"

namespace skerry::test::damp_velocity_test {

namespace {

/// Bodies of unconnected nodes.
struct Cloud {
    std::vector<Index> block_begin, block_end, block_body, body_material, pinned;
    std::vector<std::uint8_t> asleep;
    std::vector<std::uint16_t> unstrained;
    std::vector<Range> node_blocks;
    std::vector<Real> damping{0, 20}, mass, inverse_mass;  // material 1 is damped
    std::vector<Vec3> position, velocity;
    std::vector<NodeBlockSums> sums;
    Real dissipated = 0, lag = 0;

    void add(const std::vector<Vec3>& nodes, const std::vector<Vec3>& velocities, Index material) {
        const Index first = static_cast<Index>(position.size()), first_block = static_cast<Index>(block_begin.size());
        for (std::size_t n = 0; n < nodes.size(); ++n) {
            position.push_back(nodes[n]);
            velocity.push_back(velocities[n]);
            mass.push_back(0.1 + 0.01 * static_cast<Real>(n % 7));
            inverse_mass.push_back(1 / mass.back());
        }
        for (Index begin = first; begin < static_cast<Index>(position.size()); begin += nodes_per_block) {
            block_begin.push_back(begin);
            block_end.push_back(std::min(begin + nodes_per_block, static_cast<Index>(position.size())));
            block_body.push_back(static_cast<Index>(node_blocks.size()));
        }
        node_blocks.push_back({first_block, static_cast<Index>(block_begin.size())});
        body_material.push_back(material);
        pinned.push_back(0);
        asleep.push_back(0);
        unstrained.push_back(0);
        sums.resize(block_begin.size());
    }
    bool damp(Executor& executor, Real h) {
        std::vector<Vec3> next = velocity;  // nothing else acts
        const bool damped = damp_from(executor, h, next);
        velocity = next;
        return damped;
    }
    bool damp_from(Executor& executor, Real h, std::vector<Vec3>& velocity_next) {
        return damp_velocity(executor,
                             {block_begin,
                              block_end,
                              block_body,
                              node_blocks,
                              body_material,
                              pinned,
                              {},
                              asleep,
                              unstrained,
                              damping,
                              position,
                              mass,
                              inverse_mass,
                              lag},
                             velocity, h, sums, velocity_next, dissipated);
    }
};

struct Momenta {
    Vec3 linear = Vec3::Zero(), angular = Vec3::Zero();
    Real size = 0, turn = 0, kinetic = 0;
};
Momenta momenta(const Cloud& cloud) {
    Momenta m;
    for (std::size_t n = 0; n < cloud.position.size(); ++n) {
        const Vec3 p = cloud.mass[n] * cloud.velocity[n];
        m.linear += p;
        m.angular += cloud.position[n].cross(p);
        m.size += p.norm();
        m.turn += cloud.position[n].norm() * p.norm();
        m.kinetic += 0.5 * p.dot(cloud.velocity[n]);
    }
    return m;
}

std::vector<Vec3> random_vectors(std::size_t count, Real size, const Vec3& centre, std::uint64_t seed) {
    std::mt19937_64 random(seed);
    std::vector<Vec3> out(count);
    for (Vec3& v : out) v = centre + size * test::random_vector(random);
    return out;
}

}  // namespace

TEST_CASE("damping keeps momentum and angular momentum and takes energy", "[unit]") {
    const auto executor = make_executor(Backend::serial, 1);
    Cloud cloud;
    cloud.lag = GENERATE(0.0, 0.02);  // a tenth of the body's size [s]
    cloud.add(random_vectors(1000, 0.5, Vec3(10, -20, 5), 1), random_vectors(1000, 2, Vec3(3, 1, 0), 2), 1);
    const Momenta before = momenta(cloud);
    Real dissipated = 0;
    for (int step = 0; step < 20; ++step) {
        REQUIRE(cloud.damp(*executor, 1e-3));
        dissipated += cloud.dissipated;
    }
    const Momenta after = momenta(cloud);
    CHECK(dissipated == Approx(before.kinetic - after.kinetic).epsilon(1e-10));
    CHECK((after.linear - before.linear).norm() <= 1e-13 * before.size);
    CHECK((after.angular - before.angular).norm() <= 1e-13 * before.turn);
    CHECK(after.kinetic < 0.9 * before.kinetic);
}

TEST_CASE("damping has the bits of one sum after the other", "[unit]") {
    const auto executor = make_executor(Backend::serial, 1);
    Cloud cloud;
    cloud.lag = 0.02;  // [s]
    cloud.add(random_vectors(200, 0.5, Vec3(10, -20, 5), 1), random_vectors(200, 2, Vec3(3, 1, 0), 2), 1);
    const std::vector<Vec3> x = cloud.position, v = cloud.velocity;
    // momentum and inertia about the first node, then about the centre of mass
    Real mass = 0;
    Vec3 momentum = Vec3::Zero(), first = Vec3::Zero(), angular = Vec3::Zero();
    Mat3 second = Mat3::Zero();
    for (std::size_t n = 0; n < x.size(); ++n) {
        const Real m = cloud.mass[n];
        const Vec3 from = x[n] - x[0], slip = v[n] - v[0], p = m * slip;
        mass += m;
        momentum += p;
        first += m * from;
        angular += from.cross(p);
        second += (m * (from - cloud.lag * slip)) * from.transpose();
    }
    angular -= first.cross(momentum) / mass;
    second -= (first - cloud.lag * momentum) * first.transpose() / mass;
    momentum += mass * v[0];
    const Vec3 omega = (second.trace() * Mat3::Identity() - second).inverse() * angular;
    const Vec3 linear = momentum / mass, centre = first / mass;
    const Real h = 1e-3, fraction = -std::expm1(-cloud.damping[1] * h);
    REQUIRE(cloud.damp(*executor, h));
    Real taken = 0;
    for (std::size_t n = 0; n < x.size(); ++n) {
        const Vec3 relative = v[n] - linear, from = x[n] - x[0] - centre;
        const Vec3 excess = relative - omega.cross(from - cloud.lag * relative);
        CHECK(cloud.velocity[n] == v[n] - fraction * excess);
        taken += cloud.mass[n] * fraction * excess.dot(relative - fraction / 2 * excess);
    }
    CHECK(cloud.dissipated == taken);
}

TEST_CASE("a body at rest under load does not feel its damping", "[unit]") {
    // Velocity that the forces of this step add is not damped. Otherwise a body would not rest in its balanced shape.
    const auto executor = make_executor(Backend::serial, 1);
    Cloud cloud;
    cloud.add(random_vectors(50, 0.5, Vec3::Zero(), 1), std::vector<Vec3>(50, Vec3::Zero()), 1);
    const std::vector<Vec3> predicted = random_vectors(50, 1, Vec3::Zero(), 9);
    std::vector<Vec3> next = predicted;
    CHECK(cloud.damp_from(*executor, 0.1, next));
    CHECK(next == predicted);
    CHECK(cloud.dissipated == 0);
}

TEST_CASE("rigid motion is not damped", "[unit]") {
    const auto executor = make_executor(Backend::serial, 1);
    Cloud cloud;
    const std::vector<Vec3> nodes = random_vectors(700, 0.5, Vec3(1, 2, 3), 3);
    std::vector<Vec3> velocities;
    for (const Vec3& x : nodes) velocities.push_back(Vec3(1, 2, 3) + Vec3(3, -2, 5).cross(x));
    cloud.add(nodes, velocities, 1);
    cloud.damp(*executor, 0.1);
    for (std::size_t n = 0; n < nodes.size(); ++n) CHECK((cloud.velocity[n] - velocities[n]).norm() <= 1e-12);
}

TEST_CASE("places that turn on while velocities lag behind are rigid motion", "[unit]") {
    // The body turns by a finite angle per step: each velocity is along the chord that led to the present position.
    const auto executor = make_executor(Backend::serial, 1);
    const Real h = 0.02;
    const auto excess_with_lag = [&](Real lag) {
        Cloud cloud;
        cloud.lag = lag;
        std::vector<Vec3> before = random_vectors(700, 0.5, Vec3(1, 2, 3), 3), now, velocities;
        const Eigen::AngleAxis<Real> turn(0.3, Vec3(3, -2, 5).normalized());
        for (const Vec3& x : before) {
            now.push_back(turn * x + Vec3(0.1, 0, 0));
            velocities.push_back((now.back() - x) / h);
        }
        cloud.add(now, velocities, 1);
        cloud.damp(*executor, h);
        Real largest = 0;
        for (std::size_t n = 0; n < now.size(); ++n)
            largest = std::max(largest, (cloud.velocity[n] - velocities[n]).norm());
        return largest;
    };
    CHECK(excess_with_lag(h / 2) <= 1e-12);
    CHECK(excess_with_lag(0) > 0.1);  // outward velocity omega^2 r h / 2, of which damping removed a part
}

TEST_CASE("motion other than rigid decays at the given rate", "[unit]") {
    const auto executor = make_executor(Backend::serial, 1);
    Cloud cloud;
    cloud.add({Vec3(-1, 0, 0), Vec3(1, 0, 0)}, {Vec3(-1, 0, 0), Vec3(1, 0, 0)}, 1);
    cloud.mass = {1, 1};
    cloud.damp(*executor, 0.1);
    CHECK(cloud.velocity[1].x() == Approx(std::exp(-2.0)).epsilon(1e-14));
}

TEST_CASE("nodes in a point and on a line are damped without a rotation they cannot have", "[unit]") {
    const auto executor = make_executor(Backend::serial, 1);
    Cloud cloud;
    cloud.lag = GENERATE(0.0, 0.02);
    cloud.add({Vec3(1, 1, 1)}, {Vec3(1, 2, 3)}, 1);                                 // one node: all motion is rigid
    cloud.add({Vec3(2, 2, 2), Vec3(2, 2, 2)}, {Vec3(1, 0, 0), Vec3(-1, 0, 0)}, 1);  // two nodes at one position
    // three nodes on a line
    cloud.add({Vec3(0, 0, 0), Vec3(0.1, 0.2, 0.3), Vec3(0.3, 0.6, 0.9)}, {Vec3(1, 0, 0), Vec3(0, 1, 0), Vec3(0, 0, 1)},
              1);
    const Momenta before = momenta(cloud);
    cloud.damp(*executor, 0.1);
    const Momenta after = momenta(cloud);
    CHECK((cloud.velocity[0] - Vec3(1, 2, 3)).norm() <= 1e-15);
    CHECK((after.linear - before.linear).norm() <= 1e-13 * before.size);
    CHECK((after.angular - before.angular).norm() <= 1e-13 * before.turn);
    CHECK(after.kinetic < before.kinetic);
}

TEST_CASE("a body with pinned nodes is damped towards rest, its pinned nodes not at all", "[unit]") {
    const auto executor = make_executor(Backend::serial, 1);
    Cloud cloud;
    cloud.add(random_vectors(10, 1, Vec3::Zero(), 5), std::vector<Vec3>(10, Vec3(1, 0, 0)), 1);
    const std::array<std::size_t, 4> pinned{0, 4, 5, 9};
    for (const std::size_t n : pinned) cloud.inverse_mass[n] = 0;
    cloud.pinned[0] = 4;
    cloud.damp(*executor, 0.1);
    for (std::size_t n = 0; n < 10; ++n)
        if (std::ranges::count(pinned, n) > 0)
            CHECK(cloud.velocity[n] == Vec3(1, 0, 0));
        else
            CHECK(cloud.velocity[n].x() == Approx(std::exp(-2.0)).epsilon(1e-14));
}

TEST_CASE("bodies without damping or without a material are passed over", "[unit]") {
    const auto executor = make_executor(Backend::serial, 1);
    Cloud cloud;
    CHECK_FALSE(cloud.damp(*executor, 0.1));
    const std::vector<Vec3> velocities = random_vectors(5, 1, Vec3::Zero(), 7);
    cloud.add(random_vectors(5, 1, Vec3::Zero(), 6), velocities, 0);
    cloud.add(random_vectors(5, 1, Vec3::Zero(), 6), velocities, no_index);
    CHECK_FALSE(cloud.damp(*executor, 0.1));
    cloud.add(random_vectors(5, 1, Vec3::Zero(), 6), velocities, 1);
    CHECK(cloud.damp(*executor, 0.1));
    for (std::size_t n = 0; n < 10; ++n) CHECK(cloud.velocity[n] == velocities[n % 5]);
    CHECK(cloud.velocity[10] != velocities[0]);
}

TEST_CASE("damping has the same bits on any number of workers", "[unit][determinism]") {
    std::vector<Vec3> reference;
    for (int workers : {1, 2, 3, 4, 8}) {
        const auto executor = make_executor(available_backends().front(), workers);
        Cloud cloud;
        for (std::uint64_t body = 0; body < 5; ++body)
            cloud.add(random_vectors(3000, 0.5, Vec3(1, 2, 3), body), random_vectors(3000, 2, Vec3(3, 1, 0), body + 9),
                      body % 2 == 0);
        for (int step = 0; step < 3; ++step) cloud.damp(*executor, 1e-3);
        if (workers == 1)
            reference = cloud.velocity;
        else
            CHECK(std::memcmp(reference.data(), cloud.velocity.data(), reference.size() * sizeof(Vec3)) == 0);
    }
}

}  // namespace skerry::test::damp_velocity_test
