#include <filesystem>
#include <limits>
#include <ostream>

#include "engine/mesh/tetrahedron.h"
#include "engine/output/write_file.h"
#include "skerry/error.h"
#include "skerry/mesh.h"

namespace skerry::mesh {

void write(const std::string& path, const Mesh& mesh) {
    const std::filesystem::path file(path);
    if (file.extension() != ".msh")
        Complaint{path,
                  {},
                  "file name",
                  file.has_extension() ? "the extension " + file.extension().string() : "no extension",
                  "the extension .msh",
                  {}}
            .raise();
    require_valid(mesh, path);
    write_file(file, [&](std::ostream& out) {
        out.precision(std::numeric_limits<Real>::max_digits10);
        out << "$MeshFormat\n2.2 0 8\n$EndMeshFormat\n$Nodes\n" << mesh.nodes.size() << '\n';
        for (std::size_t n = 0; n < mesh.nodes.size(); ++n)
            out << n + 1 << ' ' << mesh.nodes[n].x() << ' ' << mesh.nodes[n].y() << ' ' << mesh.nodes[n].z() << '\n';
        out << "$EndNodes\n$Elements\n" << mesh.tetrahedra.size() << '\n';
        for (std::size_t e = 0; e < mesh.tetrahedra.size(); ++e) {
            const int label = mesh.label.empty() ? 1 : mesh.label[e];
            // Element type 4 is a tetrahedron. It has two tags: physical group and geometric volume.
            out << e + 1 << " 4 2 " << label << ' ' << label;
            for (const Index n : mesh.tetrahedra[e]) out << ' ' << n + 1;
            out << '\n';
        }
        out << "$EndElements\n";
    });
}

}  // namespace skerry::mesh
