#include "engine/program/repair.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <limits>

#include "engine/mesh/manifold_fault.h"
#include "engine/mesh/repair/part_fans.h"
#include "engine/mesh/repair/thin_knots.h"
#include "engine/program/fill_surface.h"
#include "engine/program/number_text.h"
#include "skerry/error.h"
#include "systems/collision/build_surface.h"

namespace skerry {

namespace {

// Least ratio of the new to the old stable step for which the new mesh is written.
constexpr Real least_gain = 1.05;
// Largest altitude of a knot, which is a nearly flat surface triangle, as a fraction of the mean edge of the surface
// (measured: docs/decisions/0012).
constexpr Real knot_altitude = 0.4;
// Least ratio of the new to the old number of tetrahedra. With fewer tetrahedra the mesh would be coarser, not better.
constexpr Real least_count = 0.7;
// Edge lengths of tetrahedra to be tried, as multiples of the mean edge of the old mesh. A finer surface leads to
// smaller tetrahedra.
constexpr Real largest_edges[] = {1.5, 1, 0.7};
// Largest accepted difference between the volume inside a surface and the volume of its tetrahedra, as a fraction of
// the volume inside the surface.
constexpr Real volume_rounding = 1e-6;

using Corners = std::array<Vec3, 3>;

Corners corners(const SurfaceMesh& surface, const std::array<Index, 3>& t) {
    return {surface.nodes[static_cast<std::size_t>(t[0])], surface.nodes[static_cast<std::size_t>(t[1])],
            surface.nodes[static_cast<std::size_t>(t[2])]};
}

/// Computes the volume inside a closed surface by the divergence theorem. Positions are measured from a point of the
/// surface. The rounding error thus depends on the size of the surface and not on its position.
Real volume_inside(const SurfaceMesh& surface) {
    Real volume = 0;
    for (const auto& t : surface.triangles) {
        Corners x = corners(surface, t);
        for (Vec3& corner : x) corner -= surface.nodes.front();
        volume += x[0].dot(x[1].cross(x[2])) / 6;
    }
    return volume;
}

Real mean_edge_of(const SurfaceMesh& surface) {
    Real sum = 0;
    for (const auto& t : surface.triangles) {
        const Corners x = corners(surface, t);
        for (std::size_t a = 0; a < 3; ++a) sum += (x[(a + 1) % 3] - x[a]).norm();
    }
    return sum / static_cast<Real>(3 * surface.triangles.size());
}

/// Returns the stable step of a body with this mesh [s], or 0 if the mesh is not valid for a body.
Real step_of(const Mesh& mesh, const MeshReport& report, const StepCase& of) {
    return report.tetrahedra > 0 && report.inverted + report.flat == 0 ? step_bound(mesh, of, false).step : 0;
}

MeshFigures figures_of(const Mesh& mesh, const SurfaceMesh& surface, const StepCase& of) {
    MeshFigures figures{.mesh = inspect(mesh), .surface_area = area_of(surface), .step = 0};
    figures.step = step_of(mesh, figures.mesh, of);
    return figures;
}

/// A new mesh for the body, and the numbers of surface edges that were collapsed and flipped.
struct Candidate {
    Mesh mesh;
    SurfaceMesh surface;
    MeshFigures figures;  // properties of the new mesh; a step of 0 means that no mesh was found
    std::size_t collapsed = 0, flipped = 0;
};

class Repair {
public:
    Repair(const Mesh& mesh, const std::string& what, const StepCase& of, Real tolerance,
           const std::function<void(const std::string&)>& progress)
        : parted_(mesh::part_fans(mesh)), mesh_(parted_.mesh), of_(of), progress_(progress) {
        const std::string fault = mesh::manifold_fault(boundary_triangles(mesh_.tetrahedra));
        if (!fault.empty())
            Complaint{what,
                      "boundary",
                      {},
                      fault,
                      "a closed manifold: two triangles at each edge",
                      parted_.parted > 0 || fault.find("triangles") != std::string::npos
                          ? "separate tetrahedra that share only an edge: delete the tetrahedra on one side of the "
                            "edge, or give them their own copies of its two nodes"
                          : ""}
                .raise();
        if (parted_.parts > 1)
            Complaint{what,
                      "tetrahedra",
                      {},
                      std::to_string(parted_.parts) + " parts without common faces",
                      "one part, in which common faces connect all tetrahedra",
                      "save each part as a separate mesh and repair the meshes one by one"}
                .raise();
        surface_ = mesh::boundary(mesh_);
        result_.before = figures_of(mesh, surface_, of);
        result_.parted = parted_.parted;
        const MeshReport& report = result_.before.mesh;
        if (report.labels.size() > 1)
            Complaint{what,
                      "tetrahedra",
                      "label",
                      std::to_string(report.labels.size()) + " different labels",
                      "one label, because all tetrahedra are replaced and the boundary between materials would be lost",
                      "save the tetrahedra of each label as a separate mesh and repair the meshes one by one"}
                .raise();
        result_.tolerance = tolerance * (report.upper - report.lower).norm();
    }

    RepairedMesh run() {
        Candidate best;
        try_fill(surface_, "the unchanged surface", best);
        if (result_.tolerance > 0) {
            progress_("removing very flat triangles from the surface");
            const mesh::ThinnedSurface thinned = thinned_within_tolerance();
            if (thinned.collapsed + thinned.flipped > 0) {
                Candidate other;
                try_fill(thinned.surface, "the surface without very flat triangles", other);
                other.collapsed = thinned.collapsed;
                other.flipped = thinned.flipped;
                if (other.figures.step > least_gain * best.figures.step) best = std::move(other);
            }
        }
        take(std::move(best));
        return std::move(result_);
    }

private:
    /// Removes knots from the surface within the tolerance. thin_knots checks the distance to the old surface at few
    /// points only. If a full check then finds a larger distance, the thinning is repeated with a smaller tolerance.
    mesh::ThinnedSurface thinned_within_tolerance() const {
        constexpr int tries = 4;
        constexpr Real less = 0.75;
        Real tolerance = result_.tolerance;
        for (int i = 0; i < tries; ++i, tolerance *= less) {
            mesh::ThinnedSurface thinned = mesh::thin_knots(
                surface_, {.tolerance = tolerance, .altitude = knot_altitude * mean_edge_of(surface_)});
            if (mesh::surface_distance(surface_, thinned.surface).greatest() <= result_.tolerance) return thinned;
        }
        return {};
    }

    /// Fills the surface with tetrahedra of several sizes, and sets `best` to the acceptable mesh with the longest
    /// step. The finest size is tried only if no coarser mesh was acceptable.
    void try_fill(const SurfaceMesh& surface, const std::string& which, Candidate& best) {
        const Real volume = volume_inside(surface);
        for (const Real size : largest_edges) {
            if (size < 1 && best.figures.step > 0) return;
            const Mesh filled =
                fill_surface(surface, size * result_.before.mesh.mean_edge, [&] { progress_("filling " + which); });
            if (filled.tetrahedra.empty()) continue;
            filled_once_ = true;
            if (static_cast<Real>(filled.tetrahedra.size()) < least_count * static_cast<Real>(mesh_.tetrahedra.size()))
                continue;
            const SurfaceMesh boundary = mesh::boundary(filled);
            const MeshFigures figures = figures_of(filled, boundary, of_);
            if (std::abs(figures.mesh.volume - volume) <= volume_rounding * volume && figures.step > best.figures.step)
                best = {filled, boundary, figures, 0, 0};
        }
    }

    void take(Candidate best) {
        result_.mesh = std::move(best.mesh);
        if (const auto& labels = result_.before.mesh.labels; !labels.empty())
            result_.mesh.label.assign(result_.mesh.tetrahedra.size(), labels.begin()->first);
        result_.after = best.figures;
        result_.collapsed = best.collapsed;
        result_.flipped = best.flipped;
        judge(best.surface);
        if (result_.refusal.empty() || parted_.parted == 0) return;
        result_.kept = std::move(result_.refusal);
        result_.refusal.clear();
        result_.mesh = mesh_;
        result_.after = figures_of(mesh_, surface_, of_);
        result_.distance = {};
        result_.collapsed = result_.flipped = 0;
    }

    /// Sets result_.refusal to a reason if the new mesh is not good enough to be written.
    void judge(const SurfaceMesh& surface) {
        if (result_.mesh.tetrahedra.empty() || !(result_.after.step > 0)) {
            result_.refusal =
                filled_once_
                    ? "every new mesh was too coarse or had a different volume"
                    : "Netgen could not fill the surface with tetrahedra; check whether the surface intersects itself";
            return;
        }
        progress_("measuring the movement of the surface");
        result_.distance = mesh::surface_distance(surface_, surface);
        // With a tolerance of 0 the surfaces must agree except for rounding errors.
        const Real rounding = 1e-9 * (result_.before.mesh.upper - result_.before.mesh.lower).norm();
        if (result_.distance.greatest() > std::max(result_.tolerance, rounding))
            result_.refusal = "the surface would move by " + with_unit(result_.distance.greatest(), "m") +
                              ", more than the tolerance of " + with_unit(result_.tolerance, "m") +
                              "; try a larger --tolerance";
        else if (!(result_.after.step > least_gain * result_.before.step))
            result_.refusal =
                "no new mesh has a stable step that is at least 5 % longer: " + with_unit(result_.before.step, "s") +
                " for the old mesh, " + with_unit(result_.after.step, "s") + " for the best new mesh";
    }

    mesh::PartedMesh parted_;
    const Mesh& mesh_;  // refers to parted_.mesh
    const StepCase& of_;
    const std::function<void(const std::string&)>& progress_;
    SurfaceMesh surface_;
    RepairedMesh result_;
    bool filled_once_ = false;
};

}  // namespace

Real area_of(const SurfaceMesh& surface) {
    Real area = 0;
    for (const auto& t : surface.triangles) {
        const Corners x = corners(surface, t);
        area += (x[1] - x[0]).cross(x[2] - x[0]).norm() / 2;
    }
    return area;
}

RepairedMesh repair(const Mesh& mesh, const std::string& what, const StepCase& of, Real tolerance,
                    const std::function<void(const std::string&)>& progress) {
    return Repair(mesh, what, of, tolerance, progress).run();
}

}  // namespace skerry
