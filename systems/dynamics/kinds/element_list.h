// The elements of a new body, before they are packed into lanes.
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "components/material_table.h"
#include "components/options.h"
#include "components/types.h"

namespace skerry {

/// Elements with their nodes, gradients and volumes. Nodes and tetrahedra are those of the body, numbered from zero.
struct ElementList {
    std::vector<std::size_t> first_node{0};         // of element e in node and gradient; size() + 1 entries
    std::vector<Index> node;                        // the first node of each element is the reference x_0 of F
    std::vector<Vec3> gradient;                     // sums to zero in each element [1/m]
    std::vector<std::size_t> first_tetrahedron{0};  // of element e in tetrahedron; size() + 1 entries
    std::vector<Index> tetrahedron;                 // tetrahedra that each element covers
    std::vector<Real> volume;                       // m^3, at rest
    std::vector<ElementPart> part;
    std::vector<Index> material;  // row of MaterialTable

    std::size_t size() const { return volume.size(); }
    std::size_t nodes_of(std::size_t e) const { return first_node[e + 1] - first_node[e]; }
};

/// Rest volume (m^3) and gradients (1/m) of the shape functions of a tetrahedron.
struct TetrahedronGradients {
    std::array<Vec3, 4> g;
    Real volume;
};

/// Six times the volume of a tetrahedron at rest [m^3].
Real six_volumes(const std::array<Index, 4>& tetrahedron, std::span<const Vec3> rest_position);

/// Gradients of a tetrahedron. Its volume must be positive.
TetrahedronGradients tetrahedron_gradients(const std::array<Index, 4>& tetrahedron,
                                           std::span<const Vec3> rest_position);

/// Mesh at rest, from which elements are made.
struct RestMesh {
    std::span<const std::array<Index, 4>> tetrahedra;
    std::span<const Vec3> position;  // m
};

/// The elements of a kind, all of one material. `kind` must not be `smoothed`: resolve it first with resolved().
ElementList elements_of(const RestMesh& mesh, ElementKind kind, Index material = 0);

/// Tetrahedra of one material, and the kind of their elements.
struct MaterialZone {
    Index material;  // row of MaterialTable
    ElementKind kind;
    std::vector<Index> tetrahedra;  // ascending
};

/// The elements of all zones, zone after zone. No element covers tetrahedra of two zones, so that no strain is averaged
/// across an interface, where it jumps (docs/methods/elasticity.md 7.6).
ElementList elements_of(const RestMesh& mesh, std::span<const MaterialZone> zones);

/// A tetrahedron with less than this share of the mean volume of the tetrahedra around each of its corners is a sliver:
/// no step is shortened to keep it from inverting (docs/methods/time_stepping.md 4.2).
inline constexpr Real sliver_volume = 0.05;

/// For each tetrahedron 1 if it is a sliver, else 0.
std::vector<std::uint8_t> sliver_tetrahedra(const RestMesh& mesh);

/// Tetrahedra below this share of the mean volume get guards: so small a tetrahedron has little effect on the means
/// around its edges and nodes (docs/methods/elasticity.md 7.7).
inline constexpr Real guarded_volume = 0.5;

/// Adds a guard, behind all other elements, for every small tetrahedron that is not a sliver in the zones of smoothed
/// elements. A guard covers no tetrahedron, since it does not contribute to reported stress or strain. Its volume is
/// zero until it acts (clusters/arm_guards.h).
void add_guards(const RestMesh& mesh, std::span<const MaterialZone> zones, ElementList& list);

/// The kind for which `smoothed` stands; other kinds are returned as they are. Above a Poisson ratio of 0.25 the
/// volumetric modulus lambda is more than the shear modulus, and elements smoothed over edges alone begin to lock
/// (docs/methods/elasticity.md 7.3).
ElementKind resolved(ElementKind kind, Real poisson_ratio);

/// Makes every tetrahedron an element of constant strain, the stiffest kind.
void add_tetrahedron_elements(const RestMesh& mesh, ElementList& list);

/// Makes every edge an element: F is the mean over the tetrahedra around it, each of which gives it a sixth of its
/// volume (Liu, Nguyen-Thoi, Vu-Do, Lam: An edge-based smoothed finite element method, 2009).
void add_edge_elements(const RestMesh& mesh, ElementPart part, ElementList& list);

/// Makes every node an element: F is the mean over the tetrahedra around it, each of which gives it a quarter of its
/// volume. Too soft for all of the stress, right for its volumetric part
/// (selective smoothing: Nguyen-Thoi, Liu, Lam, Zhang: A face-based smoothed finite element method, 2009, 5).
void add_node_elements(const RestMesh& mesh, ElementPart part, ElementList& list);

}  // namespace skerry
