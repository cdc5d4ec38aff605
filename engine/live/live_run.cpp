#include "engine/live/live_run.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "engine/base/complaint.h"
#include "skerry/error.h"

namespace skerry {

namespace {

// Longest simulated time of a call of advance [s]. It equals the default time between two frames of a scene.
constexpr Real frame_step = 1.0 / 60;
constexpr Real frames_per_second = 30;  // largest number of snapshots per second of wall time [1/s]
// Least wall time from one snapshot to the next, as a multiple of the time to take one. With 4, snapshots take at most
// 1/4 of the wall time.
constexpr int snapshot_pause = 4;
constexpr Real longest_wait = 0.02;  // longest wait in due(), and in sync() while paused [s]
// Largest lag behind the wall clock that is made up for [s]. A larger lag is forgotten: the pace restarts.
constexpr Real longest_lag = 0.1;
constexpr Real fastest_rate = 1000;  // largest simulated time per wall time
constexpr Real not_a_number = std::numeric_limits<Real>::quiet_NaN();
constexpr Real speed_interval = 0.5;  // wall time over which the speed is measured [s]

std::chrono::steady_clock::duration seconds_of(Real seconds) {
    return std::chrono::duration_cast<std::chrono::steady_clock::duration>(std::chrono::duration<Real>(seconds));
}

Real seconds_from(std::chrono::steady_clock::duration duration) {
    return std::chrono::duration<Real>(duration).count();
}

void require_rate(Real rate) {
    if (rate >= 0 && rate <= fastest_rate) return;
    refuse("live view", "rate", short_text(rate), "a number from 0 to " + short_text(fastest_rate),
           "0: as fast as possible");
}

/// Value of a slider; NaN if its object was removed.
Real value_of(const World& world, const Slider& slider) {
    try {
        return slider_value(world, slider);
    } catch (const SceneError&) {
        return not_a_number;
    }
}

std::vector<LivePlot> plots_of(const World& world, const std::vector<RecordedProbe>& probes) {
    check_probes(world, probes);
    std::vector<LivePlot> plots;
    for (const RecordedProbe& probe : probes)
        add_columns(world, probe, plots.emplace_back(LivePlot{.name = probe.name, .columns = {}}).columns);
    return plots;
}

}  // namespace

LiveRun::LiveRun(World& world, const LiveSettings& settings)
    : settings_(settings),
      plots_(plots_of(world, settings.probes)),
      probes_(tracked_probes(world)),
      start_(world.clone({.threads = 1})),
      state_{.playing = !settings.paused, .rate = settings.rate, .gravity = true} {
    require_rate(settings.rate);
    for (const Slider& slider : settings.sliders) slider_value(world, slider);
    begin_run(world);
}

void LiveRun::sync(World& world) {
    step_asked_ = false;
    if (hub_.is_busy()) {
        sample_probes(world);
        apply_commands(world);
        changed_ = true;
        show(world, true);
    }
    if (!state_.playing && !step_asked_) hub_.wait_for_commands(Clock::now() + seconds_of(longest_wait));
}

Real LiveRun::due(World& world) {
    sample_probes(world);
    apply_commands(world);
    show(world, true);
    if (step_asked_) {
        step_asked_ = false;
        pace_from_now(world);
        const Real length = call_length(world);
        return length / std::max<Real>(1, std::ceil(length / world.stable_step()));
    }
    const Clock::time_point now = Clock::now();
    Real wait = longest_wait;
    if (state_.playing) {
        // wall time by which the simulation is ahead
        const Real ahead =
            state_.rate > 0 ? (world.time() - pace_time_) / state_.rate - seconds_from(now - pace_wall_) : 0;
        if (ahead < -longest_lag || world.time() < pace_time_) pace_from_now(world);
        if (!(ahead > 0)) return call_length(world);
        wait = std::min(wait, ahead);
    }
    hub_.wait_for_commands(now + seconds_of(wait));
    return 0;
}

bool LiveRun::between_steps(const World& world) {
    if (hub_.has_commands()) return false;
    show(world, false);
    return true;
}

void LiveRun::fail(const std::string& text) {
    failed_ = true;
    state_.playing = false;
    hub_.report_failure(text);
    hub_.set_state(state_);
}

void LiveRun::end_pulls(World& world) {
    for (auto& [client, pull] : pulls_) pull.end(world);
    pulls_.clear();
}

void LiveRun::apply_commands(World& world) {
    note_gravity(world);
    for (const LiveCommand& command : hub_.has_commands() ? hub_.take_commands() : std::vector<LiveCommand>()) {
        try {
            apply(command, world);
        } catch (const SceneError& error) {
            hub_.report(command.client, error.what());
        }
        changed_ = true;
    }
    hub_.set_state(state_);
}

void LiveRun::apply(const LiveCommand& command, World& world) {
    switch (command.action) {
        case LiveAction::play:
            state_.playing = true;
            failed_ = false;
            pace_from_now(world);
            break;
        case LiveAction::pause:
            state_.playing = false;
            break;
        case LiveAction::step:
            state_.playing = false;
            step_asked_ = true;
            break;
        case LiveAction::reset:
            reset(world);
            break;
        case LiveAction::rate:
            require_rate(command.value);
            state_.rate = command.value;
            pace_from_now(world);
            break;
        case LiveAction::gravity:
            set_gravity(world, command.on);
            break;
        case LiveAction::slider:
            if (command.number >= settings_.sliders.size())
                refuse("command", "number", std::to_string(command.number),
                       "the number of one of " + std::to_string(settings_.sliders.size()) + " sliders");
            set_slider(world, settings_.sliders[command.number], command.value);
            break;
        case LiveAction::pull:
            pulls_[command.client].begin(world, command.body, command.point, command.to);
            break;
        case LiveAction::move:
            pulls_[command.client].move(world, command.to);
            break;
        case LiveAction::release:
            pulls_[command.client].end(world);
            pulls_.erase(command.client);
            break;
        case LiveAction::seen:
        case LiveAction::fields:
            break;  // LiveHub::receive carries them out
    }
}

void LiveRun::set_gravity(World& world, bool on) {
    if (on != state_.gravity) world.set_gravity(on ? gravity_ : Vec3::Zero());
    note_gravity(world);
}

/// Sets the gravity switch of the page to the state of the world, because the program or another view may have changed
/// gravity. In a world that never had gravity the switch is on.
void LiveRun::note_gravity(const World& world) {
    const Vec3 gravity = world.settings().gravity;
    if (!gravity.isZero(0)) gravity_ = gravity;
    state_.gravity = !gravity.isZero(0) || gravity_.isZero(0);
}

void LiveRun::reset(World& world) {
    if (!reset_refusal_.empty()) throw SceneError(reset_refusal_);
    world.reset(start_);
    pulls_.clear();
    probes_ = tracked_probes(world);
    state_.playing = state_.playing || failed_;
    failed_ = false;
    step_asked_ = false;
    ++resets_;
    begin_run(world);
}

/// Starts new streams for all browsers.
void LiveRun::begin_run(const World& world) {
    taker_.clear();
    note_gravity(world);
    LiveRunInfo info{.title = settings_.title,
                     .gravity = gravity_,
                     .sliders = settings_.sliders,
                     .slider_values = {},
                     .plots = plots_};
    for (const Slider& slider : settings_.sliders) info.slider_values.push_back(value_of(world, slider));
    hub_.begin_run(info, state_);
    pace_from_now(world);
    speed_wall_ = pace_wall_;
    speed_time_ = pace_time_;
    sampled_time_ = world.time();
    speed_ = 0;
}

/// Takes a snapshot if one is due and a browser waits for one. `between_calls`: the world is between two calls of
/// advance, so that probes can be read. Within a call, snapshots become due one interval later, so only long calls take
/// them.
void LiveRun::show(const World& world, bool between_calls) {
    if (!hub_.is_busy()) return;
    const Clock::time_point now = Clock::now();
    const Clock::duration interval = seconds_of(1 / frames_per_second);
    if (now < (between_calls ? next_show_ : next_show_ + interval)) return;
    // Snapshots become due at fixed intervals, not one interval after the last snapshot. The mean rate then stays the
    // same if calls of sync() come a little early or late.
    next_show_ = std::max(next_show_, now - interval) + interval;
    if (std::exchange(changed_, false) || world.time() != shown_time_) hub_.mark_changed();
    shown_time_ = world.time();
    if (between_calls && taker_.is_other_run(world)) begin_run(world);
    const LiveHub::FrameRequest request = hub_.requested_frame();
    sample_speed(world);
    if (!request.frame) return;
    const std::shared_ptr<Snapshot> snapshot = hub_.free_snapshot();
    taker_.take(world, request.content, *snapshot);
    snapshot->speed = speed_;
    snapshot->probes.resize(probes_.size());
    for (std::size_t p = 0; p < probes_.size(); ++p) {
        PlottedProbe& probe = probes_[p];
        if (between_calls && !probe.tracked.empty()) {
            try {
                probe.values.clear();
                put_row(world, probe.tracked.front(), probe.values);
            } catch (const SceneError&) {  // the object of the probe was removed
                probe.tracked.clear();
                probe.values.assign(plots_[p].columns.size(), not_a_number);
            }
        }
        snapshot->probes[p] = probe.values;
    }
    snapshot->sliders.clear();
    for (const Slider& slider : settings_.sliders) snapshot->sliders.push_back(value_of(world, slider));
    snapshot->pulls.clear();
    for (const auto& [client, pull] : pulls_) {
        if (const auto state = pull.state(world)) snapshot->pulls.emplace_back(client, *state);
        // The page draws one line for the pull. The springs of a pull are no objects of the scene, so their lines are
        // removed.
        std::erase_if(snapshot->frame.lines, [&held = pull](const LineFrame& line) { return held.has(line); });
    }
    hub_.publish(snapshot);
    next_show_ = std::max(next_show_, now + snapshot_pause * (Clock::now() - now));
}

std::vector<LiveRun::PlottedProbe> LiveRun::tracked_probes(World& world) const {
    std::vector<TrackedProbe> tracked = track(world, settings_.probes);
    std::vector<PlottedProbe> probes;
    for (std::size_t p = 0; p < tracked.size(); ++p)
        probes.push_back(
            {.tracked = {std::move(tracked[p])}, .values = std::vector<Real>(plots_[p].columns.size(), not_a_number)});
    return probes;
}

/// Adds the forces of the last call of advance to the force sums of the probes.
void LiveRun::sample_probes(const World& world) {
    if (!(world.time() > sampled_time_)) return;
    sampled_time_ = world.time();
    for (PlottedProbe& probe : probes_) {
        if (probe.tracked.empty()) continue;
        try {
            add_forces(world, probe.tracked.front());
        } catch (const SceneError&) {  // the object was removed; show() then clears the probe
        }
    }
}

void LiveRun::sample_speed(const World& world) {
    const Clock::time_point now = Clock::now();
    const Real seconds = seconds_from(now - speed_wall_);
    if (seconds < speed_interval) return;
    speed_ = std::max<Real>(0, world.time() - speed_time_) / seconds;
    speed_wall_ = now;
    speed_time_ = world.time();
}

/// Restarts the pace at the present time. Any lead or lag of the simulation is discarded.
void LiveRun::pace_from_now(const World& world) {
    pace_wall_ = Clock::now();
    pace_time_ = world.time();
}

/// Simulated time of a call of advance [s]: the time that passes at the set rate in 1/60 s of wall time, but at least
/// the stable step, so that slow motion hardly changes the length of the steps. The upper limit is 1/60 s.
Real LiveRun::call_length(const World& world) const {
    if (!(state_.rate > 0)) return frame_step;
    return std::min(frame_step, std::max(state_.rate * frame_step, world.stable_step()));
}

}  // namespace skerry
