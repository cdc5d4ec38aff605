// Columns that each kind of probe records, and the values of these columns.
#pragma once

#include <span>
#include <vector>

#include "skerry/recorder.h"

namespace skerry {

/// Force data summed up by a force probe since the previous row of its series.
struct ForceSum {
    // Sums of impulse [N s], angular impulse [N m s] and friction impulse [N s].
    Vec3 impulse = Vec3::Zero(), moment = Vec3::Zero(), friction = Vec3::Zero();
    // Sum of the magnitudes of the normal impulses [N s], largest force [N], and duration of the sums [s].
    Real pressing = 0, largest = 0, seconds = 0;
    bool measured = false;  // true if at least one of the summed calls of advance was long enough to measure the force
    Index contacts = 0;

    void add(const ForceReport& report);
};

/// A probe together with the data that it has accumulated.
struct TrackedProbe {
    RecordedProbe probe;
    Vec3 origin = Vec3::Zero();  // position from which the displacement of the probe is measured [m]
    ForceSum force{};
};

// If the world lacks an object or a node of a probe, check_probes(), add_forces() and put_row() throw a SceneError that
// names the probe.

/// Throws SceneError unless the names of the probes are valid and distinct, and the world has the objects and nodes of
/// the probes.
void check_probes(const World& world, std::span<const RecordedProbe> probes);
/// Starts probes that check_probes() has accepted: sets their origins, and makes the world measure forces if one of the
/// probes needs them.
std::vector<TrackedProbe> track(World& world, std::vector<RecordedProbe> probes);
void add_columns(const World& world, const RecordedProbe& probe, std::vector<SeriesColumn>& columns);
/// Adds the forces of the last call of advance to a force probe. Does nothing for other probes.
void add_forces(const World& world, TrackedProbe& probe);
/// Appends one value per column of the probe to `values`, and resets the accumulated forces.
void put_row(const World& world, TrackedProbe& probe, std::vector<Real>& values);

}  // namespace skerry
