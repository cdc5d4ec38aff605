// Multirate beside contacts and in quick deformation: elements that are due in every step, impulses that are too long,
// and what viscosity takes (docs/methods/stable_step.md 7).
#include "systems/dynamics/elements/touched_elements.h"

#include <catch2/catch.hpp>

#include <algorithm>
#include <limits>

#include "systems/dynamics/checks/limit_impulses.h"
#include "systems/dynamics/checks/measure_viscosity.h"
#include "systems/dynamics/motion/predict_velocity.h"
#include "tests/support/elastic_body.h"

namespace skerry::test::touched_elements_test {

namespace {

/// A strained, moving box whose blocks have levels 0 to 2, ascending, in patches of up to four blocks.
struct LevelledBody : ElasticBody {
    std::unique_ptr<Executor> executor = make_executor(Backend::serial, 1);
    std::mt19937_64 random{7};
    std::vector<std::uint8_t> node_touched, body_level{0}, body_cap{2}, body_touched{0};
    std::vector<Index> of_body;
    std::vector<LevelMask> levels;
    std::vector<Vec3> held;

    LevelledBody()
        : ElasticBody(jittered_box({4, 4, 4}, 0.1, 0.2, 3),
                      MaterialConstants{MaterialModel::stable_neo_hookean, 4e4, 6e4, 1000}) {
        for (Vec3& x : position) x += 0.002 * random_vector(random);
        for (Vec3& v : velocity) v = random_vector(random);
        const std::size_t count = elements.level.size();
        for (std::size_t b = 0; b < count; ++b) {
            elements.level[b] = static_cast<std::uint8_t>(3 * b / count);
            elements.opens_patch[b] = b % 4 == 0 || elements.level[b] != elements.level[b - 1];
        }
        patches = {};
        build_patches(elements, position.size(), element_nodes, patches);
        of_body.assign(count, 0);
        node_touched.assign(position.size(), 0);
        held.assign(position.size(), Vec3::Zero());
        levels.assign(position.size(), 0);
        for (std::size_t slot = 0; slot < patches.node.size(); ++slot)
            levels[static_cast<std::size_t>(patches.node[slot])] |= static_cast<LevelMask>(1u << patches.level[slot]);
    }
    Range nodes() const { return {0, static_cast<Index>(position.size())}; }
    void touch() {
        find_touched_blocks(element_nodes, node_touched, blocks, elements);
        body_touched[0] = mark_touched(elements, element_nodes, blocks, nodes(), patches, levels);
    }
    ElementInputs due(unsigned mask, Real duration) const {
        ElementInputs inputs = ElasticBody::inputs();
        inputs.schedule = {elements.level, of_body, body_level, {}, {}, {}, body_cap, elements.touched, body_touched};
        for (std::size_t l = 0; l < step_level_count; ++l)
            inputs.schedule.active.duration[l] = (mask >> l & 1) != 0 ? duration : 0;
        return inputs;
    }
    void compute(const ElementInputs& inputs, Real h, std::span<ElementViscousImpulse> impulse = {},
                 std::span<std::uint8_t> viscous = {}) {
        PatchForces forces = patch_forces();
        forces.touched = patches.touched;
        forces.viscous_impulse = impulse;
        forces.viscous = viscous;
        compute_element_forces(*executor, inputs, position, velocity, h, 0, elements.rotation,
                               {elements.rotation_next, elements.viscous_strain_next}, forces);
    }
    std::vector<Vec3> kicked(unsigned mask, Real h) {
        const std::vector<LevelMask> active{
            static_cast<LevelMask>(mask | (body_touched[0] != 0 ? 1u << touched_level : 0))};
        const std::vector<Index> begin{0, 40, 41}, end{40, 41, nodes().end}, of_block{0, 0, 0};
        std::vector<Vec3> next(position.size());
        const KickInputs inputs{begin,
                                end,
                                of_block,
                                patches.slots_of_node.view(),
                                patches.force,
                                {active, levels, patches.level},
                                mass,
                                inverse_mass,
                                Vec3(0, 0, -9.81)};
        predict_velocity(*executor, inputs, velocity, h, held, next);
        return next;
    }
};

}  // namespace

TEST_CASE("elements of touched nodes get an impulse in every step, all others when they are due", "[unit]") {
    constexpr Real h = 1e-4, duration = 4;
    for (const unsigned mask : {0x0u, 0x1u, 0x2u, 0x5u, 0x7u}) {
        INFO("levels " << mask);
        LevelledBody body;
        for (const std::size_t n : {std::size_t{3}, std::size_t{60}}) body.node_touched[n] = 1;
        body.touch();
        REQUIRE(body.body_touched[0] == 1);
        // an element is touched with all others of its block, and no block without a touched node is
        std::size_t touched = 0;
        for (std::size_t b = 0; b < body.elements.level.size(); ++b) {
            bool any = false;
            for (std::size_t l = 0; l < element_lanes; ++l)
                for (std::size_t k = 0; k < 4; ++k) any |= body.node_touched[body.node(b * element_lanes + l, k)] != 0;
            CHECK(any == (body.elements.touched[b] != 0));
            touched += any;
        }
        REQUIRE(touched > 1);
        REQUIRE(2 * touched < body.elements.level.size());

        // the same forces, block by block, each for as long as it is due
        std::vector<Vec3> expected = body.velocity;
        for (std::size_t n = 0; n < expected.size(); ++n) expected[n] += h * Vec3(0, 0, -9.81);
        LevelledBody plain;
        for (std::size_t b = 0; b < plain.elements.level.size(); ++b) {
            const bool due = (mask >> plain.elements.level[b] & 1) != 0;
            const Real seconds = body.elements.touched[b] ? h : (due ? duration * h : 0);
            LevelledBody one;
            for (std::size_t other = 0; other < one.elements.volume.size(); ++other)
                if (other != b) one.elements.volume[other] = {};
            one.compute_elements(*one.executor);
            one.gather();
            for (std::size_t n = 0; n < expected.size(); ++n)
                expected[n] += seconds * one.inverse_mass[n] * one.force[n];
        }
        // what a patch had before must not be seen where it is not due
        for (PaddedVec3& force : body.patches.force) force = {{1, 2, 3, 0}};
        body.compute(body.due(mask, duration), h);
        const std::vector<Vec3> next = body.kicked(mask, h);
        for (std::size_t n = 0; n < next.size(); ++n)
            CHECK((next[n] - expected[n]).norm() <= 1e-12 * (1 + expected[n].norm()));
    }
}

TEST_CASE("nodes that are touched no more leave no trace", "[unit]") {
    LevelledBody body, plain;
    body.node_touched[3] = 1;
    body.touch();
    REQUIRE(body.body_touched[0] == 1);
    REQUIRE(std::ranges::count(body.patches.level, touched_level) > 0);
    body.node_touched[3] = 0;
    body.touch();
    CHECK(body.body_touched[0] == 0);
    for (std::size_t n = 0; n < body.levels.size(); ++n) CHECK(body.levels[n] == plain.levels[n]);
    for (std::size_t s = 0; s < body.patches.level.size(); ++s) CHECK(body.patches.level[s] == plain.patches.level[s]);
    for (std::size_t p = 0; p < body.patches.touched.size(); ++p) CHECK(body.patches.touched[p] == 0);
}

TEST_CASE("a level above that of the cap is due with the cap", "[unit]") {
    LevelledBody body;
    body.body_cap[0] = 1;
    const ElementInputs inputs = body.due(0x2, 2);
    for (std::size_t b = 0; b < body.elements.level.size(); ++b)
        CHECK(inputs.schedule.duration(b) == (body.elements.level[b] == 0 ? 0 : 2));
}

TEST_CASE("impulses are as long as the strain rate of each element allows", "[unit]") {
    constexpr Real h = 1e-5, most = 0.2, unlimited = std::numeric_limits<Real>::max();
    for (const Real scale : {1e-3, 1.0, 30.0, 300.0}) {
        INFO("speeds times " << scale);
        LevelledBody body;
        for (Vec3& v : body.velocity) v = scale * v + Vec3(0, 0, -50);
        body.node_touched[3] = 1;
        body.touch();
        const std::vector<Range> blocks{body.blocks};
        const std::vector<std::uint8_t> body_level{2}, asleep{0};
        std::array<Index, element_level_count> count{};
        std::array<Real, element_level_count> steepness{};
        Real speed = 0, expected = unlimited;
        for (const Vec3& v : body.velocity) speed = std::max(speed, (v - Vec3(0, 0, -50)).norm());
        for (std::size_t e = 0; e < body.elements.level.size() * element_lanes; ++e) {
            if (!(body.volume(e) > 0)) continue;
            const std::size_t block = e / element_lanes, level = body.elements.level[block];
            ++count[level];
            Mat3 rate = Mat3::Zero();
            Real sum = 0;
            for (std::size_t k = 0; k < 4; ++k) {
                rate += body.velocity[body.node(e, k)] * body.gradient(e, k).transpose();
                sum += body.gradient(e, k).norm();
            }
            steepness[level] = std::max(steepness[level], sum);
            CHECK(rate.norm() <= speed * sum * (1 + 1e-12));
            if (body.elements.touched[block]) continue;
            if (std::ldexp(h, 2 + static_cast<int>(level)) * rate.norm() > most)
                expected = std::min(expected, most / rate.norm());
        }
        const std::vector counts{count};
        const std::vector steep{steepness};
        const std::vector<Real> speeds{speed};
        const ImpulseLimitInputs inputs{blocks,
                                        body_level,
                                        asleep,
                                        counts,
                                        steep,
                                        speeds,
                                        body.elements.first,
                                        body.elements.count,
                                        body.elements.level,
                                        body.elements.touched,
                                        body.element_nodes.node,
                                        body.element_nodes.gradient,
                                        body.elements.implicit_modulus,
                                        body.velocity};
        Column<Real> parts;
        std::vector<Real> longest{-1};
        limit_impulses(*body.executor, inputs, h, most, false, parts, longest);
        if (longest[0] != -1) CHECK(expected == unlimited);  // by speeds alone, and then rightly
        if (scale == 1e-3) CHECK(longest[0] == unlimited);
        limit_impulses(*body.executor, inputs, h, most, true, parts, longest);
        if (expected == unlimited)
            CHECK(longest[0] == unlimited);
        else
            CHECK(longest[0] == Approx(expected).epsilon(1e-12));
        CHECK((expected == unlimited) == (scale <= 1));
    }
}

TEST_CASE("what viscosity takes is what its impulses do to moving nodes", "[unit]") {
    constexpr Real h = 1e-4, duration = 2;
    LevelledBody body;
    std::vector<Vec3> next;
    for (const Vec3& v : body.velocity) next.push_back(v + 0.5 * random_vector(body.random));
    std::vector<Real> time(body.elements.first.size(), 0);
    for (std::size_t p = 0; p < body.patches.blocks.size(); p += 2)
        for (Index b = body.patches.blocks[p].begin; b < body.patches.blocks[p].end; ++b)
            time[static_cast<std::size_t>(b)] = 1e-4;
    std::vector<ElementViscousImpulse> impulse(time.size());
    std::vector<std::uint8_t> viscous(time.size());
    for (const unsigned mask : {0x1u, 0x6u}) {
        ElementInputs inputs = body.due(mask, duration);
        for (PaddedVec3& force : body.patches.force) force = {};
        body.compute(inputs, h);
        body.gather();
        const std::vector<Vec3> elastic = body.force;
        inputs.viscous_time = time;
        body.compute(inputs, h, impulse, viscous);
        body.gather();
        Real expected = 0;
        for (std::size_t n = 0; n < elastic.size(); ++n)
            expected -= h * (body.force[n] - elastic[n]).dot(body.velocity[n] + next[n]) / 2;
        Column<Real> parts;
        const Real taken = measure_viscosity(*body.executor, inputs, body.patches.blocks, impulse, viscous,
                                             body.velocity, next, parts);
        CHECK(expected > 0);
        CHECK(taken == Approx(expected).epsilon(1e-10));
    }
}

}  // namespace skerry::test::touched_elements_test
