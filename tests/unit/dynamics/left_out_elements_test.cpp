// Skipped elements of bodies that are inactive in a step, and the kick by the forces of the others.
#include <catch2/catch.hpp>

#include "systems/dynamics/elements/keep_memory.h"
#include "systems/dynamics/motion/predict_velocity.h"
#include "tests/support/elastic_body.h"

namespace skerry::test::left_out_elements_test {

namespace {

/// A strained, moving box with slivers.
struct SliverBody : ElasticBody {
    std::unique_ptr<Executor> executor = make_executor(Backend::serial, 1);
    std::mt19937_64 random{7};

    explicit SliverBody(MaterialModel model = MaterialModel::stable_neo_hookean)
        : ElasticBody(jittered_box({4, 4, 4}, 0.1, 0.3, 3, 0.01), MaterialConstants{model, 4e4, 6e4, 1000}) {
        for (Vec3& x : position) x += 0.002 * random_vector(random);
        for (Vec3& v : velocity) v = random_vector(random);
    }
    void compute(const ElementInputs& inputs) {
        compute_element_forces(*executor, inputs, position, velocity, 1e-3, elements.rotation,
                               {elements.rotation_next, elements.spring_strain_next}, patch_forces());
    }
    /// Assigns the patches alternately to two bodies.
    std::vector<Index> bodies_in_turns() const {
        std::vector<Index> body(elements.first.size());
        for (std::size_t p = 0; p < patches.blocks.size(); ++p)
            for (Index b = patches.blocks[p].begin; b < patches.blocks[p].end; ++b)
                body[static_cast<std::size_t>(b)] = static_cast<Index>(p % 2);
        return body;
    }
};

}  // namespace

TEST_CASE("patches of bodies that rest or are unstrained keep their force, others get theirs", "[unit]") {
    SliverBody body;
    const std::vector<Index> of_body = body.bodies_in_turns();
    REQUIRE(body.patches.blocks.size() > 1);
    body.compute(body.inputs());
    const Column<PaddedVec3> all = body.patches.force;
    const std::vector<std::uint8_t> asleep{0, 1};
    const std::vector<std::uint16_t> unstrained{0, 5};
    for (const bool sleeps : {false, true}) {
        for (PaddedVec3& force : body.patches.force) force = {{1, 2, 3, 0}};
        ElementInputs inputs = body.inputs();
        inputs.body = of_body;
        if (sleeps)
            inputs.body_idle = asleep;
        else
            inputs.body_unstrained = unstrained;
        body.compute(inputs);
        for (std::size_t p = 0; p < body.patches.blocks.size(); ++p)
            for (Index s = body.patches.slots[p].begin; s < body.patches.slots[p].end; ++s) {
                const auto slot = static_cast<std::size_t>(s);
                CHECK(vector_of(body.patches.force[slot]) == (p % 2 == 1 ? Vec3(1, 2, 3) : vector_of(all[slot])));
            }
    }
}

TEST_CASE("frames and strains of a step are kept for bodies that were in it", "[unit]") {
    SliverBody body(MaterialModel::corotational);
    body.constants[0].loss_factor = 0.1;
    for (RelaxationRates& rates : body.elements.relaxation_rate) rates.fill(100);
    for (Real& share : body.elements.relaxing_share) share = 0.1;
    const std::vector<Index> of_body = body.bodies_in_turns();
    const std::vector<std::uint8_t> asleep{1, 0};
    ElementInputs inputs = body.inputs();
    inputs.body = of_body;
    inputs.body_idle = asleep;
    body.compute(inputs);
    keep_memory(*body.executor, inputs, body.elements);
    for (std::size_t b = 0; b < of_body.size(); ++b) {
        CHECK((body.elements.rotation[b][1][0] != 0) == (of_body[b] == 1));
        CHECK((body.elements.spring_strain[b][0][0] != 0) == (of_body[b] == 1));
    }
    for (std::size_t p = 0; p < body.patches.blocks.size(); ++p) CHECK((body.patches.relaxed[p] > 0) == (p % 2 == 1));
}

TEST_CASE("the kick has the bits of forces gathered first", "[unit]") {
    SliverBody body;
    body.compute(body.inputs());
    const bool loaded = GENERATE(false, true), held = GENERATE(false, true);
    const Vec3 gravity = GENERATE(Vec3(1, 2, -9.81), Vec3(0, 0, 0));
    if (loaded)
        for (Vec3& f : body.load) f = random_vector(body.random);
    if (held)
        for (std::size_t n = 0; n < body.position.size(); n += 7) body.inverse_mass[n] = 0;
    const auto count = static_cast<Index>(body.position.size());
    const std::vector<Index> begin{0, 40, 41}, end{40, 41, count}, of_block{0, 0, 0};
    constexpr Real h = 1e-3;
    std::vector<Vec3> next(body.position.size(), Vec3::Zero()), expected = next, on_held = next;
    KickInputs inputs{
        begin,  end, of_block, body.patches.slots_of_node.view(), body.patches.force, body.mass, body.inverse_mass,
        gravity};
    if (loaded) inputs.load = body.load;
    predict_velocity(*body.executor, inputs, body.velocity, h, on_held, next);
    body.gather(gravity);
    kick(body.force, body.inverse_mass, body.velocity, h, expected);
    for (std::size_t n = 0; n < next.size(); ++n) {
        CHECK(next[n] == expected[n]);
        CHECK(on_held[n] == (body.inverse_mass[n] == 0 ? body.force[n] : Vec3(Vec3::Zero())));
    }
}

}  // namespace skerry::test::left_out_elements_test
