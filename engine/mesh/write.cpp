#include <filesystem>
#include <limits>
#include <map>
#include <ostream>
#include <string>

#include "engine/base/complaint.h"
#include "engine/base/write_file.h"
#include "engine/mesh/tetrahedron.h"
#include "skerry/mesh.h"

namespace skerry::mesh {

namespace {

std::string name_in_file(const std::string& name) {
    std::string text = name;
    for (char& c : text)
        if (c == '"' || c == '\n' || c == '\r') c = '_';
    return '"' + text + '"';
}

/// Writes the names of the sets of nodes (as physical groups of points) and of faces (as physical groups of surfaces).
/// A group has the number of its set, counted from 1.
void write_names(std::ostream& out, const std::map<std::string, MeshSet>& sets) {
    std::size_t count = 0, number = 0;
    for (const auto& [name, set] : sets) count += (set.nodes.empty() ? 0u : 1u) + (set.faces.empty() ? 0u : 1u);
    if (count == 0) return;
    out << "$PhysicalNames\n" << count << '\n';
    for (const auto& [name, set] : sets) {
        ++number;
        if (!set.nodes.empty()) out << "0 " << number << ' ' << name_in_file(name) << '\n';
        if (!set.faces.empty()) out << "2 " << number << ' ' << name_in_file(name) << '\n';
    }
    out << "$EndPhysicalNames\n";
}

/// Writes the nodes and faces of sets as Gmsh elements of the types point (15) and triangle (2). `element`: number of
/// elements that are already written.
void write_members(std::ostream& out, const std::map<std::string, MeshSet>& sets, std::size_t element) {
    std::size_t number = 0;
    for (const auto& [name, set] : sets) {
        ++number;
        for (const Index n : set.nodes) out << ++element << " 15 2 " << number << ' ' << number << ' ' << n + 1 << '\n';
        for (const auto& [a, b, c] : set.faces)
            out << ++element << " 2 2 " << number << ' ' << number << ' ' << a + 1 << ' ' << b + 1 << ' ' << c + 1
                << '\n';
    }
}

/// Writes each set of tetrahedra as element data with the value 1. The format allows a tetrahedron only one physical
/// group, and this group already holds the label.
void write_tetrahedra(std::ostream& out, const std::map<std::string, MeshSet>& sets) {
    for (const auto& [name, set] : sets) {
        if (set.tetrahedra.empty()) continue;
        out << "$ElementData\n1\n" << name_in_file(name) << "\n1\n0\n3\n0\n1\n" << set.tetrahedra.size() << '\n';
        for (const Index t : set.tetrahedra) out << t + 1 << " 1\n";
        out << "$EndElementData\n";
    }
}

}  // namespace

void write(const std::string& path, const Mesh& mesh) {
    const std::filesystem::path file(path);
    if (file.extension() != ".msh")
        refuse_in(path, {}, "file name",
                  file.has_extension() ? "the extension " + file.extension().string() : "no extension",
                  "the extension .msh");
    require_valid(mesh, path);
    write_file(file, [&](std::ostream& out) {
        out.precision(std::numeric_limits<Real>::max_digits10);
        out << "$MeshFormat\n2.2 0 8\n$EndMeshFormat\n";
        write_names(out, mesh.sets);
        out << "$Nodes\n" << mesh.nodes.size() << '\n';
        for (std::size_t n = 0; n < mesh.nodes.size(); ++n)
            out << n + 1 << ' ' << mesh.nodes[n].x() << ' ' << mesh.nodes[n].y() << ' ' << mesh.nodes[n].z() << '\n';
        std::size_t elements = mesh.tetrahedra.size();
        for (const auto& [name, set] : mesh.sets) elements += set.nodes.size() + set.faces.size();
        out << "$EndNodes\n$Elements\n" << elements << '\n';
        for (std::size_t e = 0; e < mesh.tetrahedra.size(); ++e) {
            const int label = mesh.label.empty() ? 1 : mesh.label[e];
            // Element type 4 is a tetrahedron. It has two tags: physical group and geometric volume.
            out << e + 1 << " 4 2 " << label << ' ' << label;
            for (const Index n : mesh.tetrahedra[e]) out << ' ' << n + 1;
            out << '\n';
        }
        write_members(out, mesh.sets, mesh.tetrahedra.size());
        out << "$EndElements\n";
        write_tetrahedra(out, mesh.sets);
    });
}

}  // namespace skerry::mesh
