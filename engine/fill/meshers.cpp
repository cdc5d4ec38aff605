#include "engine/fill/meshers.h"

#include <unistd.h>

#include <cstdlib>
#include <filesystem>
#include <sstream>
#include <system_error>

#include "engine/base/complaint.h"
#include "engine/mesh/repair/surface_measures.h"

namespace skerry::mesh {

namespace {

/// Program for the Python interpreter: fills the surface of standard input (see run_mesher). Its argument is the
/// envelope, the largest allowed movement of the surface, as a fraction of the diagonal of the bounding box.
constexpr const char* ftetwild_script = R"(
import os, sys
try:
    import numpy, wildmeshing
except ImportError as error:
    sys.exit(print(error, file=sys.stderr) or 3)
nodes, triangles, edge = sys.stdin.readline().split()
nodes, triangles = int(nodes), int(triangles)
# fTetWild writes its input to a file of the current folder, which fails in this folder, and prints an error message.
os.chdir("/proc")
sys.stderr = os.fdopen(os.dup(2), "w")
os.dup2(os.open(os.devnull, os.O_WRONLY), 2)
numbers = numpy.fromstring(sys.stdin.read(), sep=" ")
points = numbers[:3 * nodes].reshape(-1, 3)
faces = numbers[3 * nodes:].astype(numpy.int32).reshape(-1, 3)
diagonal = numpy.linalg.norm(points.max(axis=0) - points.min(axis=0))
mesher = wildmeshing.Tetrahedralizer(
    epsilon=float(sys.argv[1]), edge_length_r=float(edge) / diagonal, coarsen=False, max_threads=1)
mesher.set_log_level(6)
mesher.set_mesh(points, faces)
mesher.tetrahedralize()
points, tetrahedra = mesher.get_tet_mesh(manifold_surface=True, correct_surface_orientation=True)[:2]
if len(tetrahedra) == 0:
    sys.exit("the surface encloses no volume")
used, tetrahedra = numpy.unique(tetrahedra, return_inverse=True)
points, tetrahedra = points[used], tetrahedra.reshape(-1, 4)
with os.fdopen(3, "w") as out:
    out.write(f"{len(points)} {len(tetrahedra)}\n")
    numpy.savetxt(out, points, "%.17g")
    numpy.savetxt(out, tetrahedra, "%d")
os._exit(0)
)";

std::string value_of(const char* variable) {
    const char* value = std::getenv(variable);
    return value ? value : "";
}

std::function<void()> waiting(const MesherSetup& setup, const std::string& doing) {
    if (!setup.progress) return {};
    return [&setup, doing] { setup.progress(doing); };
}

}  // namespace

const char* const install_netgen =
    "install Netgen's library (apt-get install libnglib-dev), then configure and build Skerry again";

std::string netgen_program() {
    if (std::string named = value_of("SKERRY_FILL"); !named.empty()) return named;
    std::error_code ignored;
    std::istringstream folders(std::filesystem::read_symlink("/proc/self/exe", ignored).parent_path().string() + ":" +
                               value_of("PATH"));
    for (std::string folder; std::getline(folders, folder, ':');)
        if (const std::filesystem::path program = std::filesystem::path(folder) / "skerry-fill";
            access(program.c_str(), X_OK) == 0)
            return program.string();
    return {};
}

std::string python_program(const std::string& setting) {
    if (!setting.empty()) return setting;
    const std::string named = value_of("SKERRY_FILL_PYTHON");
    return named.empty() ? "python3" : named;
}

MesherResult fill_by_netgen(const SurfaceMesh& surface, Real largest_edge, const MesherSetup& setup,
                            const std::string& doing) {
    const std::string program = netgen_program();
    if (program.empty()) return {.failure = "is not installed: no program skerry-fill", .missing = true};
    return run_mesher(surface, largest_edge,
                      {.command = {program}, .limits = setup.limits, .wait = waiting(setup, doing)});
}

MesherResult fill_by_ftetwild(const SurfaceMesh& surface, Real edge, Real envelope, const MesherSetup& setup) {
    return run_mesher(surface, edge,
                      {.command = {python_program(setup.python), "-c", ftetwild_script,
                                   short_text(envelope / box_diagonal(surface), 17)},
                       .limits = setup.limits,
                       .wait = waiting(setup, "filling the surface by fTetWild")});
}

}  // namespace skerry::mesh
