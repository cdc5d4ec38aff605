// One frame of output as plain data, the input of the writers. Only collect_frame.cpp collects it from a World.
#pragma once

#include <array>
#include <span>
#include <string>
#include <vector>

#include "skerry/report.h"
#include "skerry/settings.h"

namespace skerry {

/// A body in the output. The spans refer to the world and are valid until it changes.
struct BodyFrame {
    BodyHandle handle;
    std::string name;
    std::span<const Vec3> position;                    // by node [m]
    std::span<const Vec3> velocity;                    // by node [m/s]
    std::span<const std::array<Index, 3>> surface;     // boundary triangles, as rows of position
    std::span<const std::array<Index, 4>> tetrahedra;  // corners, as rows of position
    std::vector<Mat3> stress, strain;                  // by tetrahedron: Cauchy stress [Pa] and Green strain
    std::vector<Mat3> node_stress, node_strain;        // by node
    std::vector<Index> material{};  // by tetrahedron; materials are numbered in the order in which they were added
};

struct ColliderFrame {
    ColliderHandle handle;
    std::string name;
    const Shape* shape = nullptr;  // in its own frame
    MotionKey pose;                // shape frame to world; a plane is z = 0 of its frame, facing up
};

struct Frame {
    Real time = 0;                // [s]
    Vec3 gravity = Vec3::Zero();  // [m/s^2]
    Energy energy;
    std::vector<BodyFrame> bodies;
    std::vector<ColliderFrame> colliders;
    std::span<const Contact> contacts;
};

/// Number of contact regions. Regions are numbered consecutively from 0; -1 marks contacts without a moving node.
inline Index count_regions(std::span<const Contact> contacts) {
    Index count = 0;
    for (const Contact& contact : contacts) count = contact.region >= count ? contact.region + 1 : count;
    return count;
}

}  // namespace skerry
