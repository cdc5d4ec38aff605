#include <catch2/catch.hpp>
#include <limits>
#include <numeric>
#include <random>
#include <vector>

#include "systems/dynamics/motion/advance_positions.h"
#include "systems/dynamics/motion/measure_displacement.h"
#include "systems/dynamics/motion/predict_velocity.h"
#include "systems/dynamics/stability/largest_length.h"

using namespace skerry;

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
            body.push_back(n >= 3);  // the first block is a body of its own
        }
        displacement_squared.resize(begin.size());
    }
    void predict(Real h, const Vec3& gravity = Vec3::Zero(), bool loaded = true) {
        KickInputs inputs{begin, end, body, slots_of_node.view(), {}, {}, mass, inverse_mass, gravity};
        if (loaded) inputs.load = load;
        predict_velocity(*executor, inputs, velocity, h, force, next);
    }
    void advance(Real h, bool pushed, Integrator integrator = Integrator::symplectic_euler,
                 std::span<const std::uint8_t> asleep = {}) {
        const std::span<Vec3> none;
        advance_positions(*executor, {begin, end, body, asleep, next, origin}, h, integrator,
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
    CHECK(nodes.next[2] == Vec3(0, 0, 1));  // a pinned node stays put even under a force that is no number
    CHECK(nodes.force[1] == Vec3(1, 2, 3));
    predict_velocity(*nodes.executor, {}, {}, 0.25, {}, {});
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
    advance_positions(*nodes.executor, {}, 0.5, Integrator::symplectic_euler, {});
}

TEST_CASE("a drift without a push-out has the bits of one with a push-out of zero", "[unit]") {
    const auto integrator = GENERATE(Integrator::symplectic_euler, Integrator::forward_euler);
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
            if (copy != &start)
                copy->advance(0.3, copy == &pushed, integrator, rest ? asleep : std::vector<std::uint8_t>());
        }
        for (std::size_t n = 0; n < 11; ++n) {
            const bool moves = n < 3 || !rest;
            const Vec3 with = integrator == Integrator::forward_euler ? start.velocity[n] : start.next[n];
            CHECK(plain.position[n] == (moves ? Vec3(start.position[n] + 0.3 * with) : start.position[n]));
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

TEST_CASE("the largest length is found among any number of vectors, and what is not finite shows", "[unit]") {
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
        for (const std::size_t place : {std::size_t{0}, flat.size() / 2, flat.size() - 1}) {
            if (count == 0) break;
            for (const Real bad : {not_a_number, -not_a_number, infinite, -infinite, 1e200}) {
                const Real kept = std::exchange(flat[place], bad);
                CHECK_FALSE(found() <= std::numeric_limits<Real>::max());
                flat[place] = kept;
            }
        }
    }
}

TEST_CASE("free fall follows its discrete law", "[unit]") {
    // docs/methods/accuracy.md 1: v_n = -g n h, x_n = -g h^2 n (n + 1) / 2.
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
