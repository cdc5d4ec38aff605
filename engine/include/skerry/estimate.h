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

/// Estimated relative errors of one body. A value is `not_estimated` if the error does not exist for the body, for
/// example the error of the mesh for a rigid body.
struct ErrorEstimate {
    BodyHandle body{};  // the body
    std::string name;   // name of the body
    // Error of the stress of the tetrahedra, due to the mesh: energy norm of the error over that of the stress. This
    // and the next three values are those at the sample with the largest elastic energy of the body.
    Real mesh = not_estimated;
    // Error of a displacement under given loads, due to the mesh. Positive if the mesh is too stiff, negative if it is
    // too soft. Multiplied by `deformation` it is the error of the motion.
    Real deflection = not_estimated;
    // Error of the displacement of a single node in addition to `deflection`, due to the mesh: root mean square of the
    // error of linear interpolation along the edges [m].
    Real interpolation = not_estimated;
    Real stress = not_estimated;  // error of the largest von Mises stress at the nodes, due to the mesh
    // Error of the motion, due to the length of the steps: largest distance of the nodes from their positions with
    // infinitely short steps, divided by their largest displacement from the start, both as root mean squares. Not
    // estimated for a body at rest.
    Real step = not_estimated;
    // Largest displacement by deformation over the largest displacement from the start, both as root mean squares. Not
    // estimated for a body at rest.
    Real deformation = not_estimated;
    // Error of the contact impulses, due to the tolerance of the solver: mean of the errors of the solver, weighted by
    // impulse. Regions that were left unsolved count with their errors.
    Real contact = not_estimated;
    Real overlap = not_estimated;  // largest overlap with another object at a sample, 0 if there is none [m]
    // Largest distance to another object, at a sample, at which a contact carried a force, because contacts act within
    // the contact distance. Positions have an error of this size [m].
    Real gap = not_estimated;
    // Radius of the most loaded contact area by the theory of Hertz, and mean edge length of the mesh there [m]. Not
    // estimated where flat faces, edges or corners touch.
    Real contact_radius = not_estimated, contact_edge = not_estimated;
    Index worst_tetrahedron = -1;  // tetrahedron with the largest error of the stress, -1 if there is none
    Real time = not_estimated;     // time of the sample with the largest elastic energy [s]
};

/// Estimates errors while a world advances. It never changes the world. Two runs of a scene take the same samples,
/// because their number follows from the number of steps and not from a clock.
class ErrorEstimator {
public:
    /// The estimator must only be used with this world.
    explicit ErrorEstimator(const World& world);
    ~ErrorEstimator();
    ErrorEstimator(ErrorEstimator&&) noexcept;
    ErrorEstimator& operator=(ErrorEstimator&&) noexcept;

    /// Call this after every call of advance(). Takes a sample when motion starts, and then after every fixed number of
    /// steps with motion. Samples take less than 2 % of the computing time of the steps.
    void sample(const World& world);
    /// Takes the last sample. Call this once, at the end of a run. After less than 8000 explicit steps it samples the
    /// mesh errors of only a few bodies, at least one: those with the most elastic energy. This limits the computing
    /// time of estimates in short runs.
    void finish(const World& world);
    /// Estimates for all bodies of the world at finish(), in the order of World::bodies().
    std::vector<ErrorEstimate> bodies() const;

private:
    struct Impl;
    std::unique_ptr<Impl> impl_;
};

/// Estimated error of the present stress of each tetrahedron, due to the mesh: root of its error energy per volume over
/// the root of the mean elastic energy per volume of the body. Empty for a rigid body. To reduce the error, refine the
/// mesh where the values are largest (Zienkiewicz, Zhu 1987).
std::vector<Real> mesh_error(const World& world, BodyHandle body);

}  // namespace skerry
#pragma GCC visibility pop
