// Parts of the reader of Gmsh files. Format: gmsh.info, "MSH file format" and "Legacy formats" of the manual.
#pragma once

#include <span>
#include <utility>

#include "engine/mesh/formats/raw_mesh.h"

namespace skerry::mesh {

/// Numbers that the file gives to an element: `physical` of its physical group (0: none), `elementary` of its geometric
/// entity, and `number` of the element itself.
struct GmshTags {
    std::int64_t physical = 0, elementary = 0, number = 0;
};

/// A geometric entity or a physical group: its dimension, from 0 to 3, and its number.
using GmshEntity = std::pair<std::int64_t, std::int64_t>;

/// Map from geometric entities to the numbers of their physical groups.
using GmshEntities = std::map<GmshEntity, std::vector<std::int64_t>>;

/// A mesh that is being read from a Gmsh file, with the groups of its elements. `tags` has one entry per tetrahedron.
struct GmshMesh : RawMesh {
    std::vector<GmshTags> tags;
    std::map<GmshEntity, MeshSet> groups;           // elements of each physical group
    std::map<GmshEntity, std::string> group_names;  // names of physical groups that have one
    // Names of the views (data on elements) that have only the values 0 and 1. Each name has the list of the numbers of
    // those elements that have the value 1.
    std::map<std::string, std::vector<std::int64_t>> flagged;
    std::vector<Index> element_nodes;  // nodes of the element that is being read
};

/// Reads the section $PhysicalNames, which is text in every file.
void read_gmsh_names(FileReader& reader, GmshMesh& mesh);
/// Reads a section $ElementData (a view) of a text file into GmshMesh::flagged. Views with other values than 0 and 1
/// are ignored.
void read_gmsh_element_data(FileReader& reader, GmshMesh& mesh);

/// The next three functions read the sections $Nodes ($NOD in version 1) and $Elements ($ELM in version 1) of versions
/// 1 and 2. They start after the line with the section's name.
void read_gmsh2_nodes(FileReader& reader, bool binary, NodeNumbers& numbers, GmshMesh& mesh);
void read_gmsh1_elements(FileReader& reader, const NodeNumbers& numbers, GmshMesh& mesh);
void read_gmsh2_elements(FileReader& reader, bool binary, const NodeNumbers& numbers, GmshMesh& mesh);

/// The next three functions read the sections of version 4.1. read_gmsh4_entities reads $Entities and returns the
/// physical groups of each geometric entity that is in a group.
GmshEntities read_gmsh4_entities(FileReader& reader, bool binary);
void read_gmsh4_nodes(FileReader& reader, bool binary, NodeNumbers& numbers, GmshMesh& mesh);
void read_gmsh4_elements(FileReader& reader, bool binary, const NodeNumbers& numbers, const GmshEntities& entities,
                         GmshMesh& mesh);

/// Returns the number of nodes of an element type. Throws SceneError for unknown types and for tetrahedra of third or
/// higher order.
std::size_t gmsh_node_count(std::int64_t type, const FileReader& reader);

/// Adds an element to the mesh and to its physical groups, whose numbers are `groups`. Throws SceneError if one of the
/// nodes does not exist.
/// - A tetrahedron or triangle is added to the mesh and to the groups.
/// - An element of another type is only counted; its nodes are added to the groups.
/// - In files of version 2, a tetrahedron in several groups has a row for each group. Its second and later rows do not
///   add it to the mesh again.
void take_gmsh_element(std::int64_t type, const std::vector<std::int64_t>& node_numbers, const GmshTags& tags,
                       std::span<const std::int64_t> groups, const NodeNumbers& numbers, const FileReader& reader,
                       GmshMesh& mesh);

/// Reads the next line, which must contain exactly `count` integers. `meaning` describes the expected integers in error
/// messages.
std::vector<std::int64_t> integer_line(FileReader& reader, std::size_t count, const char* field, const char* meaning);

}  // namespace skerry::mesh
