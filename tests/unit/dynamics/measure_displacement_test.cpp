#include "systems/dynamics/motion/measure_displacement.h"

#include <algorithm>
#include <catch2/catch.hpp>
#include <cmath>
#include <random>
#include <vector>

namespace skerry::test::measure_displacement_test {

namespace {

/// One body of some nodes in its own blocks.
struct Cloud {
    std::vector<Range> node_blocks{{0, 2}};
    std::vector<Index> block_begin{0, 256}, block_end{256, 300};
    std::vector<Real> mean_edge{1}, squared = std::vector<Real>(2), frame_speed{0}, displacement{0}, travel{0};
    std::vector<std::uint8_t> rebase{0};
    std::vector<Vec3> position = std::vector<Vec3>(300, Vec3::Zero()), origin = position;

    std::vector<Vec3> velocity = position;
    std::vector<MovingFrame> frame{{}};

    void measure(Real seconds = 1) {
        const auto executor = make_executor(Backend::serial, 1);
        const auto part = [](std::vector<Vec3>& column, std::size_t first, std::size_t count) {
            return std::span(column).subspan(first, count);
        };
        const Vec3 offset = frame[0].offset + seconds * frame[0].velocity;
        squared = {block_displacement_squared(part(position, 0, 256), part(origin, 0, 256), offset),
                   block_displacement_squared(part(position, 256, 44), part(origin, 256, 44), offset)};
        measure_displacement(*executor, {squared, node_blocks, block_begin, block_end, mean_edge, position, velocity},
                             seconds, {origin, rebase, frame, frame_speed, displacement, travel});
    }
};

}  // namespace

TEST_CASE("a body that trembles does not travel, one that goes on does", "[unit]") {
    Cloud cloud;
    for (int i = 0; i < 1000; ++i) {
        cloud.position[270].x() = i % 2 ? 0.01 : -0.01;
        cloud.measure();
    }
    CHECK(cloud.travel[0] == Approx(0.01));
    for (int i = 1; i <= 1000; ++i) {
        cloud.position[270].x() = -0.01 + 0.01 * i;
        cloud.measure();
    }
    CHECK(cloud.travel[0] >= 10 - 0.02);
    CHECK(cloud.travel[0] <= 10.1);
}

TEST_CASE("no node comes further than the growth of travel and twice the displacement", "[unit]") {
    Cloud cloud;
    std::mt19937_64 random(3);
    std::uniform_real_distribution<Real> uniform(-1, 1);
    struct Moment {
        std::vector<Vec3> position;
        Real datum;
    };
    std::vector<Moment> moments;
    for (int i = 0; i < 400; ++i) {
        const Real size = i % 50 < 10 ? 0.05 : 0.003;
        for (std::size_t n = 250; n < 300; ++n)
            cloud.position[n] += size * Vec3(uniform(random), uniform(random), uniform(random));
        cloud.rebase[0] = i % 37 == 0;
        cloud.measure();
        for (const Moment& then : moments)
            for (std::size_t n = 250; n < 300; ++n)
                REQUIRE((cloud.position[n] - then.position[n]).norm() <= cloud.travel[0] - then.datum + 1e-12);
        if (i % 20 == 0) moments.push_back({cloud.position, cloud.travel[0] - 2 * cloud.displacement[0]});
    }
    REQUIRE(cloud.travel[0] > 0.5);
}

TEST_CASE("a flying body does not travel in its frame, whose path is that of the body", "[unit]") {
    Cloud cloud;
    const Vec3 speed(3, -1, 2);
    std::ranges::fill(cloud.velocity, speed);
    cloud.rebase[0] = 1;
    cloud.measure(0);  // the frame takes its new velocity
    CHECK(cloud.frame[0].velocity == speed);
    for (int i = 0; i < 100; ++i) {
        for (Vec3& x : cloud.position) x += 0.01 * speed;
        cloud.measure(0.01);
    }
    CHECK(cloud.travel[0] < 1e-12);
    CHECK(cloud.frame[0].path == Approx(speed.norm()));
    CHECK((cloud.frame[0].position - speed).norm() < 1e-12);
}

TEST_CASE(
    "between two bodies distances change by what they move in their frames and by the way of one as the other "
    "sees it",
    "[unit]") {
    Cloud a, b;
    std::mt19937_64 random(5);
    std::uniform_real_distribution<Real> uniform(-1, 1);
    struct Moment {
        std::vector<Vec3> a, b;
        Real base;
    };
    std::vector<Moment> moments;
    Real path = 0;
    Vec3 apart = Vec3::Zero();
    for (int i = 0; i < 300; ++i) {
        for (Cloud* cloud : {&a, &b}) {
            const Vec3 course(3, cloud == &a ? 0.2 : std::sin(0.1 * i), 0);
            for (std::size_t n = 0; n < cloud->position.size(); ++n) {
                cloud->velocity[n] = course + 0.3 * Vec3(uniform(random), uniform(random), uniform(random));
                cloud->position[n] += 0.01 * cloud->velocity[n];
            }
            cloud->measure(0.01);
        }
        const Vec3 now = a.frame[0].position - b.frame[0].position;
        path += (now - apart).norm();
        apart = now;
        const Real travel = a.travel[0] + b.travel[0] + path;
        for (const Moment& then : moments)
            for (std::size_t n = 0; n < 300; n += 7) {
                const Vec3 before = then.a[n] - then.b[299 - n], after = a.position[n] - b.position[299 - n];
                REQUIRE((after - before).norm() <= travel - then.base + 1e-12);
            }
        if (i % 20 == 0)
            moments.push_back({a.position, b.position, travel - 2 * (a.displacement[0] + b.displacement[0])});
    }
    CHECK(path < 3);  // each node went three metres
}

TEST_CASE("a request sets the displacement to zero and is taken back", "[unit]") {
    Cloud cloud;
    cloud.position[5].y() = 0.02;
    cloud.rebase[0] = 1;
    cloud.measure();
    CHECK(cloud.displacement[0] == 0);
    CHECK(cloud.travel[0] == Approx(0.02));
    CHECK(cloud.rebase[0] == 0);
    CHECK(cloud.origin[5] == cloud.position[5]);
}

TEST_CASE("the speed in a new frame is that of the nodes in it", "[unit]") {
    Cloud cloud;
    cloud.velocity[7].x() = 2;
    cloud.frame[0].velocity.x() = 1;  // halfway: relative to it no node is faster than 1 m/s
    cloud.frame_speed[0] = 1;
    cloud.measure(1e-3);
    CHECK(cloud.frame_speed[0] == 1);  // frame speed of this step
    cloud.rebase[0] = 1;
    cloud.measure(1e-3);
    REQUIRE(cloud.frame[0].velocity.x() == Approx(2.0 / 300));
    CHECK(cloud.frame_speed[0] == Approx(2 - 2.0 / 300));
}

}  // namespace skerry::test::measure_displacement_test
