// One frame of output as plain data: what the writers format. Collected from a World in collect_frame.cpp and nowhere
// else.
#pragma once

#include <array>
#include <span>
#include <string>
#include <vector>

#include "skerry/report.h"
#include "skerry/settings.h"

namespace skerry {

/// A body as the output shows it. The spans borrow from the world: valid until it changes.
struct BodyFrame {
    BodyHandle handle;
    std::string name;
    std::span<const Vec3> position;                    // m, by node
    std::span<const Vec3> velocity;                    // m/s, by node
    std::span<const std::array<Index, 3>> surface;     // boundary triangles, rows of position
    std::span<const std::array<Index, 4>> tetrahedra;  // rows of position
    std::vector<Mat3> stress, strain;                  // Cauchy's in Pa and Green's, by tetrahedron
    std::vector<Mat3> node_stress, node_strain;        // the same by node
    std::vector<Index> material{};                     // by tetrahedron: in the order in which materials were added
};

struct ColliderFrame {
    ColliderHandle handle;
    std::string name;
    const Shape* shape = nullptr;  // in its own frame
    MotionKey pose;                // shape frame to world; a plane is z = 0 of its frame, facing up
};

struct Frame {
    Real time = 0;                // s
    Vec3 gravity = Vec3::Zero();  // m/s^2
    Energy energy;
    std::vector<BodyFrame> bodies;
    std::vector<ColliderFrame> colliders;
    std::span<const Contact> contacts;
};

/// Regions are numbered by row, so the last number counts them; -1 marks contacts without a moving node.
inline Index count_regions(std::span<const Contact> contacts) {
    Index count = 0;
    for (const Contact& contact : contacts) count = contact.region >= count ? contact.region + 1 : count;
    return count;
}

}  // namespace skerry
