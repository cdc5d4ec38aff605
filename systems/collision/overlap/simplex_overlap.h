// Overlap of two simplices (docs/methods/collision.md 9.1).
#pragma once

#include <array>

#include "components/types.h"

namespace skerry {

/// The convex hull of four points, or of the first three points. In each pair of simplices, at least one has four
/// points.
struct Simplex {
    std::array<Vec3, 4> point;  // [m]
    std::size_t count;

    Simplex moved(const Vec3& shift) const;
};

/// Separating axis test of two simplices. For each axis normal to a face or to an edge of each simplex, it stores the
/// distance that the first simplex would have to move to be apart. The interiors of the simplices overlap if, and only
/// if, no axis separates them.
class SimplexOverlap {
public:
    /// Tests one axis after another, until the simplices overlap along an axis by no more than `tolerance` [m].
    SimplexOverlap(const Simplex& first, const Simplex& second, Real tolerance);

    bool overlapping() const { return overlapping_; }
    /// Distance by which the first simplex has to move along a unit direction to be apart from the second [m]. Valid
    /// only if the simplices overlap.
    Real way_out(const Vec3& direction) const;

private:
    bool separates(const Simplex& first, const Simplex& second, const Vec3& along, Real tolerance);

    // Greatest number of axes: 4 + 4 face normals, and 6 x 6 cross products of an edge of each simplex.
    static constexpr std::size_t most_axes = 44;
    std::array<Vec3, most_axes> axis_;
    // Distances to move the first simplex along each axis and against it [m]
    std::array<Real, most_axes> forward_, backward_;
    std::size_t count_ = 0;
    bool overlapping_ = true;
};

}  // namespace skerry
