// Encodes the visual surfaces of bodies and their bindings.
#pragma once

#include <string>
#include <vector>

#include "engine/mesh/visual/bound_visual.h"

namespace skerry {

/// The page computes the positions of a visual surface from those of the nodes of its body. A surface is therefore
/// encoded only once, whatever the number of frames. Bodies with equal surfaces share one.
class VisualStream {
public:
    /// Returns the number of a surface, which is appended if no earlier surface equals it.
    Index number_of(const BoundVisual& visual);
    /// The surfaces from number `first` on, compressed. Counts and changes are encoded as in pack.h. A surface consists
    /// of
    ///   numbers of nodes, triangles, texture points and materials, as counts; f64 step of the offsets [m]
    ///   nodes of the body that each node follows: four times all nodes, each as change from the previous one
    ///   weights of the first three of these nodes in units of 2^-16, in the same way
    ///   offsets axis by axis in steps, in the same way
    ///   number of gradients as a count, and for each: change of its node, number of terms; for each term: change of
    ///   its node, f32 gradient[3] [1/m]
    ///   corners of the triangles as changes
    ///   if there are texture points: u, then v of all points in units of 2^-16, and corners, as changes
    ///   if there are materials: material of each triangle as change
    std::string packed(std::size_t first = 0) const;
    /// Materials of each surface.
    const std::vector<std::vector<VisualMaterial>>& materials() const { return materials_; }

private:
    std::vector<std::string> encoded_;
    std::vector<std::vector<VisualMaterial>> materials_;
};

/// Marks the nodes of the body on which the positions and values of a visual surface depend.
void mark_nodes(const BoundVisual& visual, std::vector<bool>& used);

}  // namespace skerry
