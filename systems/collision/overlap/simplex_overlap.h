// How far two simplices are in each other (docs/methods/collision.md 9.1).
#pragma once

#include <array>

#include "components/types.h"

namespace skerry {

/// The convex hull of four points, or of the first three. At least one of a pair has four.
struct Simplex {
    std::array<Vec3, 4> point;  // m
    std::size_t count;

    Simplex moved(const Vec3& shift) const;
};

/// What takes the first of two simplices out of the second: for each axis along which a face or two edges can come to
/// separate them, how far it would have to go. The two share a ball if, and only if, no axis separates them.
class SimplexOverlap {
public:
    /// Looks along axis after axis, until one shows that they overlap by no more than `tolerance` (m).
    SimplexOverlap(const Simplex& first, const Simplex& second, Real tolerance);

    bool overlapping() const { return overlapping_; }
    /// m: how far the first has to go along a unit direction to be apart. Only of two that overlap.
    Real way_out(const Vec3& direction) const;

private:
    bool separates(const Simplex& first, const Simplex& second, const Vec3& along, Real tolerance);

    // Faces of both and edges of both with each other: 4 + 4 + 6 x 6.
    static constexpr std::size_t most_axes = 44;
    std::array<Vec3, most_axes> axis_;
    std::array<Real, most_axes> forward_, backward_;  // m, along the axis and against it
    std::size_t count_ = 0;
    bool overlapping_ = true;
};

}  // namespace skerry
