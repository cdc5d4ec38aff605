#include "engine/mesh/repair/remove_flat_triangles.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <optional>
#include <set>
#include <utility>

#include "engine/mesh/repair/surface_distance.h"
#include "engine/mesh/repair/triangle_tree.h"
#include "systems/geometry/closest_points.h"

namespace skerry::mesh {

namespace {

using Triangle = std::array<Index, 3>;
using Corners = std::array<Vec3, 3>;

// Least factor by which a change must increase the smallest altitude of the changed triangles. A smaller increase does
// not justify moving the surface.
constexpr Real least_gain = 1.1;
// Largest allowed distance of sample points of either surface (original or changed) from the other surface, as a
// fraction of the tolerance. The rest of the tolerance is a margin for the points between the sample points.
constexpr Real share_of_tolerance = 0.8;
// Lower limit of the cosine of the angle by which a change may rotate the normal of a triangle (60 degrees).
constexpr Real least_turn = 0.5;
// A flat triangle has no meaningful normal. The triangle that replaces it is therefore compared with the mean normal of
// all removed triangles. This is the lower limit of the cosine of the angle between the two normals.
constexpr Real least_turn_of_flat = 0.2;
// Number of intervals per edge of a triangle. It gives 15 sample points per triangle, at which distances are measured.
constexpr int intervals_per_edge = 4;

Vec3 area_vector(const Corners& x) {
    return (x[1] - x[0]).cross(x[2] - x[0]);
}

/// Smallest altitude of a triangle: twice its area divided by its longest edge [m].
Real altitude_of(const Corners& x) {
    const Real longest =
        std::max({(x[1] - x[0]).squaredNorm(), (x[2] - x[1]).squaredNorm(), (x[0] - x[2]).squaredNorm()});
    return longest > 0 ? area_vector(x).norm() / std::sqrt(longest) : 0;
}

/// A local change of the surface: triangles to remove, and the triangles that replace them.
struct Change {
    std::vector<Index> removed;
    std::vector<Triangle> added;
    // For each new triangle in `added`: the triangle in `removed` that it replaces.
    std::vector<Index> replaced;
    // For an edge collapse: the node that remains, and the node that is removed.
    Index kept = no_index, merged = no_index;
    Vec3 position = Vec3::Zero();  // new position of the node `kept` [m]
    Real altitude = 0;             // smallest altitude of the new triangles [m]
};

class TriangleRepair {
public:
    TriangleRepair(const SurfaceMesh& surface, const RepairSettings& settings)
        : settings_(settings), original_(surface), nodes_(surface.nodes), around_(surface.nodes.size()) {
        for (const Triangle& t : surface.triangles) {
            add(t);
            sample_triangle(corners(t), intervals_per_edge, samples_.back());
        }
    }

    RepairedSurface run() {
        RepairedSurface result;
        for (std::size_t t = 0; t < triangles_.size(); ++t) queue_if_flat(static_cast<Index>(t));
        while (!flat_.empty()) {
            const Index worst = flat_.begin()->second;
            flat_.erase(flat_.begin());
            const std::optional<Change> best = best_change(worst);
            if (!best) continue;
            ++(best->merged == no_index ? result.flipped : result.collapsed);
            apply(*best);
        }
        result.surface = compact();
        return result;
    }

private:
    const Triangle& triangle(Index t) const { return triangles_[static_cast<std::size_t>(t)]; }
    const Vec3& node(Index n) const { return nodes_[static_cast<std::size_t>(n)]; }
    std::vector<Index>& around(Index n) { return around_[static_cast<std::size_t>(n)]; }
    const std::vector<Index>& around(Index n) const { return around_[static_cast<std::size_t>(n)]; }
    Corners corners(const Triangle& t) const { return {node(t[0]), node(t[1]), node(t[2])}; }
    Corners corners(const Triangle& t, const Change& change) const {
        Corners x = corners(t);
        for (std::size_t a = 0; a < 3; ++a)
            if (t[a] == change.kept) x[a] = change.position;
        return x;
    }

    void add(const Triangle& t) {
        for (const Index n : t) around(n).push_back(static_cast<Index>(triangles_.size()));
        triangles_.push_back(t);
        alive_.push_back(true);
        samples_.emplace_back();
    }

    /// Puts a triangle into the queue flat_ if it still exists and its altitude is below settings_.altitude.
    void queue_if_flat(Index t) {
        const Real altitude = altitude_of(corners(triangle(t)));
        if (alive_[static_cast<std::size_t>(t)] && altitude < settings_.altitude) flat_.emplace(altitude, t);
    }

    std::vector<Index> neighbours(Index n) const {
        std::vector<Index> found;
        for (const Index t : around(n))
            for (const Index other : triangle(t))
                if (other != n) found.push_back(other);
        std::sort(found.begin(), found.end());
        found.erase(std::unique(found.begin(), found.end()), found.end());
        return found;
    }

    std::vector<Index> triangles_with(Index a, Index b) const {
        std::vector<Index> both;
        for (const Index t : around(a))
            if (std::find(triangle(t).begin(), triangle(t).end(), b) != triangle(t).end()) both.push_back(t);
        return both;
    }

    std::optional<Change> best_change(Index worst) const {
        std::optional<Change> best;
        const auto offer = [&](std::optional<Change> change) {
            if (change && (!best || change->altitude > best->altitude) && is_allowed(*change)) best = std::move(change);
        };
        for (std::size_t a = 0; a < 3; ++a) {
            const Index start = triangle(worst)[a], end = triangle(worst)[(a + 1) % 3];
            for (const Real fraction : {0.0, 0.5, 1.0}) offer(collapse(start, end, fraction));
            offer(flip(start, end));
        }
        return best;
    }

    /// Collapses the edge between the nodes a and b. Both nodes move to the point a + fraction (b - a), and the node
    /// with the lower number remains.
    std::optional<Change> collapse(Index a, Index b, Real fraction) const {
        const std::vector<Index> sides = triangles_with(a, b), near_a = neighbours(a), near_b = neighbours(b);
        std::vector<Index> common;
        std::set_intersection(near_a.begin(), near_a.end(), near_b.begin(), near_b.end(), std::back_inserter(common));
        // Link condition: a and b must have exactly two common neighbours, else the collapse changes the topology. The
        // surface of a tetrahedron, on which a and b have three neighbours each, meets the condition but must not
        // collapse.
        if (sides.size() != 2 || common.size() != 2 || near_a.size() + near_b.size() <= 6) return std::nullopt;
        Change change;
        change.position = (1 - fraction) * node(a) + fraction * node(b);
        change.kept = std::min(a, b);
        change.merged = std::max(a, b);
        change.removed = around(a);
        for (const Index t : around(b))
            if (std::find(sides.begin(), sides.end(), t) == sides.end()) change.removed.push_back(t);
        for (const Index t : change.removed) {
            if (std::find(sides.begin(), sides.end(), t) != sides.end()) continue;
            Triangle added = triangle(t);
            std::replace(added.begin(), added.end(), change.merged, change.kept);
            change.added.push_back(added);
            change.replaced.push_back(t);
        }
        return if_improves(std::move(change));
    }

    std::optional<Change> flip(Index a, Index b) const {
        const std::vector<Index> sides = triangles_with(a, b);
        if (sides.size() != 2) return std::nullopt;
        Change change;
        change.removed = change.replaced = sides;
        std::array<Index, 2> apex{};
        for (std::size_t s = 0; s < 2; ++s)
            apex[s] = *std::find_if(triangle(sides[s]).begin(), triangle(sides[s]).end(),
                                    [&](Index n) { return n != a && n != b; });
        if (apex[0] == apex[1] || !triangles_with(apex[0], apex[1]).empty()) return std::nullopt;
        // Each new triangle is one of the two old ones, in which one end of the flipped edge is replaced by the apex of
        // the other old triangle. The apex is the corner opposite to the flipped edge.
        for (std::size_t s = 0; s < 2; ++s) {
            Triangle added = triangle(sides[s]);
            std::replace(added.begin(), added.end(), next_after(added, apex[s]), apex[1 - s]);
            change.added.push_back(added);
        }
        return if_improves(std::move(change));
    }

    static Index next_after(const Triangle& t, Index n) {
        for (std::size_t a = 0; a < 3; ++a)
            if (t[a] == n) return t[(a + 1) % 3];
        return no_index;
    }

    /// Stores in the change the smallest altitude of its new triangles. Returns nullopt unless this altitude exceeds
    /// the smallest altitude of the removed triangles by the factor least_gain.
    std::optional<Change> if_improves(Change change) const {
        Real before = infinity;
        for (const Index t : change.removed) before = std::min(before, altitude_of(corners(triangle(t))));
        change.altitude = infinity;
        for (const Triangle& t : change.added)
            change.altitude = std::min(change.altitude, altitude_of(corners(t, change)));
        if (!(change.altitude > least_gain * before)) return std::nullopt;
        return change;
    }

    bool is_allowed(const Change& change) const { return keeps_sides(change) && keeps_distance(change); }

    bool keeps_sides(const Change& change) const {
        Vec3 mean = Vec3::Zero();
        for (const Index t : change.removed) mean += area_vector(corners(triangle(t)));
        for (std::size_t i = 0; i < change.added.size(); ++i) {
            const Corners before = corners(triangle(change.replaced[i])), after = corners(change.added[i], change);
            const bool flat = altitude_of(before) < settings_.altitude;
            const Vec3 towards = flat ? mean : area_vector(before), normal = area_vector(after);
            if (!(normal.dot(towards) > (flat ? least_turn_of_flat : least_turn) * normal.norm() * towards.norm()))
                return false;
        }
        return true;
    }

    bool keeps_distance(const Change& change) const {
        const Real limit = std::pow(share_of_tolerance * settings_.tolerance, 2);
        for (const Index t : change.removed)
            for (const Vec3& point : samples_[static_cast<std::size_t>(t)])
                if (nearest_made(change, point).second > limit) return false;
        std::vector<Vec3> points;
        for (const Triangle& t : change.added) sample_triangle(corners(t, change), intervals_per_edge, points);
        return std::all_of(points.begin(), points.end(),
                           [&](const Vec3& point) { return original_.distance_squared(point, 2 * limit) <= limit; });
    }

    /// Returns the index of the new triangle nearest to the point, and the squared distance from the point to this
    /// triangle [m^2].
    std::pair<std::size_t, Real> nearest_made(const Change& change, const Vec3& point) const {
        std::pair<std::size_t, Real> nearest{0, infinity};
        for (std::size_t i = 0; i < change.added.size(); ++i) {
            const Corners x = corners(change.added[i], change);
            const Real distance = closest_point_on_triangle(point, x[0], x[1], x[2]).distance_squared;
            if (distance < nearest.second) nearest = {i, distance};
        }
        return nearest;
    }

    void apply(const Change& change) {
        std::vector<std::vector<Vec3>> samples(change.added.size());
        for (const Index t : change.removed) {
            for (const Vec3& point : samples_[static_cast<std::size_t>(t)])
                samples[nearest_made(change, point).first].push_back(point);
            flat_.erase({altitude_of(corners(triangle(t))), t});
            samples_[static_cast<std::size_t>(t)].clear();
            alive_[static_cast<std::size_t>(t)] = false;
            for (const Index n : triangle(t)) std::erase(around(n), t);
        }
        if (change.kept != no_index) nodes_[static_cast<std::size_t>(change.kept)] = change.position;
        const auto first = static_cast<Index>(triangles_.size());
        for (std::size_t i = 0; i < change.added.size(); ++i) {
            add(change.added[i]);
            samples_.back() = std::move(samples[i]);
        }
        // Flat triangles next to the new triangles are examined again, because changes that were rejected before may
        // now be possible.
        for (auto t = first; t < static_cast<Index>(triangles_.size()); ++t)
            for (const Index n : triangle(t))
                for (const Index beside : around(n)) queue_if_flat(beside);
    }

    SurfaceMesh compact() const {
        SurfaceMesh surface;
        std::vector<Index> row(nodes_.size(), no_index);
        for (std::size_t n = 0; n < nodes_.size(); ++n) {
            if (around_[n].empty()) continue;
            row[n] = static_cast<Index>(surface.nodes.size());
            surface.nodes.push_back(nodes_[n]);
        }
        for (std::size_t t = 0; t < triangles_.size(); ++t) {
            if (!alive_[t]) continue;
            Triangle renumbered = triangles_[t];
            for (Index& n : renumbered) n = row[static_cast<std::size_t>(n)];
            surface.triangles.push_back(renumbered);
        }
        return surface;
    }

    RepairSettings settings_;
    TriangleTree original_;
    std::vector<Vec3> nodes_;
    std::vector<Triangle> triangles_;  // all triangles, including removed ones, for which alive_ is false
    std::vector<bool> alive_;
    // Sample points of the original surface, by triangle of the changed surface. When a change removes a triangle, its
    // points go to the nearest triangles that replace it.
    std::vector<std::vector<Vec3>> samples_;
    std::vector<std::vector<Index>> around_;  // numbers of the triangles at each node
    // Pairs (altitude, triangle number) of the flat triangles that run() still has to examine, flattest first. Equally
    // flat triangles are ordered by number.
    std::set<std::pair<Real, Index>> flat_;
};

}  // namespace

RepairedSurface remove_flat_triangles(const SurfaceMesh& surface, const RepairSettings& settings) {
    return TriangleRepair(surface, settings).run();
}

}  // namespace skerry::mesh
