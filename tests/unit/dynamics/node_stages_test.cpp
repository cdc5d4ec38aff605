#include <catch2/catch.hpp>
#include <limits>
#include <numeric>
#include <random>
#include <vector>

#include "systems/dynamics/motion/advance_positions.h"
#include "systems/dynamics/motion/measure_displacement.h"
#include "systems/dynamics/motion/predict_velocity.h"
#include "systems/dynamics/stability/largest_length.h"

namespace skerry::test::node_stages_test {

namespace {

constexpr Real not_a_number = std::numeric_limits<Real>::quiet_NaN();
constexpr Real infinite = std::numeric_limits<Real>::infinity();

/// Nodes without elements, in blocks of three.
struct Nodes {
    std::vector<Vec3> position, velocity, next, push, load, origin, force;
    std::vector<Real> mass, inverse_mass, displacement_squared;
    std::vector<Index> begin, end, body;
    Ragged<Index> slots_of_node;
    std::unique_ptr<Executor> executor = make_executor(Backend::serial, 1);

    explicit Nodes(std::size_t count) {
        for (auto* column : {&position, &velocity, &next, &push, &load, &origin, &force})
            column->assign(count, Vec3::Zero());
        mass.assign(count, 1);
        inverse_mass.assign(count, 1);
        slots_of_node.offset.assign(count + 1, 0);
        for (std::size_t n = 0; n < count; n += 3) {
            begin.push_back(static_cast<Index>(n));
            end.push_back(static_cast<Index>(std::min(n + 3, count)));
            body.push_back(n >= 3);  // the first block is a separate body
        }
        displacement_squared.resize(begin.size());
    }
    void predict(Real h, const Vec3& gravity = Vec3::Zero(), bool loaded = true) {
        KickInputs inputs{begin, end, body, slots_of_node.view(), {}, mass, inverse_mass, gravity};
        if (loaded) inputs.load = load;
        predict_velocity(*executor, inputs, velocity, h, force, next);
    }
    void advance(Real h, bool pushed, std::span<const std::uint8_t> asleep = {}) {
        const std::span<Vec3> none;
        advance_positions(*executor, {begin, end, body, asleep, next, origin}, h,
                          {pushed ? std::span<Vec3>(push) : none, position, velocity, displacement_squared});
    }
};

}  // namespace

TEST_CASE("a kick adds h force over mass, and nothing to a pinned node", "[unit]") {
    Nodes nodes(3);
    nodes.load = {Vec3(1, 2, 3), Vec3(1, 2, 3), Vec3(not_a_number, 0, 0)};
    nodes.velocity = {Vec3(1, 0, 0), Vec3(0, 1, 0), Vec3(0, 0, 1)};
    nodes.inverse_mass = {0.5, 0, 0};
    nodes.predict(0.25);
    CHECK(nodes.next[0] == Vec3(1.125, 0.25, 0.375));
    CHECK(nodes.next[1] == Vec3(0, 1, 0));
    CHECK(nodes.next[2] == Vec3(0, 0, 1));  // a pinned node stays in place even under a NaN force
    CHECK(nodes.force[1] == Vec3(1, 2, 3));
    predict_velocity(*nodes.executor, {}, {}, 0.25, {}, {});
}

TEST_CASE("nodes that are kicked together have the bits of one after the other", "[unit]") {
    const auto executor = make_executor(Backend::serial, 1);
    std::mt19937_64 random(3);
    std::uniform_real_distribution<Real> uniform(-1, 1);
    const auto vector = [&] { return Vec3(uniform(random), uniform(random), uniform(random)); };
    const Vec3 gravity(0.3, -0.2, -9.81);
    const Real h = 0.37;
    for (const Index count : {1, 7, 8, 100, 256}) {
        std::vector<PaddedVec3> patch_force;
        Ragged<Index> slots;
        std::vector<Vec3> velocity, sum;
        std::vector<Real> mass, inverse_mass;
        slots.offset.push_back(0);
        for (Index n = 0; n < count; ++n) {
            Vec3 force = Vec3::Zero();
            for (Index k = 0; k < n % 4; ++k) {
                const Vec3 part = vector();
                slots.item.push_back(static_cast<Index>(patch_force.size()));
                patch_force.push_back({part[0], part[1], part[2], uniform(random)});
                force += part;
            }
            slots.offset.push_back(static_cast<Index>(slots.item.size()));
            sum.push_back(force);
            velocity.push_back(vector());
            mass.push_back(2 + uniform(random));
            inverse_mass.push_back(1 / mass.back());
        }
        for (const bool held : {false, true}) {
            const auto middle = static_cast<std::size_t>(count / 2);
            if (held) inverse_mass[middle] = 0;
            const std::vector<Index> begin{0}, end{count}, body{0};
            std::vector<Vec3> force(velocity.size()), next(velocity.size());
            predict_velocity(*executor, {begin, end, body, slots.view(), patch_force, mass, inverse_mass, gravity},
                             velocity, h, force, next);
            for (std::size_t n = 0; n < next.size(); ++n) {
                const Vec3 total = sum[n] + mass[n] * gravity;
                const bool is_held = held && n == middle;
                CHECK(next[n] == (is_held ? velocity[n] : Vec3(velocity[n] + (h * inverse_mass[n]) * total)));
                if (is_held) CHECK(force[n] == total);
            }
        }
    }
}

TEST_CASE("a node without elements carries its weight and its load", "[unit]") {
    Nodes nodes(1);
    nodes.mass[0] = 2;
    nodes.inverse_mass[0] = 0;
    nodes.load[0] = Vec3(1, 0, 0);
    nodes.predict(1, Vec3(0, 0, -1));
    CHECK(nodes.force[0] == Vec3(1, 0, -2));
    nodes.predict(1, Vec3(0, 0, -1), false);
    CHECK(nodes.force[0] == Vec3(0, 0, -2));
}

TEST_CASE("a drift commits velocity and push-out, and uses the push-out up", "[unit]") {
    Nodes nodes(2);
    nodes.next[0] = Vec3(1, 2, 3);
    nodes.push = {Vec3(1, 0, 0), Vec3(0, 0, 2)};
    nodes.position[0] = Vec3(10, 0, 0);
    nodes.advance(0.5, true);
    CHECK(nodes.position[0] == Vec3(11, 1, 1.5));
    CHECK(nodes.position[1] == Vec3(0, 0, 1));
    CHECK(nodes.velocity[0] == nodes.next[0]);
    CHECK(nodes.velocity[1] == Vec3(0, 0, 0));  // the push-out moves positions only
    CHECK(nodes.push[0] == Vec3::Zero());
    CHECK(nodes.push[1] == Vec3::Zero());
    advance_positions(*nodes.executor, {}, 0.5, {});
}

TEST_CASE("a drift without a push-out has the bits of one with a push-out of zero", "[unit]") {
    const std::vector<std::uint8_t> asleep{0, 1};
    std::mt19937_64 random(5);
    std::uniform_real_distribution<Real> uniform(-1, 1);
    Nodes nodes(11);
    for (auto* column : {&nodes.position, &nodes.velocity, &nodes.next, &nodes.origin})
        for (Vec3& x : *column) x = Vec3(uniform(random), uniform(random), uniform(random));
    for (const bool rest : {false, true}) {
        Nodes plain(11), pushed(11), start(11);
        for (Nodes* copy : {&plain, &pushed, &start}) {
            copy->position = nodes.position, copy->velocity = nodes.velocity, copy->next = nodes.next,
            copy->origin = nodes.origin;
            if (copy != &start) copy->advance(0.3, copy == &pushed, rest ? asleep : std::vector<std::uint8_t>());
        }
        for (std::size_t n = 0; n < 11; ++n) {
            const bool moves = n < 3 || !rest;
            CHECK(plain.position[n] == (moves ? Vec3(start.position[n] + 0.3 * start.next[n]) : start.position[n]));
            CHECK(plain.velocity[n] == (moves ? start.next[n] : start.velocity[n]));
            CHECK(pushed.position[n] == plain.position[n]);
            CHECK(pushed.velocity[n] == plain.velocity[n]);
        }
        for (std::size_t b = 0; b < plain.begin.size(); ++b) {
            Real largest = 0;
            for (Index n = plain.begin[b]; n < plain.end[b]; ++n)
                largest = std::max(
                    largest, (plain.position[static_cast<std::size_t>(n)] - plain.origin[static_cast<std::size_t>(n)])
                                 .squaredNorm());
            CHECK(plain.displacement_squared[b] == Approx(largest).epsilon(1e-15));  // the order of three summands
        }
    }
}

TEST_CASE("the largest length is found among any number of vectors, and values that are not finite show", "[unit]") {
    std::mt19937_64 random(7);
    std::uniform_real_distribution<Real> uniform(-1, 1);
    for (const std::size_t count : {0u, 1u, 2u, 7u, 8u, 9u, 100u, 256u}) {
        std::vector<Real> flat(3 * count);
        for (Real& x : flat) x = uniform(random);
        const auto found = [&] { return largest_squared_length(count, [&](std::size_t i) { return flat[i]; }); };
        Real largest = 0;
        for (std::size_t n = 0; n < count; ++n)
            largest = std::max(largest, flat[3 * n] * flat[3 * n] + flat[3 * n + 1] * flat[3 * n + 1] +
                                            flat[3 * n + 2] * flat[3 * n + 2]);
        CHECK(found() == largest);
        const Vec3 origin(0.3, -0.2, 0.5);
        const auto both = [&] {
            return largest_squared_lengths(
                count, [v = flat.data()](std::size_t i) { return v[i]; }, origin);
        };
        CHECK(both()[0] == largest);
        CHECK(both()[1] == largest_squared_length(
                               count, [&](std::size_t i) { return flat[i]; }, origin));
        for (const std::size_t place : {std::size_t{0}, flat.size() / 2, flat.size() - 1}) {
            if (count == 0) break;
            for (const Real bad : {not_a_number, -not_a_number, infinite, -infinite, 1e200}) {
                const Real kept = std::exchange(flat[place], bad);
                CHECK_FALSE(found() <= std::numeric_limits<Real>::max());
                CHECK_FALSE(both()[0] <= std::numeric_limits<Real>::max());
                CHECK_FALSE(both()[1] <= std::numeric_limits<Real>::max());
                flat[place] = kept;
            }
        }
    }
}

TEST_CASE("free fall follows its discrete law", "[unit]") {
    // docs/accuracy.md, item 1: v_n = -g n h, x_n = -g h^2 n (n + 1) / 2.
    const Real g = 9.81, h = 1e-3, mass = 0.3;
    Nodes nodes(1);
    nodes.mass[0] = mass;
    nodes.inverse_mass[0] = 1 / mass;
    constexpr int steps = 1000;
    for (int n = 0; n < steps; ++n) {
        nodes.predict(h, Vec3(0, 0, -g));
        nodes.advance(h, false);
    }
    CHECK(nodes.velocity[0].z() == Approx(-g * steps * h).epsilon(1e-12));
    CHECK(nodes.position[0].z() == Approx(-g * h * h * steps * (steps + 1) / 2).epsilon(1e-12));
}

}  // namespace skerry::test::node_stages_test
