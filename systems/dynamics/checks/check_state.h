// Looks at the step before it is committed (docs/methods/time_stepping.md 4).
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

/// How fast elements deform: |F'|, or, where that is less, how fast two corners of a tetrahedron part over its
/// altitude; over the leeway that they have.
struct StrainRate {
    Real rate = 0;          // 1/s, of the fastest; 0: all are slower than was asked for
    Index body = no_index;  // row of BodyTable: whose it is
};

/// Why a step must not be committed.
struct StepVerdict {
    StepFault fault = StepFault::none;
    Index body = no_index;         // row of BodyTable
    Index node = no_index;         // row of NodeTable, when one node is to blame
    Real value = 0;                // not_finite: -; too_fast: norm of what F changes by in this step there;
                                   // too_far: distance between neighbouring numbers there, over the mean edge
    Index tetrahedron = no_index;  // place: lane of a block, when one tetrahedron is to blame
    StrainRate fastest = {};       // whatever the fault, but for not_finite
};

struct CheckInputs {
    std::span<const Index> block_begin, block_end, block_body;  // NodeBlockTable
    std::span<const Range> body_node_blocks;
    std::span<const Real> body_min_altitude;  // m; 0 for a kinematic body: not judged by speed
    std::span<const Vec3> velocity;           // m/s, at the start of the step
    std::span<const Vec3> velocity_next;
    std::span<const Vec3> push_out;                           // m/s; empty: no contact pushes
    std::span<const Vec3> rest_position = {};                 // m
    std::span<const TetrahedronNodes> tetrahedron_node = {};  // TetrahedronBlockTable
    std::span<const ElementLane> tetrahedron_altitude = {};   // m
    std::span<const ElementLane> tetrahedron_leeway = {};     // in times max_strain_step; empty: 1
    std::span<const Range> body_blocks = {};  // BodyTable; empty: bodies are judged as one tetrahedron each
    // ElementBlockTable, ElementNodeTable; empty: tetrahedra are the elements
    std::span<const Range> body_element_blocks = {};
    std::span<const Index> element_first = {}, element_count = {};
    std::span<const NodeLane> element_node = {};
    std::span<const ElementGradient> element_gradient = {};
    std::span<const ElementLane> element_implicit_modulus = {};
    std::span<const ElementPart> element_part = {};  // empty: none is a guard
    std::span<const MovingFrame> body_frame = {};    // BodyTable; empty: none moves

    /// `pushed`: some contact pushes.
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

/// Greatest speeds of velocity_next + push_out: m^2/s^2 by block, m/s by body; in the body's frame, too.
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

/// In how many times max_strain_step implicit elements may deform, and the tetrahedra that they cover.
inline constexpr Real implicit_leeway = 5;

/// Writes speeds and returns the first fault in body order: a velocity that is
/// not finite, or an element whose F would change by more than `max_strain_step` (Frobenius norm) in this step. That F
/// is a mean over tetrahedra, so elements are looked at beside tetrahedra whose F would change by as much (by their
/// leeway more), and these where two corners move apart by more than this fraction of the smallest altitude. What is
/// blamed is the tetrahedron that deforms fastest. Common motion and slow turns of a large body do no harm and are not
/// counted. Without `body_blocks` a node is compared with the mean velocity of its body instead, and its way with the
/// smallest altitude of the body, which refuses a quick turn of a large body, too. How fast the fastest body deforms is
/// said where it would be too fast for a step of `longest` (s). `beside_fast` is scratch, by node. Parallel over node
/// blocks and bodies.
StepVerdict check_state(Executor& executor, const CheckInputs& state, Real h, Real longest, Real max_strain_step,
                        const SpeedOutputs& speed, Column<std::uint8_t>& beside_fast);

/// The same rate between two steps, by velocity_next and push_out: of the body that deforms fastest, where faster than
/// `rate` (1/s).
StrainRate strain_rate(Executor& executor, const CheckInputs& state, Real rate, Column<std::uint8_t>& beside_fast);

/// Coordinates of a body that are further apart than this fraction of its mean edge are no ground for a step: motion
/// below a millionth of the speed of sound would be lost to rounding.
inline constexpr Real coarsest_place = 1e-6;

/// Finds the first body that is too far from the origin for its size. Looks at one node a body: against such distances
/// a body is small.
StepVerdict check_distance(Executor& executor, std::span<const Vec3> position, std::span<const Range> body_nodes,
                           std::span<const Real> body_mean_edge);

}  // namespace skerry
