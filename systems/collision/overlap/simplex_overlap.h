// Overlap of two simplices (docs/methods/collision.md 9.1).
#pragma once

#include <array>

#include "components/types.h"

namespace skerry {

/// The convex hull of four points, or of the first three. At least one simplex of a pair has four.
struct Simplex {
    std::array<Vec3, 4> point;  // [m]
    std::size_t count;

    Simplex moved(const Vec3& shift) const;
};

/// Separating axis test of two simplices. For each axis along which a face or two edges can separate them, it stores
/// how far the first would have to move. The two share a ball if, and only if, no axis separates them.
class SimplexOverlap {
public:
    /// Tests axis after axis, until one shows that they overlap by no more than `tolerance` [m].
    SimplexOverlap(const Simplex& first, const Simplex& second, Real tolerance);

    bool overlapping() const { return overlapping_; }
    /// Distance the first has to move along a unit direction to be apart [m]. Valid only if the two overlap.
    Real way_out(const Vec3& direction) const;

private:
    bool separates(const Simplex& first, const Simplex& second, const Vec3& along, Real tolerance);

    // Face normals of both, and cross products of an edge of each: 4 + 4 + 6 x 6.
    static constexpr std::size_t most_axes = 44;
    std::array<Vec3, most_axes> axis_;
    std::array<Real, most_axes> forward_, backward_;  // along the axis and against it [m]
    std::size_t count_ = 0;
    bool overlapping_ = true;
};

}  // namespace skerry
