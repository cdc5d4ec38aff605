// Encodes the visual surfaces of bodies, and the data with which their nodes follow the nodes of the bodies.
#pragma once

#include <string>
#include <vector>

#include "engine/mesh/visual/bound_visual.h"

namespace skerry {

/// The page computes the positions of a visual surface from the node positions of its body. A surface is therefore
/// encoded only once, whatever the number of frames. Bodies with equal visual surfaces and equal bindings share one
/// encoded surface.
class VisualStream {
public:
    /// Returns the number of a surface. Appends the surface unless an equal one is already stored.
    Index number_of(const BoundVisual& visual);
    /// The surfaces from number `first` on, compressed. Counts and changes are encoded as in pack.h. A surface consists
    /// of
    ///   numbers of nodes, triangles, texture points and materials, as counts; f64 resolution of the offsets [m]
    ///   the four body nodes that each surface node follows: the first body node of all surface nodes, then the second,
    ///     and so on, each as change from the previous number
    ///   weights of the first three of these body nodes in units of 2^-16, in the same order; the sum of all four is 1
    ///   offsets d (see BoundVisual), axis by axis, in units of their resolution, each as change from the previous one
    ///   number of body nodes with a deformation gradient as a count, and for each: the node as change from the last
    ///     one, number of terms of the gradient; for each term: its body node as change from the last term (the first
    ///     term: from the node with the gradient), and f32 gradient[3] [1/m]
    ///   corners of the triangles as changes
    ///   if there are texture points: u, then v of all points in units of 2^-16, and corners, as changes
    ///   if there are materials: material of each triangle as change
    std::string packed(std::size_t first = 0) const;
    /// Materials of each surface, by number of the surface.
    const std::vector<std::vector<VisualMaterial>>& materials() const { return materials_; }

private:
    std::vector<std::string> encoded_;
    std::vector<std::vector<VisualMaterial>> materials_;
};

/// Sets used[n] for each node n of the body that influences the positions or values of the visual surface.
void mark_nodes(const BoundVisual& visual, std::vector<bool>& used);

}  // namespace skerry
