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

#include "skerry/world.h"

#pragma GCC visibility push(default)
namespace skerry {

/// Records position, displacement and velocity of a material point of a body: a weighted mean of up to four nodes. The
/// weights must sum to one.
struct PointProbe {
    BodyHandle body{};
    std::array<Index, 4> node{};   // local node numbers
    std::array<Real, 4> weight{};  // weight of each node
    std::optional<Vec3> origin{};  // origin of the displacement [m]; default: position when the recorder is made
};
/// Probe of the material point that is now at `point` (world, [m]), interpolated in the tetrahedron that contains it. A
/// point outside of all tetrahedra is replaced by the nearest node, if that is no further away than the mean surface
/// edge. Otherwise throws SceneError.
PointProbe probe_point(const World& world, BodyHandle body, const Vec3& point);

/// Records position, displacement and velocity of the centre of mass of a body.
struct BodyProbe {
    BodyHandle body{};
    std::optional<Vec3> origin{};  // see PointProbe::origin
};
/// Records the contact forces on a body: of all contacts, or of those with one other body or collider.
struct BodyForceProbe {
    BodyHandle body{};
    std::optional<std::variant<BodyHandle, ColliderHandle>> by{};
};
/// Records the contact forces on a collider: of all contacts, or of those with one body.
struct ColliderForceProbe {
    ColliderHandle collider{};
    std::optional<BodyHandle> by{};
};
/// Records the force of an attachment on its body.
struct ReactionProbe {
    AttachmentHandle attachment{};
};
/// Records the kinetic, elastic, potential and dissipated energy of the world.
struct EnergyProbe {};
/// Records the largest von Mises stress at the given nodes (local numbers) of a body, or at all nodes if none is given.
struct StressProbe {
    BodyHandle body{};
    std::vector<Index> nodes{};
};
/// Records the smallest ratio of present volume to rest volume of the tetrahedra of a body; below 0 one is inverted.
struct VolumeProbe {
    BodyHandle body{};
};

struct RecordedProbe {
    std::string name;  // unique, not empty, "." or "time", without '/' and control characters
    std::variant<PointProbe, BodyProbe, BodyForceProbe, ColliderForceProbe, ReactionProbe, EnergyProbe, StressProbe,
                 VolumeProbe>
        what;
};

/// A column of a series. Its heading is "PROBE.QUANTITY [UNIT]"; the first column is "time [s]".
struct SeriesColumn {
    std::string probe;  // empty for the time
    std::string quantity;
    std::string unit;  // SI unit; 1 for counts and ratios

    std::string heading() const;
};

/// Records a row of values after the first call of advance that reaches the next multiple of `every`. Forces cover all
/// calls since the previous row: impulses are sums, forces and moments are means, and largest_force is the
/// largest of any step. All rows stay in memory as long as the Recorder exists.
class Recorder {
public:
    /// `every`: time between rows, >= 0 [s]; with 0 every sample makes a row. If a probe needs forces and the world
    /// does not measure them, measuring is switched on, with moments about the origin. Throws SceneError that names the
    /// probe.
    Recorder(World& world, std::vector<RecordedProbe> probes, Real every = 0);
    ~Recorder();
    Recorder(Recorder&&) noexcept;
    Recorder& operator=(Recorder&&) noexcept;

    /// Must be called after every call of advance, so that no impulse is missed. A call before the first step records
    /// the initial state, with NaN as forces.
    void sample(const World& world);
    const std::vector<SeriesColumn>& columns() const;
    std::size_t row_count() const;
    /// The values of a row, one per column; valid until the next sample.
    std::span<const Real> row(std::size_t number) const;

    /// Writes the rows so far to a CSV file, and from now on each row as soon as it is recorded: a run that is killed
    /// leaves a file of complete rows. The file is replaced as in write_csv. With `keep_until` [s] its rows up to that
    /// time are kept at the beginning; its headings must be the same. Throws SceneError, here and in sample.
    void stream_csv(const std::filesystem::path& file, std::optional<Real> keep_until = {});
    /// Writes CSV: headings with units in the first line, then numbers with all their digits, "nan" for missing values.
    /// The file is replaced as a whole or not at all. Throws SceneError.
    void write_csv(const std::filesystem::path& file) const;
    /// Writes HDF5: a data set "/time" and a data set "/PROBE/QUANTITY" for each other column, with the attribute
    /// "unit". The file is replaced as a whole or not at all. Throws SceneError.
    void write_hdf5(const std::filesystem::path& file) const;

private:
    struct Impl;
    std::unique_ptr<Impl> impl_;
};

}  // namespace skerry
#pragma GCC visibility pop
