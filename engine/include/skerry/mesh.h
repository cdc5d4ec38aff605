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

/// A tetrahedral mesh in its own frame. Tetrahedra index `nodes`; a positive tetrahedron has det(n1 - n0, n2 - n0, n3 -
/// n0) > 0.
struct Mesh {
    std::vector<Vec3> nodes;                       // m
    std::vector<std::array<Index, 4>> tetrahedra;  // rows of nodes
    // A number of each tetrahedron, for example of its material: BodySettings::materials goes by it. Or empty: no
    // labels
    std::vector<int> label{};
};

/// A closed or open triangle surface, counter-clockwise seen from outside.
struct SurfaceMesh {
    std::vector<Vec3> nodes;                      // m
    std::vector<std::array<Index, 3>> triangles;  // rows of nodes
};

/// Built-in meshes. All are centred at the origin unless said, axes along z, with positive tetrahedra. Lengths in
/// metres. `resolution` counts elements along the smallest extent unless said. Throw std::invalid_argument for sizes
/// that are not positive and for meshes too large for 32-bit indices.
namespace mesh {

/// A box of the given edge lengths, cut into cells (i, j, k) of six tetrahedra each: cells alike in each eighth of the
/// box, eighths that mirror each other where the number of cells is even.
Mesh box(const Vec3& size, const std::array<int, 3>& cells);

/// A ball: `resolution` elements across the diameter (an odd number counts as the next even one). All boundary nodes
/// lie on the sphere.
Mesh ball(Real radius, int resolution);

/// What a rigid sphere is drawn with: its first node is in the middle, the next twelve are the corners of an
/// icosahedron, all others lie between these on the sphere. Its faces are flat, a tetrahedron each.
Mesh sphere_picture(Real radius);

/// What a rigid capsule is drawn with: its first two nodes are the ends of its axis, at z = -length/2 and length/2, all
/// others lie on its surface; the next ten are the pole of either end and four places of the rim there. Its faces are
/// flat, and `length` (m) is that of the straight part.
Mesh capsule_picture(Real radius, Real length);

/// What a rigid cylinder is drawn with: its first node is in the middle, the second in the middle of the upper end, at
/// z = height/2, all others but one lie on its rims. Its faces are flat.
Mesh cylinder_picture(Real radius, Real height);

/// A solid cylinder of the given radius and height: `resolution` elements across the diameter (odd: the next even
/// number).
Mesh cylinder(Real radius, Real height, int resolution);

/// A body of revolution about z: `profile` lists (radius, z) from bottom to top, z ascending and radii positive;
/// between the points the outline is linear. `resolution` elements across the largest diameter (odd: the next even
/// number), about as long along z; kinks closer together than that are rounded, and an end narrower than a third of an
/// element closes to a point.
Mesh lathe(std::span<const std::array<Real, 2>> profile, int resolution);

/// A skittle (a lathe with the outline of a ninepin) of the given height, standing on z = 0.
Mesh skittle(Real height, int resolution);

/// A table: a top of size x by y by thickness on four square legs, standing on z = 0. `cells_per_leg` elements across a
/// leg.
struct TableShape {
    Real length = 0.5;      // m, along x
    Real width = 0.3;       // m, along y
    Real height = 0.3;      // m
    Real thickness = 0.05;  // m, of the top
    Real leg = 0.05;        // m, edge of a leg
    int cells_per_leg = 1;
};
Mesh table(const TableShape& shape);

/// Reads Gmsh .msh (1, 2.2, 4.1; ASCII and binary), legacy VTK .vtk (ASCII and binary) or TetGen .node/.ele (either
/// name). Linear tetrahedra are taken, other element kinds are passed over, curved tetrahedra refused; nodes no
/// tetrahedron uses are dropped. If no tetrahedron is positive the file counts the other way round and all are turned
/// over; if some are, the mesh is as in the file and `inspect` says what is wrong with it.
///
/// Labels are, of Gmsh: the number of the physical group (the first, if a volume is in several), 0 outside of all; of
/// the elementary volume where no tetrahedron is in a group. Of VTK: the first array of cell data that is called
/// region, gmsh:physical, medit:ref or CellEntityIds and has one whole number a cell. Of TetGen: the last attribute of
/// the .ele, where all are whole numbers. Without any of these the mesh has no labels.
///
/// Throws SceneError that names the file, the place and what was found and expected.
Mesh read(const std::string& path);

/// Reads the triangles of a file of the same kinds, or of a Wavefront .obj or an STL; of a tetrahedral file its
/// boundary. Polygons fan out into triangles. Throws SceneError.
SurfaceMesh read_surface(const std::string& path);

/// Writes a mesh as Gmsh 2.2 text with all digits, so that `read` gives the same mesh back: the whole file or none. The
/// name ends in .msh. Throws SceneError.
void write(const std::string& path, const Mesh& mesh);

/// The boundary of a tetrahedral mesh. Throws SceneError when a tetrahedron names nodes that do not exist or one twice,
/// or a node is not finite; so does `inspect`.
SurfaceMesh boundary(const Mesh& mesh);

}  // namespace mesh

/// What `skerry inspect` prints of a mesh.
struct MeshReport {
    std::size_t nodes = 0, tetrahedra = 0, boundary_triangles = 0, components = 0;
    Vec3 lower = Vec3::Zero(), upper = Vec3::Zero();  // m
    Real volume = 0;                                  // m^3
    Real mean_edge = 0, min_edge = 0, max_edge = 0;   // m
    Real min_altitude = 0;                            // m
    // 12 (3 V)^(2/3) / sum of squared edges: 1 is regular, < 0 inverted
    Real min_quality = 0, mean_quality = 0;
    std::size_t inverted = 0, flat = 0;  // tetrahedra of negative, of no volume
    bool closed_manifold = false;        // of the boundary: edges of two triangles, a ring of them at each node
    std::map<int, std::size_t> labels;   // tetrahedra with each label; none without labels
};
MeshReport inspect(const Mesh& mesh);

}  // namespace skerry
#pragma GCC visibility pop
