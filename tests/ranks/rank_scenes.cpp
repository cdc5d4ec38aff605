#include "tests/ranks/rank_scenes.h"

#include <algorithm>
#include <atomic>
#include <cstdio>
#include <stdexcept>
#include <utility>

#include "engine/scene/scene_plan.h"
#include "engine/world/state_hash.h"
#include "engine/world/world_state.h"
#include "tests/fuzz/random_scene.h"
#include "tests/ranks/first_difference.h"
#include "tests/ranks/thread_ranks.h"
#include "tests/support/temporary_folder.h"

namespace skerry::test {

namespace {

constexpr int calls = 3;  // of advance in a run; more than one, because each call starts and ends in its own way

/// Rows of the bodies that state_hash covers one by one, in the order of their slots.
std::vector<std::size_t> rows_in_slot_order(const Model& model) {
    std::vector<std::size_t> rows;
    for (std::size_t b = 0; b < model.bodies.slot.size(); ++b)
        if (model.bodies.kind[b] == BodyKind::deformable) rows.push_back(b);
    std::ranges::sort(rows, {}, [&](std::size_t row) { return model.bodies.slot[row]; });
    return rows;
}

std::function<World(int threads)> maker_of(ScenePlan plan) {
    return [plan = std::move(plan)](int threads) {
        ScenePlan with_threads = plan;
        with_threads.settings.threads = threads;
        return build_scene(with_threads).world;
    };
}

/// Runs a world in several calls of advance. `look(step)` follows each committed step, numbered from 0. `go_on`: see
/// World::advance.
std::vector<StepReport> run(World& world, Real seconds, const std::function<void(std::size_t step)>& look,
                            const std::function<bool(const StepReport&)>& go_on = {}) {
    std::size_t step = 0;
    world.watch_steps([&](const StepReport&) { look(step++); });
    std::vector<StepReport> reports;
    for (int call = 0; call < calls && (reports.empty() || reports.back().ok()); ++call)
        reports.push_back(world.advance(seconds / calls, go_on));
    world.watch_steps({});
    return reports;
}

/// Repeats the run without ranks up to a step, and compares a body.
std::string difference_at(const RankScene& scene, std::size_t step, Model& found, std::size_t body) {
    World world = scene.make(1);
    std::string difference;
    bool done = false;
    run(
        world, scene.seconds,
        [&](std::size_t now) {
            if (now != step) return;
            done = true;
            Model& expected = WorldAccess::state_of(world).model;
            for (const std::size_t row : rows_in_slot_order(expected))
                if (expected.bodies.slot[row] == found.bodies.slot[body])
                    difference = first_difference(expected, row, found, body);
        },
        [&](const StepReport&) { return !done; });
    return difference.empty() ? "no state column (links, clusters or filters differ)" : difference;
}

std::string text(Real value) {
    char characters[32];
    std::snprintf(characters, sizeof characters, "%.17g", value);
    return characters;
}

/// Names and values of the members of a report that do not depend on the number of ranks.
std::vector<std::pair<const char*, std::string>> values_of(const StepReport& report) {
    return {{"message", report.message()},
            {"warning", report.warning()},
            {"value", text(report.value)},
            {"step_size", text(report.step_size)},
            {"steps", std::to_string(report.steps)},
            {"shortened", std::to_string(report.shortened)},
            {"retried", std::to_string(report.retried)},
            {"limited", std::to_string(report.limited)},
            {"contacts", std::to_string(report.contacts)},
            {"regions", std::to_string(report.regions)},
            {"largest_region", std::to_string(report.largest_region)},
            {"unconverged", std::to_string(report.unconverged)},
            {"worst_error", text(report.worst_error)},
            {"worst_region", std::to_string(report.worst_region)},
            {"max_penetration", text(report.max_penetration)},
            {"max_gap_violation", text(report.max_gap_violation)},
            {"held_penetration", text(report.held_penetration)},
            {"inverted", std::to_string(report.inverted)},
            {"crossed", std::to_string(report.crossed)}};
}

std::string difference_of_reports(const std::vector<StepReport>& expected, const std::vector<StepReport>& found) {
    if (expected.size() != found.size())
        return "expected " + std::to_string(expected.size()) + " calls of advance, found " +
               std::to_string(found.size()) + ", the last one with the message: " + found.back().message();
    for (std::size_t call = 0; call < expected.size(); ++call) {
        const auto a = values_of(expected[call]), b = values_of(found[call]);
        for (std::size_t i = 0; i < a.size(); ++i)
            if (a[i] != b[i])
                return "report of call " + std::to_string(call) + ", " + a[i].first + ": expected " + a[i].second +
                       ", found " + b[i].second;
    }
    return {};
}

/// Compares the bodies that a rank owns after a step. Returns how many these are. Throws if one differs.
std::size_t compare(const RankScene& scene, const WholeRun& whole, std::size_t step, int rank, WorldState& state) {
    Model& model = state.model;
    const auto fail = [&](std::size_t body, const std::string& what) {
        throw std::runtime_error("rank " + std::to_string(rank) + ", step " + std::to_string(step) + ", body '" +
                                 model.body_records[body].name + "': " + what);
    };
    std::size_t owned = 0;
    for (const std::size_t body : rows_in_slot_order(model)) {
        if (!state.ranks.owns(body)) continue;
        ++owned;
        const std::size_t slot = model.bodies.slot[body];
        if (step >= whole.bodies.size()) fail(body, "the run without ranks ended before this step");
        if (whole.bodies[step][slot] != body_hash(model, body)) fail(body, difference_at(scene, step, model, body));
    }
    return owned;
}

}  // namespace

RankScene scene_of_file(const std::string& file, const Tuning& tuning) {
    ScenePlan plan = plan_scene(std::filesystem::path(SKERRY_SOURCE_DIR) / file);
    plan.tuning = tuning;
    const Real seconds = plan.seconds;
    return {.name = file, .make = maker_of(std::move(plan)), .seconds = seconds};
}

RankScene random_rank_scene(std::uint64_t seed, int steps) {
    const RandomScene random = make_random_scene(seed);
    const TemporaryFolder folder;
    ScenePlan plan = plan_scene(write_random_scene(random, folder.path(), "scene.json"));
    plan.tuning = random.tuning;
    plan.settings.contact_regions = ContactRegions::separate;  // the other values cannot be divided among ranks
    plan.settings.integrator = Integrator::symplectic_euler;
    RankScene scene{.name = "random scene " + std::to_string(seed), .make = maker_of(std::move(plan))};
    scene.seconds = std::min<Real>(steps, random.advances * random.steps_per_advance) * scene.make(1).stable_step();
    return scene;
}

WholeRun run_whole(const RankScene& scene, int threads) {
    WholeRun whole;
    World world = scene.make(threads);
    Index asleep = 0;
    whole.reports = run(world, scene.seconds, [&](std::size_t) {
        Model& model = WorldAccess::state_of(world).model;
        std::vector<std::uint64_t>& hashes = whole.bodies.emplace_back();
        for (const std::size_t body : rows_in_slot_order(model)) hashes.push_back(body_hash(model, body));
        const auto now_asleep = static_cast<Index>(std::ranges::count(model.bodies.asleep, std::uint8_t{1}));
        whole.woken |= now_asleep < asleep;
        asleep = now_asleep;
        whole.most_asleep = std::max(whole.most_asleep, asleep);
    });
    return whole;
}

std::string run_on_ranks_differs(const RankScene& scene, const WholeRun& whole, int ranks, int threads,
                                 const std::function<void(World&, Ranks&)>& divide) {
    std::atomic<std::size_t> compared = 0;
    try {
        run_on_ranks(ranks, [&](Ranks& mine) {
            World world = scene.make(threads);
            divide(world, mine);
            const std::vector<StepReport> reports = run(world, scene.seconds, [&](std::size_t step) {
                compared += compare(scene, whole, step, mine.rank(), WorldAccess::state_of(world));
            });
            if (reports.back().status == StepStatus::stopped) return;  // another rank has found a difference
            const std::string difference = difference_of_reports(whole.reports, reports);
            if (!difference.empty())
                throw std::runtime_error("rank " + std::to_string(mine.rank()) + ", " + difference);
        });
    } catch (const std::exception& error) {
        return scene.name + " on " + std::to_string(ranks) + " ranks with " + std::to_string(threads) +
               " threads: " + error.what();
    }
    std::size_t expected = 0;
    for (const std::vector<std::uint64_t>& step : whole.bodies) expected += step.size();
    if (compared != expected)
        return scene.name + ": expected " + std::to_string(expected) + " comparisons of bodies, found " +
               std::to_string(compared) + ", so some body has no owner or several";
    return {};
}

}  // namespace skerry::test
