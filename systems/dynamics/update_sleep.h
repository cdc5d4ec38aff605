// Bodies that have been slow for a while are put to rest, all that touch each other at once; what touches them wakes them (methods.md 7).
#pragma once

#include <cstdint>
#include <span>

#include "components/body_table.h"
#include "components/collider_table.h"
#include "components/column.h"
#include "components/contact_table.h"

namespace skerry {

struct SleepSettings {
    Real speed = 0;   // m/s: a body is calm while no node of it is as fast; 0: none ever is
    Real time = 0.5;  // s: so long a body has to be calm, and all that it touches
};

/// The contacts of this step, after the solve.
struct TouchInputs {
    std::span<const Index> first_body, second_body;
    std::span<const ContactState> state;
    std::span<const Real> gap;               // m
    std::span<const Vec3> surface_velocity;  // m/s
};

/// Marks bodies at rest that a contact has pressed on: by the impulse that it had when they were put to rest, since without their weight they may
/// not press now. Before the solve. `warm_impulse` is empty when none is kept: then every contact counts.
void mark_pressed(std::span<const Index> first_body, std::span<const Index> second_body, std::span<const Vec3> warm_impulse,
                  std::span<const std::uint8_t> asleep, Column<std::uint8_t>& pressed);

/// Wakes every body that is marked, that a contact of this step presses on, by an impulse or by overlap, or that an attachment leads. Contacts
/// between bodies at rest are not looked for, so what presses moves. Returns false when none was woken.
bool wake_bodies(const TouchInputs& touches, std::span<const std::uint8_t> pressed, std::span<const Index> attached_body,
                 std::span<const RigidMotion> attached_motion, std::span<std::uint8_t> asleep, std::span<Real> calm);

struct RestInputs {
    std::span<const BodyKind> kind;
    std::span<const Range> nodes;
    std::span<const Real> max_speed;     // m/s, of this step
    std::span<const Real> mass;          // kg, by node
    std::span<const Real> inverse_mass;  // 1/kg, by node
};

/// What rest took from the bodies that were put to it in this step.
struct TakenByRest {
    Real energy = 0;               // J, kinetic
    Vec3 momentum = Vec3::Zero();  // kg m/s
    Index bodies = 0;
};

struct SleepMemory {
    Column<Index> root;             // by body, of those that touch each other
    Column<std::uint8_t> restless;  // by body
};

/// Counts for how long each body has been calm, and puts those to rest that are calm with all that they touch, directly or through others:
/// their velocities become zero. What touches a collider that moves stays awake. Sequential, over bodies and, when a body is ready, contacts.
TakenByRest rest_bodies(const TouchInputs& touches, const RestInputs& bodies, const SleepSettings& settings, Real h, SleepMemory& memory,
                        std::span<std::uint8_t> asleep, std::span<Real> calm, std::span<Vec3> velocity, std::span<Vec3> velocity_next);

}  // namespace skerry
