// Runs a mesher, a separate program that fills a surface with tetrahedra. If the mesher crashes, hangs or needs too
// much memory, only its process ends.
#pragma once

#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "skerry/fill.h"

namespace skerry::mesh {

struct MesherCall {
    std::vector<std::string> command;  // path of the program, or its name if it is in PATH, and the arguments
    FillLimits limits{};
    // Called about 50 times a second while the mesher runs. If it throws, run_mesher kills the mesher and throws the
    // same exception.
    std::function<void()> wait{};
};

/// The tetrahedra that a mesher made, or the reason why there are none.
struct MesherResult {
    std::optional<Mesh> mesh{};
    // end of a message that begins with the mesher's name: "crashed: ..."; empty if there is a mesh
    std::string failure{};
    bool missing = false;  // true if the program or the package of the mesher is not installed
    bool stopped = false;  // true if a limit ended the mesher
    bool crashed = false;  // true if a signal ended the mesher

    /// True if the same call may find a mesh later or on another machine, because the mesher was missing, hit a limit
    /// or crashed.
    bool may_change() const { return missing || stopped || crashed; }
};

/// Exit code of a mesher whose package is not installed.
inline constexpr int exit_missing = 3;

/// Runs a mesher. Throws std::system_error if no process or temporary file can be created. The mesher reads and writes
/// text, with nodes counted from 0:
/// - standard input: "NODES TRIANGLES LARGEST_EDGE", then lines "x y z" of the nodes and lines "a b c" of the triangles
/// - file descriptor 3, for the result: "NODES TETRAHEDRA", then lines "x y z" of the nodes and lines "a b c d" of the
///   tetrahedra
///
/// Any other result counts as a failure. No tetrahedron of the result is inverted, but some may be flat.
MesherResult run_mesher(const SurfaceMesh& surface, Real largest_edge, const MesherCall& call);

}  // namespace skerry::mesh
