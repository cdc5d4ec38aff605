#include "systems/dynamics/checks/find_inversions.h"

#include <Eigen/Geometry>
#include <catch2/catch.hpp>
#include <limits>
#include <random>

namespace skerry::test::find_inversions_test {

namespace {

constexpr Real h = 0.01;

/// Bodies of separate tetrahedra, each with its own corners. Unused lanes have no volume.
struct Loose {
    std::vector<TetrahedronNodes> node;
    std::vector<ElementLane> volume;
    std::vector<std::uint8_t> sliver;
    std::vector<Range> blocks;
    std::vector<Real> max_speed, travel, displacement, uninverted_until, block_uninverted_until;
    std::vector<Vec3> position, velocity, push;
    InversionMemory memory;

    Loose(std::mt19937_64& random, const std::vector<Index>& elements) {
        std::uniform_real_distribution<Real> place(-1, 1);
        for (const Index count : elements) {
            const Index first = static_cast<Index>(node.size());
            for (Index e = 0; e < count; ++e) {
                const std::size_t l = static_cast<std::size_t>(e) % element_lanes;
                if (l == 0) {
                    node.emplace_back();
                    volume.emplace_back();
                    for (auto& corner : node.back())
                        for (std::size_t lane = 0; lane < element_lanes; ++lane)
                            corner[lane] = static_cast<Index>(position.size());
                }
                for (std::size_t a = 0; a < 4; ++a) {
                    node.back()[a][l] = static_cast<Index>(position.size());
                    position.emplace_back(place(random), place(random), place(random));
                }
                if (determinant(position, node.size() - 1, l) < 0)
                    std::swap(position.back(), position[position.size() - 2]);
                volume.back()[l] = 1;
            }
            blocks.push_back({first, static_cast<Index>(node.size())});
            max_speed.push_back(0);
            travel.push_back(0);
            displacement.push_back(0);
            uninverted_until.push_back(-std::numeric_limits<Real>::infinity());
        }
        block_uninverted_until.assign(node.size(), -std::numeric_limits<Real>::infinity());
        velocity.assign(position.size(), Vec3::Zero());
        push = velocity;
    }
    Real determinant(const std::vector<Vec3>& x, std::size_t b, std::size_t l) const {
        const auto at = [&](std::size_t a) { return x[static_cast<std::size_t>(node[b][a][l])]; };
        return (at(1) - at(0)).dot((at(2) - at(0)).cross(at(3) - at(0)));
    }
    std::vector<Vec3> next() const {
        std::vector<Vec3> x = position;
        for (std::size_t n = 0; n < x.size(); ++n) x[n] += h * (velocity[n] + push[n]);
        return x;
    }
    Inversions find(int workers = 1) {
        const auto executor = make_executor(workers == 1 ? Backend::serial : available_backends().front(), workers);
        return find_inversions(
            *executor, {node, volume, {}, sliver, blocks, max_speed, travel, displacement, position, velocity, push}, h,
            memory, {block_uninverted_until, uninverted_until});
    }
    /// Reference result: finds inversions by testing every element.
    Inversions by_hand() const {
        Inversions found;
        const std::vector<Vec3> after = next();
        for (std::size_t body = 0; body < blocks.size(); ++body) {
            Index count = 0, first = no_index;
            bool inverted = false;
            for (Index b = blocks[body].begin; b < blocks[body].end; ++b)
                for (std::size_t l = 0; l < element_lanes; ++l) {
                    const std::size_t block = static_cast<std::size_t>(b);
                    if (volume[block][l] == 0) continue;
                    const bool was = !(determinant(position, block, l) > 0);
                    inverted |= was;
                    if (was || determinant(after, block, l) > 0) continue;
                    if (count++ == 0) first = static_cast<Index>(block * element_lanes + l);
                }
            if (count == 0) continue;
            if (found.count == 0) found = {0, static_cast<Index>(body), first, false};
            found.count += count;
            found.is_first_of_body |= !inverted;
        }
        return found;
    }
};

}  // namespace

TEST_CASE("inverted elements are found as by testing every element in every step", "[unit][long]") {
    for (const int workers : {1, 4}) {
        std::mt19937_64 random(7);
        std::normal_distribution<Real> kick(0, 1);
        Loose loose(random, {1, 2200, 30});
        std::size_t with = 0, skipped = 0;
        std::vector<Vec3> start = loose.position;
        for (int step = 0; step < 200; ++step) {
            for (std::size_t body = 0; body < loose.blocks.size(); ++body) {
                const Real speed = (step / 50) % 2 ? 0.002 : 0.2;  // speed of a node in slow and fast periods [m/s]
                for (Index b = loose.blocks[body].begin; b < loose.blocks[body].end; ++b)
                    for (std::size_t l = 0; l < element_lanes; ++l)
                        for (std::size_t a = 0; a < 4; ++a) {
                            const auto n = static_cast<std::size_t>(loose.node[static_cast<std::size_t>(b)][a][l]);
                            loose.velocity[n] = speed * Vec3(kick(random), kick(random), kick(random));
                            loose.push[n] = 0.1 * speed * Vec3(kick(random), kick(random), kick(random));
                            loose.max_speed[body] =
                                std::max(loose.max_speed[body], (loose.velocity[n] + loose.push[n]).norm());
                        }
            }
            const std::vector<Real> before = loose.block_uninverted_until;
            const Inversions found = loose.find(workers), expected = loose.by_hand();
            REQUIRE(found.count == expected.count);
            REQUIRE(found.body == expected.body);
            REQUIRE(found.tetrahedron == expected.tetrahedron);
            REQUIRE(found.is_first_of_body == expected.is_first_of_body);
            with += found.count > 0;
            for (std::size_t b = 0; b < before.size(); ++b) skipped += before[b] == loose.block_uninverted_until[b];
            loose.position = loose.next();
            // updates as in measure_displacement, without its origins
            for (std::size_t body = 0; body < loose.blocks.size(); ++body) {
                loose.travel[body] += h * loose.max_speed[body];
                loose.max_speed[body] = 0;
            }
        }
        CHECK(with > 20);
        CHECK(skipped > 1000);
    }
}

TEST_CASE("an element is safe until its corners have moved by half of its width", "[unit]") {
    std::mt19937_64 random(1);
    Loose loose(random, {1});
    loose.position = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1}};
    REQUIRE(loose.find().count == 0);
    CHECK(loose.uninverted_until[0] == Approx(std::sqrt(1.0 / 3) / 2));  // half the distance to the slanted face
    loose.travel[0] = 5;
    loose.displacement[0] = 0.1;
    REQUIRE(loose.find().count == 0);
    CHECK(loose.uninverted_until[0] == Approx(5 - 0.2 + std::sqrt(1.0 / 3) / 2));
    // A flat tetrahedron whose two crossing edges are its closest pair: no corner is as close to the opposite face.
    loose.position = {{-1, 0, 0}, {1, 0, 0}, {0, -1, 0.1}, {0, 1, 0.1}};
    if (loose.determinant(loose.position, 0, 0) < 0) std::swap(loose.position[0], loose.position[1]);
    loose.uninverted_until[0] = loose.block_uninverted_until[0] = -1;
    REQUIRE(loose.find().count == 0);
    CHECK(loose.uninverted_until[0] == Approx(5 - 0.2 + 0.1 / 2));
}

TEST_CASE("a sliver that turns over is counted, but no step is shortened for it", "[unit]") {
    std::mt19937_64 random(2);
    Loose loose(random, {2});
    for (std::size_t t = 0; t < 2; ++t) {
        const std::size_t first = 4 * t;
        const Vec3 at(3.0 * static_cast<Real>(t), 0, 0);
        const std::array<Vec3, 4> corner{Vec3(0, 0, 0), Vec3(1, 0, 0), Vec3(0, 1, 0), Vec3(0, 0, t == 0 ? 0.02 : 1)};
        for (std::size_t a = 0; a < 4; ++a) loose.position[first + a] = at + corner[a];
    }
    const auto let_fall = [&](std::size_t t, Real way) {
        loose.velocity[4 * t + 3] = Vec3(0, 0, -way / h);
        loose.max_speed[0] = std::max(loose.max_speed[0], way / h);
    };
    let_fall(0, 0.04);
    CHECK(loose.find().is_first_of_body);
    loose.sliver = {1};
    Inversions found = loose.find();
    CHECK(found.count == 1);
    CHECK(found.tetrahedron == 0);
    CHECK_FALSE(found.is_first_of_body);

    let_fall(1, 2);
    found = loose.find();
    CHECK(found.count == 2);
    CHECK(found.is_first_of_body);

    loose.position[3].z() = -0.02;  // inverted long ago: the body counts as sound
    let_fall(0, 0);
    found = loose.find();
    CHECK(found.count == 1);
    CHECK(found.tetrahedron == 1);
    CHECK(found.is_first_of_body);
}

}  // namespace skerry::test::find_inversions_test
