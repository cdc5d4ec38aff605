// Size of the contact areas of bodies, compared with their meshes.
#pragma once

#include <map>
#include <vector>

#include "skerry/estimate.h"

namespace skerry {

/// Estimates the radius of the most loaded contact area of each deformable body. By the theory of Hertz (1881), the
/// radius follows from the contact force, the curvatures of both surfaces at rest, and the elastic constants.
class ContactArea {
public:
    /// Takes a sample from the contacts of the last step.
    void sample(const World& world);
    /// Sets ErrorEstimate::contact_radius and contact_edge of the bodies with a suitable contact area: one of the two
    /// surfaces there is curved, and neither has a sharp edge.
    void add_to(std::vector<ErrorEstimate>& bodies) const;

private:
    /// Surface of a body at rest. All values of inner nodes are 0.
    struct Surface {
        std::vector<Real> curvature;         // mean curvature by node, positive if convex [1/m]
        std::vector<Real> edge;              // mean length of the edges at a node [m]
        std::vector<Real> normal_deviation;  // largest angle between the normal of a node and those of its faces [rad]
    };
    struct Area {
        Real force = 0;   // largest force in the samples between the body and one other object [N]
        Real radius = 0;  // [m]
        Real edge = 0;    // mean edge length of the surface of the body at the contacts with this object [m]
    };

    const Surface& surface_of(const World& world, BodyHandle body);
    Real curvature_at(const World& world, const Contact& contact, bool first);
    Real normal_deviation_at(const World& world, const Contact& contact, bool first);

    std::map<BodyHandle, Surface> surfaces_;
    std::map<BodyHandle, Area> areas_;
};

}  // namespace skerry
