#include "systems/collision/overlap/solid_overlap.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <utility>

#include "systems/collision/tree/box.h"
#include "systems/geometry/closest_points.h"

namespace skerry {

namespace {

/// Two simplices that overlap, and the position of the overlap.
struct SimplexPair {
    Index first, second;
    Vec3 center;  // centre of the intersection of the two bounding boxes [m]
};

Aabb box_of(const Simplex& s) {
    Aabb box = empty_box();
    for (std::size_t k = 0; k < s.count; ++k) grow(box, s.point[k]);
    return box;
}

Aabb shared(const Aabb& a, const Aabb& b) {
    return {a.lower.cwiseMax(b.lower), a.upper.cwiseMin(b.upper)};
}

Vec3 middle(const Aabb& box) {
    return (box.lower + box.upper) / 2;
}

/// Calls `visit` for each pair of overlapping simplices of two solids. The arguments are the indices of both simplices,
/// the two simplices in the frame of the second solid, and their SimplexOverlap.
template <class Visit>
void for_each_overlapping_pair(const PlacedSolid& first, const PlacedSolid& second, Real tolerance, Visit&& visit) {
    // shift of the first solid relative to the second solid
    const Vec3 shift = first.shift - second.shift;
    // The boxes are enlarged, because the box of a triangle in an axis-aligned plane has no volume and would overlap
    // nothing (boxes_overlap).
    const Vec3 skin = Vec3::Constant(tolerance);
    const Aabb second_box{second.solid.box.lower - shift - skin, second.solid.box.upper - shift + skin};
    first.solid.tree.for_each_overlap(second_box, [&](Index f) {
        const Simplex own = first.solid.at(f).moved(shift);
        Aabb box = box_of(own);
        box.lower -= skin;
        box.upper += skin;
        second.solid.tree.for_each_overlap(box, [&](Index s) {
            const Simplex other = second.solid.at(s);
            if (const SimplexOverlap overlap(own, other, tolerance); overlap.overlapping())
                visit(f, s, own, other, overlap);
        });
    });
}

std::vector<SimplexPair> find_overlapping_pairs(const PlacedSolid& first, const PlacedSolid& second, Real tolerance) {
    std::vector<SimplexPair> found;
    for_each_overlapping_pair(first, second, tolerance,
                              [&](Index f, Index s, const Simplex& own, const Simplex& other, const SimplexOverlap&) {
                                  found.push_back({f, s, middle(shared(box_of(own), box_of(other))) + second.shift});
                              });
    return found;
}

/// For each direction: distance that the first solid has to move to leave all simplices of the second solid that it
/// overlaps now [m].
std::vector<Real> exit_distances(const PlacedSolid& first, const PlacedSolid& second, Real tolerance,
                                 std::span<const Vec3> direction) {
    std::vector<Real> distance(direction.size(), 0);
    for_each_overlapping_pair(first, second, tolerance,
                              [&](Index, Index, const Simplex&, const Simplex&, const SimplexOverlap& overlap) {
                                  for (std::size_t d = 0; d < distance.size(); ++d)
                                      distance[d] = std::max(distance[d], overlap.exit_distance(direction[d]));
                              });
    return distance;
}

bool all_inside(const PlacedSolid& inner, const PlacedSolid& outer, Real tolerance) {
    return std::ranges::all_of(inner.solid.surface_point, [&](Index n) {
        const Vec3 x = inner.solid.point[static_cast<std::size_t>(n)] + inner.shift - outer.shift;
        return contains(outer.solid, x, tolerance);
    });
}

OverlapKind kind_of(const PlacedSolid& first, const PlacedSolid& second, Real tolerance) {
    const bool inside = second.solid.has_volume && all_inside(first, second, tolerance);
    const bool around = all_inside(second, first, tolerance);
    if (inside && around) return OverlapKind::coincident;
    return inside ? OverlapKind::inside : around ? OverlapKind::around : OverlapKind::crossing;
}

/// Distance by which the first solid has to move along a unit direction until all points of the first solid are beyond
/// all points of the second solid [m].
Real exit_distance_of_points(const PlacedSolid& first, const PlacedSolid& second, const Vec3& direction) {
    Real lowest = infinity, highest = -infinity;
    for (const Index n : first.solid.surface_point)
        lowest = std::min(lowest, direction.dot(first.solid.point[static_cast<std::size_t>(n)] + first.shift));
    for (const Index n : second.solid.surface_point)
        highest = std::max(highest, direction.dot(second.solid.point[static_cast<std::size_t>(n)] + second.shift));
    return highest - lowest;
}

Vec3 middle_of_points(const PlacedSolid& placed) {
    Vec3 sum = Vec3::Zero();
    for (const Index n : placed.solid.surface_point) sum += placed.solid.point[static_cast<std::size_t>(n)];
    return sum / static_cast<Real>(placed.solid.surface_point.size()) + placed.shift;
}

/// List of candidate directions. The angle between any two directions in the list is at least 6 degrees.
class Directions {
public:
    void add(const Vec3& along) {
        // Cosine of 6 degrees; a direction that is wrong by this angle makes the separating distance 0.5 % longer.
        constexpr Real nearly_same = 0.995;
        constexpr std::size_t max_directions = 48;
        const Real length = along.norm();
        if (!(length > 0) || found_.size() == max_directions) return;
        const Vec3 direction = along / length;
        for (const Vec3& other : found_)
            if (other.dot(direction) > nearly_same) return;
        found_.push_back(direction);
    }
    std::span<const Vec3> span() const { return found_; }

private:
    std::vector<Vec3> found_;
};

void add_normals(const Solid& solid, const std::vector<char>& overlaps, Real sign, Directions& directions) {
    for (const SolidTriangle& t : solid.surface) {
        if (!overlaps[static_cast<std::size_t>(t.simplex)]) continue;
        const auto at = [&](std::size_t k) -> const Vec3& { return solid.point[static_cast<std::size_t>(t.node[k])]; };
        const Vec3 normal = (at(1) - at(0)).cross(at(2) - at(0));
        directions.add(sign * normal);
        if (!solid.closed) directions.add(-sign * normal);
    }
}

/// Candidate directions along which the first solid may leave the second solid:
/// - the direction from the centre of the second solid to the centre of the first,
/// - outward normals of the second solid at overlapping simplices,
/// - inward normals of the first solid at overlapping simplices.
Directions likely_directions(const PlacedSolid& first, const PlacedSolid& second, std::span<const SimplexPair> pairs) {
    Directions directions;
    directions.add(middle_of_points(first) - middle_of_points(second));
    std::vector<char> first_overlaps(first.solid.simplex.size(), 0), second_overlaps(second.solid.simplex.size(), 0);
    for (const SimplexPair& pair : pairs)
        first_overlaps[static_cast<std::size_t>(pair.first)] = second_overlaps[static_cast<std::size_t>(pair.second)] =
            1;
    add_normals(second.solid, second_overlaps, 1, directions);
    add_normals(first.solid, first_overlaps, -1, directions);
    return directions;
}

/// Extent of the positions of all overlaps along a direction [m].
Real extent(std::span<const SimplexPair> pairs, const Vec3& direction) {
    Real lowest = infinity, highest = -infinity;
    for (const SimplexPair& pair : pairs) {
        lowest = std::min(lowest, direction.dot(pair.center));
        highest = std::max(highest, direction.dot(pair.center));
    }
    return highest - lowest;
}

/// The candidate direction with the lowest cost: the distance by which the first solid leaves the simplices that it
/// overlaps now, plus the extent of the overlaps along the direction. The extent makes a motion along a long region
/// of overlap expensive, because it would meet further simplices.
Vec3 best_direction(const PlacedSolid& first, const PlacedSolid& second, Real tolerance,
                    std::span<const SimplexPair> pairs) {
    const Directions directions = likely_directions(first, second, pairs);
    const std::vector<Real> distance = exit_distances(first, second, tolerance, directions.span());
    // A cost replaces an earlier one only if it is smaller by more than rounding errors. The first of equal costs is
    // thus used on every machine.
    constexpr Real shorter = 1 - 1e-6;
    Vec3 best = Vec3::UnitZ();
    Real least = infinity;
    for (std::size_t d = 0; d < distance.size(); ++d)
        if (const Real length = distance[d] + extent(pairs, directions.span()[d]); length < shorter * least) {
            least = length;
            best = directions.span()[d];
        }
    return best;
}

/// Distance by which the first solid has to move along `direction` until it overlaps no simplex of the second solid
/// [m]. Each iteration moves the first solid out of the simplices that it overlaps at its current position.
Real exit_distance_along(const PlacedSolid& first, const PlacedSolid& second, Real tolerance, const Vec3& direction) {
    constexpr int max_tries = 16;
    Real moved = 0;
    for (int i = 0; i < max_tries; ++i) {
        const PlacedSolid shifted{first.solid, first.shift + moved * direction};
        const Real further = exit_distances(shifted, second, tolerance, {&direction, 1}).front();
        if (!(further > 0)) return moved;
        moved += further;
    }
    // Too many iterations: all points of the first solid move past all points of the second.
    return exit_distance_of_points(first, second, direction);
}

/// Finds the separating motion if one of the solids contains the other. It is the shortest motion along the line
/// between the centres or along a coordinate axis that takes all points of the first solid past all points of the
/// second.
void pass_over(const PlacedSolid& first, const PlacedSolid& second, Overlap& overlap) {
    Directions directions;
    directions.add(middle_of_points(first) - middle_of_points(second));
    for (Index axis : {2, 0, 1})
        for (Real sign : {1.0, -1.0}) directions.add(sign * Vec3::Unit(axis));
    overlap.depth = infinity;
    for (const Vec3& direction : directions.span())
        if (const Real distance = exit_distance_of_points(first, second, direction); distance < overlap.depth) {
            overlap.depth = distance;
            overlap.direction = direction;
        }
}

/// True if `inner` is inside the closed surface `outer`. Simplices of `inner` and `outer` must not overlap, so that one
/// point of `inner` suffices for the test.
bool is_within(const PlacedSolid& inner, const PlacedSolid& outer) {
    const Simplex any = inner.solid.at(0).moved(inner.shift - outer.shift);
    const Vec3 centre = (any.point[0] + any.point[1] + any.point[2] + any.point[3]) / 4;
    return !outer.solid.has_volume && contains(outer.solid, centre, 0);
}

}  // namespace

std::optional<Overlap> find_overlap(const PlacedSolid& first, const PlacedSolid& second, Real tolerance) {
    if (first.solid.simplex.empty() || !boxes_overlap(first.box(), second.box())) return std::nullopt;
    const std::vector<SimplexPair> pairs = find_overlapping_pairs(first, second, tolerance);
    Overlap overlap{OverlapKind::crossing, 0, Vec3::UnitZ(), Vec3::Zero()};
    if (pairs.empty()) {
        const bool inside = is_within(first, second);
        if (!inside && !is_within(second, first)) return std::nullopt;
        overlap.kind = inside ? OverlapKind::inside : OverlapKind::around;
        overlap.place = middle_of_points(inside ? first : second);
        pass_over(first, second, overlap);
        return overlap;
    }
    Aabb centers = empty_box();
    for (const SimplexPair& pair : pairs) grow(centers, pair.center);
    overlap.place = middle(centers);
    overlap.kind = kind_of(first, second, tolerance);
    if (overlap.kind != OverlapKind::crossing) {
        pass_over(first, second, overlap);
        return overlap;
    }
    overlap.direction = best_direction(first, second, tolerance, pairs);
    overlap.depth = exit_distance_along(first, second, tolerance, overlap.direction);
    return overlap;
}

std::optional<Overlap> find_touch_of_open_surface(const PlacedSolid& solid, const PlacedSolid& surface,
                                                  Real tolerance) {
    std::vector<Vec3> outward(solid.solid.point.size(), Vec3::Zero());  // by point: sum of 2 * area * normal [m^2]
    for (const SolidTriangle& triangle : solid.solid.surface) {
        const auto at = [&](std::size_t k) { return solid.solid.point[static_cast<std::size_t>(triangle.node[k])]; };
        const Vec3 area = (at(1) - at(0)).cross(at(2) - at(0));
        for (const Index node : triangle.node) outward[static_cast<std::size_t>(node)] += area;
    }
    std::optional<Overlap> found;
    for (const Index p : solid.solid.surface_point) {
        const auto row = static_cast<std::size_t>(p);
        const Vec3 point = solid.solid.point[row] + solid.shift - surface.shift;
        surface.solid.tree.for_each_overlap({point.array() - tolerance, point.array() + tolerance}, [&](Index s) {
            const auto& [a, b, c, none] = surface.solid.at(s).point;
            const Vec3 normal = (b - a).cross(c - a).normalized();
            const Real distance_squared = closest_point_on_triangle(point, a, b, c).distance_squared;
            if (distance_squared <= tolerance * tolerance && outward[row].dot(normal) > 0)
                found = Overlap{OverlapKind::crossing, 2 * tolerance, -normal, point + surface.shift};
        });
        if (found) return found;
    }
    return found;
}

}  // namespace skerry
