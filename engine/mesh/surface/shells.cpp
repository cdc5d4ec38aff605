#include "engine/mesh/surface/shells.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <map>
#include <optional>
#include <utility>

#include "engine/mesh/repair/surface_measures.h"
#include "engine/mesh/repair/triangle_tree.h"
#include "engine/mesh/surface/add_fault.h"
#include "engine/mesh/surface/connect.h"
#include "engine/mesh/surface/triangle_boxes.h"
#include "systems/collision/tree/box.h"
#include "systems/collision/tree/box_tree.h"

namespace skerry::mesh {
namespace {

struct ShellSize {
    Aabb box = empty_box();      // [m]
    Real area = 0;               // [m^2]
    Real volume = 0;             // [m^3]
    Vec3 origin = Vec3::Zero();  // a corner, from which volumes are measured [m]

    Real diagonal() const { return (box.upper - box.lower).norm(); }
};

std::vector<ShellSize> sizes_of(const SurfaceReport& report) {
    std::vector<ShellSize> sizes(report.shells.size());
    for (std::size_t t = 0; t < report.shell.size(); ++t) {
        ShellSize& size = sizes[static_cast<std::size_t>(report.shell[t])];
        std::array<Vec3, 3> x = corners_of(report.cleaned, static_cast<Index>(t));
        if (size.box.lower.x() > size.box.upper.x()) size.origin = x[0];
        for (Vec3& corner : x) {
            grow(size.box, corner);
            corner -= size.origin;
        }
        size.area += (x[1] - x[0]).cross(x[2] - x[0]).norm() / 2;
        size.volume += x[0].dot(x[1].cross(x[2])) / 6;
    }
    return sizes;
}

/// For each shell: indices of its triangles in report.cleaned.triangles.
std::vector<std::vector<Index>> rows_of_shells(const SurfaceReport& report) {
    std::vector<std::vector<Index>> rows(report.shells.size());
    for (std::size_t t = 0; t < report.shell.size(); ++t)
        rows[static_cast<std::size_t>(report.shell[t])].push_back(static_cast<Index>(t));
    return rows;
}

/// The given triangles as a surface in which triangles share no nodes.
SurfaceMesh part_of(const SurfaceMesh& surface, std::span<const Index> rows) {
    SurfaceMesh part;
    for (const Index t : rows) {
        const auto first = static_cast<Index>(part.nodes.size());
        for (const Vec3& x : corners_of(surface, t)) part.nodes.push_back(x);
        part.triangles.push_back({first, first + 1, first + 2});
    }
    return part;
}

/// Returns the largest distance of the nodes of the second shell from the first one, or nullopt if the second shell
/// does not repeat the first one within `distance` [m]. Unless `keep_walls`, the limit for shells of the same
/// orientation is larger: see `relative_limit`.
std::optional<Real> repeats(const SurfaceReport& report, std::span<const ShellSize> sizes,
                            std::span<const std::vector<Index>> rows, std::size_t first, std::size_t second,
                            Real distance, bool keep_walls) {
    // Upper limit of the distance between two shells of the same orientation, divided by their diagonal, at which they
    // count as one. The narrow space between them is hardly meant as a region.
    constexpr Real relative_limit = 1e-3;
    const ShellSize &a = sizes[first], &b = sizes[second];
    const bool closed = report.shells[first].closed;
    const bool alike = closed == report.shells[second].closed && (!closed || (a.volume > 0) == (b.volume > 0));
    const Real limit = std::max(distance, alike && !keep_walls ? relative_limit * a.diagonal() : 0);
    if ((a.box.lower - b.box.lower).norm() > 2 * limit || (a.box.upper - b.box.upper).norm() > 2 * limit ||
        std::abs(a.area - b.area) > 10 * relative_limit * a.area)
        return {};
    const SurfaceMesh part = part_of(report.cleaned, rows[second]);
    const TriangleTree tree(part_of(report.cleaned, rows[first]));
    Real greatest = 0;
    for (const Vec3& x : part.nodes) {
        greatest = std::max(greatest, tree.distance_squared(x, 2 * limit * limit));
        if (greatest > limit * limit) return {};
    }
    return std::sqrt(greatest);
}

/// Returns 1 or -1: the side of the line from `p` to `q` on which `x` lies, seen along the x axis. A point on the line
/// counts as lying on one fixed side of it for both triangles at the edge, so that exactly one of them contains the
/// point.
int side_of(const Vec3& x, const Vec3& p, const Vec3& q) {
    const bool swapped = q.z() < p.z() || (q.z() == p.z() && q.y() < p.y());
    const Vec3 &a = swapped ? q : p, &b = swapped ? p : q;
    const bool left = (b.y() - a.y()) * (x.z() - a.z()) - (b.z() - a.z()) * (x.y() - a.y()) >= 0;
    return left == swapped ? -1 : 1;
}

/// Finds the closed shells that contain a point. It counts the triangles that a ray from the point along the x axis
/// crosses.
class ContainingShells {
public:
    explicit ContainingShells(const SurfaceReport& report, std::span<const ShellSize> sizes)
        : report_(report), winding_(sizes.size(), 0) {
        std::vector<Aabb> boxes;
        for (std::size_t s = 0; s < sizes.size(); ++s)
            boxes.push_back(report.shells[s].closed ? sizes[s].box : empty_box());
        shells_ = BoxTree(boxes);
        triangles_ = BoxTree(triangle_boxes(report.cleaned, 0));
    }

    /// Returns the closed shells with a winding number other than 0 around the point `x`, except shell `own`, in
    /// ascending order. Only triangles on the ray from the point in the direction +x are counted.
    std::vector<Index> around(const Vec3& x, Index own) {
        const auto on_ray = [&](const Aabb& box) {
            return box.lower.y() <= x.y() && x.y() <= box.upper.y() && box.lower.z() <= x.z() &&
                   x.z() <= box.upper.z() && x.x() <= box.upper.x();
        };
        std::vector<Index> found;
        shells_.for_each([&](const Aabb& box) { return on_ray(box) && box.lower.x() <= x.x(); },
                         [&](Index shell) {
                             if (shell != own) found.push_back(shell);
                         });
        if (found.empty()) return found;
        triangles_.for_each(on_ray, [&](Index t) {
            const auto [p, q, r] = corners_of(report_.cleaned, t);
            const int side = side_of(x, p, q);
            if (side_of(x, q, r) != side || side_of(x, r, p) != side) return;
            const Vec3 across = (q - p).cross(r - p);
            if (across.dot(p - x) * across.x() <= 0) return;
            const Index shell = report_.shell[static_cast<std::size_t>(t)];
            winding_[static_cast<std::size_t>(shell)] += side;
            passed_.push_back(shell);
        });
        std::erase_if(found, [&](Index shell) { return winding_[static_cast<std::size_t>(shell)] == 0; });
        for (const Index shell : passed_) winding_[static_cast<std::size_t>(shell)] = 0;
        passed_.clear();
        std::ranges::sort(found);
        return found;
    }

private:
    const SurfaceReport& report_;
    BoxTree shells_, triangles_;
    std::vector<int> winding_;   // winding number of each shell around the present point; 0 between calls of around()
    std::vector<Index> passed_;  // shells whose triangles the ray of the present point crosses
};

/// Triangles of one shell for which the points just inside the shell lie in the same other shells; given by their
/// number `count` and the first of them. The key of SurroundedTriangles is the shell and the list of these other
/// shells.
struct Surrounded {
    std::size_t count = 0;
    Index first = no_index;
};
using SurroundedTriangles = std::map<std::pair<Index, std::vector<Index>>, Surrounded>;

SurroundedTriangles surrounded_triangles(const SurfaceReport& report, std::span<const ShellSize> sizes) {
    constexpr Real depth = 1e-6;  // depth of test points behind the triangles, divided by the diagonal of the surface
    const Real below = depth * (report.upper - report.lower).norm();
    ContainingShells containing(report, sizes);
    SurroundedTriangles found;
    for (std::size_t t = 0; t < report.shell.size(); ++t) {
        const auto own = static_cast<std::size_t>(report.shell[t]);
        if (!report.shells[own].closed) continue;
        const auto [a, b, c] = corners_of(report.cleaned, static_cast<Index>(t));
        const Vec3 outward = std::copysign(Real(1), sizes[own].volume) * (b - a).cross(c - a).normalized();
        if (outward.isZero()) continue;
        Surrounded& group =
            found[{static_cast<Index>(own),
                   containing.around(0.41 * a + 0.35 * b + 0.24 * c - below * outward, static_cast<Index>(own))}];
        if (group.count++ == 0) group.first = static_cast<Index>(t);
    }
    return found;
}

/// Sets `around` of each shell to the smallest shell of larger volume that contains all of its triangles.
void nest(SurfaceReport& report, const SurroundedTriangles& surrounded) {
    // key (a, b): number of triangles of shell a that lie in shell b
    std::map<std::pair<Index, Index>, std::size_t> inside;
    for (const auto& [key, group] : surrounded)
        for (const Index other : key.second) inside[{key.first, other}] += group.count;
    for (const auto& [pair, count] : inside) {
        SurfaceShell& shell = report.shells[static_cast<std::size_t>(pair.first)];
        const auto size_of = [&](Index s) { return std::abs(report.shells[static_cast<std::size_t>(s)].volume); };
        if (count == shell.triangles && size_of(pair.second) > size_of(pair.first) &&
            (shell.around == no_index || size_of(pair.second) < size_of(shell.around)))
            shell.around = pair.second;
    }
}

/// Reverses the triangles of each outermost shell of negative volume, and those of the shells inside it.
void reverse_negative_shells(SurfaceReport& report) {
    std::vector<bool> reversed(report.shells.size(), false);
    for (std::size_t s = 0; s < reversed.size(); ++s) {
        std::size_t outermost = s;
        while (report.shells[outermost].around != no_index)
            outermost = static_cast<std::size_t>(report.shells[outermost].around);
        reversed[s] = report.shells[outermost].volume < 0;
    }
    if (std::ranges::count(reversed, true) == 0) return;
    for (std::size_t t = 0; t < report.shell.size(); ++t) {
        const auto own = static_cast<std::size_t>(report.shell[t]);
        SurfaceShell& shell = report.shells[own];
        if (!reversed[own]) continue;
        if (report.number[t] == shell.triangle && shell.around == no_index)
            add_fault(report, SurfaceFaultKind::inside_out_shells, static_cast<Index>(t));
        std::swap(report.cleaned.triangles[t][1], report.cleaned.triangles[t][2]);
    }
    for (std::size_t s = 0; s < reversed.size(); ++s)
        if (reversed[s]) report.shells[s].volume *= -1;
}

}  // namespace

bool drop_repeated_shells(SurfaceReport& report, Real distance, bool keep_walls) {
    const std::vector<ShellSize> sizes = sizes_of(report);
    const std::vector<std::vector<Index>> rows = rows_of_shells(report);
    std::vector<Aabb> boxes;
    for (const ShellSize& size : sizes)
        boxes.push_back({size.box.lower.array() - distance, size.box.upper.array() + distance});
    const BoxTree tree(boxes);
    std::vector<bool> dropped(sizes.size(), false);
    for (std::size_t s = 0; s < sizes.size(); ++s) {
        std::size_t repeated = s;       // first shell that this one repeats
        Real distance_to_repeated = 0;  // [m]
        tree.for_each_overlap(boxes[s], [&](Index other) {
            const auto row = static_cast<std::size_t>(other);
            if (row >= repeated || dropped[row]) return;
            if (const std::optional<Real> found = repeats(report, sizes, rows, row, s, distance, keep_walls)) {
                repeated = row;
                distance_to_repeated = *found;
            }
        });
        dropped[s] = repeated < s;
        if (!dropped[s]) continue;
        SurfaceFault& fault =
            add_fault(report, SurfaceFaultKind::duplicate_shells, rows[s].front(), rows[repeated].front());
        fault.length = std::max(fault.length, distance_to_repeated);
    }
    if (std::ranges::count(dropped, true) == 0) return false;
    keep_triangles(report, [&](std::size_t t) { return !dropped[static_cast<std::size_t>(report.shell[t])]; });
    return true;
}

void compare_shells(SurfaceReport& report) {
    const std::vector<ShellSize> sizes = sizes_of(report);
    std::vector<bool> seen(report.shells.size(), false);
    for (std::size_t t = 0; t < report.shell.size(); ++t) {
        const auto own = static_cast<std::size_t>(report.shell[t]);
        SurfaceShell& shell = report.shells[own];
        if (seen[own] || !shell.closed) continue;
        seen[own] = true;
        constexpr Real flat = 1e-12;  // largest volume that is a rounding error, divided by size^3
        const Real size = (sizes[own].box.upper - sizes[own].box.lower).maxCoeff();
        shell.volume = sizes[own].volume;
        if (std::abs(shell.volume) <= flat * size * size * size)
            add_fault(report, SurfaceFaultKind::flat_shells, static_cast<Index>(t));
    }
    SurroundedTriangles surrounded;
    if (std::ranges::count(report.shells, true, &SurfaceShell::closed) > 1)
        surrounded = surrounded_triangles(report, sizes);
    nest(report, surrounded);
    reverse_negative_shells(report);
    const auto sign_of = [&](Index shell) {
        return report.shells[static_cast<std::size_t>(shell)].volume > 0 ? 1 : -1;
    };
    for (const auto& [key, group] : surrounded) {
        // Number of solids minus number of voids at the points just inside these triangles. `key`: the shell of the
        // triangles, and all other shells that contain these points. Shells of negative volume bound voids.
        int volumes = sign_of(key.first);
        for (const Index other : key.second) volumes += sign_of(other);
        if (volumes > 1 || (volumes < 0 && !key.second.empty()))
            add_fault(report, SurfaceFaultKind::doubled_volumes, group.first).count += group.count - 1;
    }
    for (const SurfaceShell& shell : report.shells)
        if (shell.around == no_index || sign_of(shell.around) != (shell.volume > 0 ? 1 : -1))
            report.volume += shell.volume;
    for (const ShellSize& size : sizes) report.area += size.area;
}

}  // namespace skerry::mesh
