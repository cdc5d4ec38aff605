// Error of the motion of bodies that is due to the length of the steps.
#pragma once

#include <cstdint>
#include <map>
#include <optional>
#include <set>
#include <vector>

#include "skerry/estimate.h"
#include "systems/dynamics/motion/move_colliders.h"

namespace skerry {

/// Estimates how far the nodes of each body are from the positions to which infinitely short steps would move them
/// (docs/methods/error_estimates.md 2).
class StepError {
public:
    /// Takes a sample. The first sample that contains a body stores the start of its motion.
    void sample(const World& world);
    /// Sets ErrorEstimate::step of the bodies that moved, and ErrorEstimate::deformation of those that are not rigid.
    void add_to(std::vector<ErrorEstimate>& bodies) const;

private:
    /// Motion of the nodes of a body relative to the frame in which it deforms, in the axes of this frame.
    struct Deformation {
        std::vector<Vec3> displacement, velocity;  // by node [m, m/s]
    };
    struct Motion {
        Real start_time = 0;                       // [s]
        std::vector<Vec3> start;                   // node positions at the start [m]
        Twist start_velocity;                      // rigid motion at the start
        Vec3 start_spin = Vec3::Zero();            // angular momentum of a rigid body at the start [kg m^2/s]
        Vec3 velocity = Vec3::Zero();              // velocity of the centre of mass at the last sample [m/s]
        std::optional<AttachmentHandle> holder{};  // an attachment that holds nodes of the body
        RigidPose rest_mesh_pose{};                // pose of the rest mesh in the frame of the deformation
        Deformation deformation{};                 // deformation at the last sample; empty for a rigid body
        Real first_step = 0;                       // mean length of the steps before the second sample [s]
        Real acceleration = -1;                    // mean acceleration until the second sample; -1: unknown [m/s^2]
        // Position error because bodies rebound in wrong directions or too late [m]. rebound_error_rate: growth rate of
        // `rebound_error` by the wrong directions [m/s].
        Real rebound_error = 0, rebound_error_rate = 0;
        Real tumbled = 0;  // position error due to free rotation [m]
        // Sums over the samples for the Rayleigh quotient of the deformation: twice the elastic energy [J], and the
        // squared displacements times the masses [kg m^2].
        Real stiffness = 0, inertia = 0;
        Real phase_time_error = 0;  // phase error of vibrations, summed over the samples, as a time [s]
        Real dissipated = 0;        // energy that the world had dissipated at the start [J]
        Real lost = 0;     // amplitude of the vibrations that numerical damping of the theta method has removed [m]
        Real largest = 0;  // largest root mean square displacement by deformation so far [m]
        Real error = 0;    // largest error so far [m]
        Real moved = 0;    // largest root mean square displacement from the start so far [m]
        Real rest_displacement = 0;  // largest displacement that counts as rest [m]
    };
    struct Interval;
    struct Frame;

    static Frame frame_of(const World& world, BodyHandle body, const std::optional<AttachmentHandle>& holder);
    /// `mesh`: pose of the rest mesh in the frame.
    static Deformation deformation_of(const World& world, BodyHandle body, const Frame& frame, const RigidPose& mesh);
    static Motion begin(const World& world, BodyHandle body, std::optional<AttachmentHandle> holder);
    static void go_on(const World& world, BodyHandle body, const Interval& interval, Motion& motion);
    static Real rigid_error(const World& world, BodyHandle body, const Frame& frame, const Interval& interval,
                            Motion& motion);
    static Real deformation_error(const World& world, BodyHandle body, const Frame& frame, const Interval& interval,
                                  Motion& motion);

    std::map<BodyHandle, Motion> motions_;
    std::set<BodyHandle> touching_;  // bodies that touched another body at the last sample
    Real time_ = 0;                  // time of the last sample [s]
    std::uint64_t steps_ = 0;        // number of steps of the world at the last sample
};

}  // namespace skerry
