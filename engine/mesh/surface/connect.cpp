#include "engine/mesh/surface/connect.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <numbers>
#include <numeric>
#include <tuple>
#include <utility>

#include "engine/mesh/surface/add_fault.h"
#include "engine/mesh/surface/sides.h"

namespace skerry::mesh {
namespace {

/// Returns true for the triangles that cannot lie where two closed shells touch, because there an even number of
/// triangles meet at each edge.
///
/// Only triangles for which `given` is true are tested. They are divided into patches, which are connected by edges.
/// The result is true for a whole patch if one of its edges has an odd number of triangles of the surface, not counting
/// `dropped` ones.
std::vector<bool> patches_with_odd_edge(Triangles triangles, const std::vector<bool>& given,
                                        const std::vector<bool>& dropped) {
    UnionFind patches;
    patches.start(triangles.size());
    std::vector<Index> at_odd_edge;
    const std::vector<Side> sides = sorted_sides(triangles);
    for_each_edge(sides, [&](std::span<const Side> edge) {
        Index previous = no_index;
        std::size_t count = 0;
        for (const Side& side : edge) {
            count += !dropped[static_cast<std::size_t>(side.triangle())];
            if (!given[static_cast<std::size_t>(side.triangle())]) continue;
            if (previous != no_index) patches.join(previous, side.triangle());
            previous = side.triangle();
        }
        if (previous != no_index && count % 2 == 1) at_odd_edge.push_back(previous);
    });
    std::vector<bool> marked(triangles.size(), false);
    for (const Index t : at_odd_edge) marked[static_cast<std::size_t>(patches.root(t))] = true;
    for (std::size_t t = 0; t < marked.size(); ++t)
        marked[t] = given[t] && marked[static_cast<std::size_t>(patches.root(static_cast<Index>(t)))];
    return marked;
}

/// Orients the triangles of each patch like most of them. A patch consists of triangles that are connected by edges
/// with exactly two triangles. One-sided patches (Moebius strips) are left as they are; the function returns the first
/// triangle of each.
std::vector<Index> orient(SurfaceReport& report, std::span<const Side> sides) {
    std::vector<std::array<Index, 3>>& triangles = report.cleaned.triangles;
    // Each triangle has two entries: one for its present and one for its opposite orientation. Entries of neighbours
    // whose orientations agree are joined. A patch is one-sided if both entries of a triangle become joined.
    UnionFind orientations;
    orientations.start(2 * triangles.size());
    for_each_edge(sides, [&](std::span<const Side> edge) {
        if (edge.size() != 2) return;
        const Index a = 2 * edge[0].triangle(), b = 2 * edge[1].triangle();
        const Index same = edge[0].rises() == edge[1].rises() ? 1 : 0;
        orientations.join(a, b + same);
        orientations.join(a + 1, b + 1 - same);
    });
    struct Patch {
        Index triangles = 0, opposite = 0;  // number of triangles, and of those oriented opposite to the first one
    };
    std::vector<Patch> patches(triangles.size());  // indexed by the first triangle of the patch
    const auto roots_of = [&](std::size_t t) {
        const auto row = static_cast<Index>(2 * t);
        return std::pair(orientations.root(row), orientations.root(row + 1));
    };
    const auto patch_of = [&](std::pair<Index, Index> roots) -> Patch& {
        return patches[static_cast<std::size_t>(std::min(roots.first, roots.second) / 2)];
    };
    std::vector<Index> one_sided;
    for (std::size_t t = 0; t < triangles.size(); ++t) {
        const auto roots = roots_of(t);
        Patch& patch = patch_of(roots);
        if (roots.first == roots.second && patch.triangles == 0) one_sided.push_back(static_cast<Index>(t));
        ++patch.triangles;
        patch.opposite += roots.first > roots.second;
    }
    for (std::size_t t = 0; t < triangles.size(); ++t) {
        const auto roots = roots_of(t);
        const Patch& patch = patch_of(roots);
        const bool most_are_opposite = 2 * patch.opposite > patch.triangles;
        if (roots.first == roots.second || (roots.first > roots.second) == most_are_opposite) continue;
        std::swap(triangles[t][1], triangles[t][2]);
        add_fault(report, SurfaceFaultKind::turned_triangles, static_cast<Index>(t));
    }
    return one_sided;
}

/// Finds the two triangles that bound each solid at an edge at which several solids touch. Calls visit(a, b) with the
/// sides (Side) of these two triangles at the edge. Returns true if solids overlap at the edge.
///
/// The edge must have at least four triangles. Half of their sides must lead from one end to the other, and half of
/// them back.
bool for_each_solid(const SurfaceMesh& surface, std::span<const Side> edge, auto&& visit) {
    const auto at = [&](Index n) -> const Vec3& { return surface.nodes[static_cast<std::size_t>(n)]; };
    const Vec3 &low = at(edge[0].node[0]), along = (at(edge[0].node[1]) - low).normalized();
    const auto direction_of = [&](const Side& side) -> Vec3 {
        const std::array<Index, 3>& nodes = surface.triangles[static_cast<std::size_t>(side.triangle())];
        const Vec3 arm = at(nodes[static_cast<std::size_t>(3 - side.corner[0] % 3 - side.corner[1] % 3)]) - low;
        return arm - along.dot(arm) * along;
    };
    struct SideAngle {
        long angle;  // angle around the edge from its first triangle, in units of 1e-6 rad
        bool opens;  // true: the volume behind the triangle is on the side of larger angles
        std::size_t side;
    };
    constexpr Real step = 1e-6;
    const long full_turn = std::lround(2 * std::numbers::pi / step);
    const Vec3 zero = direction_of(edge[0]);
    std::vector<SideAngle> by_angle;
    for (std::size_t s = 0; s < edge.size(); ++s) {
        const Vec3 arm = direction_of(edge[s]);
        const Real angle = std::atan2(along.dot(zero.cross(arm)), zero.dot(arm));
        by_angle.push_back({(std::lround(angle / step) + full_turn) % full_turn, !edge[s].rises(), s});
    }
    std::ranges::sort(by_angle, {}, [](const SideAngle& p) { return std::tuple(p.angle, p.opens, p.side); });
    std::vector<std::size_t> open;
    bool overlap = false;
    std::vector<bool> paired(edge.size(), false);
    // Goes around the edge twice: a solid that contains the direction of angle 0 opens in the first turn and is closed
    // in the second.
    for (std::size_t i = 0; i < 2 * by_angle.size(); ++i) {
        const SideAngle& here = by_angle[i % by_angle.size()];
        if (paired[here.side]) continue;
        if (here.opens && i < by_angle.size()) open.push_back(here.side);
        if (here.opens || open.empty()) continue;
        paired[here.side] = paired[open.back()] = true;
        visit(edge[here.side], edge[open.back()]);
        open.pop_back();
        overlap = overlap || !open.empty();
    }
    return overlap;
}

void report_holes(SurfaceReport& report, std::span<const Side> open) {
    const auto at = [&](Index n) -> const Vec3& { return report.cleaned.nodes[static_cast<std::size_t>(n)]; };
    UnionFind loops;
    loops.start(report.cleaned.nodes.size());
    for (const Side& side : open) loops.join(side.node[0], side.node[1]);
    struct Hole {
        Real length = 0;
        Vec3 moment = Vec3::Zero();  // sum over the edges of midpoint times length [m^2], for the centroid
        Index triangle = no_index;
    };
    std::vector<Hole> holes;
    for (const Side& side : open) {
        const auto row = static_cast<std::size_t>(loops.number(side.node[0]));
        if (row == holes.size()) holes.push_back({.triangle = side.triangle()});
        const Vec3 &a = at(side.node[0]), &b = at(side.node[1]);
        holes[row].length += (b - a).norm();
        holes[row].moment += (b - a).norm() * (a + b) / 2;
        holes[row].triangle = std::min(holes[row].triangle, side.triangle());
    }
    std::ranges::stable_sort(holes, std::ranges::greater{}, &Hole::length);
    for (const Hole& hole : holes) {
        SurfaceFault& fault = add_fault(report, SurfaceFaultKind::holes, hole.triangle, hole.moment / hole.length);
        fault.length = std::max(fault.length, hole.length);
    }
}

}  // namespace

std::vector<Index> drop_duplicates(SurfaceReport& report) {
    struct Entry {
        std::array<Index, 3> node;  // ascending
        Index triangle;
        bool turned;  // true: the nodes in ascending order are clockwise as seen from outside
    };
    std::vector<Entry> entries;
    entries.reserve(report.number.size());
    for (const auto& [a, b, c] : report.cleaned.triangles) {
        const int ascents = int{a < b} + int{b < c} + int{c < a};
        entries.push_back({{a, b, c}, static_cast<Index>(entries.size()), ascents == 1});
        std::ranges::sort(entries.back().node);
    }
    std::ranges::sort(entries, {}, [](const Entry& e) { return std::tuple(e.node, e.triangle); });
    std::vector<bool> dropped(entries.size(), false), opposite(entries.size(), false);
    std::vector<Index> repeats(entries.size(), no_index);  // for a repeated triangle: the first one with its nodes
    for (std::size_t first = 0, i = 1; i < entries.size(); ++i) {
        if (entries[i].node != entries[first].node) {
            first = i;
            continue;
        }
        const auto triangle = static_cast<std::size_t>(entries[i].triangle);
        repeats[triangle] = entries[first].triangle;
        dropped[triangle] = std::any_of(entries.begin() + static_cast<std::ptrdiff_t>(first),
                                        entries.begin() + static_cast<std::ptrdiff_t>(i),
                                        [&](const Entry& earlier) { return earlier.turned == entries[i].turned; });
        opposite[triangle] = !dropped[triangle];
    }
    if (std::ranges::count(opposite, true) > 0) {
        const std::vector<bool> spurious = patches_with_odd_edge(report.cleaned.triangles, opposite, dropped);
        for (std::size_t t = 0; t < dropped.size(); ++t) dropped[t] = dropped[t] || spurious[t];
    }
    std::vector<Index> repeated_by(entries.size(), no_index);
    for (std::size_t t = dropped.size(); t-- > 0;)
        if (dropped[t]) repeated_by[static_cast<std::size_t>(repeats[t])] = report.number[t];
    for (std::size_t t = 0; t < dropped.size(); ++t)
        if (dropped[t]) add_fault(report, SurfaceFaultKind::duplicate_triangles, static_cast<Index>(t));
    keep_triangles(report, [&](std::size_t t) { return !dropped[t]; });
    std::size_t kept = 0;
    for (std::size_t t = 0; t < dropped.size(); ++t)
        if (!dropped[t]) repeated_by[kept++] = repeated_by[t];
    repeated_by.resize(kept);
    return repeated_by;
}

void connect(SurfaceReport& report) {
    using enum SurfaceFaultKind;
    std::erase_if(report.faults, [](const SurfaceFault& fault) { return fault.kind >= holes; });
    report.shells.clear();
    report.min_edge = report.mean_edge = report.max_edge = 0;
    const SurfaceMesh& surface = report.cleaned;
    std::vector<Side> sides = sorted_sides(surface.triangles);
    const std::vector<Index> one_sided = orient(report, sides);
    if (report.find(turned_triangles)) sides = sorted_sides(surface.triangles);
    const std::size_t count = surface.triangles.size();
    UnionFind parts, fans;
    parts.start(count);
    fans.start(3 * count);
    const auto join = [&](const Side& a, const Side& b) {
        parts.join(a.triangle(), b.triangle());
        join_corners(fans, a, b);
    };
    // open: sides at edges with one triangle; unbalanced: sides at edges with more triangles in one direction than the
    // other
    std::vector<Side> open, unbalanced;
    std::vector<bool> branches(surface.nodes.size(), false);
    Real edges = 0;
    if (count > 0) report.min_edge = infinity;
    for_each_edge(sides, [&](std::span<const Side> edge) {
        const Vec3 &a = surface.nodes[static_cast<std::size_t>(edge[0].node[0])],
                   &b = surface.nodes[static_cast<std::size_t>(edge[0].node[1])];
        const Real length = (b - a).norm();
        report.min_edge = std::min(report.min_edge, length);
        report.max_edge = std::max(report.max_edge, length);
        report.mean_edge += length;
        ++edges;
        if (edge.size() == 1) open.push_back(edge[0]);
        if (edge.size() == 2) join(edge[0], edge[1]);
        if (edge.size() <= 2) return;
        add_fault(report, branching_edges, edge[0].triangle(), (a + b) / 2);
        for (const Index n : edge[0].node) branches[static_cast<std::size_t>(n)] = true;
        if (2 * static_cast<std::size_t>(std::ranges::count_if(edge, &Side::rises)) == edge.size()) {
            if (for_each_solid(surface, edge, join))
                add_fault(report, doubled_volumes, edge[0].triangle(), (a + b) / 2);
            return;
        }
        for (const Side& side : edge) join(edge[0], side);
        unbalanced.push_back(edge[0]);
    });
    if (edges > 0) report.mean_edge /= edges;

    report.shell.resize(count);
    for (std::size_t t = 0; t < count; ++t) {
        report.shell[t] = parts.number(static_cast<Index>(t));
        const auto row = static_cast<std::size_t>(report.shell[t]);
        if (row == report.shells.size()) report.shells.push_back({.triangle = report.number[t], .closed = true});
        ++report.shells[row].triangles;
    }
    const auto open_shell = [&](Index triangle) {
        report.shells[static_cast<std::size_t>(report.shell[static_cast<std::size_t>(triangle)])].closed = false;
    };
    for (const Side& side : open) open_shell(side.triangle());
    for (const Side& side : unbalanced) open_shell(side.triangle());
    for (const Index t : one_sided) {
        open_shell(t);
        add_fault(report, one_sided_shells, t);
    }
    report_holes(report, open);
    for (const Index corner : further_fans(surface.triangles, fans)) {
        const Index node =
            surface.triangles[static_cast<std::size_t>(corner / 3)][static_cast<std::size_t>(corner % 3)];
        if (!branches[static_cast<std::size_t>(node)])
            add_fault(report, pinched_nodes, corner / 3, surface.nodes[static_cast<std::size_t>(node)]);
    }
}

}  // namespace skerry::mesh
