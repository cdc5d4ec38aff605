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

/// Command that starts the Python interpreter with the package wildmeshing: `setting`, the value of
/// FillSettings::python, if it is not empty, else the environment variable SKERRY_FILL_PYTHON, else python3.
std::string python_program(const std::string& setting);

/// Fills a closed manifold surface that does not cross itself, with edges of at most about the length `largest_edge`
/// [m]. The nodes of the surface are the first nodes of the mesh, unchanged to the last bit. `doing`: text for
/// setup.progress while Netgen runs.
MesherResult fill_by_netgen(const SurfaceMesh& surface, Real largest_edge, const MesherSetup& setup,
                            const std::string& doing);

/// Fills any surface, also with holes or crossings. The edges of the new surface and of the tetrahedra have about the
/// length `edge` [m]. Points of the surface move by up to `envelope` [m].
MesherResult fill_by_ftetwild(const SurfaceMesh& surface, Real edge, Real envelope, const MesherSetup& setup);

}  // namespace skerry::mesh
