// What each kind of probe records: its columns, and their values at a time.
#pragma once

#include <vector>

#include "skerry/recorder.h"

namespace skerry {

/// What a probe of forces got since the row before.
struct ForceSum {
    Vec3 impulse = Vec3::Zero(), moment = Vec3::Zero(), friction = Vec3::Zero();  // N s, N m s
    Real pressing = 0, largest = 0, seconds = 0;
    Index contacts = 0;

    void add(const ForceReport& report);
};

/// A probe, and what it remembers.
struct TrackedProbe {
    RecordedProbe probe;
    Vec3 origin = Vec3::Zero();  // m, of displacements
    ForceSum force{};
};

bool measures_force(const RecordedProbe& probe);
/// Refuses what the world does not have: throws SceneError.
TrackedProbe track(const World& world, RecordedProbe probe);
void add_columns(const RecordedProbe& probe, std::vector<SeriesColumn>& columns);
/// Of the last call of advance, for probes of forces.
void add_forces(const World& world, TrackedProbe& probe);
/// Appends one value a column, and forgets the forces.
void put_row(const World& world, TrackedProbe& probe, std::vector<Real>& values);

}  // namespace skerry
