// Checks the result of a step before the step is committed (docs/methods/time_stepping.md 4).
#pragma once

#include <cstdint>
#include <span>

#include "components/body_table.h"
#include "components/element_table.h"
#include "components/ghost_marks.h"
#include "components/node_block_table.h"
#include "components/node_table.h"
#include "jobs/access.h"
#include "jobs/executor.h"

namespace skerry {

enum class StepFault { none, not_finite, too_fast, too_far, too_stiff, unsolved };

/// Deformation rate of the fastest element, divided by the leeway of this element. The leeway is a factor on
/// max_strain_step, the largest change of the deformation gradient F that a step may make. The deformation rate is the
/// smaller of two values:
/// - the norm |F'| of the rate of F,
/// - the greatest speed of a corner of a tetrahedron relative to its corner 0, divided by the smallest altitude of the
///   tetrahedron.
struct StrainRate {
    Real rate = 0;          // rate of the fastest element; 0 if no element exceeds the given rate [1/s]
    Index body = no_index;  // body of the fastest element: row of BodyTable
};

/// Shows whether a step may be committed, and otherwise the fault that prevents it.
struct StepVerdict {
    StepFault fault = StepFault::none;
    Index body = no_index;  // row of BodyTable
    Index node = no_index;  // row of NodeTable, if one node causes the fault
    // Size of the fault:
    // - too_fast: norm of the change of F in this step, divided by the leeway of the tetrahedron;
    // - too_far: spacing of floating-point coordinates, divided by the mean edge;
    // - too_stiff: longest stable step [s];
    // - not_finite and unsolved: not used.
    Real value = 0;
    Index tetrahedron = no_index;  // tetrahedron t that causes the fault, if there is one: lane t % 8 of block t / 8
    StrainRate fastest = {};       // fastest element; not set if the fault is not_finite
};

struct CheckInputs {
    std::span<const Index> block_begin, block_end, block_body;  // NodeBlockTable
    std::span<const Range> body_node_blocks;
    // smallest rest altitude; 0 for a kinematic body, whose speed is not checked [m]
    std::span<const Real> body_min_altitude;
    std::span<const Vec3> velocity;  // velocity at the start of the step [m/s]
    std::span<const Vec3> velocity_next;
    // Velocity with which contacts push nodes out of overlaps [m/s]. It changes positions, but is not part of
    // velocity_next. Empty if no contact pushes.
    std::span<const Vec3> push_out;
    std::span<const Vec3> rest_position = {};                 // m
    std::span<const TetrahedronNodes> tetrahedron_node = {};  // TetrahedronBlockTable
    std::span<const ElementLane> tetrahedron_altitude = {};   // m
    // leeway: factor on max_strain_step, the largest change of F that a step may make; empty means 1 for all tetrahedra
    std::span<const ElementLane> tetrahedron_leeway = {};
    std::span<const Range> body_blocks = {};  // tetrahedra of each body; if empty, check_state tests node speeds
    // Elements: columns of BodyTable, ElementBlockTable and ElementNodeTable. If body_element_blocks is empty, the
    // tetrahedra are the elements.
    std::span<const Range> body_element_blocks = {};
    std::span<const Index> element_first = {}, element_count = {};
    std::span<const NodeLane> element_node = {};
    std::span<const ElementGradient> element_gradient = {};
    std::span<const ElementLane> element_implicit_modulus = {};
    std::span<const ElementPart> element_part = {};  // empty if no element is an inversion barrier
    // column of BodyTable; empty if the frames of all bodies are at rest
    std::span<const MovingFrame> body_frame = {};
    GhostMarks ghosts = {};  // copies of bodies of other ranks; their deformation rates are not checked

    /// `pushed`: true if a contact pushes nodes out of penetration in this step.
    static CheckInputs bind(const Binder& binder, const NodeBlockTable& block, const BodyTable& body,
                            const NodeTable& node, const TetrahedronBlockTable& tetrahedron,
                            const ElementBlockTable& element, const ElementNodeTable& element_node,
                            const bool& pushed) {
        return {.block_begin = binder.read(block.begin),
                .block_end = binder.read(block.end),
                .block_body = binder.read(block.body),
                .body_node_blocks = binder.read(body.node_blocks),
                .body_min_altitude = binder.read(body.min_altitude),
                .velocity = binder.read(node.velocity),
                .velocity_next = binder.read(node.velocity_next),
                .push_out = binder.read_if(binder.read(pushed), node.push_out),
                .rest_position = binder.read(node.rest_position),
                .tetrahedron_node = binder.read(tetrahedron.node),
                .tetrahedron_altitude = binder.read(tetrahedron.altitude),
                .tetrahedron_leeway = binder.read(tetrahedron.leeway),
                .body_blocks = binder.read(body.tetrahedron_blocks),
                .body_element_blocks = binder.read(body.blocks),
                .element_first = binder.read(element.first),
                .element_count = binder.read(element.count),
                .element_node = binder.read(element_node.node),
                .element_gradient = binder.read(element_node.gradient),
                .element_implicit_modulus = binder.read(element.implicit_modulus),
                .element_part = binder.read(element.part),
                .body_frame = binder.read(body.frame),
                .ghosts = {binder.read(body.ghost)}};
    }
};

/// Greatest node speeds with the velocities velocity_next + push_out, in the world and in the moving frame of the body.
/// Values by node block are squared [m^2/s^2], values by body are not [m/s].
struct SpeedOutputs {
    std::span<Real> block_squared, block_frame_squared;
    std::span<Real> body, body_frame;

    static SpeedOutputs bind(const Binder& binder, NodeBlockTable& block, BodyTable& body_table) {
        return {.block_squared = binder.write(block.max_speed_squared),
                .block_frame_squared = binder.write(block.frame_speed_squared),
                .body = binder.write(body_table.max_speed),
                .body_frame = binder.write(body_table.frame_speed)};
    }
};

/// Leeway (factor on max_strain_step) of implicit elements and of the tetrahedra that these elements cover. All other
/// elements have the leeway 1. Implicit elements may deform more in a step, because they make no step unstable.
inline constexpr Real implicit_leeway = 5;

/// Tests the velocities and the deformation in a step of length `h` [s]. Writes the greatest node speeds to `speed`,
/// and returns the first fault in body order: a velocity that is not finite, or an element whose deformation gradient F
/// would change too much. Parallel over node blocks and bodies.
///
/// The change of F (Frobenius norm) must not exceed `max_strain_step` times the leeway of the element. Common motion of
/// all nodes and slow rotation of a large body cause no fault. The verdict names the tetrahedron that deforms fastest.
/// Simple conditions decide which tests are made:
/// 1. A tetrahedron is tested if two of its corners move apart by more than the allowed change of F times its smallest
///    altitude.
/// 2. An element is tested if one of its tetrahedra changes too much, because F of an element is a mean of F over
///    tetrahedra.
///
/// Without `body_blocks`, the speed of each node relative to the mean velocity of its body is tested against the
/// smallest altitude of the body. This test also rejects fast rotation of a large body.
///
/// StepVerdict::fastest is set if an element deforms too fast for a step of length `h` or `longest` [s]. `longest`:
/// upper limit on the length of the next step. `beside_fast`: work memory, one entry per node.
StepVerdict check_state(Executor& executor, const CheckInputs& state, Real h, Real longest, Real max_strain_step,
                        const SpeedOutputs& speed, Column<std::uint8_t>& beside_fast);

/// Finds the body that deforms fastest with the velocities velocity_next + push_out. The function serves checks between
/// two steps. The deformation rate of the result is 0 if no body deforms faster than `rate` [1/s].
StrainRate strain_rate(Executor& executor, const CheckInputs& state, Real rate, Column<std::uint8_t>& beside_fast);

/// Upper limit on the spacing of floating-point coordinates, as a fraction of the mean edge of a body. A step lasts
/// about as long as sound takes to cross an edge. So at a larger spacing, rounding could suppress the motion of nodes
/// that move at a millionth of the speed of sound.
inline constexpr Real coarsest_spacing = 1e-6;

/// Finds the first body that is too far from the origin for its size. One node per body is tested, because the size of
/// a body is small compared with such distances.
StepVerdict check_distance(Executor& executor, std::span<const Vec3> position, std::span<const Range> body_nodes,
                           std::span<const Real> body_mean_edge);

}  // namespace skerry
