// Parts of the Gmsh reader. Format: gmsh.info, "MSH file format" and "Legacy formats" of the manual.
#pragma once

#include "engine/mesh/formats/raw_mesh.h"

namespace skerry::mesh {

/// Groups of an element: a physical group (0: none) and an elementary entity.
struct GmshTags {
    std::int64_t physical = 0, elementary = 0;
};

/// Physical group by tag of a volume.
using GmshVolumes = std::unordered_map<std::int64_t, std::int64_t>;

/// A mesh with the tags of its tetrahedra.
struct GmshMesh : RawMesh {
    std::vector<GmshTags> tags;
};

/// Read sections $Nodes ($NOD) and $Elements ($ELM) of versions 1 and 2, starting after the line with their name.
void read_gmsh2_nodes(FileReader& reader, bool binary, NodeNumbers& numbers, GmshMesh& mesh);
void read_gmsh1_elements(FileReader& reader, const NodeNumbers& numbers, GmshMesh& mesh);
void read_gmsh2_elements(FileReader& reader, bool binary, const NodeNumbers& numbers, GmshMesh& mesh);

/// Read the sections of version 4.1. read_gmsh4_entities returns the physical groups of section $Entities.
GmshVolumes read_gmsh4_entities(FileReader& reader, bool binary);
void read_gmsh4_nodes(FileReader& reader, bool binary, NodeNumbers& numbers, GmshMesh& mesh);
void read_gmsh4_elements(FileReader& reader, bool binary, const NodeNumbers& numbers, const GmshVolumes& volumes,
                         GmshMesh& mesh);

/// Number of nodes of an element type. Throws SceneError for unknown types and for curved tetrahedra.
std::size_t gmsh_node_count(std::int64_t type, const FileReader& reader);

/// Adds a tetrahedron or a triangle and counts any other element. The nodes of all elements must exist.
void take_gmsh_element(std::int64_t type, const std::vector<std::int64_t>& node_numbers, const GmshTags& tags,
                       const NodeNumbers& numbers, const FileReader& reader, GmshMesh& mesh);

/// Reads the next line, which must have exactly `count` integers. The error message contains the line.
std::vector<std::int64_t> integer_line(FileReader& reader, std::size_t count, const char* field, const char* meaning);

}  // namespace skerry::mesh
