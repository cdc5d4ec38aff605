// Levels of elements, impulses of several steps, and the viscosity of fine elements.
#include <catch2/catch.hpp>

#include "systems/dynamics/elements/keep_memory.h"
#include "systems/dynamics/motion/predict_velocity.h"
#include "systems/dynamics/stability/element_levels.h"
#include "systems/dynamics/stability/stable_step.h"
#include "tests/support/elastic_body.h"

namespace skerry::test::element_levels_test {

namespace {

MaterialConstants rubber(MaterialModel model) {
    return {model, 4e4, 6e4, 1000};
}

/// A strained, moving box with slivers.
struct SliverBody : ElasticBody {
    std::unique_ptr<Executor> executor = make_executor(Backend::serial, 1);
    std::mt19937_64 random{7};

    explicit SliverBody(MaterialModel model = MaterialModel::stable_neo_hookean)
        : ElasticBody(jittered_box({4, 4, 4}, 0.1, 0.3, 3, 0.01), rubber(model)) {
        for (Vec3& x : position) x += 0.002 * random_vector(random);
        for (Vec3& v : velocity) v = random_vector(random);
    }
    void compute(const ElementInputs& inputs) {
        compute_element_forces(*executor, inputs, position, velocity, 1e-3, 0, elements.rotation,
                               {elements.rotation_next, elements.viscous_strain_next}, patch_forces());
    }
    /// Gives every block a level, in a patch of its own.
    template <class LevelOf>
    void set_levels(LevelOf&& level_of) {
        for (std::size_t b = 0; b < elements.level.size(); ++b) {
            elements.level[b] = static_cast<std::uint8_t>(level_of(b));
            elements.opens_patch[b] = 1;
        }
        patches = {};
        build_patches(elements, position.size(), element_nodes, patches);
    }
};

}  // namespace

TEST_CASE("every level of a mesh with slivers stands its own step", "[unit]") {
    SliverBody body;
    std::vector<Real> sums(body.position.size());
    const Real step = stable_step(body.inputs(), body.blocks, body.position, body.mass, sums).step;
    std::vector<std::uint8_t> level(static_cast<std::size_t>(body.blocks.size()) * element_lanes);
    find_element_levels(body.inputs(), body.blocks, body.position, body.mass, step, sums, level);
    CHECK(*std::min_element(level.begin(), level.end()) == 0);
    CHECK(*std::max_element(level.begin(), level.end()) >= 1);

    // Blocks have the lowest level of their lanes. Then level by level the bound gives back the step of the body, and a
    // level more for all that are above 0 does not.
    for (std::size_t b = 0; b < body.elements.level.size(); ++b)
        body.elements.level[b] =
            *std::min_element(level.begin() + static_cast<std::ptrdiff_t>(b * element_lanes),
                              level.begin() + static_cast<std::ptrdiff_t>((b + 1) * element_lanes));
    ElementInputs inputs = body.inputs();
    inputs.schedule.level = body.elements.level;
    CHECK(stable_step(inputs, body.blocks, body.position, body.mass, sums).step == Approx(step).epsilon(1e-12));
    for (auto& l : body.elements.level) l = static_cast<std::uint8_t>(l + 1);
    CHECK(stable_step(inputs, body.blocks, body.position, body.mass, sums).step < 0.6 * step);
}

TEST_CASE("blocks that are not due keep their force, those due for four steps get four times as much", "[unit]") {
    SliverBody body;
    const std::vector<Index> of_body(body.elements.first.size(), 0);
    const std::vector<std::uint8_t> body_level{1};
    body.set_levels([](std::size_t b) { return b % 2; });
    ElementInputs inputs = body.inputs();
    body.compute(inputs);
    const Column<PaddedVec3> once = body.patches.force;
    for (PaddedVec3& force : body.patches.force) force = {{1, 2, 3, 0}};
    inputs.schedule = {body.elements.level, of_body, body_level, {}};
    inputs.schedule.active.duration.fill(0);
    inputs.schedule.active.duration[2] = 4;  // level 1 of a body of level 1
    body.compute(inputs);
    for (std::size_t slot = 0; slot < once.size(); ++slot) {
        const Vec3 force = vector_of(body.patches.force[slot]);
        if (body.patches.level[slot] == 1)
            CHECK((force - 4 * vector_of(once[slot])).norm() <= 1e-14 * force.norm());
        else
            CHECK(force == Vec3(1, 2, 3));
    }
}

TEST_CASE("nodes are kicked by the patches that are due and nothing else", "[unit]") {
    SliverBody body;
    const std::size_t nodes = body.position.size();
    std::vector<LevelMask> levels(nodes, 0);
    const std::size_t block_count = body.elements.level.size();
    body.set_levels([&](std::size_t b) { return 4 * b / block_count; });  // sorted, as a body sorts them
    body.compute(body.inputs());
    for (std::size_t slot = 0; slot < body.patches.node.size(); ++slot)
        levels[static_cast<std::size_t>(body.patches.node[slot])] |=
            static_cast<LevelMask>(1u << body.patches.level[slot]);
    for (Vec3& f : body.load) f = random_vector(body.random);
    const Vec3 gravity = GENERATE(Vec3(0, 0, -9.81), Vec3(0, 0, 0));
    const bool loaded = GENERATE(true, false), held = GENERATE(true, false);
    if (!loaded) std::fill(body.load.begin(), body.load.end(), Vec3::Zero());
    if (held)
        for (std::size_t n = 0; n < nodes; n += 7) body.inverse_mass[n] = 0;
    const std::vector<Index> pinned_count{held};
    constexpr Real h = 1e-3;
    std::vector<Vec3> next(nodes);
    const std::vector<Index> begin{0, 40, 41}, end{40, 41, static_cast<Index>(nodes)}, of_block{0, 0, 0};
    for (const unsigned mask : {0x0u, 0x1u, 0x5u, 0xau, 0xfu}) {
        INFO("levels " << mask);
        const std::vector<LevelMask> due{static_cast<LevelMask>(mask)};
        KickInputs inputs{begin,
                          end,
                          of_block,
                          body.patches.slots_of_node.view(),
                          body.patches.force,
                          {due, levels, body.patches.level},
                          body.mass,
                          body.inverse_mass,
                          gravity};
        inputs.body_pinned_count = pinned_count;
        if (loaded) inputs.load = body.load;
        predict_velocity(*body.executor, inputs, body.velocity, h, body.force, next);
        for (std::size_t n = 0; n < nodes; ++n) {
            Vec3 sum = Vec3::Zero();
            for (const Index slot : body.patches.slots_of_node[n])
                if ((mask >> body.patches.level[static_cast<std::size_t>(slot)] & 1) != 0)
                    sum += vector_of(body.patches.force[static_cast<std::size_t>(slot)]);
            sum = sum + body.mass[n] * gravity + body.load[n];
            if (body.inverse_mass[n] == 0) CHECK(body.force[n] == sum);
            const Vec3 expected = body.inverse_mass[n] == 0 ? body.velocity[n]
                                                            : Vec3(body.velocity[n] + (h * body.inverse_mass[n]) * sum);
            CHECK(next[n] == expected);
        }
    }
}

TEST_CASE("all elements due, the kick has the bits of forces gathered first", "[unit]") {
    SliverBody body;
    body.compute(body.inputs());
    for (Vec3& f : body.load) f = random_vector(body.random);
    for (std::size_t n = 0; n < body.position.size(); n += 7) body.inverse_mass[n] = 0;
    const auto count = static_cast<Index>(body.position.size());
    const std::vector<Index> begin{0, 40}, end{40, count}, of_block{0, 0};
    const Vec3 gravity(1, 2, -9.81);
    constexpr Real h = 1e-3;
    std::vector<Vec3> next(body.position.size(), Vec3::Zero()), expected = next, held = next;
    KickInputs inputs{begin,
                      end,
                      of_block,
                      body.patches.slots_of_node.view(),
                      body.patches.force,
                      {},
                      body.mass,
                      body.inverse_mass,
                      gravity,
                      body.load};
    predict_velocity(*body.executor, inputs, body.velocity, h, held, next);
    body.gather(gravity);
    kick(body.force, body.inverse_mass, body.velocity, h, expected);
    for (std::size_t n = 0; n < next.size(); ++n) {
        CHECK(next[n] == expected[n]);
        CHECK(held[n] == (body.inverse_mass[n] == 0 ? body.force[n] : Vec3(Vec3::Zero())));
    }
}

TEST_CASE("a range of blocks is passed over only if none of them is due", "[unit]") {
    // Three bodies, sorted by level, the second one asleep or at another level.
    const std::vector<std::uint8_t> level{0, 0, 1, 1, 1, 1, 3, 1, 1, 1, 1, 0, 1, 1, 1, 2};
    const std::vector<Index> of_body{0, 0, 0, 0, 0, 0, 0, 1, 1, 1, 1, 2, 2, 2, 2, 2};
    int passed = 0;
    for (const std::uint8_t second : std::array<std::uint8_t, 3>{0, 1, 2})
        for (const unsigned mask : {0x1u, 0x2u, 0x4u, 0x9u, 0xfu})
            for (const std::uint8_t rests : std::array<std::uint8_t, 2>{0, 1}) {
                const std::vector<std::uint8_t> body_level{0, second, 1}, asleep{0, rests, 0};
                ElementSchedule schedule{level, of_body, body_level, {}, asleep};
                for (std::size_t l = 0; l < step_level_count; ++l)
                    schedule.active.duration[l] = (mask >> l & 1) != 0 ? 2 : 0;
                for (std::size_t begin = 0; begin < level.size(); ++begin)
                    for (std::size_t end = begin + 1; end <= level.size(); ++end) {
                        if (!schedule.none_active(begin, end)) continue;
                        ++passed;
                        for (std::size_t b = begin; b < end; ++b) CHECK(schedule.duration(b) == 0);
                    }
            }
    CHECK(passed > 100);
}

TEST_CASE("viscosity gives no force and no torque as a whole, takes energy, and leaves rigid motion alone", "[unit]") {
    const auto model = GENERATE(MaterialModel::linear, MaterialModel::corotational, MaterialModel::stable_neo_hookean);
    SliverBody body(model);
    const std::vector<Real> time(body.elements.first.size(), 1e-3);
    ElementInputs inputs = body.inputs();
    const auto viscous_part = [&] {
        inputs.viscous_time = {};
        body.compute(inputs);
        body.gather();
        const std::vector<Vec3> elastic = body.force;
        inputs.viscous_time = time;
        body.compute(inputs);
        body.gather();
        std::vector<Vec3> force = body.force;
        for (std::size_t n = 0; n < force.size(); ++n) force[n] -= elastic[n];
        return force;
    };
    Real size = 0, power = 0;
    Vec3 sum = Vec3::Zero(), torque = Vec3::Zero();
    std::vector<Vec3> force = viscous_part();
    for (std::size_t n = 0; n < force.size(); ++n) {
        size += force[n].norm();
        sum += force[n];
        torque += body.position[n].cross(force[n]);
        power += force[n].dot(body.velocity[n]);
    }
    REQUIRE(size > 1);
    // Differences of forces that are some times as large: rounding to 1e-13 of them.
    CHECK(sum.norm() < 1e-12 * size);
    CHECK(torque.norm() < 1e-12 * size);
    CHECK(power < -1e-3 * size);
    for (std::size_t n = 0; n < force.size(); ++n)
        body.velocity[n] = Vec3(1, 2, 3) + Vec3(-2, 1, 4).cross(body.position[n]);
    force = viscous_part();
    for (const Vec3& f : force) CHECK(f.norm() < 1e-11 * size);
}

TEST_CASE("frames and strains are kept of blocks that were due", "[unit]") {
    SliverBody body(MaterialModel::corotational);
    body.constants[0].loss_factor = 0.1;
    for (ElementLane& rate : body.elements.relaxation_rate)
        for (Real& lane : rate.lane) lane = 100;
    for (Real& share : body.elements.relaxing_share) share = 0.1;
    const std::vector<Index> of_body(body.elements.first.size(), 0);
    const std::vector<std::uint8_t> body_level{0};
    body.set_levels([](std::size_t b) { return b % 2; });
    ElementInputs inputs = body.inputs();
    inputs.schedule = {body.elements.level, of_body, body_level, {}};
    inputs.schedule.active.duration.fill(0);
    inputs.schedule.active.duration[1] = 2;
    body.compute(inputs);
    keep_memory(*body.executor, inputs, body.elements);
    for (std::size_t b = 0; b < body.elements.level.size(); ++b) {
        const bool turned = body.elements.rotation[b][1][0] != 0;
        CHECK(turned == (b % 2 == 1));
        const bool forgot = body.elements.viscous_strain[b][0][0] != 0;
        CHECK(forgot == (b % 2 == 1));
        CHECK((body.patches.relaxed[b] > 0) == (b % 2 == 1));
    }
}

}  // namespace skerry::test::element_levels_test
