// Snapshots: the state of a world in one frame of a live view, with copies of all data that the frame needs.
#pragma once

#include <chrono>
#include <cstdint>
#include <map>
#include <memory>
#include <utility>
#include <vector>

#include "engine/live/pull.h"
#include "engine/output/collect_frame.h"

namespace skerry {

/// One frame of a live view. Another thread can read it while the world advances.
struct Snapshot {
    Frame frame;  // its spans and pointers refer to the copies below

    std::uint64_t number = 0;                                // consecutive number among all snapshots, from 1
    std::uint64_t run = 0;                                   // number of the run; LiveHub::begin_run adds 1
    std::uint64_t version = 0;                               // number of the shown state, see LiveHub::mark_changed
    std::vector<std::vector<Real>> probes;                   // values by probe and column
    std::vector<Real> sliders;                               // values of the sliders
    std::vector<std::pair<std::uint64_t, PullState>> pulls;  // number of a browser, and the pull of its user
    Real speed = 0;                                          // simulated time per wall time

    using Triangles = std::vector<std::array<Index, 3>>;
    struct BodyCopy {
        std::vector<Vec3> position, velocity;
        std::shared_ptr<const Triangles> surface;
        std::shared_ptr<const BoundVisual> visual;
    };
    std::vector<BodyCopy> bodies;
    std::vector<std::shared_ptr<const Shape>> shapes;  // by collider
    std::vector<Contact> contacts;
};

/// Takes snapshots of a world. Surfaces and shapes, which do not change, are copied once and shared by all snapshots.
class SnapshotTaker {
public:
    /// Replaces the content of `snapshot`, and reuses its memory. With FrameContent::mesh_error it includes the energy.
    /// With lesser content, an extra pass over all elements calculates the energy, so rarely that it takes at most 1 %
    /// of the wall time. The snapshots in between get the last result.
    void take(const World& world, FrameContent content, Snapshot& snapshot);
    /// Returns true if the time is earlier than in the last snapshot, or if a body has other numbers of nodes or
    /// triangles than in its first snapshot. The owner has then reset or replaced the world, and streams must start
    /// anew.
    bool is_other_run(const World& world) const;
    /// Forgets all objects, the energy and the time of the last snapshot.
    void clear();

private:
    struct KnownBody {
        std::size_t nodes = 0;
        std::shared_ptr<const Snapshot::Triangles> surface;
    };
    std::map<BodyHandle, KnownBody> bodies_;
    std::map<ColliderHandle, std::shared_ptr<const Shape>> shapes_;
    Energy energy_{};
    std::chrono::steady_clock::time_point next_energy_{};  // wall time of the next calculation of the energy
    Real time_ = -infinity;                                // simulated time of the last snapshot [s]
};

}  // namespace skerry
