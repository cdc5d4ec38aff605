#include "systems/dynamics/motion/move_colliders.h"

#include <catch2/catch.hpp>
#include <vector>

#include "systems/geometry/rotation.h"

namespace skerry::test::move_colliders_test {

namespace {

const RigidMotion start{Vec3(1, 2, 3), rotation_matrix(Vec3(0.3, 0, 0)), Vec3::Zero(), Vec3::Zero()};

MotionScript keys_of(const std::vector<Keyframe>& keys) {
    return {Vec3::Zero(), Vec3::Zero(), 0, static_cast<Index>(keys.size())};
}

}  // namespace

TEST_CASE("a collider without script stays where it was put", "[unit]") {
    const MotionScript still{Vec3::Zero(), Vec3::Zero(), 0, 0};
    const RigidMotion motion = motion_of_step(still, {}, start, 5, 0.1);
    CHECK(motion.position == start.position);
    CHECK(motion.rotation == start.rotation);
    CHECK(motion.velocity == Vec3::Zero());
    CHECK(motion.angular_velocity == Vec3::Zero());
}

TEST_CASE("constant velocities move and turn it from its initial pose", "[unit]") {
    const MotionScript script{Vec3(1, 0, 0), Vec3(0, 0, 2), 0, 0};
    const RigidPose pose = pose_at(script, {}, start, 0.5);
    CHECK((pose.position - Vec3(1.5, 2, 3)).norm() <= 1e-15);
    CHECK((pose.rotation - rotation_matrix(Vec3(0, 0, 1)) * start.rotation).norm() <= 1e-15);
    // also if a step contains many turns
    CHECK(motion_of_step(script, {}, start, 0.5, 10).angular_velocity == Vec3(0, 0, 2));
}

TEST_CASE("keys are held before the first and after the last", "[unit]") {
    const std::vector<Keyframe> keys{{1, Vec3(1, 0, 0), Vec3(0, 0, 0.5)}, {2, Vec3(3, 0, 0), Vec3(0, 0, 1.5)}};
    CHECK(pose_at(keys_of(keys), keys, start, 0).position == Vec3(1, 0, 0));
    CHECK(pose_at(keys_of(keys), keys, start, 1).position == Vec3(1, 0, 0));
    CHECK(pose_at(keys_of(keys), keys, start, 2).position == Vec3(3, 0, 0));
    CHECK((pose_at(keys_of(keys), keys, start, 9).rotation - rotation_matrix(Vec3(0, 0, 1.5))).norm() <= 1e-15);
    CHECK(motion_of_step(keys_of(keys), keys, start, 3, 0.1).velocity == Vec3::Zero());
}

TEST_CASE("between keys position is linear and the turn steady about a fixed axis", "[unit]") {
    const std::vector<Keyframe> keys{{0, Vec3(0, 0, 0), Vec3(0.4, 0, 0)}, {2, Vec3(2, 4, 0), Vec3(0, 0.9, 0.2)}};
    const RigidPose first = pose_at(keys_of(keys), keys, start, 0.5), second = pose_at(keys_of(keys), keys, start, 1.0),
                    third = pose_at(keys_of(keys), keys, start, 1.5);
    CHECK((second.position - Vec3(1, 2, 0)).norm() <= 1e-15);
    CHECK((second.rotation * first.rotation.transpose() - third.rotation * second.rotation.transpose()).norm() <=
          1e-14);
    CHECK((pose_at(keys_of(keys), keys, start, 2 - 1e-12).rotation - rotation_matrix(keys[1].rotation)).norm() <=
          1e-11);
}

TEST_CASE("two keys about one axis may be several turns apart", "[unit]") {
    const std::vector<Keyframe> keys{{0, Vec3::Zero(), Vec3::Zero()}, {1, Vec3::Zero(), Vec3(0, 0, 8 * M_PI)}};
    CHECK((pose_at(keys_of(keys), keys, start, 1.0 / 16).rotation - rotation_matrix(Vec3(0, 0, M_PI / 2))).norm() <=
          1e-14);
    CHECK((motion_of_step(keys_of(keys), keys, start, 0.3, 0.01).angular_velocity - Vec3(0, 0, 8 * M_PI)).norm() <=
          1e-10);
}

TEST_CASE("the velocities of a step lead to the pose at its end", "[unit]") {
    const std::vector<Keyframe> keys{
        {0, Vec3(0, 0, 0), Vec3(0.4, 0, 0)}, {1, Vec3(2, 4, 0), Vec3(0, 0.9, 0.2)}, {2, Vec3(0, 0, 1), Vec3(1, 1, 0)}};
    const Real t = 0.95, h = 0.1;  // the step crosses a key
    const RigidMotion motion = motion_of_step(keys_of(keys), keys, start, t, h);
    const RigidPose end = pose_at(keys_of(keys), keys, start, t + h);
    CHECK((motion.position + h * motion.velocity - end.position).norm() <= 1e-15);
    CHECK((rotation_matrix(h * motion.angular_velocity) * motion.rotation - end.rotation).norm() <= 1e-14);
}

TEST_CASE("every collider reads its own keys", "[unit]") {
    const std::vector<Keyframe> keys{
        {0, Vec3(9, 9, 9), Vec3::Zero()}, {0, Vec3(0, 0, 0), Vec3::Zero()}, {1, Vec3(1, 0, 0), Vec3::Zero()}};
    const std::vector<MotionScript> script{{Vec3::Zero(), Vec3::Zero(), 1, 3}, {Vec3(0, 0, 1), Vec3::Zero(), 0, 0}};
    const std::vector<RigidMotion> initial{start, start};
    std::vector<RigidMotion> motion(2);
    move_colliders({script, keys, initial}, 0.5, 0.1, motion);
    CHECK((motion[0].position - Vec3(0.5, 0, 0)).norm() <= 1e-15);
    CHECK((motion[0].velocity - Vec3(1, 0, 0)).norm() <= 1e-14);
    CHECK(motion[1].velocity == Vec3(0, 0, 1));
    move_colliders({}, 0, 0.1, {});
}

TEST_CASE("driven nodes arrive where the motion ends", "[unit]") {
    const RigidMotion motion{Vec3(1, 0, 0), rotation_matrix(Vec3(0, 0, 0.2)), Vec3(0, 1, 0), Vec3(0, 0, 3)};
    const std::vector<RigidMotion> motions{motion};
    const std::vector<Range> ranges{{0, 2}};
    const std::vector<Index> node{2, 0};
    const std::vector<Vec3> anchor{Vec3(0.5, 0, 0), Vec3(0, 0.5, 1)},
        position{Vec3(7, 7, 7), Vec3(8, 8, 8), Vec3(9, 9, 9)};
    std::vector<Vec3> velocity(3, Vec3(-1, -1, -1));
    const Real h = 0.1;
    const std::vector<Mat3> held{Mat3::Identity()};
    drive_nodes({motions, ranges, node, anchor, held}, h, position, velocity);
    const Mat3 end = rotation_matrix(Vec3(0, 0, 0.5));
    CHECK((position[2] + h * velocity[2] - (Vec3(1, 0.1, 0) + end * anchor[0])).norm() <= 1e-14);
    CHECK((position[0] + h * velocity[0] - (Vec3(1, 0.1, 0) + end * anchor[1])).norm() <= 1e-14);
    CHECK(velocity[1] == Vec3(-1, -1, -1));
}

}  // namespace skerry::test::move_colliders_test
