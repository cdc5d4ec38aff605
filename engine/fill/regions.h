// Shells, the connected parts of a surface, and the regions that they bound.
#pragma once

#include <array>
#include <cstddef>
#include <vector>

#include "skerry/surface_check.h"

namespace skerry::mesh {

/// A connected part of a surface.
struct Shell {
    // Indices of nodes, counter-clockwise as seen from outside the shell, also for a cavity.
    std::vector<std::array<Index, 3>> triangles;
    Real volume = 0;                  // volume inside the shell, including the shells inside it [m^3]
    Index parent = no_index;          // index in Shells of the smallest shell around this shell; no_index: none
    bool cavity = false;              // true: the inside is empty, except for shells inside it
    int label = 0;                    // label of the region inside the shell; 0 for a cavity
    Index first_triangle = no_index;  // index in the given surface of the first triangle of the shell
};

/// A surface that is divided into shells, the largest volume first.
struct Shells {
    std::vector<Vec3> nodes;
    std::vector<Shell> shell;

    /// True if the regions need labels, because a region lies inside another shell.
    bool has_regions() const;
    std::size_t cavity_count() const;
};

/// Divides the cleaned surface of a report into shells (triangles connected by common edges). A shell inside an odd
/// number of others is a cavity if `all_cavities` is true, or if its triangles are clockwise as seen from outside. The
/// other shells bound regions with the labels 1, 2, ...
Shells shells_of(const SurfaceReport& report, bool all_cavities);

/// Returns the triangles of all shells. Those of cavities are turned inside out, so that the winding number is 0 inside
/// a cavity.
SurfaceMesh whole_surface(const Shells& shells);

/// Boundary of the region inside a shell: the triangles of the shell and, turned inside out, those of the shells
/// directly inside it.
SurfaceMesh boundary_of_region(const Shells& shells, std::size_t shell);

/// Returns the surface without the nodes that no triangle uses. `kept_nodes`, if given, gets the index in `surface` of
/// each remaining node.
SurfaceMesh without_unused_nodes(const SurfaceMesh& surface, std::vector<Index>* kept_nodes = nullptr);

/// Gives each tetrahedron the label of the smallest shell around its centroid. Shells of cavities are ignored.
void label_regions(Mesh& mesh, const Shells& shells);

/// Returns the boundary triangles of a mesh, and the faces between tetrahedra with different labels.
std::vector<std::array<Index, 3>> faces_of_regions(const Mesh& mesh);

/// Divides the faces of regions among the shells: each face belongs to the shell that is nearest to its centroid.
std::vector<std::vector<std::array<Index, 3>>> faces_of_shells(const Mesh& mesh, const Shells& shells);

}  // namespace skerry::mesh
