// Fills triangle surfaces with tetrahedra.
#pragma once

#include <filesystem>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "skerry/mesh.h"
#include "skerry/settings.h"
#include "skerry/surface_check.h"

#pragma GCC visibility push(default)
namespace skerry::mesh {

/// Limits of one run of a mesher.
struct FillLimits {
    Real seconds = 300;  // wall time [s]
    Real bytes = 8e9;    // memory of the mesher and the processes that it started [bytes]
};

/// Settings of fill().
struct FillSettings {
    // Factor for all coordinates of the surfaces, > 0. All other lengths are those after scaling.
    Real scale = 1;
    // Edge length of the new tetrahedra and of their surface, > 0 [m]. If it is not given, the triangles of a clean
    // surface (see fill()) are kept, and other surfaces get edges of a twentieth of the diagonal of their bounding box.
    std::optional<Real> edge{};
    // Largest allowed distance between the given and the new surface, as a fraction of the diagonal of the bounding
    // box, from 0 to below 1. With 0 the triangles of a clean surface are kept, and other surfaces are refused.
    Real tolerance = 1e-3;
    // Meaning of a shell (triangles connected by common edges) that lies inside another shell:
    // - true: it bounds an empty cavity
    // - false: it bounds an empty cavity if its triangles are clockwise as seen from its outside, otherwise a region
    //   with a label of its own
    bool cavities = false;
    MaterialSettings material{};  // material for which the stable steps of the candidate meshes are compared
    FillLimits limits{};          // limits of each run of a mesher
    // Python interpreter with the package wildmeshing. If it is empty: the value of the environment variable
    // SKERRY_FILL_PYTHON, or else python3 in PATH.
    std::string python{};
};

/// Distances between two surfaces, measured from points of one surface to the nearest point of the other [m].
struct SurfaceDistance {
    Real from_first = 0, from_second = 0;            // largest distance from first to second, and back
    Real mean_from_first = 0, mean_from_second = 0;  // mean distance from first to second, and back

    /// The larger one of from_first and from_second.
    Real greatest() const { return from_first > from_second ? from_first : from_second; }
};

/// Result of fill(): the mesh, its distance from the given surface, and notes.
struct FilledMesh {
    Mesh mesh;                   // tetrahedra, with labels of regions and sets of shells; see fill()
    std::string mesher;          // "Netgen", "fTetWild", or "fTetWild and Netgen"
    bool exact = false;          // true if the new surface equals SurfaceReport::cleaned, bitwise
    SurfaceReport surface;       // check of the given surface
    SurfaceDistance distance{};  // distance from SurfaceReport::cleaned (first) to the new surface (second)
    Real tolerance = 0;          // largest distance that was allowed [m]
    // Volume inside the given surface, without cavities [m^3]; empty unless SurfaceReport::can_be_filled() is true.
    std::optional<Real> surface_volume{};
    Real stable_step = 0;            // stable step of an explicit body of this mesh [s]
    std::vector<std::string> notes;  // corrections of the surface, regions, and failures of meshers
    // True if Netgen was missing, crashed or was stopped by a limit, so that a later call may return a better mesh.
    bool may_change = false;
};

/// Function that fill() calls many times a second with a description of its current activity. If the function throws,
/// fill() ends with this exception.
using FillProgress = std::function<void(const std::string&)>;

/// Fills surfaces with tetrahedra. Nodes are first merged as by check_surface. Each mesher runs in its own process:
/// - Netgen fills clean surfaces (closed manifolds without crossings), and keeps their triangles bitwise unless `edge`
///   requests others.
/// - fTetWild (Hu et al., Fast tetrahedral meshing in the wild, 2020) fills other surfaces within the tolerance. It
///   closes holes and unites crossing shells. Repeated runs give slightly different meshes.
///
/// If several meshes are made, the one with the longest stable step is returned
/// (docs/decisions/0026-filling-surfaces.md).
///
/// A shell consists of triangles connected by common edges. Shells decide the labels and sets of the mesh:
/// - If a shell that bounds a region lies inside another shell, the regions have the labels 1, 2, ..., beginning with
///   the region of the largest shell.
/// - If there are nested shells or several files, the faces of each shell form a set. The set has the name of the file
///   without extension if there are as many files as shells, otherwise shell_1, shell_2, ...
///
/// Notes report identical shells, which are used once, and a new surface that is farther from the given one than the
/// tolerance, for example where a hole was closed. Throws SceneError that names the file if a file cannot be read, a
/// mesher is not installed, or no mesher fills the surface within the limits.
FilledMesh fill(const std::vector<std::filesystem::path>& files, const FillSettings& settings = {},
                const FillProgress& progress = {});

/// Fills a surface from memory. Messages use `name` in place of a file name.
FilledMesh fill(const SurfaceMesh& surface, const std::string& name, const FillSettings& settings = {},
                const FillProgress& progress = {});

/// Returns the mesh that fills a surface file. Reads it from the cache file beside the surface file, or else fills the
/// surface and writes the cache file.
///
/// The name of the cache file contains a hash of the surface, `edge`, `tolerance`, `cavities` and whether skerry-fill
/// (the program that runs Netgen) is installed. One file serves all materials: the best mesh is chosen for the default
/// material, not for `material`.
///
/// No cache file is written if skerry-fill is installed, but did not start, crashed or reached a limit
/// (FilledMesh::may_change). The next call then tries again.
///
/// `notes` gets the notes of reading and filling, and a note if no cache file was written. A text file beside the cache
/// file keeps the notes of the filling for later calls.
Mesh fill_cached(const std::filesystem::path& file, const FillSettings& settings = {},
                 const FillProgress& progress = {}, std::vector<std::string>* notes = nullptr);

}  // namespace skerry::mesh
#pragma GCC visibility pop
