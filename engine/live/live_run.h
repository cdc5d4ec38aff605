// The simulation's side of a live view: commands, snapshots, and the pace of the simulation.
#pragma once

#include <atomic>
#include <chrono>
#include <cstdint>
#include <map>
#include <string>
#include <vector>

#include "engine/live/hub.h"
#include "engine/output/series/probe_columns.h"
#include "skerry/live.h"

namespace skerry {

/// Carries out the functions of LiveView that have the same names (skerry/live.h).
class LiveRun {
public:
    LiveRun(World& world, const LiveSettings& settings);

    LiveHub& hub() { return hub_; }
    std::uint64_t resets() const { return resets_; }
    bool playing() const { return step_asked_ || hub_.state().playing; }
    void sync(World& world);
    Real due(World& world);
    bool between_steps(const World& world);
    void fail(const std::string& text);
    void refuse_resets(const std::string& reason) { reset_refusal_ = reason; }
    /// Ends all pulls: removes their springs and drag fields from the world.
    void end_pulls(World& world);

private:
    using Clock = std::chrono::steady_clock;

    void apply_commands(World& world);
    void apply(const LiveCommand& command, World& world);
    void set_gravity(World& world, bool on);
    void note_gravity(const World& world);
    void reset(World& world);
    void begin_run(const World& world);
    void show(const World& world, bool between_calls);
    void sample_probes(const World& world);
    void sample_speed(const World& world);
    void pace_from_now(const World& world);
    Real call_length(const World& world) const;

    /// A probe with its last values. The values of a probe whose object was removed are NaN.
    struct PlottedProbe {
        std::vector<TrackedProbe> tracked;  // one probe; empty if its object was removed
        std::vector<Real> values;           // by column
    };
    std::vector<PlottedProbe> tracked_probes(World& world) const;

    LiveSettings settings_;
    std::vector<LivePlot> plots_;
    std::vector<PlottedProbe> probes_;
    World start_;  // state for a reset
    LiveState state_;
    Vec3 gravity_ = Vec3::Zero();          // last gravity of the world that was not zero [m/s^2]
    std::map<std::uint64_t, Pull> pulls_;  // by number of the browser
    // true from the command `step` until due() returns, or until the next call of sync()
    std::atomic<bool> step_asked_ = false;
    bool failed_ = false;        // paused by fail()
    std::string reset_refusal_;  // reason why resets are refused; empty if they are allowed
    std::atomic<std::uint64_t> resets_ = 0;

    SnapshotTaker taker_;
    bool changed_ = false;            // the world may differ from the last snapshot although the time is the same
    Real shown_time_ = 0;             // simulated time when a snapshot was last due [s]
    Real sampled_time_ = 0;           // simulated time of the last sample of the probes [s]
    Clock::time_point next_show_{};   // wall time from which a snapshot is due
    Clock::time_point pace_wall_{};   // reference of the pace: at this wall time the simulated time was pace_time_
    Real pace_time_ = 0;              // [s]
    Clock::time_point speed_wall_{};  // wall time at the start of the interval over which the speed is measured
    Real speed_time_ = 0;             // simulated time at speed_wall_ [s]
    Real speed_ = 0;                  // simulated time per wall time

    LiveHub hub_;
};

}  // namespace skerry
