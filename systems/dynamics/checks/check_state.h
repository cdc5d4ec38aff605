// Checks the step before it is committed (docs/methods/time_stepping.md 4).
#pragma once

#include <cstdint>
#include <span>

#include "components/body_table.h"
#include "components/element_table.h"
#include "components/node_block_table.h"
#include "components/node_table.h"
#include "jobs/access.h"
#include "jobs/executor.h"

namespace skerry {

enum class StepFault { none, not_finite, too_fast, too_far, too_stiff, unsolved };

/// Deformation rate of an element: |F'| or, if that is less, the relative speed of two corners of a tetrahedron over
/// its altitude. It is divided by the leeway of the element.
struct StrainRate {
    Real rate = 0;          // of the fastest element; 0: none is faster than the rate asked for [1/s]
    Index body = no_index;  // body of that element: row of BodyTable
};

/// Why a step must not be committed.
struct StepVerdict {
    StepFault fault = StepFault::none;
    Index body = no_index;  // row of BodyTable
    Index node = no_index;  // row of NodeTable, if one node causes the fault
    Real value = 0;         // too_fast: norm of the change of F in this step, over the leeway;
                            // too_far: spacing of floating-point coordinates over the mean edge; not_finite: unused
    Index tetrahedron = no_index;  // lane of a block, if one tetrahedron causes the fault
    StrainRate fastest = {};       // set by check_state unless the fault is not_finite
};

struct CheckInputs {
    std::span<const Index> block_begin, block_end, block_body;  // NodeBlockTable
    std::span<const Range> body_node_blocks;
    std::span<const Real> body_min_altitude;  // 0: a kinematic body, whose speed is not checked [m]
    std::span<const Vec3> velocity;           // m/s, at the start of the step
    std::span<const Vec3> velocity_next;
    std::span<const Vec3> push_out;                           // m/s; empty: no contact pushes
    std::span<const Vec3> rest_position = {};                 // m
    std::span<const TetrahedronNodes> tetrahedron_node = {};  // TetrahedronBlockTable
    std::span<const ElementLane> tetrahedron_altitude = {};   // m
    std::span<const ElementLane> tetrahedron_leeway = {};     // factor on max_strain_step; empty: 1
    std::span<const Range> body_blocks = {};                  // BodyTable; empty: see check_state
    // ElementBlockTable, ElementNodeTable; empty: tetrahedra are the elements
    std::span<const Range> body_element_blocks = {};
    std::span<const Index> element_first = {}, element_count = {};
    std::span<const NodeLane> element_node = {};
    std::span<const ElementGradient> element_gradient = {};
    std::span<const ElementLane> element_implicit_modulus = {};
    std::span<const ElementPart> element_part = {};  // empty: no element is a guard
    std::span<const MovingFrame> body_frame = {};    // BodyTable; empty: no frame moves

    /// `pushed`: true if some contact pushes.
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
                .body_frame = binder.read(body.frame)};
    }
};

/// Greatest speeds of velocity_next + push_out, in the world and in the frame of the body: squared by node block
/// [m^2/s^2], and by body [m/s].
struct SpeedOutputs {
    std::span<Real> block_squared, block_frame_squared;
    std::span<Real> body, body_frame;

    static SpeedOutputs bind(const Binder& binder, NodeBlockTable& block, BodyTable& of_body) {
        return {.block_squared = binder.write(block.max_speed_squared),
                .block_frame_squared = binder.write(block.frame_speed_squared),
                .body = binder.write(of_body.max_speed),
                .body_frame = binder.write(of_body.frame_speed)};
    }
};

/// Factor on max_strain_step for implicit elements and for the tetrahedra that they cover.
inline constexpr Real implicit_leeway = 5;

/// Writes speeds and returns the first fault in body order: a velocity that is not finite, or an element whose F would
/// change by more than `max_strain_step` (Frobenius norm) in this step. F of an element is a mean over tetrahedra. So
/// an element is tested only beside a tetrahedron whose F would change by as much (times its leeway). A tetrahedron is
/// tested only if two corners move apart by more than this fraction of its smallest altitude. The verdict names the
/// tetrahedron that deforms fastest. Common motion and slow rotation of a large body do no harm and do not count.
/// Without `body_blocks` a node is compared with the mean velocity of its body, and its displacement with the smallest
/// altitude of the body. This also rejects fast rotation of a large body. `fastest` is reported if it is too fast for a
/// step of `longest` [s]. `beside_fast` is scratch, by node. Parallel over node blocks and bodies.
StepVerdict check_state(Executor& executor, const CheckInputs& state, Real h, Real longest, Real max_strain_step,
                        const SpeedOutputs& speed, Column<std::uint8_t>& beside_fast);

/// Deformation rate of the body that deforms fastest, from velocity_next and push_out, for use between two steps.
/// The result has rate 0 if no body is faster than `rate` [1/s].
StrainRate strain_rate(Executor& executor, const CheckInputs& state, Real rate, Column<std::uint8_t>& beside_fast);

/// Largest allowed spacing of the coordinates of a body, over its mean edge. With a coarser spacing motion below a
/// millionth of the speed of sound would be lost to rounding.
inline constexpr Real coarsest_place = 1e-6;

/// Finds the first body that is too far from the origin for its size. Tests one node per body, since a body is small
/// compared with such distances.
StepVerdict check_distance(Executor& executor, std::span<const Vec3> position, std::span<const Range> body_nodes,
                           std::span<const Real> body_mean_edge);

}  // namespace skerry
