#include "systems/dynamics/rigid/rigid_motion.h"

namespace skerry {

Mat3 without_strain(const Mat3& rotation) {
    // one step of Newton's: what is wrong by rounding is wrong by its square then
    return 0.5 * rotation * (3 * Mat3::Identity() - rotation.transpose() * rotation);
}

}  // namespace skerry
