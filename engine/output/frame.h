// One frame of output as plain data, which is the input of the writers. Only collect_frame.cpp reads the World.
#pragma once

#include <array>
#include <span>
#include <string>
#include <vector>

#include "skerry/report.h"
#include "skerry/settings.h"

namespace skerry {

/// State of a body in one frame of output. The spans refer to the world and are valid until the world changes.
struct BodyFrame {
    BodyHandle handle;
    std::string name;
    std::span<const Vec3> position;  // by node [m]
    std::span<const Vec3> velocity;  // by node [m/s]
    // Corners of the boundary triangles, as indices of `position`.
    std::span<const std::array<Index, 3>> surface;
    // Corners of the tetrahedra, as indices of `position`.
    std::span<const std::array<Index, 4>> tetrahedra;
    std::vector<Mat3> stress, strain;            // values by tetrahedron: Cauchy stress [Pa] and Green strain
    std::vector<Real> plastic_strain;            // equivalent plastic strain by tetrahedron; empty if nothing yields
    std::vector<Mat3> node_stress, node_strain;  // values by node: Cauchy stress [Pa] and Green strain
    // Material number of each tetrahedron. Materials are numbered in the order in which they were added.
    std::vector<Index> material{};
};

struct ColliderFrame {
    ColliderHandle handle;
    std::string name;
    const Shape* shape = nullptr;  // shape in the collider's own frame
    // Pose of the collider in the world. In the frame of the collider a plane is z = 0, and its normal is +z.
    MotionKey pose;
};

struct Frame {
    Real time = 0;                // [s]
    Vec3 gravity = Vec3::Zero();  // [m/s^2]
    Energy energy;
    std::vector<BodyFrame> bodies;
    std::vector<ColliderFrame> colliders;
    std::span<const Contact> contacts;
};

/// Number of contact regions. Regions are numbered consecutively from 0. Contacts that belong to no region have the
/// number -1.
inline Index count_regions(std::span<const Contact> contacts) {
    Index count = 0;
    for (const Contact& contact : contacts) count = contact.region >= count ? contact.region + 1 : count;
    return count;
}

}  // namespace skerry
