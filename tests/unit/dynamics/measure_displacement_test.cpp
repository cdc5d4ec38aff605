#include "systems/dynamics/motion/measure_displacement.h"

#include <catch2/catch.hpp>
#include <random>
#include <vector>

using namespace skerry;

namespace {

/// One body of some nodes in blocks of its own.
struct Cloud {
    std::vector<Range> node_blocks{{0, 2}}, nodes{{0, 300}};
    std::vector<Real> mean_edge{1}, squared = std::vector<Real>(2), displacement{0}, travel{0};
    std::vector<std::uint8_t> rebase{0};
    std::vector<Vec3> position = std::vector<Vec3>(300, Vec3::Zero()), origin = position;

    void measure() {
        const auto executor = make_executor(Backend::serial, 1);
        const auto part = [](std::vector<Vec3>& column, std::size_t first, std::size_t count) {
            return std::span(column).subspan(first, count);
        };
        squared = {block_displacement_squared(part(position, 0, 256), part(origin, 0, 256)),
                   block_displacement_squared(part(position, 256, 44), part(origin, 256, 44))};
        measure_displacement(*executor, {squared, node_blocks, nodes, mean_edge, position},
                             {origin, rebase, displacement, travel});
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
