// Fills a clean surface by Netgen in several ways, and keeps the mesh with the longest stable step.
#pragma once

#include <cstddef>
#include <functional>
#include <string>

#include "engine/fill/meshers.h"
#include "engine/fill/regions.h"

namespace skerry::mesh {

struct BestMeshTask {
    SurfaceMesh surface{};      // closed manifold that does not cross itself
    Real edge = 0;              // wanted edge length of the tetrahedra [m]
    Real tolerance = 0;         // largest movement of the surface; 0: it stays unchanged [m]
    Real least_count = 0;       // smallest accepted number of tetrahedra; with fewer the mesh would be too coarse
    bool all_cavities = false;  // see FillSettings::cavities
    MesherSetup setup{};
    std::function<Real(const Mesh&)> stable_step{};  // [s]
};

struct BestMesh {
    Mesh mesh;
    Real step = 0;                           // stable step; 0: no mesh was found [s]
    std::size_t collapsed = 0, flipped = 0;  // numbers of surface edges that were collapsed or flipped
    std::string failure{};                   // reason why no mesh was found
    bool missing = false;                    // true if the mesher is not installed
    // true if a failed call of the mesher may succeed later, see MesherResult::may_change
    bool may_change = false;
};

/// A mesh with a changed surface replaces the mesh with the given surface if the stable step of the former is longer by
/// this factor.
inline constexpr Real least_gain = 1.05;

/// Fills the surface several times, with different sizes of tetrahedra, and returns the mesh with the longest stable
/// step. With a tolerance above 0 it also tries the surface without needles and caps, which are thin triangles
/// (remove_flat_triangles.h).
BestMesh best_mesh(const BestMeshTask& task);

}  // namespace skerry::mesh
