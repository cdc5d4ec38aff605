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

/// Moves a collider or an attachment, so that it reaches a pose at the end of the interval (World::move_to). Values per
/// interval (RolloutControl::values), six: position [m] and rotation vector [rad].
struct PoseControl {
    std::variant<ColliderHandle, AttachmentHandle> object{};  // the moved object
};
/// Moves a collider or an attachment at constant velocities (World::set_velocity). Values per interval, six: velocity
/// [m/s] and angular velocity [rad/s].
struct VelocityControl {
    std::variant<ColliderHandle, AttachmentHandle> object{};  // the moved object
};
/// Sets the target speed of the motor of a hinge or slider. The joint must have a motor, which keeps its `strength`.
/// One value per interval: the speed [rad/s or m/s].
struct MotorSpeedControl {
    JointHandle joint{};  // joint with the motor
};
/// Sets the target coordinate of the motor of a hinge or slider. The joint must have a motor, which keeps its
/// `strength` and `fastest`. One value per interval: the coordinate [rad or m].
struct MotorPositionControl {
    JointHandle joint{};  // joint with the motor
};
/// Sets the external forces on all nodes of a body (World::set_loads). Values per interval: three per node [N].
struct NodeForceControl {
    BodyHandle body{};  // body of the nodes
};
/// Sets an external force on a body, in place of the forces of World::set_loads(). The force is distributed over the
/// nodes in proportion to their masses, so that it acts at the centre of mass. Values per interval: three [N].
struct BodyForceControl {
    BodyHandle body{};  // body on which the force acts
};
/// Sets the acceleration of gravity. Values per interval: three [m/s^2].
struct GravityControl {};
/// Sets a value that the settings of an object give as a TimeTable. One value per interval:
/// - cable: the prescribed tension [N], length [m] or rate [m/s],
/// - cavity: the pressure [Pa], the inflow of gas [kg/s] or the volume of liquid [m^3],
/// - pipe: the pressure of its reservoir [Pa],
/// - spring: the rest length [m],
/// - load: the scale [1],
/// - fibres: the active tension [Pa].
struct ValueControl {
    // object whose value is set
    std::variant<CableHandle, CavityHandle, PipeHandle, SpringHandle, LoadHandle, FibreHandle> object{};
};

/// One controlled quantity. Each object may have one control only. The values of an interval are set at its start.
struct RolloutControl {
    std::variant<PoseControl, VelocityControl, MotorSpeedControl, MotorPositionControl, NodeForceControl,
                 BodyForceControl, GravityControl, ValueControl>
        what;  // the controlled object and quantity
    // Values of the control, ordered by world, then by interval. The kind of control states how many values an interval
    // has. If the values of only one world are given, they apply to all worlds. The values are not copied and must
    // exist until rollout() returns.
    std::span<const Real> values;
};

/// Progress of a rollout, for RolloutSettings::go_on.
struct RolloutProgress {
    std::size_t worlds_done = 0, worlds = 0;  // numbers of completed worlds and of all worlds
    std::size_t intervals_done = 0;           // number of completed intervals, summed over the worlds
};

/// Settings of rollout(): number and duration of the intervals, the controls, and the recorded quantities.
struct RolloutSettings {
    std::size_t intervals = 1;               // number of control intervals, >= 1
    Real dt = 0;                             // duration of an interval, > 0 [s]
    std::vector<RolloutControl> controls{};  // quantities that change at the start of each interval
    std::vector<RecordedProbe> record{};     // quantities that are recorded at the end of each interval
    int threads = 0;                         // number of threads of the rollout; 0: the number of cores
    bool keep_worlds = false;                // true: the result contains the worlds at the end of the rollout
    // If given, called once for each copy before its first interval, for example to change materials or poses.
    // `number`: index of the copied world in the argument `worlds` of rollout().
    //
    // Several threads call the function at once. It must not remove objects that controls or probes name. If it throws,
    // the rollout ends and rethrows the exception of the world with the lowest number.
    std::function<void(World& copy, std::size_t number)> prepare{};
    // If given, called about every 20 ms on the thread that called rollout(). If it returns false or throws, all worlds
    // stop before their next step, and rollout() returns or rethrows the exception.
    std::function<bool(const RolloutProgress&)> go_on{};
};

/// Values of one probe. They have the columns that a Recorder makes for this probe.
struct RolloutSeries {
    std::string name;                   // name of the probe
    std::vector<SeriesColumn> columns;  // the columns of the probe, without a column for the time
    // values by world, then interval, then column; NaN in intervals that were not completed
    std::vector<Real> values;
};

/// Outcome of the rollout of one world.
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
    std::vector<Real> time;             // simulated time at the end of each interval, by world, then interval [s]
    std::vector<RolloutSeries> series;  // one entry for each entry of RolloutSettings::record
    std::vector<RolloutStatus> status;  // one entry for each world
    // Worlds at the end of the rollout, if keep_worlds is set. Empty if go_on ended the rollout.
    std::vector<World> worlds;
};

/// Advances a copy of each world through all intervals, several worlds at once. In each interval a copy applies the
/// controls, calls advance(dt) and samples a Recorder. The results are bitwise those of such a loop over single worlds,
/// on any number of threads.
///
/// - Input: the given worlds do not change. During the call no other thread may use them, and go_on may only read them.
///   A world may be listed several times. All must be clones of one world, so that the handles of controls and probes
///   are valid in each of them.
/// - Failure: if a step of a copy is refused, this copy stops and the others continue.
/// - Threads: if there are fewer worlds than threads, each world gets an equal number of threads.
/// - Memory: each thread of the rollout has one copy of a world at a time, and the results need 8 bytes per value. With
///   keep_worlds all copies remain; each keeps the number of threads with which it was advanced.
/// - Next calls: to continue a rollout, keep the worlds and pass them to the next call. To start again from the same
///   states, pass the original worlds again. World::reset of the copies would save no time: it takes as long as a new
///   copy, about 0.4 ms for a world of 4,000 tetrahedra.
/// Throws SceneError before any world runs if a setting, a handle or a value is invalid.
RolloutResult rollout(std::span<const World* const> worlds, const RolloutSettings& settings);
/// Advances `count` copies of one world.
RolloutResult rollout(const World& world, std::size_t count, const RolloutSettings& settings);

}  // namespace skerry
#pragma GCC visibility pop
