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

/// A named part of a mesh. A set can list nodes, faces, tetrahedra, or several of these kinds. The functions
/// nodes_of(), faces_of() and tetrahedra_of() of the namespace mesh return the items of one kind that a set lists, or
/// that follow from its other lists.
struct MeshSet {
    std::vector<Index> nodes{};                 // indices of nodes, ascending
    std::vector<std::array<Index, 3>> faces{};  // three nodes of each face
    std::vector<Index> tetrahedra{};            // indices of tetrahedra, ascending

    /// True if the set lists nothing.
    bool empty() const { return nodes.empty() && faces.empty() && tetrahedra.empty(); }
    bool operator==(const MeshSet&) const = default;
};

/// A tetrahedral mesh in its own coordinate frame. The rows of `tetrahedra` are indices into `nodes`. A tetrahedron
/// with the nodes n0 to n3 is positive if det(n1 - n0, n2 - n0, n3 - n0) > 0.
struct Mesh {
    std::vector<Vec3> nodes;                       // positions of the nodes [m]
    std::vector<std::array<Index, 4>> tetrahedra;  // indices of nodes
    // Label of each tetrahedron, for example the number of its material. BodySettings::materials maps labels to
    // materials. An empty list means that the mesh has no labels.
    std::vector<int> label{};
    // Number of each node in the file from which the mesh was read, ascending. The nodes of the file are numbered from
    // 0, in the order of the file. An empty list means that the numbers equal the indices in `nodes`.
    std::vector<Index> file_number{};
    std::map<std::string, MeshSet> sets{};  // sets by name
    // For a rigid body without tetrahedra: the triangles of its surface, see World::add_body(const SurfaceMesh&, ...).
    // With tetrahedra the list must be empty.
    std::vector<std::array<Index, 3>> triangles{};
    // Named lists with one vector per tetrahedron, for example directions of fibres. `read` makes one from each array
    // with three numbers per cell of a VTK file.
    std::map<std::string, std::vector<Vec3>> vectors{};
};

/// A triangle surface, either closed or with a boundary. Triangles are counter-clockwise as seen from outside.
struct SurfaceMesh {
    std::vector<Vec3> nodes;                      // positions of the nodes [m]
    std::vector<std::array<Index, 3>> triangles;  // indices of nodes
};

/// Built-in meshes with positive tetrahedra. Unless stated otherwise a mesh is centred at the origin, its axis is z,
/// and `resolution` is the number of elements along the smallest extent. Lengths are in metres. The functions throw
/// SceneError for sizes that are not positive and for meshes too large for 32-bit indices.
namespace mesh {

/// A box of the given edge lengths, divided into `cells` = (i, j, k) cells along x, y and z with six tetrahedra each.
/// All cells in one octant of the box are divided in the same way. If the number of cells along an axis is even, the
/// two halves of the box along this axis are mirror images of each other.
Mesh box(const Vec3& size, const std::array<int, 3>& cells);

/// A ball with `resolution` elements across the diameter; an odd number is rounded up to even. All boundary nodes lie
/// on the sphere.
Mesh ball(Real radius, int resolution);

/// A mesh that represents a rigid sphere in output. The triangles are flat and belong to one tetrahedron each. Order of
/// the nodes:
/// - the centre,
/// - the twelve corners of an icosahedron,
/// - all other nodes, which lie between these corners on the sphere.
Mesh sphere_picture(Real radius);

/// A mesh that represents a rigid capsule in output. The triangles are flat. `length` is the length of the straight
/// part [m]. Order of the nodes:
/// - the ends of the axis, at z = -length/2 and z = length/2,
/// - ten nodes: for each end, the pole and four nodes of the rim,
/// - all other nodes, which lie on the surface, too.
Mesh capsule_picture(Real radius, Real length);

/// A mesh that represents a rigid cylinder in output. The first node is the centre of the cylinder, the second is the
/// centre of the upper end at z = height/2. All other nodes lie on the two rims, except the centre of the lower end.
/// The triangles are flat.
Mesh cylinder_picture(Real radius, Real height);

/// A solid cylinder of the given radius and height, with `resolution` elements across the diameter; an odd number is
/// rounded up to even.
Mesh cylinder(Real radius, Real height, int resolution);

/// A solid of revolution about z, with `resolution` elements across the largest diameter (an odd number is rounded up
/// to even). `profile` lists points (radius, z) of the outline from bottom to top, with ascending z and positive radii.
/// The outline is linear between them.
///
/// The height of a layer along z is about the size of an element. Details that are too small for the mesh are
/// simplified:
/// - Where kinks of the outline are closer together than 0.6 element sizes, only the sharpest is kept.
/// - An end with a radius below 0.3 element sizes closes to a point.
Mesh lathe(std::span<const std::array<Real, 2>> profile, int resolution);

/// A skittle of the given height, standing on z = 0. It is a lathe() mesh with the outline of a ninepin.
Mesh skittle(Real height, int resolution);

/// A table that stands on z = 0. A top of length x width x thickness rests on four square legs, with `cells_per_leg`
/// cells across a leg.
struct TableShape {
    Real length = 0.5;      // along x [m]
    Real width = 0.3;       // along y [m]
    Real height = 0.3;      // total height, including the top [m]
    Real thickness = 0.05;  // thickness of the top [m]
    Real leg = 0.05;        // edge length of the square cross-section of a leg [m]
    int cells_per_leg = 1;  // number of cells across a leg, >= 1
};
/// Returns a mesh of a table.
Mesh table(const TableShape& shape);

/// Reads a mesh from a file in one of these formats:
/// - Gmsh .msh (1, 2.2, 4.1; ASCII and binary)
/// - legacy VTK .vtk (ASCII and binary), and VTK XML .vtu (unstructured grids; ASCII, base64 and raw, also compressed
///   by zlib)
/// - TetGen .node/.ele (`path` may name either file)
/// - Medit .mesh/.meshb (ASCII and binary)
/// - Abaqus .inp
///
/// Elements:
/// - Tetrahedra of second order are divided into eight linear ones each, which together have all nodes of the file.
///   Tetrahedra of higher order are refused.
/// - Other kinds of elements and unused nodes are dropped. Mesh::file_number then lists the numbers of the remaining
///   nodes.
/// - Inverted tetrahedra are turned: two of their nodes change places. If turning would make tetrahedra overlap, the
///   shape itself is faulty. The mesh is then left as in the file, and `inspect` counts the faults.
/// `notes`, if given, gets sentences about divided, dropped and turned elements, each with the name of the file.
///
/// An Abaqus file must list its nodes and elements itself, in Cartesian coordinates. Keywords that generate or include
/// them, such as *NGEN and *INCLUDE, are refused. Instances of parts are joined into one mesh. Steps, loads and
/// constants of materials are not read.
///
/// Sources of the labels; without these sources the mesh has no labels:
/// - Gmsh: the number of the physical group (of the first group, if a volume is in several), 0 outside of all groups.
///   If no tetrahedron is in a group: the number of the elementary volume.
/// - VTK: the first array of cell data that is called region, gmsh:physical, medit:ref or CellEntityIds and has one
///   whole number per cell.
/// - TetGen: the last attribute in the .ele file, if it is a whole number for all tetrahedra.
/// - Medit: the references of the tetrahedra.
/// - Abaqus: the materials of the solid sections are numbered from 1 in their order; 0 outside of all sections. `notes`
///   names the material of each label.
///
/// Sources of the sets:
/// - Gmsh: each physical group of points, curves, surfaces or volumes, by its name. A group without a name is called
///   point_N, curve_N or surface_N after its number N; a volume without a name has a label only.
/// - VTK: arrays of bits or whole numbers with one number per point or cell. An array NAME of zeros and ones gives the
///   set NAME, any other array a set NAME_N for each number N but 0. An array in which all numbers differ gives none.
/// - TetGen: node_marker_N and face_marker_N for each marker N but 0 of the files .node and .face.
/// - Medit: node_ref_N and face_ref_N for each reference N but 0 of the vertices and triangles.
/// - Abaqus: sets of nodes, sets of elements and surfaces by name. The names of sets of an instance begin with the name
///   of the instance and a dot. If other objects have the same name, sets of elements are called NAME_elements and
///   surfaces NAME_surface. A set of nodes is dropped if a set of elements has the same name and exactly these nodes.
///   Internal sets are dropped, too.
/// Triangles that are not faces of a tetrahedron are dropped from sets, and a note states how many.
///
/// Throws SceneError that names the file, the place in the file, and the found and the expected text.
Mesh read(const std::string& path, std::vector<std::string>* notes = nullptr);

/// Reads the mesh of a rigid body like `read`. If the file has no tetrahedra, reads its triangle surface like
/// `read_surface`, into Mesh::triangles. Throws SceneError.
Mesh read_rigid(const std::string& path, std::vector<std::string>* notes = nullptr);

/// Reads a triangle surface from a file in one of the formats of `read`, or in Wavefront .obj, .ply (ASCII
/// and binary) or .stl format. From a tetrahedral mesh it returns the boundary. Polygons are split into triangles that
/// share the first corner of the polygon. `notes` as for `read`. Throws SceneError.
SurfaceMesh read_surface(const std::string& path, std::vector<std::string>* notes = nullptr);

/// Prepares a mesh that was made in memory: turns its inverted tetrahedra as `read` does, sorts the numbers in sets,
/// and gives the faces of sets the orientation of the boundary. `notes` and errors use `name` in place of a file name.
///
/// Throws SceneError
/// - if a tetrahedron uses a node twice or a node that does not exist,
/// - if a position is not finite,
/// - if a set has a number that is out of range or a face that no tetrahedron has.
void turn_inverted(Mesh& mesh, const std::string& name, std::vector<std::string>* notes = nullptr);

/// Writes a mesh as Gmsh 2.2 text with all digits, so that `read` returns an equal mesh. The file name must end in
/// .msh. An existing file is replaced completely or not at all. Throws SceneError.
void write(const std::string& path, const Mesh& mesh);

/// Returns the boundary triangles of a tetrahedral mesh. Throws SceneError if a tetrahedron uses a node twice or a node
/// that does not exist, or if a position is not finite. `inspect` throws the same errors.
SurfaceMesh boundary(const Mesh& mesh);

/// Nodes of a set: the listed nodes, and all nodes of the listed faces and tetrahedra.
std::vector<Index> nodes_of(const MeshSet& set, std::span<const std::array<Index, 4>> tetrahedra);
/// Faces of a set: the listed faces, and the triangles of `surface`, the boundary of the tetrahedra, that belong to
/// listed tetrahedra or whose nodes are all listed.
std::vector<std::array<Index, 3>> faces_of(const MeshSet& set, std::span<const std::array<Index, 4>> tetrahedra,
                                           std::span<const std::array<Index, 3>> surface);
/// Tetrahedra of a set: the listed tetrahedra. If none are listed: the tetrahedra whose nodes are all in the set.
std::vector<Index> tetrahedra_of(const MeshSet& set, std::span<const std::array<Index, 4>> tetrahedra);

}  // namespace mesh

/// Statistics of a mesh, as printed by `skerry inspect`.
struct MeshReport {
    // Numbers of nodes, of tetrahedra, of boundary triangles, and of connected components (parts that share no node).
    std::size_t nodes = 0, tetrahedra = 0, boundary_triangles = 0, components = 0;
    Vec3 lower = Vec3::Zero(), upper = Vec3::Zero();  // bounding box [m]
    Real volume = 0;                                  // volume of all tetrahedra [m^3]
    Real mean_edge = 0, min_edge = 0, max_edge = 0;   // edge lengths [m]
    Real min_altitude = 0;                            // smallest altitude of a tetrahedron [m]
    // Quality 12 (3 V)^(2/3) / (sum of squared edge lengths) of a tetrahedron of volume V: 1 for a regular tetrahedron,
    // < 0 for an inverted one.
    Real min_quality = 0, mean_quality = 0;
    std::size_t inverted = 0, flat = 0;  // numbers of tetrahedra of negative volume and of zero volume
    std::size_t slivers = 0;             // number of tetrahedra of positive volume with a quality below 0.1
    // true if every boundary edge has two triangles, and the triangles at every node form one ring
    bool closed_manifold = false;
    std::string boundary_fault;  // describes the first fault of the boundary and counts all; empty if there is none
    std::map<int, std::size_t> labels;  // number of tetrahedra with each label; empty if the mesh has no labels
    // numbers of nodes, faces and tetrahedra of each set
    std::map<std::string, std::array<std::size_t, 3>> sets;
};
/// Counts and measures the tetrahedra of a mesh. Throws SceneError if a tetrahedron uses a node twice or a node that
/// does not exist, or if a position is not finite.
MeshReport inspect(const Mesh& mesh);

}  // namespace skerry
#pragma GCC visibility pop
