#include "engine/scene/make_mesh.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "engine/base/complaint.h"
#include "engine/mesh/surface/check_shells.h"
#include "engine/scene/mesh_levels.h"

namespace skerry {

namespace {

/// Number of cells of a shape after `refine` doublings, or after -refine halvings if `refine` is negative.
int refined(int cells, int refine) {
    return refine >= 0 ? cells << refine : cells >> -refine;
}

/// Number of elements across a round shape after refinement. Odd numbers are first rounded up to even ones, as in the
/// functions that make round meshes.
int refined_resolution(int resolution, int refine) {
    return refine == 0 ? resolution : refined(resolution + resolution % 2, refine);
}

/// Fills the surface in a file, or the surface of the mesh in a file, with tetrahedra in the length unit of the file.
/// The edges are 2^doublings times `edge`, which must be given if `doublings` is positive.
Mesh fill_file(const std::filesystem::path& file, std::optional<Real> edge, int doublings, const MeshEntry& entry,
               std::vector<std::string>& notes, const SurfaceFilling& filling) {
    mesh::FillSettings settings{.edge = edge, .cavities = entry.cavities, .python = filling.python};
    settings.tolerance = entry.tolerance.value_or(settings.tolerance);
    if (doublings > 0) {
        settings.edge = std::ldexp(*edge, doublings);
        // Largest tolerance of a coarser filling, as a fraction of the diagonal of the bounding box. The tolerance is
        // scaled with the square of the edge length, because the distance between flat triangles and a curved surface
        // grows with this square.
        constexpr Real most = 0.1;
        settings.tolerance =
            std::min(std::ldexp(settings.tolerance, 2 * doublings), std::max(settings.tolerance, most));
    }
    std::vector<std::string> of_filling;
    Mesh mesh = mesh::fill_cached(file, settings, filling.progress, &of_filling);
    if (entry.scale != 1)
        std::erase_if(of_filling, [](const std::string& note) { return note.ends_with(mesh::other_unit); });
    notes.insert(notes.end(), of_filling.begin(), of_filling.end());
    return mesh;
}

/// Returns the mesh of a file, or fills the surface of a file with tetrahedra, in the length unit of the file. If
/// `refine` is negative, the mesh is made coarser by a new filling. Positive refinement is left to make_mesh().
Mesh make_from_file(const MeshEntry& entry, bool rigid, std::vector<std::string>& notes,
                    const SurfaceFilling& filling) {
    // The edge length is converted to the unit of the file. Surfaces are filled in this unit and scaled afterwards, so
    // that scenes with different scales share the mesh in the cache.
    std::optional<Real> edge;
    if (entry.edge) edge = *entry.edge / entry.scale;
    const std::filesystem::path& file = (entry.file ? entry.file : entry.surface)->path;
    const auto unrefined = [&](std::vector<std::string>& remarks) {
        if (entry.surface) return fill_file(file, edge, 0, entry, remarks, filling);
        return rigid ? mesh::read_rigid(file.string(), &remarks) : mesh::read(file.string(), &remarks);
    };
    if (entry.refine >= 0) return unrefined(notes);
    std::vector<std::string> not_of_this_mesh;
    if (!edge) edge = inspect(unrefined(not_of_this_mesh)).mean_edge;
    Mesh mesh = fill_file(file, edge, -entry.refine, entry, notes, filling);
    const Real wanted = std::ldexp(*edge, -entry.refine), mean = inspect(mesh).mean_edge;
    constexpr Real least_ratio = 0.7;
    if (mean < least_ratio * wanted)
        refuse_in(file.string(), "mesh", "refine",
                  "a mesh with a mean edge of " + short_text(mean) + " for the value " + std::to_string(entry.refine),
                  "a mean edge of about " + short_text(wanted), "larger triangles would be too far from the surface");
    return mesh;
}

Mesh make_shape(const MeshEntry& entry, bool rigid, std::vector<std::string>& notes, const SurfaceFilling& filling) {
    if (entry.file || entry.surface) return make_from_file(entry, rigid, notes, filling);
    const int refine = entry.refine;
    if (entry.box) {
        std::array<int, 3> cells = entry.box->cells;
        for (int& count : cells) count = refined(count, refine);
        return mesh::box(entry.box->size, cells);
    }
    if (entry.ball) return mesh::ball(entry.ball->radius, refined_resolution(entry.ball->resolution, refine));
    if (entry.cylinder)
        return mesh::cylinder(entry.cylinder->radius, entry.cylinder->height,
                              refined_resolution(entry.cylinder->resolution, refine));
    if (entry.lathe) return mesh::lathe(entry.lathe->profile, refined_resolution(entry.lathe->resolution, refine));
    if (entry.skittle)
        return mesh::skittle(entry.skittle->height, refined_resolution(entry.skittle->resolution, refine));
    mesh::TableShape table = *entry.table;
    if (refine < 0) table.cells_per_leg = refined(table.cells_per_leg, refine);
    return mesh::table(table);
}

}  // namespace

PlannedMesh make_mesh(const MeshEntry& entry, bool rigid, std::vector<std::string>& notes,
                      const SurfaceFilling& filling) {
    return called_at(entry.place, [&] {
        PlannedMesh mesh{make_shape(entry, rigid, notes, filling)};
        if (entry.file || entry.surface || entry.table)
            for (int n = 0; n < entry.refine; ++n) mesh.subdivisions.push_back(mesh::subdivide(mesh));
        for (Vec3& node : mesh.nodes) node *= entry.scale;
        return mesh;
    });
}

SurfaceMesh make_surface(const MeshEntry& entry, std::vector<std::string>& notes, const SurfaceFilling& filling) {
    if (!entry.file) return mesh::boundary(make_mesh(entry, false, notes, filling));
    return called_at(entry.place, [&] {
        SurfaceMesh surface = mesh::read_surface(entry.file->path.string(), &notes);
        Mesh mesh{.nodes = std::move(surface.nodes), .tetrahedra = {}, .triangles = std::move(surface.triangles)};
        for (int n = 0; n < entry.refine; ++n) mesh::subdivide(mesh);
        for (Vec3& node : mesh.nodes) node *= entry.scale;
        return SurfaceMesh{std::move(mesh.nodes), std::move(mesh.triangles)};
    });
}

}  // namespace skerry
