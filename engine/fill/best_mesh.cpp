#include "engine/fill/best_mesh.h"

#include <cmath>
#include <optional>
#include <utility>

#include "engine/mesh/repair/remove_flat_triangles.h"
#include "engine/mesh/repair/surface_distance.h"
#include "engine/mesh/repair/surface_measures.h"

namespace skerry::mesh {

namespace {

// Triangles of the surface with a lower altitude are removed (remove_flat_triangles). The limit is given as a fraction
// of the mean edge of the surface (measured: docs/decisions/0012).
constexpr Real least_altitude = 0.4;
// Upper limits of the edge length that are tried, as multiples of the wanted edge. Near finer parts of the surface
// Netgen makes smaller tetrahedra.
constexpr Real largest_edges[] = {1.5, 1, 0.7};
// Largest accepted difference between the volume inside a surface and the volume of its tetrahedra, as a fraction of
// the volume inside the surface.
constexpr Real volume_rounding = 1e-6;

/// Appends a region to a mesh. The first nodes of the region are nodes of its boundary, which the mesh already
/// contains: `node_of` gives their indices in the mesh.
void append_region(const Mesh& region, std::vector<Index> node_of, int label, Mesh& mesh) {
    for (std::size_t n = node_of.size(); n < region.nodes.size(); ++n) {
        node_of.push_back(static_cast<Index>(mesh.nodes.size()));
        mesh.nodes.push_back(region.nodes[n]);
    }
    for (const auto& [a, b, c, d] : region.tetrahedra) {
        mesh.tetrahedra.push_back({node_of[static_cast<std::size_t>(a)], node_of[static_cast<std::size_t>(b)],
                                   node_of[static_cast<std::size_t>(c)], node_of[static_cast<std::size_t>(d)]});
        mesh.label.push_back(label);
    }
}

/// Fills each region of the surface. Neighbouring regions share the nodes of the shell that separates them.
MesherResult fill_regions(const Shells& shells, Real largest_edge, const MesherSetup& setup,
                          const std::string& surface_name) {
    MesherResult all{.mesh = Mesh{.nodes = shells.nodes, .tetrahedra = {}}};
    for (std::size_t s = 0; s < shells.shell.size(); ++s) {
        if (shells.shell[s].cavity) continue;
        std::vector<Index> boundary_nodes;
        const SurfaceMesh boundary = without_unused_nodes(boundary_of_region(shells, s), &boundary_nodes);
        MesherResult region = fill_by_netgen(boundary, largest_edge, setup, "filling " + surface_name + " by Netgen");
        if (!region.mesh) return region;
        const Real volume = volume_inside(boundary), filled = inspect(*region.mesh).volume;
        if (std::abs(filled - volume) > volume_rounding * volume)
            return {.failure = "filled a different volume than the surface contains"};
        append_region(*region.mesh, std::move(boundary_nodes), shells.shell[s].label, *all.mesh);
    }
    if (!shells.has_regions()) all.mesh->label.clear();
    return all;
}

/// Fills the surface once for each of the sizes `largest_edges`, and replaces `best` by an acceptable mesh with a
/// longer stable step. The finest size is tried only if no coarser mesh was acceptable.
void try_fill(const SurfaceMesh& surface, const std::string& surface_name, const BestMeshTask& task, BestMesh& best) {
    const Shells shells = shells_of(check_surface(surface, no_weld), task.all_cavities);
    for (const Real size : largest_edges) {
        if (size < 1 && best.step > 0) return;
        MesherResult filled = fill_regions(shells, size * task.edge, task.setup, surface_name);
        if (!filled.mesh) {
            best.failure = "Netgen " + filled.failure;
            best.missing = filled.missing;
            best.may_change = best.may_change || filled.may_change();
            if (filled.missing || filled.stopped) return;
            continue;
        }
        if (static_cast<Real>(filled.mesh->tetrahedra.size()) < task.least_count) {
            best.failure = "every new mesh was too coarse";
            continue;
        }
        const Real step = task.stable_step(*filled.mesh);
        if (!(step > 0)) best.failure = "Netgen made flat tetrahedra";
        if (step > best.step) {
            best.mesh = *std::move(filled.mesh);
            best.step = step;
        }
    }
}

/// Removes very flat triangles from the surface within the tolerance. remove_flat_triangles checks the distance to the
/// old surface at few points only. If a full check then finds a distance above `tolerance`, remove_flat_triangles runs
/// again with a smaller tolerance.
RepairedSurface repaired_within_tolerance(const SurfaceMesh& surface, Real tolerance) {
    constexpr int tries = 4;
    constexpr Real reduction = 0.75;
    Real reduced = tolerance;
    for (int i = 0; i < tries; ++i, reduced *= reduction) {
        RepairedSurface repaired =
            remove_flat_triangles(surface, {.tolerance = reduced, .altitude = least_altitude * mean_edge(surface)});
        if (surface_distance(surface, repaired.surface).greatest() <= tolerance) return repaired;
    }
    return {};
}

}  // namespace

BestMesh best_mesh(const BestMeshTask& task) {
    BestMesh best;
    try_fill(task.surface, "the unchanged surface", task, best);
    if (best.missing || !(task.tolerance > 0)) return best;
    if (task.setup.progress) task.setup.progress("removing very flat triangles from the surface");
    const RepairedSurface repaired = repaired_within_tolerance(task.surface, task.tolerance);
    if (repaired.collapsed + repaired.flipped == 0) return best;
    BestMesh repaired_best;
    try_fill(repaired.surface, "the surface without very flat triangles", task, repaired_best);
    best.may_change = repaired_best.may_change = best.may_change || repaired_best.may_change;
    if (!(repaired_best.step > least_gain * best.step)) return best;
    repaired_best.collapsed = repaired.collapsed;
    repaired_best.flipped = repaired.flipped;
    return repaired_best;
}

}  // namespace skerry::mesh
