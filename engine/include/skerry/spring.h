// Springs and dampers between points of bodies, colliders and the world (docs/methods/springs.md).
#pragma once

#include <optional>
#include <vector>

#include "components/spring_side.h"
#include "components/types.h"
#include "skerry/anchor.h"
#include "skerry/object_view.h"
#include "skerry/time_table.h"

#pragma GCC visibility push(default)
namespace skerry {

/// A spring, a damper, or both in parallel, between two anchors. At least one anchor must be on a body. Stiffness and
/// damping must not both be 0.
struct SpringSettings {
    Anchor first{};                          // one end
    Anchor second{};                         // the other end
    Real stiffness = 0;                      // force per elongation, >= 0 [N/m]
    Real damping = 0;                        // force per rate of the length, >= 0 [N s/m]
    std::optional<TimeTable> rest_length{};  // each value >= 0; default: the length when the spring is added [m]
    SpringSide only = SpringSide::both;      // spring and damper act in tension, in compression or in both
    // Upper limit of the magnitude of the force of spring and damper together, > 0 [N]. Where stiffness and damping
    // would give a larger force, the force has this magnitude.
    Real strength = infinity;
};

/// Present state of a spring. Before the first step `force` is zero.
struct SpringState {
    Anchor first{}, second{};  // anchors at their present positions
    Real length = 0;           // distance of the anchors [m]
    Real rate = 0;             // rate of the length [m/s]
    Real rest_length = 0;      // present rest length [m]
    Real force = 0;            // force in the last step; positive if it pulls the anchors together [N]
    Real energy = 0;           // elastic energy [J]
};

extern template class __attribute__((visibility("default"))) ObjectView<SpringHandle>;

/// A view of the springs of a world. Each change wakes the bodies of the spring, unless the new value equals the old
/// one.
class Springs : public ObjectView<SpringHandle> {
public:
    using ObjectView::ObjectView;

    /// Adds a spring. Stiff springs on light bodies shorten the step of the world.
    SpringHandle add(const SpringSettings& spring);
    /// Ends, length and force of a spring after the last step.
    SpringState state(SpringHandle spring) const;
    /// Settings with which add() would make a spring like this one in its present state: the anchors have their present
    /// positions.
    SpringSettings settings(SpringHandle spring) const;

    /// Moves the second anchor of a spring. The rest length does not change. Call this repeatedly to drag a body, for
    /// example with a mouse; `strength` then limits the force.
    void set_second(SpringHandle spring, const Anchor& anchor);
    /// Sets the rest length [m].
    void set_rest_length(SpringHandle spring, const TimeTable& rest_length);
    /// Sets the stiffness [N/m].
    void set_stiffness(SpringHandle spring, Real stiffness);
    /// Sets the damping [N s/m].
    void set_damping(SpringHandle spring, Real damping);
};

}  // namespace skerry
#pragma GCC visibility pop
