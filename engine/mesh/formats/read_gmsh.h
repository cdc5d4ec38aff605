// Parts of the Gmsh reader. Format: gmsh.info, "MSH file format" and "Legacy formats" of the manual.
#pragma once

#include "engine/mesh/formats/raw_mesh.h"

namespace skerry::mesh {

/// What an element belongs to: a physical group, 0 for none, and an elementary entity.
struct GmshTags {
    std::int64_t physical = 0, elementary = 0;
};

/// Physical group by tag of a volume.
using GmshVolumes = std::unordered_map<std::int64_t, std::int64_t>;

/// A mesh with the tags of its tetrahedra.
struct GmshMesh : RawMesh {
    std::vector<GmshTags> tags;
};

/// Sections $Nodes ($NOD) and $Elements ($ELM) of versions 1 and 2, behind the line of their name.
void read_gmsh2_nodes(FileReader& reader, bool binary, NodeNumbers& numbers, GmshMesh& mesh);
void read_gmsh1_elements(FileReader& reader, const NodeNumbers& numbers, GmshMesh& mesh);
void read_gmsh2_elements(FileReader& reader, bool binary, const NodeNumbers& numbers, GmshMesh& mesh);

/// The same of version 4.1, and the physical groups of section $Entities.
GmshVolumes read_gmsh4_entities(FileReader& reader, bool binary);
void read_gmsh4_nodes(FileReader& reader, bool binary, NodeNumbers& numbers, GmshMesh& mesh);
void read_gmsh4_elements(FileReader& reader, bool binary, const NodeNumbers& numbers, const GmshVolumes& volumes,
                         GmshMesh& mesh);

/// How many nodes an element of this type has. Complains about types that are not known, and about curved tetrahedra.
std::size_t gmsh_node_count(std::int64_t type, const FileReader& reader);

/// Takes a tetrahedron or a triangle, passes over any other element, all of whose nodes must exist, too.
void take_gmsh_element(std::int64_t type, const std::vector<std::int64_t>& node_numbers, const GmshTags& tags,
                       const NodeNumbers& numbers, const FileReader& reader, GmshMesh& mesh);

/// The next line with exactly so many integers. Complains with the line otherwise.
std::vector<std::int64_t> integer_line(FileReader& reader, std::size_t count, const char* field, const char* meaning);

}  // namespace skerry::mesh
