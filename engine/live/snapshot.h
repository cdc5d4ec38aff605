// State of a world in one frame of a live view, with copies of all data that it needs.
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

    std::uint64_t number = 0;               // position in the sequence of all snapshots, from 1
    std::uint64_t run = 0;                  // number of the run: 1, and one more after each reset
    std::uint64_t version = 0;              // number of the state that it shows (LiveHub::mark_changed)
    std::vector<std::vector<Real>> probes;  // values by probe and column
    std::vector<Real> sliders;              // values of the sliders
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
    /// Replaces the frame of `snapshot`, whose memory is used again. If the content does not include the energy, which
    /// takes a pass over all elements, the calculation may take 1 % of the wall time. Frames between two calculations
    /// get the last energy.
    void take(const World& world, FrameContent content, Snapshot& snapshot);
    /// Returns true if time went back, or if a body has another number of nodes or triangles than in an earlier
    /// snapshot. The world was then reset or replaced by its owner, and a stream cannot continue.
    bool is_other_run(const World& world) const;
    /// Forgets all objects.
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
