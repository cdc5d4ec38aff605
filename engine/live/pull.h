// A spring with which a user drags a body (docs/view.md).
#pragma once

#include <optional>
#include <vector>

#include "skerry/load.h"
#include "skerry/spring.h"
#include "skerry/world.h"

namespace skerry {

struct LineFrame;

/// Present state of a pull.
struct PullState {
    Real force = 0;   // sum of the forces of all springs in the last step [N]
    Real length = 0;  // distance of the pulled point from the target [m]
};

/// Drags a body by a spring without rest length from a point of its surface to a target. With the mass m of the body,
/// the natural frequency f = 2 Hz and w = 2 pi f, the stiffness is m w^2. The force is at most 50 times m 9.81 m/s^2.
///
/// - A deformable body has up to 12 parallel springs around the point, each with the same share of stiffness and
///   largest force.
/// - A drag field on the whole body damps it critically: after the time t, the distance of a stiff free body from the
///   target has decreased by the factor (1 + w t) exp(-w t).
/// - The springs and the field are objects of the world until end(). They are removed with the body. World::reset to a
///   clone without them ends the pull.
class Pull {
public:
    /// Starts to drag a body towards `target`, at its surface point nearest to `point`. Ends the previous pull, and
    /// wakes the body. Throws SceneError, and changes nothing, for a removed body, for coordinates beyond 1e9 m, and
    /// for an implicit body in a world with theta < 1.
    void begin(World& world, BodyHandle body, const Vec3& point, const Vec3& target);
    /// Moves the target. Does nothing if no body is pulled. Throws SceneError for coordinates beyond 1e9 m.
    void move(World& world, const Vec3& target);
    /// Removes the springs and the field. Does nothing if no body is pulled.
    void end(World& world);
    /// Returns nothing if no body is pulled.
    std::optional<PullState> state(const World& world) const;
    /// Returns true if the line shows one of the springs.
    bool has(const LineFrame& line) const;

private:
    std::vector<SpringHandle> springs_{};
    // vectors from the pulled point to the first anchor of each spring when the pull began [m]
    std::vector<Vec3> offset_{};
    LoadHandle drag_{};
};

}  // namespace skerry
