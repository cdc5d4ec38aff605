#include "systems/solver/local/joint_law.h"

#include <Eigen/LU>

namespace skerry {

void JointLaw::prepare(const Mat3& delassus_block, bool with_axis) {
    axis_free = with_axis;
    block = delassus_block;
    if (!axis_free) {
        inverse = block.inverse();
        axis_mobility = 0;
        return;
    }
    inverse.setZero();
    inverse.topLeftCorner<2, 2>() = block.topLeftCorner<2, 2>().inverse();
    axis_mobility = block(2, 2) - block.block<1, 2>(2, 0) * inverse.topLeftCorner<2, 2>() * block.block<2, 1>(0, 2);
}

}  // namespace skerry
