// Rollouts: many worlds that follow given controls, on all cores (docs/control.md).
#pragma once

#include <cstddef>
#include <functional>
#include <span>
#include <string>
#include <variant>
#include <vector>

#include "components/load_kind.h"
#include "skerry/recorder.h"
#include "skerry/world.h"

#pragma GCC visibility push(default)
namespace skerry {

/// Moves a collider or an attachment, so that it reaches a pose at the end of the interval (World::move_to). Numbers:
/// position [m] and rotation vector [rad].
struct PoseControl {
    std::variant<ColliderHandle, AttachmentHandle> object{};  // the moved object
};
/// Moves a collider or an attachment at constant velocities (World::set_velocity). Numbers: velocity [m/s] and angular
/// velocity [rad/s].
struct VelocityControl {
    std::variant<ColliderHandle, AttachmentHandle> object{};  // the moved object
};
/// Sets the target speed of the motor of a hinge or slider. The joint must have a motor, which keeps its `strength`.
/// Numbers: the speed [rad/s or m/s].
struct MotorSpeedControl {
    JointHandle joint{};  // joint with the motor
};
/// Sets the target coordinate of the motor of a hinge or slider. The joint must have a motor, which keeps its
/// `strength` and `fastest`. Numbers: the coordinate [rad or m].
struct MotorPositionControl {
    JointHandle joint{};  // joint with the motor
};
/// Sets the external forces on all nodes of a body (World::set_loads). Numbers: three per node [N].
struct NodeForceControl {
    BodyHandle body{};  // body of the nodes
};
/// Sets an external force on a body. The force is distributed over the nodes in proportion to their masses, so that it
/// acts at the centre of mass. Numbers: three [N].
struct BodyForceControl {
    BodyHandle body{};  // body on which the force acts
};
/// Sets the acceleration of gravity. Numbers: three [m/s^2].
struct GravityControl {};
/// Sets the value that an object has as a TimeTable. Numbers: tension [N], length [m] or rate [m/s] of a cable,
/// whichever is prescribed; pressure [Pa], inflow [kg/s] or liquid volume [m^3] of a cavity; pressure of the reservoir
/// of a pipe [Pa]; rest length of a spring [m]; scale of a load; active tension of fibres [Pa].
struct ValueControl {
    // object whose value is set
    std::variant<CableHandle, CavityHandle, PipeHandle, SpringHandle, LoadHandle, FibreHandle> object{};
};

/// One controlled quantity. An object may have only one control. Each value applies from the start of its interval.
struct RolloutControl {
    std::variant<PoseControl, VelocityControl, MotorSpeedControl, MotorPositionControl, NodeForceControl,
                 BodyForceControl, GravityControl, ValueControl>
        what;  // the controlled object and quantity
    // Values in the order (world, interval, number), or in the order (interval, number) for all worlds. The values are
    // not copied and must exist until rollout() returns.
    std::span<const Real> values;
};

/// Progress of a rollout, for RolloutSettings::go_on.
struct RolloutProgress {
    std::size_t worlds_done = 0, worlds = 0;  // number of completed worlds, and of all worlds
    std::size_t intervals_done = 0;           // number of completed intervals of all worlds
};

/// Settings of rollout(): number and duration of the intervals, the controls, and the recorded quantities.
struct RolloutSettings {
    std::size_t intervals = 1;               // number of control intervals, >= 1
    Real dt = 0;                             // duration of an interval, > 0 [s]
    std::vector<RolloutControl> controls{};  // quantities that change at the start of each interval
    std::vector<RecordedProbe> record{};     // quantities that are recorded at the end of each interval
    int threads = 0;                         // number of threads of the rollout; 0: the number of cores
    bool keep_worlds = false;                // true: the result contains the worlds at the end of the rollout
    // If given, called with each copy of a world and its number before the first interval, to change materials, poses
    // and the like. The calls come from several threads at once. They must not remove objects that controls or probes
    // name. An exception ends the rollout, which rethrows the exception of the lowest number.
    std::function<void(World& copy, std::size_t number)> prepare{};
    // If given, called about every 20 ms on the thread that called rollout(). If it returns false or throws, all worlds
    // stop before their next step. An exception is rethrown.
    std::function<bool(const RolloutProgress&)> go_on{};
};

/// Values of one probe, with the columns that a Recorder gives it.
struct RolloutSeries {
    std::string name;                   // name of the probe
    std::vector<SeriesColumn> columns;  // without the time
    // values in the order (world, interval, column); NaN in intervals that were not completed
    std::vector<Real> values;
};

/// End of the rollout of one world.
struct RolloutStatus {
    std::size_t intervals = 0;  // number of completed intervals
    StepReport report{};        // report of the last call of advance; `stopped` if go_on ended the rollout
    std::string error{};        // message of the SceneError of a control or of advance, else empty
    // Reasons why the values cannot be trusted (WorldReport::distrust). They may have arisen before the rollout.
    std::string distrust{};

    /// True if all intervals were completed.
    bool ok() const { return report.ok() && error.empty(); }
    /// Names the body and the reason why the world stopped. Empty if ok().
    std::string message() const { return error.empty() ? report.message() : error; }
};

/// Result of rollout(). The rows of a world that stopped early end with NaN; `status` gives the reason.
struct RolloutResult {
    std::vector<Real> time;  // simulated time at the end of each interval, in the order (world, interval) [s]
    std::vector<RolloutSeries> series;  // one entry for each entry of RolloutSettings::record
    std::vector<RolloutStatus> status;  // by world
    // Worlds at the end of the rollout, if keep_worlds is set. Empty if go_on ended the rollout.
    std::vector<World> worlds;
};

/// Advances a copy of each world through all intervals, several worlds at once. The worlds do not change: no other
/// thread may use them during the call, and go_on may only read them. Worlds may occur several times, but all must be
/// copies of one world, so that the handles of controls and probes are valid in each of them.
///
/// The results are bitwise those of a loop that clones each world, applies the controls of an interval, calls
/// advance(dt) and samples a Recorder, on any number of threads. A world whose step is refused stops, and the others
/// continue. If there are fewer worlds than threads, each world gets an equal number of threads.
///
/// Each thread of the rollout has one copy of a world at a time. With keep_worlds all copies remain, each with the
/// number of threads with which it was advanced. The results need 8 bytes per value. To continue a rollout, keep the
/// worlds and pass them to the next call. To start again from the same states, pass the same worlds again. There is no
/// need to keep copies and reset them: World::reset takes as long as a new copy, about 0.4 ms for a world of 4,000
/// tetrahedra.
///
/// Throws SceneError before any world runs if a setting, a handle or a value is invalid.
RolloutResult rollout(std::span<const World* const> worlds, const RolloutSettings& settings);
/// Advances `count` copies of one world.
RolloutResult rollout(const World& world, std::size_t count, const RolloutSettings& settings);

}  // namespace skerry
#pragma GCC visibility pop
