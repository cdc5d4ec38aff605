// How long impulses of elements may be while they deform as fast as they do (docs/methods/stable_step.md 7.6).
#pragma once

#include <cstdint>
#include <span>

#include "components/body_table.h"
#include "components/element_table.h"
#include "components/node_table.h"
#include "jobs/access.h"
#include "jobs/executor.h"

namespace skerry {

struct ImpulseLimitInputs {
    // BodyTable
    std::span<const Range> body_blocks;
    std::span<const std::uint8_t> body_level, body_asleep;
    std::span<const std::array<Index, element_level_count>> body_level_count;
    std::span<const std::array<Real, element_level_count>> body_steepness;  // 1/m
    std::span<const Real> body_frame_speed;                                 // m/s
    // ElementBlockTable, ElementNodeTable
    std::span<const Index> element_first, element_count;
    std::span<const std::uint8_t> element_level, element_touched;
    std::span<const NodeLane> element_node;
    std::span<const ElementGradient> element_gradient;
    std::span<const ElementLane> element_implicit_modulus;  // Pa; implicit ones have leeway (check_state.h)
    std::span<const Vec3> velocity_next;                    // m/s

    static ImpulseLimitInputs bind(const Binder& binder, const BodyTable& body, const ElementBlockTable& element,
                                   const ElementNodeTable& element_node, const NodeTable& node) {
        return {.body_blocks = binder.read(body.blocks),
                .body_level = binder.read(body.level),
                .body_asleep = binder.read(body.asleep),
                .body_level_count = binder.read(body.level_count),
                .body_steepness = binder.read(body.steepness),
                .body_frame_speed = binder.read(body.frame_speed),
                .element_first = binder.read(element.first),
                .element_count = binder.read(element.count),
                .element_level = binder.read(element.level),
                .element_touched = binder.read(element.touched),
                .element_node = binder.read(element_node.node),
                .element_gradient = binder.read(element_node.gradient),
                .element_implicit_modulus = binder.read(element.implicit_modulus),
                .velocity_next = binder.read(node.velocity_next)};
    }
};

/// longest[body], s: within an impulse as long no element of the body that is not touched changes its F by more than
/// `max_strain_step` (Frobenius norm) at its present rate; the greatest number where none would within an impulse of
/// its level, which greatest speeds tell in most steps. Where they do not, elements are looked at only if `look` says
/// so; else longest[body] stays. Parallel over blocks of elements.
void limit_impulses(Executor& executor, const ImpulseLimitInputs& inputs, Real h, Real max_strain_step, bool look,
                    Column<Real>& partial, std::span<Real> longest);

}  // namespace skerry
