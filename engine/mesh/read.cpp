#include <algorithm>
#include <cctype>
#include <filesystem>
#include <utility>

#include "engine/mesh/formats/raw_mesh.h"
#include "engine/mesh/tetrahedron.h"
#include "skerry/error.h"
#include "skerry/mesh.h"

namespace skerry::mesh {
namespace {

std::string lower_extension(const std::string& path) {
    std::string extension = std::filesystem::path(path).extension().string();
    std::transform(extension.begin(), extension.end(), extension.begin(),
                   [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
    return extension;
}

RawMesh read_raw(const std::string& path, bool surface) {
    const std::string extension = lower_extension(path);
    if (extension == ".node" || extension == ".ele") return read_tetgen(path);
    const bool known =
        extension == ".msh" || extension == ".vtk" || (surface && (extension == ".obj" || extension == ".stl"));
    if (!known)
        Complaint{
            path,
            {},
            "file name",
            extension.empty() ? "no extension" : "the extension " + extension,
            surface ? "the extension .msh, .vtk, .node, .ele, .obj or .stl" : "the extension .msh, .vtk, .node or .ele",
            "export the mesh in one of these formats"}
            .raise();
    FileReader reader(path);
    if (extension == ".msh") return read_gmsh(reader);
    if (extension == ".vtk") return read_vtk(reader);
    return extension == ".obj" ? read_obj(reader) : read_stl(reader);
}

/// Nodes that are used, and their numbers among all nodes.
struct UsedNodes {
    std::vector<Vec3> nodes;
    std::vector<Index> number;
};

/// Removes nodes that no row uses. The remaining nodes stay in order, and the node numbers in the rows are updated.
template <std::size_t N>
UsedNodes drop_unused(const std::vector<Vec3>& nodes, std::vector<std::array<Index, N>>& rows) {
    std::vector<Index> place(nodes.size(), no_index);
    for (const std::array<Index, N>& row : rows)
        for (const Index n : row) place[static_cast<std::size_t>(n)] = 0;
    UsedNodes used;
    for (std::size_t n = 0; n < nodes.size(); ++n) {
        if (place[n] == no_index) continue;
        place[n] = static_cast<Index>(used.nodes.size());
        used.nodes.push_back(nodes[n]);
        used.number.push_back(static_cast<Index>(n));
    }
    for (std::array<Index, N>& row : rows)
        for (Index& n : row) n = place[static_cast<std::size_t>(n)];
    return used;
}

Mesh take_tetrahedra(RawMesh& raw) {
    Mesh mesh;
    UsedNodes used = drop_unused(raw.nodes, raw.tetrahedra);
    mesh.nodes = std::move(used.nodes);
    if (mesh.nodes.size() < raw.nodes.size()) mesh.file_number = std::move(used.number);
    mesh.tetrahedra = std::move(raw.tetrahedra);
    mesh.label = std::move(raw.label);
    // Some programs write tetrahedra with the opposite orientation. A file with inverted and no positive tetrahedra is
    // reoriented, because it probably comes from such a program. If both kinds occur, the mesh is faulty, and
    // reorienting would hide the fault.
    bool any_positive = false, any_inverted = false;
    for (const std::array<Index, 4>& t : mesh.tetrahedra) {
        const Orientation side = orientation(mesh, t);
        any_positive = any_positive || side == Orientation::positive;
        any_inverted = any_inverted || side == Orientation::inverted;
    }
    if (any_inverted && !any_positive)
        for (std::array<Index, 4>& t : mesh.tetrahedra) std::swap(t[2], t[3]);
    return mesh;
}

}  // namespace

Mesh read(const std::string& path) {
    RawMesh raw = read_raw(path, false);
    if (raw.tetrahedra.empty())
        Complaint{path,
                  {},
                  {},
                  "no tetrahedra",
                  "at least one tetrahedron",
                  "the file has " + std::to_string(raw.triangles.size()) + " triangles and " +
                      std::to_string(raw.others) + " other elements; export the mesh with its tetrahedra"}
            .raise();
    return take_tetrahedra(raw);
}

SurfaceMesh read_surface(const std::string& path) {
    RawMesh raw = read_raw(path, true);
    if (!raw.tetrahedra.empty()) return boundary(take_tetrahedra(raw));
    if (raw.curved_triangles > 0)
        Complaint{path,
                  {},
                  {},
                  std::to_string(raw.curved_triangles) + " triangles of second or higher order",
                  "linear triangles",
                  "export the surface with linear elements"}
            .raise();
    if (raw.triangles.empty())
        Complaint{
            path,
            {},
            {},
            "no triangles",
            "at least one triangle",
            "the file has " + std::to_string(raw.others) + " elements of other types; export the surface as triangles"}
            .raise();
    SurfaceMesh surface;
    surface.nodes = drop_unused(raw.nodes, raw.triangles).nodes;
    surface.triangles = std::move(raw.triangles);
    return surface;
}

}  // namespace skerry::mesh
