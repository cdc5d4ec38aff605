// Fuzz targets for mesh files, which are read as tetrahedra and as a surface.
#include <algorithm>

#include "readers.h"
#include "skerry/error.h"
#include "skerry/mesh.h"
#include "tests/support/temporary_folder.h"

namespace skerry::test {

namespace {

std::string text_of(FileBytes bytes) {
    return {reinterpret_cast<const char*>(bytes.data()), bytes.size()};
}

const TemporaryFolder& folder() {
    static const TemporaryFolder made;
    return made;
}

template <std::size_t N>
void expect_rows(const std::vector<Vec3>& nodes, const std::vector<std::array<Index, N>>& rows) {
    for (const Vec3& x : nodes) expect_valid(x.allFinite(), "a node that is not finite");
    for (const auto& row : rows)
        for (const Index n : row)
            expect_valid(n >= 0 && static_cast<std::size_t>(n) < nodes.size(), "a row that names no node");
}

void use_body(const std::string& path) {
    try {
        const Mesh mesh = mesh::read(path);
        expect_rows(mesh.nodes, mesh.tetrahedra);
        inspect(mesh);
    } catch (const SceneError&) {
    }
}

void use_surface(const std::string& path) {
    try {
        const SurfaceMesh surface = mesh::read_surface(path);
        expect_rows(surface.nodes, surface.triangles);
    } catch (const SceneError&) {
    }
}

void use_file(const char* name, FileBytes bytes) {
    const std::string path = folder().write(name, text_of(bytes)).string();
    use_body(path);
    use_surface(path);
}

}  // namespace

void read_gmsh_bytes(FileBytes bytes) {
    use_file("mesh.msh", bytes);
}

void read_abaqus_bytes(FileBytes bytes) {
    use_file("mesh.inp", bytes);
}

void read_medit_bytes(FileBytes bytes) {
    use_file("mesh.mesh", bytes);
}

void read_vtk_bytes(FileBytes bytes) {
    use_file("mesh.vtk", bytes);
}

void read_vtu_bytes(FileBytes bytes) {
    use_file("mesh.vtu", bytes);
}

void read_obj_bytes(FileBytes bytes) {
    use_surface(folder().write("mesh.obj", text_of(bytes)).string());
}

void read_ply_bytes(FileBytes bytes) {
    use_surface(folder().write("mesh.ply", text_of(bytes)).string());
}

void read_stl_bytes(FileBytes bytes) {
    use_surface(folder().write("mesh.stl", text_of(bytes)).string());
}

void read_tetgen_bytes(FileBytes bytes) {
    const auto border = std::find(bytes.begin(), bytes.end(), 0);
    const bool found = border != bytes.end();
    const auto first =
        static_cast<std::size_t>(found ? border - bytes.begin() : static_cast<std::ptrdiff_t>(bytes.size() / 2));
    folder().write("mesh.node", text_of(bytes.first(first)));
    const std::string path = folder().write("mesh.ele", text_of(bytes.subspan(first + (found ? 1 : 0)))).string();
    use_body(path);
    use_surface(path);
}

}  // namespace skerry::test
