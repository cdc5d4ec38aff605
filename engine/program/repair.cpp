#include "engine/program/repair.h"

#include <algorithm>
#include <utility>

#include "engine/base/complaint.h"
#include "engine/fill/best_mesh.h"
#include "engine/mesh/manifold_fault.h"
#include "engine/mesh/repair/part_fans.h"
#include "engine/mesh/repair/surface_distance.h"
#include "engine/mesh/repair/surface_measures.h"
#include "engine/output/number_text.h"
#include "systems/collision/build_surface.h"

namespace skerry {

namespace {

// Lower limit of the new number of tetrahedra, divided by the old number. A mesh with fewer tetrahedra could allow
// longer steps only because it is coarser.
constexpr Real least_count = 0.7;

/// Returns the stable step of a body with this mesh [s], or 0 if the mesh is not valid for a body.
Real step_of(const Mesh& mesh, const MeshReport& report, const BodyCase& body_case) {
    return report.tetrahedra > 0 && report.inverted + report.flat == 0 ? step_bound(mesh, body_case, false).step : 0;
}

MeshFigures figures_of(const Mesh& mesh, const SurfaceMesh& surface, const BodyCase& body_case) {
    MeshFigures figures{.mesh = inspect(mesh), .surface_area = mesh::area_of(surface), .step = 0};
    figures.step = step_of(mesh, figures.mesh, body_case);
    return figures;
}

class Repair {
public:
    Repair(const Mesh& mesh, const std::string& name, const BodyCase& body_case, Real tolerance,
           const std::function<void(const std::string&)>& progress)
        : parted_(mesh::part_fans(mesh)), mesh_(parted_.mesh), body_case_(body_case), progress_(progress) {
        const std::string fault = mesh::manifold_fault(boundary_triangles(mesh_.tetrahedra));
        if (!fault.empty())
            refuse_in(name, "boundary", {}, fault, "a closed manifold: two triangles at each edge",
                      parted_.parted > 0 || fault.find("triangles") != std::string::npos
                          ? "separate tetrahedra that share only an edge: delete the tetrahedra on one side of the "
                            "edge, or give them their own copies of its two nodes"
                          : "");
        if (parted_.parts > 1)
            refuse_in(name, "tetrahedra", {}, std::to_string(parted_.parts) + " parts without common faces",
                      "one part, in which common faces connect all tetrahedra",
                      "save each part as a separate mesh and repair the meshes one by one");
        surface_ = mesh::boundary(mesh_);
        result_.before = figures_of(mesh, surface_, body_case);
        result_.parted = parted_.parted;
        const MeshReport& report = result_.before.mesh;
        if (report.labels.size() > 1)
            refuse_in(name, "tetrahedra", "label", std::to_string(report.labels.size()) + " different labels",
                      "one label, because all tetrahedra are replaced and the boundary between materials would be lost",
                      "save the tetrahedra of each label as a separate mesh and repair the meshes one by one");
        result_.tolerance = tolerance * (report.upper - report.lower).norm();
    }

    RepairedMesh run() {
        mesh::BestMesh best = mesh::best_mesh(
            {.surface = surface_,
             .edge = result_.before.mesh.mean_edge,
             .tolerance = result_.tolerance,
             .least_count = least_count * static_cast<Real>(mesh_.tetrahedra.size()),
             .setup = {.progress = progress_},
             .stable_step = [this](const Mesh& mesh) { return step_of(mesh, inspect(mesh), body_case_); }});
        take(std::move(best));
        return std::move(result_);
    }

private:
    void take(mesh::BestMesh best) {
        result_.mesh = std::move(best.mesh);
        if (const auto& labels = result_.before.mesh.labels; !labels.empty())
            result_.mesh.label.assign(result_.mesh.tetrahedra.size(), labels.begin()->first);
        result_.collapsed = best.collapsed;
        result_.flipped = best.flipped;
        if (best.step > 0)
            judge();
        else
            result_.refusal = best.failure + "; check whether the surface intersects itself";
        if (result_.refusal.empty() || parted_.parted == 0) return;
        result_.reason_unchanged = std::move(result_.refusal);
        result_.refusal.clear();
        result_.mesh = mesh_;
        result_.after = figures_of(mesh_, surface_, body_case_);
        result_.distance = {};
        result_.collapsed = result_.flipped = 0;
    }

    /// Sets result_.refusal to a reason if the new mesh is not good enough to be written.
    void judge() {
        const SurfaceMesh surface = mesh::boundary(result_.mesh);
        result_.after = figures_of(result_.mesh, surface, body_case_);
        progress_("measuring the movement of the surface");
        result_.distance = mesh::surface_distance(surface_, surface);
        // With a tolerance of 0 the surfaces must agree except for rounding errors.
        const Real rounding = 1e-9 * (result_.before.mesh.upper - result_.before.mesh.lower).norm();
        if (result_.distance.greatest() > std::max(result_.tolerance, rounding))
            result_.refusal = "the surface would move by " + with_unit(result_.distance.greatest(), "m") +
                              ", more than the tolerance of " + with_unit(result_.tolerance, "m") +
                              "; try a larger --tolerance";
        else if (!(result_.after.step > mesh::least_gain * result_.before.step))
            result_.refusal =
                "no new mesh has a stable step that is at least 5 % longer: " + with_unit(result_.before.step, "s") +
                " for the old mesh, " + with_unit(result_.after.step, "s") + " for the best new mesh";
    }

    mesh::PartedMesh parted_;
    const Mesh& mesh_;  // refers to parted_.mesh
    const BodyCase& body_case_;
    const std::function<void(const std::string&)>& progress_;
    SurfaceMesh surface_;
    RepairedMesh result_;
};

}  // namespace

RepairedMesh repair(const Mesh& mesh, const std::string& name, const BodyCase& body_case, Real tolerance,
                    const std::function<void(const std::string&)>& progress) {
    return Repair(mesh, name, body_case, tolerance, progress).run();
}

}  // namespace skerry
