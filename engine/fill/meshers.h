// The meshers that fill surfaces: Netgen and fTetWild.
#pragma once

#include <string>

#include "engine/fill/mesher_process.h"

namespace skerry::mesh {

/// Settings with which meshers are started.
struct MesherSetup {
    FillLimits limits{};
    std::string python{};  // see FillSettings::python
    FillProgress progress{};
};

/// Path of skerry-fill: the value of the environment variable SKERRY_FILL, or else the program in the folder of this
/// program or in a folder of PATH. Empty if there is none.
std::string netgen_program();

/// Explains how to install Netgen.
extern const char* const install_netgen;

/// Command that starts the Python interpreter with the package wildmeshing. `given`: value of FillSettings::python.
std::string python_program(const std::string& given);

/// Fills closed manifold surfaces that do not cross with tetrahedra of edge length up to about `largest_edge` [m]. The
/// surface is unchanged bitwise: its nodes are the first nodes of the mesh. `doing`: activity that is shown.
MesherResult fill_by_netgen(const SurfaceMesh& surface, Real largest_edge, const MesherSetup& setup,
                            const std::string& doing);

/// Fills any surface. The edges of the surface and of the tetrahedra have about the length `edge` [m]. Points of the
/// surface move by up to `envelope` [m].
MesherResult fill_by_ftetwild(const SurfaceMesh& surface, Real edge, Real envelope, const MesherSetup& setup);

}  // namespace skerry::mesh
