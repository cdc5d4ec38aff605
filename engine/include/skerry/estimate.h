// Estimated errors of a running simulation, by body (docs/methods/error_estimates.md).
#pragma once

#include <limits>
#include <memory>
#include <string>
#include <vector>

#include "skerry/world.h"

#pragma GCC visibility push(default)
namespace skerry {

/// Value of an error that was not estimated.
inline constexpr Real not_estimated = std::numeric_limits<Real>::quiet_NaN();

/// Estimated errors of one body, relative where no unit is given. A value is `not_estimated` if the body cannot have
/// this error; a rigid body, for example, has no error of the mesh. The mesh errors `mesh`, `deflection`,
/// `interpolation` and `stress` belong to the sample (see ErrorEstimator) at which the body has the largest elastic
/// energy.
struct ErrorEstimate {
    BodyHandle body{};  // the body
    std::string name;   // name of the body
    // Error of the stress of the tetrahedra, due to the mesh: e / sqrt(e^2 + s^2), with the energy norms e of the error
    // and s of the stress.
    Real mesh = not_estimated;
    // Relative error of the displacement that given loads cause, due to the mesh. Positive if the mesh is too stiff,
    // negative if it is too soft. It applies to displacements by deformation only: multiplied by `deformation` it is
    // the relative error of the whole motion.
    Real deflection = not_estimated;
    // Error of the displacement of a single node, due to the mesh [m]. It adds to `deflection`, the error of the body
    // as a whole. It is the estimated error of linear interpolation along an edge, as root mean square over the edges.
    Real interpolation = not_estimated;
    Real stress = not_estimated;  // error of the largest von Mises stress at the nodes, due to the mesh
    // Relative error of the motion, due to the length of the steps: distance of the nodes from the positions with
    // infinitely short steps, divided by their displacement from the start. Both are root mean squares over the nodes,
    // and the largest of all samples. Not estimated for a body at rest.
    Real step = not_estimated;
    // Displacement by deformation divided by displacement from the start, at most 1. Both displacements are root mean
    // squares over the nodes, as for `step`. Not estimated for a body at rest.
    Real deformation = not_estimated;
    // Error of the contact impulses, due to the tolerance of the solver: mean of the solver errors of the contact
    // regions of the body, weighted by impulse. Regions in which the solver did not converge are included.
    Real contact = not_estimated;
    Real overlap = not_estimated;  // largest overlap with another object at any sample, 0 if there is none [m]
    // Largest distance to another object, over all samples, at which a contact carried a force [m]. Contacts act as
    // soon as surfaces are closer than the contact distance, so positions have an error of this size.
    Real gap = not_estimated;
    // Radius of the most loaded contact area by the theory of Hertz, and mean edge length of the mesh there [m]. Not
    // estimated where flat faces, edges or corners touch.
    Real contact_radius = not_estimated, contact_edge = not_estimated;
    Index worst_tetrahedron = -1;  // tetrahedron with the largest stress error at `time`, -1 if there is none
    Real time = not_estimated;     // time of the sample that `mesh` to `stress` use [s]
};

/// Estimates errors while a world advances, from samples of its state. It never changes the world. The times of the
/// samples depend on step numbers and not on a clock, so two runs of a scene give equal estimates.
class ErrorEstimator {
public:
    /// The estimator must only be used with this world.
    explicit ErrorEstimator(const World& world);
    ~ErrorEstimator();
    ErrorEstimator(ErrorEstimator&&) noexcept;
    ErrorEstimator& operator=(ErrorEstimator&&) noexcept;

    /// Call this after every call of advance(). Takes a sample when motion starts, and then whenever a fixed number of
    /// steps with motion has passed since the last sample; otherwise does nothing. Samples take less than 2 % of the
    /// computing time of the steps.
    void sample(const World& world);
    /// Takes the last sample. Call this once, at the end of a run. To limit the computing time in runs of less than
    /// 8000 steps (250 if no body is explicit), it then estimates mesh errors only for the bodies with the most elastic
    /// energy, at least for one.
    void finish(const World& world);
    /// Estimates for all bodies of the world at finish(), in the order of World::bodies().
    std::vector<ErrorEstimate> bodies() const;

private:
    struct Impl;
    std::unique_ptr<Impl> impl_;
};

/// Estimated relative error of the present stress of each tetrahedron, due to the mesh; empty for a rigid body. To
/// reduce the error, refine the mesh where the values are largest (Zienkiewicz, Zhu 1987). The values are sqrt(e / E),
/// with the energies per volume
/// - e: of the stress error of the tetrahedron,
/// - E: of the stress and of the stress error of the whole body, added.
std::vector<Real> mesh_error(const World& world, BodyHandle body);

}  // namespace skerry
#pragma GCC visibility pop
