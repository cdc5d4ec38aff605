#include "engine/mesh/surface/add_fault.h"

#include "engine/mesh/repair/surface_measures.h"

namespace skerry::mesh {

SurfaceFault& add_fault(SurfaceReport& report, SurfaceFaultKind kind, Index triangle, const Vec3& position,
                        Index other) {
    std::size_t row = 0;
    while (row < report.faults.size() && report.faults[row].kind < kind) ++row;
    if (row == report.faults.size() || report.faults[row].kind != kind) {
        const auto number_of = [&](Index t) {
            return t == no_index ? no_index : report.number[static_cast<std::size_t>(t)];
        };
        report.faults.insert(
            report.faults.begin() + static_cast<std::ptrdiff_t>(row),
            {.kind = kind, .count = 0, .triangle = number_of(triangle), .other = number_of(other), .place = position});
    }
    ++report.faults[row].count;
    return report.faults[row];
}

SurfaceFault& add_fault(SurfaceReport& report, SurfaceFaultKind kind, Index triangle, Index other) {
    const auto [a, b, c] = corners_of(report.cleaned, triangle);
    return add_fault(report, kind, triangle, (a + b + c) / 3, other);
}

}  // namespace skerry::mesh
