#include "systems/collision/overlap/simplex_overlap.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <utility>

#include "systems/collision/tree/box.h"

namespace skerry {

namespace {

constexpr std::array<std::array<std::size_t, 2>, 6> edge_corners{{{0, 1}, {0, 2}, {1, 2}, {0, 3}, {1, 3}, {2, 3}}};
constexpr std::array<std::array<std::size_t, 3>, 4> face_corners{{{0, 1, 2}, {0, 1, 3}, {0, 2, 3}, {1, 2, 3}}};

std::size_t edge_count(const Simplex& s) {
    return s.count == 4 ? 6 : 3;
}

Vec3 edge(const Simplex& s, std::size_t e) {
    return s.point[edge_corners[e][1]] - s.point[edge_corners[e][0]];
}

Vec3 face_normal(const Simplex& s, std::size_t f) {
    const Vec3& a = s.point[face_corners[f][0]];
    return (s.point[face_corners[f][1]] - a).cross(s.point[face_corners[f][2]] - a);
}

std::pair<Real, Real> interval(const Simplex& s, const Vec3& origin, const Vec3& axis) {
    Real lower = infinity, upper = -infinity;
    for (std::size_t k = 0; k < s.count; ++k) {
        const Real at = axis.dot(s.point[k] - origin);
        lower = std::min(lower, at);
        upper = std::max(upper, at);
    }
    return {lower, upper};
}

}  // namespace

Simplex Simplex::moved(const Vec3& shift) const {
    Simplex other = *this;
    for (Vec3& x : other.point) x += shift;
    return other;
}

SimplexOverlap::SimplexOverlap(const Simplex& first, const Simplex& second, Real tolerance) {
    for (const Simplex* s : {&first, &second})
        for (std::size_t f = 0; f < (s->count == 4 ? 4 : 1); ++f)
            if (separates(first, second, face_normal(*s, f), tolerance)) return;
    for (std::size_t a = 0; a < edge_count(first); ++a)
        for (std::size_t b = 0; b < edge_count(second); ++b)
            if (separates(first, second, edge(first, a).cross(edge(second, b)), tolerance)) return;
    overlapping_ = count_ > 0;
}

/// Returns true if the projections of both simplices onto the axis `along` overlap by at most `tolerance` [m];
/// otherwise stores the axis and the overlap. `along`: vector of any length. The cross product of two nearly parallel
/// edges has an arbitrary direction, but every direction is a valid axis.
bool SimplexOverlap::separates(const Simplex& first, const Simplex& second, const Vec3& along, Real tolerance) {
    const Real length = along.norm();
    if (!(length > 0)) return false;
    const Vec3 axis = along / length;
    // Coordinates are measured from a point near both simplices, so that a large distance from the world's origin
    // causes no rounding errors.
    const Vec3& origin = first.point[0];
    const auto [lower, upper] = interval(first, origin, axis);
    const auto [other_lower, other_upper] = interval(second, origin, axis);
    const Real forward = other_upper - lower, backward = upper - other_lower;
    if (!(std::min(forward, backward) > tolerance)) {
        overlapping_ = false;
        return true;
    }
    axis_[count_] = axis;
    forward_[count_] = forward;
    backward_[count_++] = backward;
    return false;
}

Real SimplexOverlap::exit_distance(const Vec3& direction) const {
    Real least = infinity;
    for (std::size_t k = 0; k < count_; ++k) {
        const Real along = axis_[k].dot(direction);
        if (along != 0) least = std::min(least, along > 0 ? forward_[k] / along : backward_[k] / -along);
    }
    return least;
}

}  // namespace skerry
