// One frame of output as plain data, which is the input of the writers. Only collect_frame.cpp reads the World.
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <tuple>
#include <vector>

#include "components/options.h"
#include "engine/mesh/visual/bound_visual.h"
#include "skerry/report.h"
#include "skerry/settings.h"

namespace skerry {

/// State of a body in one frame of output. In a frame from collect_frame(), the spans refer to arrays of the World and
/// are valid until the world changes. In a Snapshot (frame of a live view), they refer to copies. Members whose values
/// the FrameContent of collect_frame() does not include are empty.
struct BodyFrame {
    BodyHandle handle;
    std::string name;
    std::span<const Vec3> position;  // by node [m]
    std::span<const Vec3> velocity;  // by node [m/s]
    // Corners of the boundary triangles, as indices of `position`.
    std::span<const std::array<Index, 3>> surface;
    // Corners of the tetrahedra, as indices of `position`. The cells of a body are its tetrahedra, or the triangles of
    // `surface` if it has none.
    std::span<const std::array<Index, 4>> tetrahedra;
    std::vector<Mat3> stress, strain;            // values by cell: Cauchy stress [Pa] and Green strain
    std::vector<Real> plastic_strain;            // equivalent plastic strain by cell; empty if nothing yields
    std::vector<Mat3> node_stress, node_strain;  // values by node: Cauchy stress [Pa] and Green strain
    std::vector<Real> node_mesh_error{};         // values by node: mean of mesh_error() over the adjacent tetrahedra
    // Material number of each cell. Materials are numbered in the order in which they were added.
    std::vector<Index> material{};
    // Stretch of the fibres, and nominal stress along them [Pa], by cell. Empty if the body has no fibres. A cell
    // without fibres has the stretch 1 and the stress 0; a cell with several families has the values of the family
    // added last.
    std::vector<Real> fibre_stretch{}, fibre_stress{};
    // Surface that is drawn in place of `surface`; nullptr if there is none. See visual_positions and visual_values.
    const BoundVisual* visual = nullptr;
    std::optional<MotionKey> rigid_pose{};  // pose of the mesh of a rigid body; empty for a deformable body

    std::size_t count_cells() const { return tetrahedra.empty() ? surface.size() : tetrahedra.size(); }
    std::size_t corners_of_cell() const { return tetrahedra.empty() ? 3 : 4; }
};

struct ColliderFrame {
    ColliderHandle handle;
    std::string name;
    const Shape* shape = nullptr;  // shape in the collider's own frame
    // Pose of the collider in the world. In the frame of the collider a plane is z = 0, and its normal is +z.
    MotionKey pose;
};

enum class LineKind : std::uint8_t { joint, tie, cable, spring };
template <>
struct EnumNames<LineKind> {
    static constexpr std::array<std::pair<LineKind, std::string_view>, 4> table{{
        {LineKind::joint, "joint"},
        {LineKind::tie, "tie"},
        {LineKind::cable, "cable"},
        {LineKind::spring, "spring"},
    }};
};

/// A joint, tie, cable or spring in one frame of output, as a line through points.
struct LineFrame {
    LineKind kind = LineKind::joint;
    std::uint32_t slot = 0, generation = 0;  // slot and generation of the object's handle
    std::string name;
    // Present positions [m]. Cable and spring: the anchors. Tie: the nodes that have not broken off. Hinge and slider:
    // the two ends of a displayed piece of the axis. Other joints: one point.
    std::vector<Vec3> points{};
    // Force at each point [N]:
    // - cable: tension of the segment that starts at the point; at the last point, of the last segment,
    // - spring: force, positive in tension,
    // - tie: norm of the force on the node,
    // - joint: norm of the force on the first body.
    std::vector<Real> force{};

    /// True if lines connect consecutive points.
    bool is_joined() const { return kind != LineKind::tie; }
    /// Identifies the object in all frames.
    std::tuple<LineKind, std::uint32_t, std::uint32_t> key() const { return {kind, slot, generation}; }
};

struct Frame {
    Real time = 0;                // [s]
    Vec3 gravity = Vec3::Zero();  // [m/s^2]
    Energy energy;
    std::vector<BodyFrame> bodies;
    std::vector<ColliderFrame> colliders;
    std::span<const Contact> contacts;
    std::vector<LineFrame> lines{};
};

/// Number of contact regions. Regions are numbered consecutively from 0. Contacts that belong to no region have the
/// number -1.
inline Index count_regions(std::span<const Contact> contacts) {
    Index count = 0;
    for (const Contact& contact : contacts) count = contact.region >= count ? contact.region + 1 : count;
    return count;
}

}  // namespace skerry
