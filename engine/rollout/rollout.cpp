#include "skerry/rollout.h"

#include <algorithm>
#include <atomic>
#include <chrono>
#include <cmath>
#include <limits>
#include <optional>
#include <utility>

#include "engine/base/complaint.h"
#include "engine/output/series/probe_columns.h"
#include "engine/rollout/controls.h"
#include "engine/world/contact_view.h"
#include "engine/world/world_state.h"
#include "jobs/run_tasks.h"

namespace skerry {

namespace {

// Time between two calls of RolloutSettings::go_on. It is short, so that a program can react to Ctrl-C within 50 ms.
constexpr std::chrono::milliseconds watch_period{20};

void check_settings(std::size_t world_count, const RolloutSettings& settings) {
    constexpr auto most = static_cast<std::size_t>(std::numeric_limits<Index>::max());
    if (world_count == 0) refuse("rollout", "worlds", "no world", "at least one world");
    if (settings.intervals == 0) refuse("rollout", "intervals", "0", "at least one interval");
    if (world_count > most || settings.intervals > most / world_count)
        refuse("rollout", "intervals",
               std::to_string(settings.intervals) + " for each of " + std::to_string(world_count) + " worlds",
               "at most " + std::to_string(most) + " intervals of all worlds together");
    if (!(settings.dt > 0) || !std::isfinite(settings.dt))
        refuse("rollout", "dt", short_text(settings.dt), "a time > 0 (s)");
    if (settings.threads < 0)
        refuse("rollout", "threads", std::to_string(settings.threads),
               "a number of threads >= 0 (0: the number of cores)");
}

/// Completes pending changes of a world and returns its state. Throws SceneError if a rollout cannot start from it.
WorldState& source_of(const World* world, std::size_t number, Real dt) {
    if (!world) refuse("rollout", "worlds", "a null pointer", "a world");
    // The cast is valid, because the state of a world is never a constant object.
    auto& state = const_cast<WorldState&>(WorldAccess::state_of(*world));
    state.require_between_steps("rollout");
    if (!(state.clock.time + dt > state.clock.time))
        refuse("rollout", "dt", short_text(dt),
               "a longer time, because rounding would lose it in the sum with " + short_text(state.clock.time) +
                   " s, the time of world " + std::to_string(number));
    // view_contacts() stores its result in the world. It is called now, so that later reads by several threads write
    // nothing.
    view_contacts(state);
    return state;
}

/// Marks worlds as advancing during the lifetime of this object, so that a call of RolloutSettings::go_on cannot change
/// them.
class SourcesScope {
public:
    explicit SourcesScope(std::span<WorldState* const> worlds) : worlds_(worlds) { mark(true); }
    ~SourcesScope() { mark(false); }
    SourcesScope(const SourcesScope&) = delete;
    SourcesScope& operator=(const SourcesScope&) = delete;

private:
    void mark(bool advancing) {
        for (WorldState* const world : worlds_) world->advancing = advancing;
    }

    std::span<WorldState* const> worlds_;
};

/// Checks a probe in all worlds and returns its columns.
std::vector<SeriesColumn> columns_of(std::span<const World* const> worlds, const RecordedProbe& probe) {
    std::vector<SeriesColumn> columns;
    agreed_count(worlds, "record: number of columns of a probe", [&](const World& world) {
        check_probes(world, {&probe, 1});
        columns.clear();
        add_columns(world, probe, columns);
        return columns.size();
    });
    return columns;
}

/// A running rollout. Each world writes only its own rows of the arrays of the result, so that no lock is needed.
class RunningRollout {
public:
    RunningRollout(std::span<const World* const> worlds, const RolloutSettings& settings) : settings_(settings) {
        check_settings(worlds.size(), settings);
        for (std::size_t w = 0; w < worlds.size(); ++w)
            sources_.push_back(w > 0 && worlds[w] == worlds[w - 1] ? sources_.back()
                                                                   : &source_of(worlds[w], w, settings.dt));
        check_controls(worlds, settings);
        check_probes(*worlds[0], settings.record);
        for (const RolloutControl& control : settings.controls)
            number_count_.push_back(number_count(*worlds[0], control));
        constexpr Real none = std::numeric_limits<Real>::quiet_NaN();
        const std::size_t rows = worlds.size() * settings.intervals;
        for (const RecordedProbe& probe : settings.record) {
            std::vector<SeriesColumn> columns = columns_of(worlds, probe);
            std::vector<Real> values(rows * columns.size(), none);
            result_.series.push_back({probe.name, std::move(columns), std::move(values)});
        }
        result_.time.assign(rows, none);
        result_.status.resize(worlds.size());
        for (RolloutStatus& status : result_.status) status.report.status = StepStatus::stopped;
        final_.resize(settings.keep_worlds ? worlds.size() : 0);
    }

    RolloutResult run() {
        const int threads = settings_.threads > 0 ? settings_.threads : core_count();
        const auto world_count = static_cast<Index>(sources_.size());
        const int threads_of_world = std::max(1, threads / world_count);
        const SourcesScope scope(sources_);
        run_tasks(
            world_count, threads, [&](Index number) { run_world(static_cast<std::size_t>(number), threads_of_world); },
            watch_period, [&] { watch(); });
        const auto is_stopped = [](const RolloutStatus& s) { return s.report.status == StepStatus::stopped; };
        if (std::ranges::none_of(result_.status, is_stopped))
            for (std::optional<World>& world : final_) result_.worlds.push_back(std::move(*world));
        return std::move(result_);
    }

private:
    void watch() {
        if (!settings_.go_on || stop_) return;
        try {
            if (!settings_.go_on({worlds_done_, sources_.size(), intervals_done_})) stop_ = true;
        } catch (...) {
            stop_ = true;
            throw;
        }
    }

    void run_world(std::size_t number, int threads) {
        if (stop_) return;
        World copy = copy_of_settled(*sources_[number], {.backend = {}, .threads = threads});
        if (settings_.prepare) settings_.prepare(copy, number);
        RolloutStatus& status = result_.status[number];
        status.report = {};
        run_intervals(copy, number, status);
        WorldReport report;
        static_cast<RunCounters&>(report) = WorldAccess::state_of(copy).record.counters;
        report.crossed = WorldAccess::state_of(copy).cache.crossings.let_through;
        status.distrust = report.distrust();
        if (settings_.keep_worlds) final_[number].emplace(std::move(copy));
        ++worlds_done_;
    }

    void run_intervals(World& world, std::size_t number, RolloutStatus& status) {
        std::vector<TrackedProbe> probes = track(world, settings_.record);
        std::vector<Real> row;
        std::vector<Vec3> forces;
        for (std::size_t i = 0; i < settings_.intervals; ++i) {
            try {
                apply_controls(settings_, number_count_, number, i, forces, world);
                status.report = world.advance(settings_.dt, [this](const StepReport&) { return !stop_; });
            } catch (const SceneError& error) {
                status.error = error.what();
            }
            if (!status.ok()) return;
            ++status.intervals;
            const std::size_t value_row = number * settings_.intervals + i;
            result_.time[value_row] = world.time();
            for (std::size_t p = 0; p < probes.size(); ++p) {
                row.clear();
                add_forces(world, probes[p]);
                put_row(world, probes[p], row);
                std::ranges::copy(row, result_.series[p].values.begin() +
                                           static_cast<std::ptrdiff_t>(value_row * result_.series[p].columns.size()));
            }
            ++intervals_done_;
        }
    }

    const RolloutSettings& settings_;
    // States of the given worlds. They have no pending changes to complete, so that reads by several threads write
    // nothing.
    std::vector<WorldState*> sources_;
    std::vector<std::size_t> number_count_;  // number of values of each control per interval
    RolloutResult result_;
    std::vector<std::optional<World>> final_;
    std::atomic<bool> stop_{false};
    std::atomic<std::size_t> worlds_done_{0}, intervals_done_{0};
};

}  // namespace

RolloutResult rollout(std::span<const World* const> worlds, const RolloutSettings& settings) {
    return RunningRollout(worlds, settings).run();
}

RolloutResult rollout(const World& world, std::size_t count, const RolloutSettings& settings) {
    const std::vector<const World*> worlds(count, &world);
    return rollout(worlds, settings);
}

}  // namespace skerry
