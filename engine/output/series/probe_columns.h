// Columns recorded by each kind of probe, and their values at a time.
#pragma once

#include <vector>

#include "skerry/recorder.h"

namespace skerry {

/// Sums of a force probe since the previous row.
struct ForceSum {
    Vec3 impulse = Vec3::Zero(), moment = Vec3::Zero(), friction = Vec3::Zero();  // [N s], [N m s], [N s]
    Real pressing = 0, largest = 0, seconds = 0;
    Index contacts = 0;

    void add(const ForceReport& report);
};

/// A probe with its accumulated state.
struct TrackedProbe {
    RecordedProbe probe;
    Vec3 origin = Vec3::Zero();  // reference of displacements [m]
    ForceSum force{};
};

bool measures_force(const RecordedProbe& probe);
/// Starts a probe. Throws SceneError if the world does not have its body, collider or other object.
TrackedProbe track(const World& world, RecordedProbe probe);
void add_columns(const RecordedProbe& probe, std::vector<SeriesColumn>& columns);
/// Adds the forces of the last call of advance; only for force probes.
void add_forces(const World& world, TrackedProbe& probe);
/// Appends one value per column and resets the accumulated forces.
void put_row(const World& world, TrackedProbe& probe, std::vector<Real>& values);

}  // namespace skerry
