// A refused step changes nothing.
#include <algorithm>
#include <catch2/catch.hpp>
#include <set>
#include <string>

#include "engine/world/state_hash.h"
#include "engine/world/step/step.h"
#include "tests/support/lively_scene.h"
#include "tests/support/sliver_box.h"
#include "tests/support/worlds.h"

namespace skerry::test::transaction_test {

namespace {

/// A ball on a plane, and a ball that an attachment moves and rotates. The first gets a load that overflows.
struct Doomed {
    World world;
    BodyHandle ball, held;

    explicit Doomed(Integrator integrator, BodyDynamics held_dynamics) : world({.integrator = integrator}) {
        const auto rubber = world.add_material({.young_modulus = 3e4, .friction = 0.5});
        world.add_collider(Plane{});
        ball = world.add_body(mesh::ball(0.05, 4), {.material = rubber, .position = {0, 0, 0.06}});
        held = world.add_body(mesh::ball(0.05, 4),
                              {.material = rubber, .position = {1, 0, 0.5}, .dynamics = held_dynamics});
        world.attach(held, std::vector<Index>{0, 1, 2}, {.velocity = {0.1, 0, 0}, .angular_velocity = {0, 0, 1}},
                     {1, 0, 0.5});
    }
    void overload() { world.set_loads(ball, std::vector<Vec3>(world.positions(ball).size(), Vec3(1e308, 1e308, 0))); }
};

/// A box with slivers and relaxing material that is shot at a held sheet, so that steps are tried again.
World shot_at_sheet() {
    World world({.gravity = Vec3::Zero(), .integrator = Integrator::symplectic_euler});
    const auto rubber = world.add_material({.young_modulus = 1e5, .poisson_ratio = 0.3});
    const auto soft = world.add_material({.young_modulus = 1e3, .poisson_ratio = 0.3});  // too soft to limit the step
    const Mesh thin = mesh::box({0.4, 0.4, 0.004}, {8, 8, 1});
    const auto sheet = world.add_body(thin, {.material = soft, .position = {0, 0, -0.105}});
    world.attach(sheet, std::vector<Index>{0, 8, 72, 80});
    world.add_body(test::sliver_box(0.2, 8, 0.01, 0.005), {.material = rubber, .velocity = {0, 0, -40}});
    REQUIRE(world.advance(0).ok());
    return world;
}

std::uint64_t runs_of(const World& world, const std::string& name) {
    const WorldReport report = world.report();
    const auto stage = std::ranges::find(report.stages, name, &StageReport::name);
    REQUIRE(stage != report.stages.end());
    return stage->runs;
}

}  // namespace

TEST_CASE("a try as long as the one before it has the same forces without a pass over the elements", "[scene][long]") {
    World world = shot_at_sheet(), twin = shot_at_sheet();
    WorldState &state = WorldAccess::state_of(world), &forgetful = WorldAccess::state_of(twin);
    AttemptLimits tries, twin_tries;
    std::uint64_t tried = 0, longer = 0, crossing = 0, shorter = 0;
    for (int step = 0; step < 200; ++tried) {
        for (WorldState* each : {&state, &forgetful})
            if (each->model.watch.first_piece.empty()) count_pieces(*each);  // as advance() does before each step
        const StepPlan plan = plan_step(state.model, 1, tries.at_most());
        REQUIRE(plan_step(forgetful.model, 1, twin_tries.at_most()).h == plan.h);
        const StepOutcome outcome = try_step(state, plan, tries);
        forgetful.scratch.parameters.h = 0;  // so that no earlier try has the same length
        REQUIRE(try_step(forgetful, plan, twin_tries) == outcome);
        // The twin computes the relaxation again, to first order, since the try before has overwritten that of the last
        // step.
        CHECK(state.scratch.findings.relaxed == Approx(forgetful.scratch.findings.relaxed).epsilon(0.02));
        longer += outcome == StepOutcome::again_with_longer_lists;
        crossing += outcome == StepOutcome::again_with_crossings;
        shorter += outcome == StepOutcome::again_shorter;
        step += outcome == StepOutcome::committed;
    }
    CHECK(world.report().clusters > 0);
    CHECK(longer + crossing > 0);
    CHECK(shorter > 0);
    CHECK(world.state_hash() == twin.state_hash());
    CHECK(world.energy().dissipated == Approx(twin.energy().dissipated).epsilon(1e-3));
    CHECK(runs_of(twin, "dynamics/compute_element_forces") == tried);
    CHECK(runs_of(world, "dynamics/compute_element_forces") == tried - longer - crossing);
}

TEST_CASE("a refused step leaves every column of state as it was", "[scene]") {
    const auto integrator = GENERATE(Integrator::leapfrog, Integrator::symplectic_euler);
    for (const BodyDynamics dynamics : {BodyDynamics::explicit_elastic, BodyDynamics::implicit_elastic}) {
        CAPTURE(integrator, dynamics);
        Doomed scene(integrator, dynamics);
        REQUIRE(scene.world.advance(0.2).ok());
        REQUIRE(scene.world.contacts().size() > 0);
        scene.overload();
        const std::uint64_t before = scene.world.state_hash();
        const StepReport report = scene.world.advance(0.01);
        CHECK(report.status == StepStatus::not_finite);
        CHECK(report.body == scene.ball);
        CHECK(scene.world.state_hash() == before);
        // The world can continue after the refusal.
        scene.world.set_loads(scene.ball, std::vector<Vec3>(scene.world.positions(scene.ball).size(), Vec3::Zero()));
        CHECK(scene.world.advance(0.1).ok());
    }
}

TEST_CASE("between calls clusters are as stiff as their elements, so that no refused step stiffens them",
          "[scene][long]") {
    for (const Integrator integrator : {Integrator::leapfrog, Integrator::symplectic_euler}) {
        World world = test::thrown_slivers({.integrator = integrator});
        REQUIRE(world.advance(0).ok());
        WorldState& state = WorldAccess::state_of(world);
        const auto body = world.bodies().back();
        const auto stiffness = [&] {
            Real sum = 0;
            for (const ElementLane& modulus : state.model.elements.implicit_modulus)
                for (const Real lane_modulus : modulus.lane) sum += lane_modulus;
            return sum;
        };
        const Real before = stiffness();
        for (int call = 0; call < 20; ++call) {
            REQUIRE(world.advance(2e-3).ok());
            const std::uint64_t hash = world.state_hash();
            if (integrator == Integrator::symplectic_euler) CHECK(follow_stiffening(state.model) == 0);
            world.set_loads(body, std::vector<Vec3>(world.positions(body).size(), Vec3(1e308, 1e308, 0)));
            const std::uint64_t loaded = world.state_hash();
            CHECK(world.advance(1e-4).status == StepStatus::not_finite);
            CHECK(world.state_hash() == loaded);
            world.set_loads(body, std::vector<Vec3>(world.positions(body).size(), Vec3::Zero()));
            CHECK(world.state_hash() == hash);
        }
        CHECK(stiffness() > 1.01 * before);
    }
}

TEST_CASE("the outcomes of a try are those of the table", "[scene]") {
    // A step that deforms a body too fast is tried with shorter lengths until it can be taken.
    World world;
    const auto rubber = world.add_material({.young_modulus = 1e5});
    world.add_body(mesh::ball(0.05, 4), {.material = rubber});
    REQUIRE(world.advance(1e-3).ok());
    WorldState& state = WorldAccess::state_of(world);
    const BodyHandle body = world.bodies().front();
    std::vector<Vec3> velocity(world.velocities(body).size(), Vec3::Zero());
    const Real stable = state.model.bodies.stable_step[0];
    const StepPlan plan{.h = stable, .steps = 2, .stable = stable, .regular = stable};

    AttemptLimits tries;
    CHECK(try_step(state, plan, tries) == StepOutcome::committed);

    velocity[0].x() = 0.9 * state.model.bodies.min_altitude[0] / plan.h;  // two corners part by most of their altitude
    world.set_velocities(body, velocity);
    const std::uint64_t before = world.state_hash();
    tries = {};
    CHECK(try_step(state, plan, tries) == StepOutcome::again_shorter);
    const StrainRate fastest = state.scratch.findings.verdict.fastest;
    CHECK(fastest.body == 0);
    CHECK(fastest.rate * plan.h > state.model.tuning.max_strain_step);
    // The next try is a tenth shorter than the present strain rate allows, but at least a quarter of the step.
    CHECK(tries.at_most() == Approx(std::max(0.9 * state.model.tuning.max_strain_step / fastest.rate, plan.h / 4)));
    CHECK(tries.fastest == 0);
    CHECK(world.state_hash() == before);

    velocity[0].x() *= 1600;  // too fast even for a 1024th of the step
    world.set_velocities(body, velocity);
    tries = {};
    const auto try_at = [&](Real h, Real regular) {
        tries = {};
        return try_step(state, {.h = h, .steps = 2, .stable = stable, .regular = regular}, tries);
    };
    CHECK(try_at(stable / 128, stable) == StepOutcome::again_shorter);
    CHECK(tries.at_most() == Approx(stable / 512));  // at least a quarter of the step
    CHECK(try_at(stable / 1024, stable) == StepOutcome::refused);
    CHECK(state.scratch.findings.verdict.fault == StepFault::too_fast);
    // A joint that rotates fast shortens all steps. Then a step of that length is not yet the shortest.
    CHECK(try_at(stable / 1024, stable / 1024) == StepOutcome::again_shorter);
}

TEST_CASE("before a step is known to be good, it writes only data that the transaction restores", "[scene]") {
    Doomed scene(Integrator::leapfrog, BodyDynamics::explicit_elastic);
    WorldState& state = WorldAccess::state_of(scene.world);
    const auto lies_in = [](const void* address, const Access& access) {
        const auto at = reinterpret_cast<std::uintptr_t>(address);
        return at >= access.begin && at < access.end;
    };
    const auto touches = [&](const StageDeclaration& stage, const void* address, bool writes) {
        return std::ranges::any_of(stage.accesses, [&](const Access& access) {
            return access.writes() == writes && lies_in(address, access);
        });
    };
    std::set<std::string> written;
    int behind_guard = 0;
    for (const StageDeclaration& stage : state.graph.stages()) {
        if (stage.guarded && touches(stage, &state.scratch.findings.crossings, false)) {
            ++behind_guard;  // it runs only in a valid step
            continue;
        }
        const auto note = [&](const std::string& table) {
            return [&, table](const char* name, auto& column, ColumnRole role) {
                if (is_state(role) && touches(stage, &column, true)) written.insert(table + "." + name);
            };
        };
        state.model.for_each_table([&](const char* table, auto& columns) { columns.for_each_column(note(table)); });
        state.cache.warm_start.for_each_column(note("warm_start"));
        state.cache.resting.for_each_column(note("resting"));
        state.cache.pairs.for_each_row_column(note("pairs"));
    }
    CHECK(behind_guard >= 4);
    // The list is that of transaction.h. nodes.velocity_next is derived, and no stage writes the columns of drift_to.
    CHECK(written == std::set<std::string>{"nodes.velocity", "bodies.max_speed", "elements.implicit_modulus",
                                           "pairs.key", "pairs.kind", "pairs.first", "pairs.second", "pairs.state"});
}

}  // namespace skerry::test::transaction_test
