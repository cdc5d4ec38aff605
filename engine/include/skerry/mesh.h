// Tetrahedral meshes: built-in shapes and files.
#pragma once

#include <array>
#include <map>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "components/types.h"

#pragma GCC visibility push(default)
namespace skerry {

/// A tetrahedral mesh in its own frame. Tetrahedra index `nodes`. A tetrahedron is positive if
/// det(n1 - n0, n2 - n0, n3 - n0) > 0.
struct Mesh {
    std::vector<Vec3> nodes;                       // [m]
    std::vector<std::array<Index, 4>> tetrahedra;  // indices of nodes
    // Label of each tetrahedron, for example the number of its material; BodySettings::materials refers to it. Empty:
    // no labels.
    std::vector<int> label{};
};

/// A closed or open triangle surface. Triangles are counter-clockwise as seen from outside.
struct SurfaceMesh {
    std::vector<Vec3> nodes;                      // [m]
    std::vector<std::array<Index, 3>> triangles;  // indices of nodes
};

/// Built-in meshes with positive tetrahedra. Unless stated otherwise they are centred at the origin, their axis is z,
/// and `resolution` is the number of elements along the smallest extent. Lengths are in metres. The functions throw
/// std::invalid_argument for sizes that are not positive and for meshes too large for 32-bit indices.
namespace mesh {

/// A box of the given edge lengths, divided into cells (i, j, k) of six tetrahedra each. All cells of an octant of the
/// box are cut alike. Octants mirror each other where the number of cells is even.
Mesh box(const Vec3& size, const std::array<int, 3>& cells);

/// A ball: `resolution` elements across the diameter, an odd number rounded up to even. All boundary nodes lie on the
/// sphere.
Mesh ball(Real radius, int resolution);

/// A mesh that represents a rigid sphere in output. The first node is the centre, the next twelve are the corners of an
/// icosahedron, and all others lie between these on the sphere. Faces are flat, with one tetrahedron each.
Mesh sphere_picture(Real radius);

/// A mesh that represents a rigid capsule in output. The first two nodes are the ends of the axis at z = -length/2 and
/// length/2; all others lie on the surface. The next ten are the pole and four rim nodes of either end. Faces are flat.
/// `length` is the length of the straight part [m].
Mesh capsule_picture(Real radius, Real length);

/// A mesh that represents a rigid cylinder in output. The first node is the centre, the second the centre of the upper
/// end at z = height/2. All others lie on the rims, except the centre of the lower end. Faces are flat.
Mesh cylinder_picture(Real radius, Real height);

/// A solid cylinder of the given radius and height: `resolution` elements across the diameter, an odd number
/// rounded up to even.
Mesh cylinder(Real radius, Real height, int resolution);

/// A solid of revolution about z. `profile` lists (radius, z) from bottom to top, z ascending and radii positive; the
/// outline is linear between these points. There are `resolution` elements across the largest diameter (an odd number
/// is rounded up to even), and layers along z are about as high. Kinks closer together than 0.6 elements are rounded.
/// An end with a radius below 0.3 elements closes to a point.
Mesh lathe(std::span<const std::array<Real, 2>> profile, int resolution);

/// A skittle (a lathe with the outline of a ninepin) of the given height, standing on z = 0.
Mesh skittle(Real height, int resolution);

/// A table on z = 0: a top of length by width by thickness on four square legs, with `cells_per_leg` cells across a
/// leg.
struct TableShape {
    Real length = 0.5;      // along x [m]
    Real width = 0.3;       // along y [m]
    Real height = 0.3;      // top included [m]
    Real thickness = 0.05;  // of the top [m]
    Real leg = 0.05;        // edge length of the section of a leg [m]
    int cells_per_leg = 1;
};
Mesh table(const TableShape& shape);

/// Reads Gmsh .msh (1, 2.2, 4.1; ASCII and binary), legacy VTK .vtk (ASCII and binary) or TetGen .node/.ele (either
/// name). Only linear tetrahedra are used: curved tetrahedra are refused, other kinds of elements and unused nodes are
/// dropped. If no tetrahedron is positive, the file has the opposite node order and all tetrahedra are reoriented. If
/// some are positive and others not, the mesh is left as in the file, and `inspect` counts the faults.
///
/// Sources of the labels; without them the mesh has no labels:
/// - Gmsh: the number of the physical group (of the first one, if a volume is in several), 0 outside of all groups. If
///   no tetrahedron is in a group: the number of the elementary volume.
/// - VTK: the first array of cell data that is called region, gmsh:physical, medit:ref or CellEntityIds and has one
///   whole number per cell.
/// - TetGen: the last attribute in the .ele file, if it is a whole number for all tetrahedra.
///
/// Throws SceneError that names the file, the place, and the found and the expected text.
Mesh read(const std::string& path);

/// Reads the triangles of a file in one of the formats of `read`, or in Wavefront .obj or .stl format. A tetrahedral
/// file gives its boundary. Polygons are split into triangles around their first corner. Throws SceneError.
SurfaceMesh read_surface(const std::string& path);

/// Writes a mesh as Gmsh 2.2 text with all digits, so that `read` returns the same mesh. The file is written as a whole
/// or not at all. Its name must end in .msh. Throws SceneError.
void write(const std::string& path, const Mesh& mesh);

/// The boundary of a tetrahedral mesh. Throws SceneError if a tetrahedron has a node twice or one that does not exist,
/// or if a position is not finite; `inspect` does the same.
SurfaceMesh boundary(const Mesh& mesh);

}  // namespace mesh

/// Statistics of a mesh, as printed by `skerry inspect`.
struct MeshReport {
    std::size_t nodes = 0, tetrahedra = 0, boundary_triangles = 0, components = 0;
    Vec3 lower = Vec3::Zero(), upper = Vec3::Zero();  // bounding box [m]
    Real volume = 0;                                  // [m^3]
    Real mean_edge = 0, min_edge = 0, max_edge = 0;   // edge lengths [m]
    Real min_altitude = 0;                            // smallest altitude of a tetrahedron [m]
    // 12 (3 V)^(2/3) / (sum of squared edge lengths): 1 for a regular tetrahedron, < 0 for an inverted one
    Real min_quality = 0, mean_quality = 0;
    std::size_t inverted = 0, flat = 0;  // tetrahedra of negative and of zero volume
    bool closed_manifold = false;        // boundary: two triangles at each edge, one ring of them at each node
    std::map<int, std::size_t> labels;   // number of tetrahedra by label; empty without labels
};
MeshReport inspect(const Mesh& mesh);

}  // namespace skerry
#pragma GCC visibility pop
