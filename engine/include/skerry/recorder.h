// Time series of a run: positions of points, forces and energies (docs/outputs.md).
#pragma once

#include <array>
#include <filesystem>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <variant>
#include <vector>

#include "components/cable_control.h"
#include "components/cavity_law.h"
#include "components/joint_kind.h"
#include "components/spring_side.h"
#include "components/tie_kind.h"
#include "skerry/world.h"

#pragma GCC visibility push(default)
namespace skerry {

/// Records position, displacement and velocity of a material point of a body. The point is the weighted mean of up to
/// four nodes. The weights must sum to one.
struct PointProbe {
    BodyHandle body{};             // body of the point
    std::array<Index, 4> node{};   // numbers of the nodes within the body
    std::array<Real, 4> weight{};  // weight of each of these nodes
    // Position from which the displacement is measured [m]. Default: the position of the point when the Recorder is
    // made.
    std::optional<Vec3> origin{};
};
/// Returns a probe for the material point that is now at `point` (world coordinates [m]). It is interpolated in the
/// tetrahedron that contains the point, or follows the nearest node if no tetrahedron does. Throws SceneError if this
/// node is farther away than the mean edge length of the surface.
///
/// The point of a body without tetrahedra, which is rigid, may be anywhere.
PointProbe probe_point(const World& world, BodyHandle body, const Vec3& point);

/// Records position, displacement and velocity of the centre of mass of a body.
struct BodyProbe {
    BodyHandle body{};             // the recorded body
    std::optional<Vec3> origin{};  // see PointProbe::origin
};
/// Records the contact forces on a body, summed over all contacts, or over the contacts with one other body or
/// collider: impulse, mean force and moment, largest force of a step, normal force, friction force, and number of
/// contacts (ForceReport).
struct BodyForceProbe {
    BodyHandle body{};                                             // body on which the forces act
    std::optional<std::variant<BodyHandle, ColliderHandle>> by{};  // the other object; default: all objects
};
/// Records the contact forces on a collider, summed over all contacts, or over the contacts with one body. The columns
/// are those of a BodyForceProbe.
struct ColliderForceProbe {
    ColliderHandle collider{};       // collider on which the forces act
    std::optional<BodyHandle> by{};  // the touching body; default: all bodies
};
/// Records the force of an attachment on its body: impulse, mean force and moment, and largest force of a step.
struct ReactionProbe {
    AttachmentHandle attachment{};  // attachment that exerts the force
};
/// Records force and moment of a joint at the last step. For a hinge or slider also records its coordinate, its speed,
/// and the parts of the moment or force that its motor, its passive forces and its limits exert (JointState).
struct JointProbe {
    JointHandle joint{};  // joint of any kind
};
/// Records force, moment and error of a tie at the last step, and the number of nodes that have broken off (TieState).
struct TieProbe {
    TieHandle tie{};  // tie of any kind
};
/// Records the tensions, the length, the rate, the work and the friction loss of a cable (CableState).
struct CableProbe {
    CableHandle cable{};  // the recorded cable
};
/// Records pressure, volume, gas mass and energy of a cavity, and its force on the body (CavityState).
struct CavityProbe {
    CavityHandle cavity{};  // cavity with any filling; without gas the mass is 0
};
/// Records length, rate, force and energy of a spring (SpringState).
struct SpringProbe {
    SpringHandle spring{};  // the recorded spring
};
/// Records the kinetic, elastic, potential and dissipated energy of the world.
struct EnergyProbe {};
/// Records the largest von Mises stress, the largest and the smallest principal stress at some nodes of a body [Pa].
struct StressProbe {
    BodyHandle body{};           // body of the nodes
    std::vector<Index> nodes{};  // numbers within the body; empty: all nodes
};
/// Records the smallest ratio of present volume to rest volume among the tetrahedra of a body. A negative ratio means
/// that a tetrahedron is inverted.
struct VolumeProbe {
    BodyHandle body{};  // body of the tetrahedra
};
/// Records the pose of a body, a collider or an attachment: position and rotation vector (World::pose).
struct PoseProbe {
    std::variant<BodyHandle, ColliderHandle, AttachmentHandle> object{};  // the recorded object
};
/// Records velocity and angular velocity:
/// - for a body: the velocity of the centre of mass, and the angular velocity of the rigid motion with the same angular
///   momentum;
/// - for a collider or an attachment: the velocities of its frame, at the origin of its pose, in the last step.
struct VelocityProbe {
    std::variant<BodyHandle, ColliderHandle, AttachmentHandle> object{};  // the recorded object
};
/// Records the positions of all nodes of a body: three columns for each node.
struct NodesProbe {
    BodyHandle body{};  // body of the nodes
};

/// A named quantity that a Recorder samples.
struct RecordedProbe {
    std::string name;  // unique and not empty; not "." or "time"; without '/' and control characters
    std::variant<PointProbe, BodyProbe, BodyForceProbe, ColliderForceProbe, ReactionProbe, JointProbe, CableProbe,
                 EnergyProbe, StressProbe, VolumeProbe, PoseProbe, VelocityProbe, NodesProbe, CavityProbe, SpringProbe,
                 TieProbe>
        what;  // the recorded quantity and its object
};

/// A column of a time series. Its heading is "PROBE.QUANTITY [UNIT]". The first column has the heading "time [s]".
struct SeriesColumn {
    std::string probe;     // name of the probe; empty for the time column
    std::string quantity;  // for example force_x
    std::string unit;      // SI unit; 1 for counts and ratios

    /// Returns "PROBE.QUANTITY [UNIT]".
    std::string heading() const;
};

/// Records time series. The first call of sample() at or after each multiple of `every` records a row of values. All
/// rows stay in memory as long as the Recorder exists.
///
/// - Forces of contacts and attachments cover all calls of advance since the previous row: impulses are sums, forces
///   and moments are means, and largest_force is the largest force of any step.
/// - All other values are those at the time of the row.
class Recorder {
public:
    /// `every` is the time between rows, >= 0 [s]; with 0 every sample makes a row. If a probe needs forces and the
    /// world does not measure forces yet, the constructor switches the measurement on, with moments about the origin.
    /// Throws SceneError that names the probe.
    Recorder(World& world, std::vector<RecordedProbe> probes, Real every = 0);
    ~Recorder();
    Recorder(Recorder&&) noexcept;
    Recorder& operator=(Recorder&&) noexcept;

    /// Takes a sample, which may become a row. Must be called after every call of advance, so that no impulse is
    /// missed. A call before the first step records the initial state, with NaN as forces.
    void sample(const World& world);
    /// The columns, beginning with the time.
    const std::vector<SeriesColumn>& columns() const;
    /// Number of recorded rows.
    std::size_t row_count() const;
    /// Returns the values of a row, one per column. The span is valid until the next sample.
    std::span<const Real> row(std::size_t number) const;

    /// Writes the rows recorded so far to a CSV file, and from now on each new row as soon as it is recorded. A run
    /// that is killed therefore leaves a file of complete rows. Throws SceneError if the file cannot be written; if a
    /// later row cannot be written, sample() throws it.
    ///
    /// An existing file is replaced as in write_csv(). With `keep_until` [s], its rows up to this time stay at the
    /// beginning of the new file; its headings must be those of this Recorder.
    void stream_csv(const std::filesystem::path& file, std::optional<Real> keep_until = {});
    /// Writes a CSV file: headings with units in the first line, then numbers with all digits, "nan" for values that
    /// were not measured. An existing file is replaced completely or not at all. Throws SceneError.
    void write_csv(const std::filesystem::path& file) const;
    /// Writes an HDF5 file: a data set "/time" and, for each other column, a data set "/PROBE/QUANTITY" with the
    /// attribute "unit". An existing file is replaced completely or not at all. Throws SceneError.
    void write_hdf5(const std::filesystem::path& file) const;

private:
    struct Impl;
    std::unique_ptr<Impl> impl_;
};

}  // namespace skerry
#pragma GCC visibility pop
