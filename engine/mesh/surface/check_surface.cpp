#include <algorithm>
#include <numeric>
#include <span>
#include <utility>

#include "engine/base/complaint.h"
#include "engine/mesh/surface/add_fault.h"
#include "engine/mesh/surface/check_shells.h"
#include "engine/mesh/surface/connect.h"
#include "engine/mesh/surface/crossings.h"
#include "engine/mesh/surface/shells.h"
#include "engine/mesh/tetrahedron.h"
#include "systems/collision/tree/box.h"

namespace skerry {

bool SurfaceReport::can_be_filled() const {
    using enum SurfaceFaultKind;
    constexpr SurfaceFaultKind hindering[] = {holes,     branching_edges, pinched_nodes, one_sided_shells,
                                              crossings, shell_crossings, overlaps,      flat_shells,
                                              slivers};
    return !cleaned.triangles.empty() &&
           std::ranges::none_of(hindering, [&](SurfaceFaultKind kind) { return find(kind) != nullptr; });
}

namespace mesh {
namespace {

void require_surface(const SurfaceMesh& surface, const std::string& name) {
    require_valid({.nodes = surface.nodes, .tetrahedra = {}}, name);
    const auto count = static_cast<Index>(surface.nodes.size());
    for (std::size_t t = 0; t < surface.triangles.size(); ++t)
        for (const Index n : surface.triangles[t])
            if (n < 0 || n >= count)
                refuse_in(name, "triangle " + std::to_string(t), "node", std::to_string(n),
                          "a node index from 0 to " + std::to_string(count - 1));
    if (surface.triangles.empty()) refuse_in(name, {}, {}, "no triangles", "at least one triangle");
}

/// Welds the surface, and reports triangles that are flat afterwards.
void weld_into(SurfaceReport& report, const SurfaceMesh& surface) {
    report.cleaned = surface;
    report.number.resize(surface.triangles.size());
    std::iota(report.number.begin(), report.number.end(), 0);
    std::vector<Index> number;
    SurfaceMesh welded = weld(surface, report.tolerance, &number);
    for (std::size_t t = 0, kept = 0; t < surface.triangles.size(); ++t)
        if (kept < number.size() && number[kept] == static_cast<Index>(t))
            ++kept;
        else
            add_fault(report, SurfaceFaultKind::flat_triangles, static_cast<Index>(t));
    std::vector<bool> used(surface.nodes.size(), false);
    for (const std::array<Index, 3>& triangle : surface.triangles)
        for (const Index n : triangle) used[static_cast<std::size_t>(n)] = true;
    report.merged = static_cast<std::size_t>(std::ranges::count(used, true)) - welded.nodes.size();
    report.cleaned = std::move(welded);
    report.number = std::move(number);
}

/// Reports each shell that occurs twice, which means that every triangle of the shell has a repetition. `repeated_by`:
/// result of drop_duplicates().
void report_repeated_shells(SurfaceReport& report, std::span<const Index> repeated_by) {
    std::vector<std::size_t> repeated(report.shells.size(), 0);
    for (std::size_t t = 0; t < repeated_by.size(); ++t)
        repeated[static_cast<std::size_t>(report.shell[t])] += repeated_by[t] != no_index;
    for (std::size_t t = 0; t < repeated_by.size(); ++t) {
        const auto own = static_cast<std::size_t>(report.shell[t]);
        if (report.number[t] != report.shells[own].triangle || repeated[own] < report.shells[own].triangles) continue;
        const auto row = static_cast<Index>(t);
        SurfaceFault& fault = add_fault(report, SurfaceFaultKind::duplicate_shells, row, row);
        if (fault.count == 1) fault.triangle = repeated_by[t];
    }
}

}  // namespace

SurfaceReport check_shells(const SurfaceMesh& surface, Real tolerance, const std::string& name, bool keep_walls) {
    require_surface(surface, name);
    if (!(tolerance < 1))
        refuse_in(name, {}, "tolerance", short_text(tolerance, 6), "a fraction of the diagonal below 1");
    SurfaceReport report{.nodes = surface.nodes.size(), .triangles = surface.triangles.size()};
    Aabb box = empty_box();
    for (const std::array<Index, 3>& triangle : surface.triangles)
        for (const Index n : triangle) grow(box, surface.nodes[static_cast<std::size_t>(n)]);
    report.lower = box.lower;
    report.upper = box.upper;
    report.tolerance = tolerance * (box.upper - box.lower).norm();
    weld_into(report, surface);
    const std::vector<Index> repeated_by = drop_duplicates(report);
    connect(report);
    report_repeated_shells(report, repeated_by);
    if (drop_repeated_shells(report, rounding_distance(report), keep_walls)) connect(report);
    compare_shells(report);
    return report;
}

namespace {

/// Adds the faults that check_shells does not search for.
SurfaceReport with_crossings(SurfaceReport report) {
    constexpr Real largest = 20, smallest = 1e-6;  // limits of the diagonal of usual bodies [m]
    if (report.cleaned.triangles.empty()) return report;
    find_crossings(report, rounding_distance(report));
    using enum SurfaceFaultKind;
    if (!report.find(crossings) && !report.find(shell_crossings) && !report.find(overlaps)) find_thin_walls(report);
    const Real size = (report.upper - report.lower).norm();
    if (size > largest || size < smallest) add_fault(report, unlikely_size, 0).length = size;
    return report;
}

}  // namespace

SurfaceReport check_surface(const SurfaceMesh& surface, Real tolerance, const std::string& name) {
    return with_crossings(check_shells(surface, tolerance, name));
}

SurfaceReport check_surface_with_walls(const SurfaceMesh& surface, Real tolerance, const std::string& name) {
    return with_crossings(check_shells(surface, tolerance, name, true));
}

std::string fault_text(const SurfaceFault& fault) {
    using enum SurfaceFaultKind;
    struct Noun {
        SurfaceFaultKind kind;
        const char *one, *more;
    };
    constexpr Noun nouns[] = {
        {flat_triangles, "triangle without area", "triangles without area"},
        {duplicate_triangles, "repeated triangle", "repeated triangles"},
        {turned_triangles, "triangle of the opposite orientation", "triangles of the opposite orientation"},
        {inside_out_shells, "shell that is inside out", "shells that are inside out"},
        {duplicate_shells, "repeated shell", "repeated shells"},
        {holes, "hole", "holes"},
        {branching_edges, "edge with more than two triangles", "edges with more than two triangles"},
        {pinched_nodes, "node at which parts of the surface meet without a common edge",
         "nodes at which parts of the surface meet without a common edge"},
        {one_sided_shells, "shell with only one side", "shells with only one side"},
        {crossings, "pair of triangles of one shell that cross", "pairs of triangles of one shell that cross"},
        {shell_crossings, "pair of triangles of two shells that cross", "pairs of triangles of two shells that cross"},
        {overlaps, "pair of triangles that overlap in a plane", "pairs of triangles that overlap in a plane"},
        {flat_shells, "closed shell without volume", "closed shells without volume"},
        {doubled_volumes, "triangle behind which shells enclose the same volume twice",
         "triangles behind which shells enclose the same volume twice"},
        {slivers, "triangle with an altitude of almost 0", "triangles with an altitude of almost 0"},
        {thin_walls, "sampled place with a wall thinner than half the mean edge",
         "sampled places with a wall thinner than half the mean edge"},
    };
    const std::string length = short_text(fault.length, 4);
    if (fault.kind == unlikely_size) return "a size of " + length + " m, " + std::string(other_unit);
    const Noun& noun = *std::ranges::find(nouns, fault.kind, &Noun::kind);
    std::string text = std::to_string(fault.count) + " " + (fault.count == 1 ? noun.one : noun.more);
    if (fault.kind == holes) text += ", the longest " + length + " m around";
    if (fault.kind == duplicate_shells && fault.length > 0) text += ", up to " + length + " m apart";
    if (fault.kind == thin_walls) text += ", down to " + length + " m";
    text += (fault.count > 1 && fault.kind != holes ? ", the first at " : " at ") + short_text(fault.place, 4) +
            " m, triangle " + std::to_string(fault.triangle);
    return fault.other == no_index ? text : text + " and triangle " + std::to_string(fault.other);
}

}  // namespace mesh
}  // namespace skerry
