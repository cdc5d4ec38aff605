// Time series of a run: where points are, what forces act, how much energy there is (docs/outputs.md).
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

/// Position, displacement and velocity of a point of a body that moves with its material: with nodes, by weights that
/// sum to one.
struct PointProbe {
    BodyHandle body{};
    std::array<Index, 4> node{};   // local
    std::array<Real, 4> weight{};  // of each
    std::optional<Vec3> origin{};  // m, of its displacement; by default where it is when the recorder is made
};
/// A point of the world, m, as the body is now: in the tetrahedron that it lies in. One outside of all of them, but no
/// further from a node than the mean edge of the surface, is that node; others are refused with SceneError.
PointProbe probe_point(const World& world, BodyHandle body, const Vec3& point);

/// Of the centre of mass.
struct BodyProbe {
    BodyHandle body{};
    std::optional<Vec3> origin{};  // as PointProbe::origin
};
/// What contacts exert on a body: all of them, or those with one other body or collider.
struct BodyForceProbe {
    BodyHandle body{};
    std::optional<std::variant<BodyHandle, ColliderHandle>> by{};
};
struct ColliderForceProbe {
    ColliderHandle collider{};
    std::optional<BodyHandle> by{};
};
/// What an attachment exerts on its body.
struct ReactionProbe {
    AttachmentHandle attachment{};
};
/// Kinetic, elastic and potential energy of the world, and what was dissipated.
struct EnergyProbe {};
/// The largest von Mises stress of nodes (local) of a body; of all without any.
struct StressProbe {
    BodyHandle body{};
    std::vector<Index> nodes{};
};
/// The smallest ratio of volume of the elements of a body to that at rest; below 0 one is turned inside out.
struct VolumeProbe {
    BodyHandle body{};
};

struct RecordedProbe {
    std::string name;  // of its own, not empty, without '/' and control characters
    std::variant<PointProbe, BodyProbe, BodyForceProbe, ColliderForceProbe, ReactionProbe, EnergyProbe, StressProbe,
                 VolumeProbe>
        what;
};

/// A column of a series: "PROBE.QUANTITY [UNIT]", "time [s]" the first.
struct SeriesColumn {
    std::string probe;  // empty: time
    std::string quantity;
    std::string unit;  // SI; 1 of counts and ratios

    std::string heading() const;
};

/// Records a row whenever time has come to the next multiple of `every`, at the end of a call of advance. Forces are
/// those of all calls since the row before: impulses are sums, forces and moments means, largest_force the largest of a
/// step. Rows stay in memory until it is written or thrown away.
class Recorder {
public:
    /// `every`: s, >= 0; 0: at every sample. Where a probe is of forces and the world does not measure them, it does
    /// from now on, moments about the origin. Throws SceneError that names the probe.
    Recorder(World& world, std::vector<RecordedProbe> probes, Real every = 0);
    ~Recorder();
    Recorder(Recorder&&) noexcept;
    Recorder& operator=(Recorder&&) noexcept;

    /// To be called after every call of advance, so that no impulse is missed; before the first it records how things
    /// begin, with forces that are not a number.
    void sample(const World& world);
    const std::vector<SeriesColumn>& columns() const;
    std::size_t row_count() const;
    /// One value a column; valid until the next sample.
    std::span<const Real> row(std::size_t number) const;

    /// From now on each row goes to a CSV file as soon as it is there, those so far at once: a run that is killed
    /// leaves a file of whole rows. With `keep_until` (s) rows that the file has up to that time stay before them:
    /// headings have to be the same. What was there is replaced as write_csv does. Throws SceneError, here and in
    /// sample.
    void stream_csv(const std::filesystem::path& file, std::optional<Real> keep_until = {});
    /// Headings with units in the first line, then numbers with all their digits, "nan" where there is none. The file
    /// is replaced as a whole or not at all. Throws SceneError.
    void write_csv(const std::filesystem::path& file) const;
    /// HDF5: a data set "/time" and one "/PROBE/QUANTITY" for each other column, with the attribute "unit". The file is
    /// replaced as a whole or not at all. Throws SceneError.
    void write_hdf5(const std::filesystem::path& file) const;

private:
    struct Impl;
    std::unique_ptr<Impl> impl_;
};

}  // namespace skerry
#pragma GCC visibility pop
