// Deformation gradient at a node of a smooth surface, from the surface around the node and its traction.
#pragma once

#include <array>
#include <optional>
#include <span>

#include "components/material_table.h"
#include "components/types.h"

namespace skerry {

/// Surface triangle. The area times the deformation gradient in the plane of the triangle is weight ((x1 - x0)
/// along_first^T + (x2 - x0) along_second^T), with the corner positions x0, x1 and x2.
struct SurfaceTriangle {
    std::array<Index, 3> node;
    Vec3 along_first, along_second;  // [m^3]
    Real weight;                     // [1/m^2]
};

/// Returns nullopt for a triangle without area. `rest`: rest positions of all nodes [m].
std::optional<SurfaceTriangle> surface_triangle(const std::array<Index, 3>& node, std::span<const Vec3> rest);

/// Surface around a node at rest, from sums over its triangles.
struct SurfaceAround {
    // outward area vector of the node: a third of the sum of the area vectors of its triangles [m^2]
    Vec3 area = Vec3::Zero();
    Vec3 normal = Vec3::Zero();  // unit vector along `area`
    bool smooth = false;         // false if the surface has an edge or corner at the node
    // Matrices of a least-squares fit for a smooth surface with the normal N. For a given b = F N and area_gradient,
    // the result of surface_stretch(), they give the deformation gradient
    //     F = area_gradient plane_inverse + b normal_row^T
    // This F differs least, among all F with this b, from the deformation gradients within the triangles.
    // `plane_inverse` is the inverse, within the tangent plane, of the sum over the triangles of area times projector
    // onto the triangle [1/m^2].
    Mat3 plane_inverse = Mat3::Zero();
    Vec3 normal_row = Vec3::Zero();
};

/// `triangles`: the triangles around the node. `rest`: rest positions of all nodes [m].
SurfaceAround surface_around(std::span<const std::array<Index, 3>> surface, std::span<const Index> triangles,
                             std::span<const Vec3> rest);

/// Sum over the triangles of area times deformation gradient within the plane of the triangle [m^2]. `position`: of all
/// nodes [m].
Mat3 surface_stretch(std::span<const SurfaceTriangle> triangles, std::span<const Vec3> position);

/// Deformation gradient F for which P(F) N is the traction, with the first Piola-Kirchhoff stress P and the outward
/// normal N. Among all such F it is the one that differs least from the deformation gradients within the triangles
/// (docs/methods/elasticity.md 7.9). `area_gradient`: result of surface_stretch. `start`: first guess of F N. The
/// surface must be smooth. Empty if Newton's method finds no F.
std::optional<Mat3> surface_gradient(const MaterialConstants& material, const SurfaceAround& around,
                                     const Mat3& area_gradient, const Vec3& traction, const Vec3& start);

}  // namespace skerry
