// A spring with which a user drags a body (docs/view.md).
#pragma once

#include <optional>

#include "skerry/load.h"
#include "skerry/spring.h"
#include "skerry/world.h"

namespace skerry {

/// Present force and length of the spring of a pull.
struct PullState {
    Real force = 0;   // [N]
    Real length = 0;  // [m]
};

/// Drags a body by a spring without rest length from a point of its surface to a target. The stiffness is m (2 pi f)^2
/// with the mass m of the body and f = 2 Hz. The force is at most 50 times m 9.81 m/s^2. A drag field damps the body
/// critically: a free body of stiffness well above that of the spring approaches the target as (1 + w t) exp(-w t) with
/// w = 2 pi f. The drag depends on the mass only, so it does not shorten the step of finely meshed bodies, which a
/// damper at a single point would do.
///
/// The spring and the field are objects of the world until end(). They are removed with the body. A pull acts on the
/// world that it began in, or on a clone. After World::reset to a clone without them, a pull is over.
class Pull {
public:
    /// Starts to drag the nearest surface point of a body to `point`; a previous pull ends. Wakes the body. Throws
    /// SceneError, and changes nothing, for a removed body, for points that are not finite, and for an implicit body in
    /// a world with theta < 1.
    void begin(World& world, BodyHandle body, const Vec3& point, const Vec3& target);
    /// Moves the target. Does nothing if no body is pulled. Throws SceneError for a target that is not finite.
    void move(World& world, const Vec3& target);
    /// Removes the spring and the field. Does nothing if no body is pulled.
    void end(World& world);
    /// Returns nothing if no body is pulled.
    std::optional<PullState> state(const World& world) const;

private:
    SpringHandle spring_{};
    LoadHandle drag_{};
};

}  // namespace skerry
