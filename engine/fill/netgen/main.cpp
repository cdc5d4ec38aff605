// skerry-fill: reads a closed surface from standard input and writes tetrahedra that fill the surface (formats:
// engine/fill/mesher_process.h). mesh::fill and `skerry inspect --repair` start it. It is a separate program for two
// reasons:
// - `skerry` then does not link Netgen (LGPL) and the libraries that Debian's build of Netgen loads (CAD libraries,
//   Tcl, Python and MPI).
// - If Netgen crashes on a surface, only this process ends.
#include <cstdio>
#include <cstdlib>
#include <iostream>
#include <vector>

namespace nglib {
#include <nglib.h>
}

namespace {

// output goes to this file descriptor, because Netgen prints its own messages to standard output
constexpr int output = 3;

bool read_surface(nglib::Ng_Mesh* mesh, nglib::Ng_Meshing_Parameters& settings) {
    long nodes = 0, triangles = 0;
    if (!(std::cin >> nodes >> triangles >> settings.maxh)) return false;
    for (long n = 0; n < nodes; ++n) {
        double x[3];
        if (!(std::cin >> x[0] >> x[1] >> x[2])) return false;
        nglib::Ng_AddPoint(mesh, x);
    }
    for (long t = 0; t < triangles; ++t) {
        int corner[3];
        if (!(std::cin >> corner[0] >> corner[1] >> corner[2])) return false;
        for (int& n : corner) ++n;
        nglib::Ng_AddSurfaceElement(mesh, nglib::NG_TRIG, corner);
    }
    return true;
}

bool write_mesh(nglib::Ng_Mesh* mesh) {
    std::FILE* out = fdopen(output, "w");
    if (!out) return false;
    const int nodes = nglib::Ng_GetNP(mesh), tetrahedra = nglib::Ng_GetNE(mesh);
    std::fprintf(out, "%d %d\n", nodes, tetrahedra);
    for (int n = 1; n <= nodes; ++n) {
        double x[3];
        nglib::Ng_GetPoint(mesh, n, x);
        std::fprintf(out, "%.17g %.17g %.17g\n", x[0], x[1], x[2]);
    }
    for (int t = 1; t <= tetrahedra; ++t) {
        int corner[10];
        nglib::Ng_GetVolumeElement(mesh, t, corner);
        std::fprintf(out, "%d %d %d %d\n", corner[0] - 1, corner[1] - 1, corner[2] - 1, corner[3] - 1);
    }
    return std::fclose(out) == 0;
}

}  // namespace

int main() {
    nglib::Ng_Init();
    nglib::Ng_Mesh* mesh = nglib::Ng_NewMesh();
    nglib::Ng_Meshing_Parameters settings;
    settings.uselocalh = 0;
    settings.closeedgeenable = 0;
    settings.minh = 0;
    settings.optvolmeshenable = 1;
    settings.optsteps_3d = 5;
    if (!read_surface(mesh, settings)) return 2;
    if (nglib::Ng_GenerateVolumeMesh(mesh, &settings) != nglib::NG_OK) return 1;
    // std::_Exit skips the exit handlers of Netgen and the libraries that it loads, whose behaviour this program cannot
    // control.
    std::_Exit(write_mesh(mesh) ? 0 : 2);
}
