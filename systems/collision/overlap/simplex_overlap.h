// Overlap of two simplices (docs/methods/collision.md 9.1).
#pragma once

#include <array>

#include "components/types.h"

namespace skerry {

/// A simplex: the convex hull of four points (tetrahedron), or of the first three points (triangle).
struct Simplex {
    std::array<Vec3, 4> point;  // [m]
    std::size_t count;

    Simplex moved(const Vec3& shift) const;
};

/// Separating axis test of two simplices. Their interiors overlap if and only if none of the axes separates them. The
/// axes are the normals of all faces, and the cross products of an edge of the first and an edge of the second simplex.
/// Triangles in one plane never overlap, because their common normal separates them.
class SimplexOverlap {
public:
    /// Tests the axes one after another. The test ends at the first axis along which the simplices overlap by at most
    /// `tolerance` [m].
    SimplexOverlap(const Simplex& first, const Simplex& second, Real tolerance);

    bool overlapping() const { return overlapping_; }
    /// Distance by which the first simplex has to move along a unit direction to be separated from the second simplex
    /// [m]. Valid only if the simplices overlap.
    Real exit_distance(const Vec3& direction) const;

private:
    bool separates(const Simplex& first, const Simplex& second, const Vec3& along, Real tolerance);

    // Greatest number of axes: 4 + 4 face normals, and 6 x 6 cross products of an edge of each simplex.
    static constexpr std::size_t most_axes = 44;
    std::array<Vec3, most_axes> axis_;
    // Distances by which the first simplex has to move along the axis, or against the axis, to be separated [m].
    std::array<Real, most_axes> forward_, backward_;
    std::size_t count_ = 0;
    bool overlapping_ = true;
};

}  // namespace skerry
