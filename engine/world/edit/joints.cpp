#include "engine/world/edit/joints.h"

#include <Eigen/Geometry>
#include <vector>

#include "components/any_table.h"
#include "systems/dynamics/rigid/rigid_motion.h"

namespace skerry {

void erase_joints(std::span<const std::uint8_t> gone, Model& model) {
    std::vector<Index> row_now;
    std::vector<Range> ranges;
    Index next = 0;
    for (std::size_t j = 0; j < gone.size(); ++j) {
        const auto row = static_cast<Index>(j);
        if (gone[j] != 0) append_gone(Range{row, row + 1}, ranges);
        row_now.push_back(gone[j] != 0 ? no_index : next++);
    }
    if (ranges.empty()) return;
    AnyTable(model.joints).erase(ranges);
    model.joint_map.rows_moved(row_now);
}

void erase_joints_of(std::size_t body, Model& model) {
    const JointTable& table = model.joints;
    const auto row = static_cast<Index>(body);
    std::vector<std::uint8_t> gone(table.size(), 0);
    for (std::size_t j = 0; j < table.size(); ++j) {
        if (table.first[j] != row && table.second[j] != row) continue;
        gone[j] = 1;
        for (const Index of_joint : {table.first[j], table.second[j]})
            if (of_joint != no_index) model.wake(static_cast<std::size_t>(of_joint));
        model.joint_map.forget(model.joint_map.handle_of_slot(table.slot[j]));
    }
    erase_joints(gone, model);
}

PointVelocity velocity_at(const Model& model, Index body, const Vec3& point) {
    if (body == no_index) return {};
    const RigidBodyTable& table = model.rigid_bodies;
    const auto r = static_cast<std::size_t>(model.bodies.rigid[static_cast<std::size_t>(body)].begin);
    const Vec3 turn = spin_of(table.rotation[r], table.moments[r], table.angular_momentum[r]);
    return {table.momentum[r] / table.mass[r] + turn.cross(point - table.center[r]), turn};
}

}  // namespace skerry
