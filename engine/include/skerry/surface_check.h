// Checks of triangle surfaces: connections, shells and intersections.
#pragma once

#include <string>
#include <vector>

#include "components/options.h"
#include "skerry/mesh.h"

#pragma GCC visibility push(default)
namespace skerry {

/// Faults of a triangle surface. `mesh::check_surface` repairs the first five kinds in SurfaceReport::cleaned.
enum class SurfaceFaultKind {
    flat_triangles,       // two corners are one node after merging
    duplicate_triangles,  // the same three nodes as an earlier triangle
    turned_triangles,     // orientation opposite to that of most connected triangles
    inside_out_shells,    // closed shells that enclose a negative volume and lie in no other shell
    duplicate_shells,     // the same surface as an earlier shell
    holes,                // connected edges with only one triangle
    branching_edges,      // edges with more than two triangles
    pinched_nodes,        // nodes at which parts of the surface meet without a common edge
    one_sided_shells,     // shells without an orientation, such as a Moebius strip
    crossings,            // pairs of triangles of one shell that pass through each other
    shell_crossings,      // pairs of triangles of different shells that pass through each other
    overlaps,             // pairs of triangles that overlap in a common plane
    flat_shells,          // closed shells without volume
    doubled_volumes,      // triangles or edges on the inner side of which the volumes of closed shells overlap
    slivers,              // triangles whose smallest altitude is at most the overlap that check_surface() tolerates
    thin_walls,           // sampled places at which the wall is thinner than half the mean edge
    unlikely_size,        // a size above 20 m or below 1e-6 m, probably a wrong unit of length
};
template <>
struct EnumNames<SurfaceFaultKind> {
    static constexpr std::array<std::pair<SurfaceFaultKind, std::string_view>, 17> table{{
        {SurfaceFaultKind::flat_triangles, "flat_triangles"},
        {SurfaceFaultKind::duplicate_triangles, "duplicate_triangles"},
        {SurfaceFaultKind::turned_triangles, "turned_triangles"},
        {SurfaceFaultKind::inside_out_shells, "inside_out_shells"},
        {SurfaceFaultKind::duplicate_shells, "duplicate_shells"},
        {SurfaceFaultKind::holes, "holes"},
        {SurfaceFaultKind::branching_edges, "branching_edges"},
        {SurfaceFaultKind::pinched_nodes, "pinched_nodes"},
        {SurfaceFaultKind::one_sided_shells, "one_sided_shells"},
        {SurfaceFaultKind::crossings, "crossings"},
        {SurfaceFaultKind::shell_crossings, "shell_crossings"},
        {SurfaceFaultKind::overlaps, "overlaps"},
        {SurfaceFaultKind::flat_shells, "flat_shells"},
        {SurfaceFaultKind::doubled_volumes, "doubled_volumes"},
        {SurfaceFaultKind::slivers, "slivers"},
        {SurfaceFaultKind::thin_walls, "thin_walls"},
        {SurfaceFaultKind::unlikely_size, "unlikely_size"},
    }};
};

/// All faults of one kind. Triangles are given by their numbers in the given surface, from 0.
struct SurfaceFault {
    SurfaceFaultKind kind{};    // kind of the fault
    std::size_t count = 0;      // number of faults; the comment on the kind says of which objects
    Index triangle = no_index;  // first triangle with the fault; for holes: a triangle at the longest hole
    // Second triangle of the first pair, if the kind counts pairs of triangles. For duplicate_shells: a triangle of the
    // shell that is repeated. For other kinds: no_index.
    Index other = no_index;
    Vec3 place = Vec3::Zero();  // place of the first fault; for holes: centre of the longest hole [m]
    Real length = 0;            // holes: length of the edges around the longest hole; thin_walls: smallest thickness;
                                // duplicate_shells: largest distance to the repeated shell; unlikely_size: diagonal [m]
};

/// Part of a surface whose triangles are connected by common edges. If several volumes meet at an edge, the edge
/// connects only triangles that bound the same volume.
struct SurfaceShell {
    std::size_t triangles = 0;  // number of triangles
    Index triangle = no_index;  // first triangle, by its number in the given surface
    bool closed = false;        // true if it has no open edges and a consistent orientation
    // enclosed volume after the orientation is repaired; negative for a void in another shell; 0 if not closed [m^3]
    Real volume = 0;
    // Row in SurfaceReport::shells of the closed shell of least volume around this one; no_index: none. A shell that
    // lies inside another one bounds a void if its volume is negative, otherwise a region of its own.
    Index around = no_index;
};

/// Result of mesh::check_surface: sizes, faults and shells of a surface, and the repaired surface.
struct SurfaceReport {
    std::size_t nodes = 0, triangles = 0;             // numbers of nodes and triangles of the given surface
    Vec3 lower = Vec3::Zero(), upper = Vec3::Zero();  // bounding box [m]
    Real tolerance = 0;                               // nodes up to this distance apart were merged; negative: none [m]
    std::size_t merged = 0;                           // number of nodes that were merged into another node
    Real min_edge = 0, mean_edge = 0, max_edge = 0;   // edge lengths of the cleaned surface [m]
    // area of the cleaned surface [m^2]; volume inside its closed shells, without voids [m^3]
    Real area = 0, volume = 0;
    // faults, at most one entry of each kind, in the order of the kinds
    std::vector<SurfaceFault> faults{};
    // The given surface after repair: near nodes are merged, and flat triangles, duplicate triangles and duplicate
    // shells are removed. Connected triangles have the same orientation, and closed shells that lie in no other shell
    // enclose a positive volume. Holes and crossings remain.
    SurfaceMesh cleaned{};
    std::vector<Index> number{};         // for each triangle of `cleaned`: its number in the given surface
    std::vector<Index> shell{};          // for each triangle of `cleaned`: its row in `shells`
    std::vector<SurfaceShell> shells{};  // shells in the order of their first triangles

    /// The faults of a kind; nullptr if there are none.
    const SurfaceFault* find(SurfaceFaultKind kind) const {
        for (const SurfaceFault& fault : faults)
            if (fault.kind == kind) return &fault;
        return nullptr;
    }
    /// True if `cleaned` bounds volumes that can be filled with tetrahedra without moving its nodes: `faults` has none
    /// of the kinds from `holes` to `slivers`, except doubled_volumes.
    bool can_be_filled() const;
};

namespace mesh {

/// Default tolerance of check_surface(), as a fraction of the diagonal of the bounding box. It is larger than rounding
/// errors of positions with seven digits, as in STL files.
inline constexpr Real default_weld = 1e-6;
/// A tolerance for check_surface() with which no nodes are merged, not even equal ones.
inline constexpr Real no_weld = -1;

/// Checks a surface. `name` is its name in errors. Throws SceneError if a node is not finite or a triangle has a node
/// that does not exist.
///
/// - Merging: first merges nodes that are at most d = `tolerance` * (diagonal of the bounding box) apart; a chain of
///   such nodes becomes one node. With the tolerance 0 only equal nodes are merged. The order of the nodes and
///   triangles does not change.
/// - Crossing: two triangles cross if their projections on every axis overlap by more than the tolerated overlap. This
///   is the larger of d and default_weld times the diagonal.
SurfaceReport check_surface(const SurfaceMesh& surface, Real tolerance = default_weld,
                            const std::string& name = "surface");

/// Merges nodes that are at most `distance` [m] apart, as check_surface() does. Then removes triangles that have fewer
/// than three different nodes. `number`, if given, gets for each remaining triangle its number in `surface`.
SurfaceMesh weld(const SurfaceMesh& surface, Real distance, std::vector<Index>* number = nullptr);

/// Describes the faults of a kind with their number and the first place, for example "2 holes, the longest 0.3 m around
/// at (0, 0, 1) m, triangle 17".
std::string fault_text(const SurfaceFault& fault);

}  // namespace mesh
}  // namespace skerry
#pragma GCC visibility pop
