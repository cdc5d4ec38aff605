#include <algorithm>
#include <filesystem>
#include <map>
#include <set>
#include <span>
#include <utility>

#include "engine/base/complaint.h"
#include "engine/mesh/formats/raw_mesh.h"
#include "engine/mesh/sets.h"
#include "engine/mesh/tetrahedron.h"
#include "engine/mesh/used_nodes.h"
#include "skerry/mesh.h"
#include "systems/collision/build_surface.h"

namespace skerry::mesh {
namespace {

struct Format {
    const char* extension;
    RawMesh (*read)(FileReader&);
    bool surface_only;  // true if the format has triangles but no tetrahedra
};
constexpr std::array<Format, 9> formats{{{".msh", read_gmsh, false},
                                         {".inp", read_abaqus, false},
                                         {".mesh", read_medit, false},
                                         {".meshb", read_medit, false},
                                         {".vtk", read_vtk, false},
                                         {".vtu", read_vtu, false},
                                         {".obj", read_obj, true},
                                         {".ply", read_ply, true},
                                         {".stl", read_stl, true}}};

RawMesh read_file(const std::string& path, bool surface) {
    const std::string extension = in_lower_case(std::filesystem::path(path).extension().string());
    if (extension == ".node" || extension == ".ele") return read_tetgen(path);
    const auto* const format = std::ranges::find(formats, extension, &Format::extension);
    const bool is_known = format != formats.end();
    if (!is_known || (format->surface_only && !surface)) {
        std::string expected = "the extension ";
        for (const Format& other : formats)
            if (surface || !other.surface_only) expected += std::string(other.extension) + ", ";
        refuse_in(
            path, {}, "file name", extension.empty() ? "no extension" : "the extension " + extension,
            expected + ".node or .ele",
            is_known
                ? "a body that deforms needs tetrahedra: write \"surface\" instead of \"file\" in a scene, or fill the "
                  "surface with `skerry fill`; a rigid body or a collider needs only a surface"
                : "export the mesh in one of these formats");
    }
    FileReader reader(path);
    return format->read(reader);
}

}  // namespace

bool is_surface_format(const std::string& path) {
    const std::string extension = in_lower_case(std::filesystem::path(path).extension().string());
    const auto* const format = std::ranges::find(formats, extension, &Format::extension);
    return format != formats.end() && format->surface_only;
}

namespace {

/// Adds a note about solid elements that are not tetrahedra, such as hexahedra. They are left out of the mesh.
void note_left_out(RawMesh& mesh) {
    static constexpr std::array<std::string_view, 6> flat{"points",         "lines",           "quadrilaterals",
                                                          "flat triangles", "triangle strips", "polygons"};
    std::string text;
    for (const auto& [kind, count] : mesh.others)
        if (std::ranges::find(flat, kind) == flat.end() && !kind.starts_with("triangles"))
            text += (text.empty() ? "" : ", ") + std::to_string(count) + " " + kind;
    if (!text.empty()) mesh.notes.push_back(text + " were left out; only tetrahedra are used");
}

/// Reads a file of any format and divides its elements of second order into linear ones.
RawMesh read_raw(const std::string& path, bool surface, std::vector<std::string>* notes) {
    RawMesh raw = read_file(path, surface);
    divide_second_order(raw);
    if (!raw.tetrahedra.empty()) note_left_out(raw);
    if (raw.flat_triangles > 0)
        raw.notes.push_back(std::to_string(raw.flat_triangles) +
                            " triangles use the same node twice (no area) and were dropped");
    for (const std::string& note : raw.notes)
        if (notes) notes->push_back(path + ": " + note);
    return raw;
}

/// True if two tetrahedra share a face and lie on the same side of it, so that they overlap.
bool any_overlap(const Mesh& mesh) {
    std::array<int, 2> on_side{};
    const TetrahedronFace* before = nullptr;
    const std::vector<TetrahedronFace> faces = sorted_faces(mesh.tetrahedra);
    for (const TetrahedronFace& face : faces) {
        if (before == nullptr || face.node != before->node) on_side = {};
        if (++on_side[face.turned ? 1 : 0] > 1) return true;
        before = &face;
    }
    return false;
}

/// Reverses the inverted tetrahedra of a mesh, whose node numbers must be valid. There are two possible causes:
/// - The program that wrote the file lists nodes in the opposite order. Reversal is then right.
/// - A node lies in a wrong place and inverts the tetrahedra around it. Reversed, they would overlap their neighbours
///   across faces. So if only some tetrahedra are inverted, and reversal causes an overlap, all stay as they are.
void reverse_inverted(const std::string& name, Mesh& mesh, std::vector<std::string>* notes) {
    std::vector<std::size_t> inverted;
    for (std::size_t t = 0; t < mesh.tetrahedra.size(); ++t)
        if (orientation(mesh, mesh.tetrahedra[t]) == Orientation::inverted) inverted.push_back(t);
    const auto turn = [&] {
        for (const std::size_t t : inverted) std::swap(mesh.tetrahedra[t][2], mesh.tetrahedra[t][3]);
    };
    const std::size_t count = inverted.size(), all = mesh.tetrahedra.size();
    if (count == 0) return;
    turn();
    if (count < all && any_overlap(mesh)) {
        turn();
        return;
    }
    if (notes)
        notes->push_back(name + ": " + std::to_string(count) + " of " + std::to_string(all) +
                         " tetrahedra list their nodes in the opposite order (negative volume) and were turned");
}

/// Adds the sets of a file to the mesh. used[n]: index in the file of node n of the mesh. Drops sets of which no member
/// is in the mesh, and adds a note about each.
void take_sets(const std::string& path, std::map<std::string, MeshSet>& raw, std::span<const Index> used,
               std::size_t raw_nodes, Mesh& mesh, std::vector<std::string>* notes) {
    std::vector<Index> new_index(raw_nodes, no_index);
    for (std::size_t n = 0; n < used.size(); ++n) new_index[static_cast<std::size_t>(used[n])] = static_cast<Index>(n);
    const auto renumber = [&](Index& n) { n = new_index[static_cast<std::size_t>(n)]; };
    std::size_t dropped = 0;
    for (auto& [name, set] : raw) {
        std::ranges::for_each(set.nodes, renumber);
        std::erase(set.nodes, no_index);
        for (std::array<Index, 3>& face : set.faces) std::ranges::for_each(face, renumber);
        dropped += std::erase_if(set.faces, [](const auto& face) { return std::ranges::count(face, no_index) > 0; });
    }
    mesh.sets = std::move(raw);
    dropped += match_faces(mesh.tetrahedra, mesh.sets);
    if (dropped > 0 && notes)
        notes->push_back(path + ": " + std::to_string(dropped) +
                         " triangles are not faces of a tetrahedron and were dropped from the sets of faces");
    for (auto& [name, set] : mesh.sets) {
        tidy(set);
        if (set.empty() && notes)
            notes->push_back(path + ": the set " + in_quotes(name) +
                             " contains no node of a tetrahedron and was dropped");
    }
    std::erase_if(mesh.sets, [](const auto& item) { return item.second.empty(); });
}

Mesh take_tetrahedra(const std::string& path, RawMesh& raw, std::vector<std::string>* notes) {
    Mesh mesh;
    const std::size_t raw_nodes = raw.nodes.size();
    UsedNodes used = drop_unused(raw.nodes, raw.tetrahedra);
    mesh.nodes = std::move(used.nodes);
    mesh.tetrahedra = std::move(raw.tetrahedra);
    mesh.label = std::move(raw.label);
    mesh.vectors = std::move(raw.vectors);
    reverse_inverted(path, mesh, notes);
    if (!raw.sets.empty()) take_sets(path, raw.sets, used.number, raw_nodes, mesh, notes);
    if (mesh.nodes.size() < raw_nodes) mesh.file_number = std::move(used.number);
    return mesh;
}

}  // namespace

void turn_inverted(Mesh& mesh, const std::string& name, std::vector<std::string>* notes) {
    require_valid(mesh, name);
    reverse_inverted(name, mesh, notes);
    for (auto& [set_name, set] : mesh.sets) {
        require_set(name, set_name, set, mesh.nodes.size(), mesh.tetrahedra);
        tidy(set);
    }
    match_faces(mesh.tetrahedra, mesh.sets);
}

Mesh read(const std::string& path, std::vector<std::string>* notes) {
    RawMesh raw = read_raw(path, false, notes);
    if (raw.tetrahedra.empty())
        refuse_in(path, {}, {}, "no tetrahedra", "at least one tetrahedron",
                  "the file has " + elements_text(raw) + "; export the mesh with tetrahedra");
    return take_tetrahedra(path, raw, notes);
}

namespace {

SurfaceMesh take_triangles(const std::string& path, RawMesh& raw) {
    if (raw.curved_triangles > 0)
        refuse_in(path, {}, {}, std::to_string(raw.curved_triangles) + " triangles of third or higher order",
                  "triangles of first or second order", "export the surface with linear elements");
    if (raw.triangles.empty())
        refuse_in(path, {}, {}, "no triangles", "at least one triangle",
                  "the file has " + elements_text(raw) + "; export the surface as triangles");
    SurfaceMesh surface;
    surface.nodes = drop_unused(raw.nodes, raw.triangles).nodes;
    surface.triangles = std::move(raw.triangles);
    return surface;
}

}  // namespace

SurfaceMesh read_surface(const std::string& path, std::vector<std::string>* notes) {
    RawMesh raw = read_raw(path, true, notes);
    return raw.tetrahedra.empty() ? take_triangles(path, raw) : boundary(take_tetrahedra(path, raw, notes));
}

namespace {

/// Reads the .mtl files of an .obj file, and fills in the properties of the materials that the .obj file uses.
void read_materials(const std::string& path, const std::vector<std::string>& files,
                    std::vector<VisualMaterial>& materials, std::vector<std::string>* notes) {
    std::set<std::string> missing;
    for (const VisualMaterial& material : materials) missing.insert(material.name);
    for (const std::string& name : files) {
        const std::filesystem::path file = std::filesystem::path(path).parent_path() / name;
        if (!std::filesystem::is_regular_file(file)) {
            if (notes) notes->push_back(path + ": the material file " + in_quotes(name) + " does not exist");
            continue;
        }
        FileReader reader(file.string());
        for (VisualMaterial& found : read_mtl(reader)) {
            const auto used = std::ranges::find(materials, found.name, &VisualMaterial::name);
            if (used == materials.end()) continue;
            missing.erase(found.name);
            *used = std::move(found);
            // A saved world must find the image from any working folder, so the path is made absolute.
            if (!used->texture.empty())
                used->texture = std::filesystem::absolute(used->texture).lexically_normal().string();
        }
    }
    if (!notes) return;
    for (const std::string& name : missing)
        notes->push_back(path + ": no material file defines the material " + in_quotes(name) + ", which is drawn grey");
}

}  // namespace

VisualSurface read_visual(const std::string& path, std::vector<std::string>* notes) {
    RawMesh raw = read_raw(path, true, notes);
    VisualSurface visual = std::move(raw.visual);
    SurfaceMesh surface =
        raw.tetrahedra.empty() ? take_triangles(path, raw) : boundary(take_tetrahedra(path, raw, notes));
    visual.nodes = std::move(surface.nodes);
    visual.triangles = std::move(surface.triangles);
    visual.file = path;
    read_materials(path, raw.material_files, visual.materials, notes);
    return visual;
}

Mesh read_rigid(const std::string& path, std::vector<std::string>* notes) {
    RawMesh raw = read_raw(path, true, notes);
    if (!raw.tetrahedra.empty()) return take_tetrahedra(path, raw, notes);
    SurfaceMesh surface = take_triangles(path, raw);
    return {.nodes = std::move(surface.nodes), .tetrahedra = {}, .triangles = std::move(surface.triangles)};
}

}  // namespace skerry::mesh
