#include "systems/collision/overlap/solid_overlap.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <utility>

#include "systems/collision/tree/box.h"
#include "systems/geometry/closest_points.h"

namespace skerry {

namespace {

/// Two simplices that overlap, and the position of the overlap.
struct Meeting {
    Index first, second;
    Vec3 place;  // centre of the intersection of the two bounding boxes [m]
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

/// Calls `meet` for each pair of overlapping simplices of two solids. The arguments are the indices of both simplices,
/// the two simplices in the frame of the second solid, and their SimplexOverlap.
template <class Meet>
void for_each_meeting(const PlacedSolid& first, const PlacedSolid& second, Real tolerance, Meet&& meet) {
    // shift of the first solid relative to the second solid
    const Vec3 shift = first.shift - second.shift;
    // The boxes are enlarged, because the box of a triangle in an axis-aligned plane has no volume and would overlap
    // nothing (boxes_overlap).
    const Vec3 skin = Vec3::Constant(tolerance);
    const Aabb of_second{second.solid.box.lower - shift - skin, second.solid.box.upper - shift + skin};
    first.solid.tree.for_each_overlap(of_second, [&](Index f) {
        const Simplex own = first.solid.at(f).moved(shift);
        Aabb box = box_of(own);
        box.lower -= skin;
        box.upper += skin;
        second.solid.tree.for_each_overlap(box, [&](Index s) {
            const Simplex other = second.solid.at(s);
            if (const SimplexOverlap overlap(own, other, tolerance); overlap.overlapping())
                meet(f, s, own, other, overlap);
        });
    });
}

std::vector<Meeting> find_meetings(const PlacedSolid& first, const PlacedSolid& second, Real tolerance) {
    std::vector<Meeting> found;
    for_each_meeting(first, second, tolerance,
                     [&](Index f, Index s, const Simplex& own, const Simplex& other, const SimplexOverlap&) {
                         found.push_back({f, s, middle(shared(box_of(own), box_of(other))) + second.shift});
                     });
    return found;
}

/// Returns for each direction the distance by which the first solid has to move along it to leave all simplices of the
/// second solid that it overlaps now [m].
std::vector<Real> ways_out(const PlacedSolid& first, const PlacedSolid& second, Real tolerance,
                           std::span<const Vec3> direction) {
    std::vector<Real> way(direction.size(), 0);
    for_each_meeting(first, second, tolerance,
                     [&](Index, Index, const Simplex&, const Simplex&, const SimplexOverlap& overlap) {
                         for (std::size_t d = 0; d < way.size(); ++d)
                             way[d] = std::max(way[d], overlap.way_out(direction[d]));
                     });
    return way;
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
Real way_out_of_points(const PlacedSolid& first, const PlacedSolid& second, const Vec3& direction) {
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
        constexpr std::size_t most = 48;
        const Real length = along.norm();
        if (!(length > 0) || found_.size() == most) return;
        const Vec3 direction = along / length;
        for (const Vec3& other : found_)
            if (other.dot(direction) > nearly_same) return;
        found_.push_back(direction);
    }
    std::span<const Vec3> span() const { return found_; }

private:
    std::vector<Vec3> found_;
};

void add_normals(const Solid& solid, const std::vector<char>& met, Real sign, Directions& directions) {
    for (const SolidTriangle& t : solid.surface) {
        if (!met[static_cast<std::size_t>(t.simplex)]) continue;
        const auto at = [&](std::size_t k) -> const Vec3& { return solid.point[static_cast<std::size_t>(t.node[k])]; };
        const Vec3 normal = (at(1) - at(0)).cross(at(2) - at(0));
        directions.add(sign * normal);
        if (!solid.closed) directions.add(-sign * normal);
    }
}

/// Directions along which the first solid may leave the second solid. These are the direction from the centre of the
/// second solid to the centre of the first, and normals of faces of overlapping simplices: outward normals of the
/// second solid and inward normals of the first.
Directions likely_directions(const PlacedSolid& first, const PlacedSolid& second, std::span<const Meeting> meetings) {
    Directions directions;
    directions.add(middle_of_points(first) - middle_of_points(second));
    std::vector<char> met_first(first.solid.simplex.size(), 0), met_second(second.solid.simplex.size(), 0);
    for (const Meeting& m : meetings)
        met_first[static_cast<std::size_t>(m.first)] = met_second[static_cast<std::size_t>(m.second)] = 1;
    add_normals(second.solid, met_second, 1, directions);
    add_normals(first.solid, met_first, -1, directions);
    return directions;
}

/// Extent of the positions of all overlaps along a direction [m].
Real extent(std::span<const Meeting> meetings, const Vec3& direction) {
    Real lowest = infinity, highest = -infinity;
    for (const Meeting& m : meetings) {
        lowest = std::min(lowest, direction.dot(m.place));
        highest = std::max(highest, direction.dot(m.place));
    }
    return highest - lowest;
}

/// The candidate direction with the lowest cost. The cost is the distance by which the first solid leaves the simplices
/// that it overlaps now, plus the extent of the region of overlap along the direction. Without the extent, a direction
/// along a long region of overlap would seem cheap, although the motion would meet further simplices.
Vec3 best_direction(const PlacedSolid& first, const PlacedSolid& second, Real tolerance,
                    std::span<const Meeting> meetings) {
    const Directions directions = likely_directions(first, second, meetings);
    const std::vector<Real> way = ways_out(first, second, tolerance, directions.span());
    // A cost must be smaller by more than rounding errors to replace an earlier one, so that the first of equal costs
    // is used on every machine.
    constexpr Real shorter = 1 - 1e-6;
    Vec3 best = Vec3::UnitZ();
    Real least = infinity;
    for (std::size_t d = 0; d < way.size(); ++d)
        if (const Real length = way[d] + extent(meetings, directions.span()[d]); length < shorter * least) {
            least = length;
            best = directions.span()[d];
        }
    return best;
}

/// Distance by which the first solid has to move along `direction` until it overlaps no simplex of the second solid
/// [m]. Each iteration moves it out of the simplices that it overlaps at its current position. If most_tries iterations
/// do not suffice, the result is the distance that takes all points of the first solid past all points of the second.
Real way_out_along(const PlacedSolid& first, const PlacedSolid& second, Real tolerance, const Vec3& direction) {
    constexpr int most_tries = 16;
    Real gone = 0;
    for (int i = 0; i < most_tries; ++i) {
        const PlacedSolid there{first.solid, first.shift + gone * direction};
        const Real more = ways_out(there, second, tolerance, {&direction, 1}).front();
        if (!(more > 0)) return gone;
        gone += more;
    }
    return way_out_of_points(first, second, direction);
}

/// Finds the separating motion if one of the solids contains the other. The motion takes all points of the first solid
/// past all points of the second, along the line between the centres or along a coordinate axis; the shortest of these
/// motions is used.
void go_past(const PlacedSolid& first, const PlacedSolid& second, Overlap& overlap) {
    Directions directions;
    directions.add(middle_of_points(first) - middle_of_points(second));
    for (Index axis : {2, 0, 1})
        for (Real sign : {1.0, -1.0}) directions.add(sign * Vec3::Unit(axis));
    overlap.depth = infinity;
    for (const Vec3& direction : directions.span())
        if (const Real way = way_out_of_points(first, second, direction); way < overlap.depth) {
            overlap.depth = way;
            overlap.direction = direction;
        }
}

/// True if `inner` is inside the closed surface `outer`. The simplices of the two must not overlap, so one point of
/// `inner` suffices for the test.
bool is_within(const PlacedSolid& inner, const PlacedSolid& outer) {
    const Simplex any = inner.solid.at(0).moved(inner.shift - outer.shift);
    const Vec3 centre = (any.point[0] + any.point[1] + any.point[2] + any.point[3]) / 4;
    return !outer.solid.has_volume && contains(outer.solid, centre, 0);
}

}  // namespace

std::optional<Overlap> find_overlap(const PlacedSolid& first, const PlacedSolid& second, Real tolerance) {
    if (first.solid.simplex.empty() || !boxes_overlap(first.box(), second.box())) return std::nullopt;
    const std::vector<Meeting> meetings = find_meetings(first, second, tolerance);
    Overlap overlap{OverlapKind::crossing, 0, Vec3::UnitZ(), Vec3::Zero()};
    if (meetings.empty()) {
        const bool inside = is_within(first, second);
        if (!inside && !is_within(second, first)) return std::nullopt;
        overlap.kind = inside ? OverlapKind::inside : OverlapKind::around;
        overlap.place = middle_of_points(inside ? first : second);
        go_past(first, second, overlap);
        return overlap;
    }
    Aabb places = empty_box();
    for (const Meeting& m : meetings) grow(places, m.place);
    overlap.place = middle(places);
    overlap.kind = kind_of(first, second, tolerance);
    if (overlap.kind != OverlapKind::crossing) {
        go_past(first, second, overlap);
        return overlap;
    }
    overlap.direction = best_direction(first, second, tolerance, meetings);
    overlap.depth = way_out_along(first, second, tolerance, overlap.direction);
    return overlap;
}

std::optional<Overlap> find_touch_of_open_surface(const PlacedSolid& solid, const PlacedSolid& surface,
                                                  Real tolerance) {
    std::vector<Vec3> outward(solid.solid.point.size(), Vec3::Zero());  // by point: sum of twice the area vectors [m^2]
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
