// Elements of a new body, before they are packed into lanes of blocks.
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "components/material_table.h"
#include "components/options.h"
#include "components/types.h"

namespace skerry {

/// Elements with their nodes, gradients and volumes. Nodes and tetrahedra are numbered from zero within the body.
struct ElementList {
    std::vector<std::size_t> first_node{0};         // first entry of element e in node and gradient; size() + 1 entries
    std::vector<Index> node;                        // nodes of each element; the first node is the reference x_0 of F
    std::vector<Vec3> gradient;                     // by entry of `node`, at rest; sum over an element: zero [1/m]
    std::vector<std::size_t> first_tetrahedron{0};  // first entry of element e in tetrahedron; size() + 1 entries
    std::vector<Index> tetrahedron;                 // tetrahedra over which each element averages F; none for barriers
    std::vector<Real> volume;                       // rest volume [m^3]; 0 for inversion barriers
    std::vector<ElementPart> part;
    std::vector<Index> material;  // row of MaterialTable

    std::size_t size() const { return volume.size(); }
    std::size_t nodes_of(std::size_t e) const { return first_node[e + 1] - first_node[e]; }
};

/// Gradients of the shape functions of a tetrahedron at rest [1/m], and its rest volume [m^3].
struct TetrahedronGradients {
    std::array<Vec3, 4> g;
    Real volume;
};

/// Six times the volume of a tetrahedron at rest [m^3].
Real six_volumes(const std::array<Index, 4>& tetrahedron, std::span<const Vec3> rest_position);

/// Gradients of the shape functions of a tetrahedron, and its volume, which must be positive.
TetrahedronGradients tetrahedron_gradients(const std::array<Index, 4>& tetrahedron,
                                           std::span<const Vec3> rest_position);

/// Tetrahedral mesh at rest, from which elements are made.
struct RestMesh {
    std::span<const std::array<Index, 4>> tetrahedra;
    std::span<const Vec3> position;  // m
};

/// Makes the elements of a mesh, all of one kind and one material. `kind` must not be `smoothed`: replace it by
/// resolved() first.
ElementList elements_of(const RestMesh& mesh, ElementKind kind, Index material = 0);

/// Tetrahedra of one material, and the kind of elements made from them.
struct MaterialZone {
    Index material;  // row of MaterialTable
    ElementKind kind;
    std::vector<Index> tetrahedra;  // ascending
};

/// Makes the elements of all zones, zone after zone. No element covers tetrahedra of two zones, because the strain
/// jumps at an interface and must not be averaged across it (docs/methods/elasticity.md 7.6).
ElementList elements_of(const RestMesh& mesh, std::span<const MaterialZone> zones);

/// Upper limit on the volume of a sliver, as a fraction of the mean volume of the tetrahedra around a corner. A
/// tetrahedron is a sliver if its volume is below this limit at all its corners. No step is shortened to keep a sliver
/// from inverting (docs/methods/time_stepping.md 4.2).
inline constexpr Real sliver_volume = 0.05;

/// For each tetrahedron: 1 if the tetrahedron is a sliver, else 0.
std::vector<std::uint8_t> sliver_tetrahedra(const RestMesh& mesh);

/// Upper limit on the volume of a tetrahedron with an inversion barrier (guard), as a fraction of the mean volume of
/// all tetrahedra of the mesh. Smaller tetrahedra need a barrier: they have little effect on the mean deformation
/// gradients of smoothed elements, which thus hardly resist their inversion (docs/methods/elasticity.md 7.7).
inline constexpr Real guarded_volume = 0.5;

/// Adds an inversion barrier (guard) for every small tetrahedron in the zones of smoothed elements, except slivers.
/// Barriers follow all other elements of the list. Reported stress and strain leave them out, so they cover no
/// tetrahedron. The volume of an inactive barrier is zero (clusters/arm_guards.h).
void add_guards(const RestMesh& mesh, std::span<const MaterialZone> zones, ElementList& list);

/// Returns the element kind that suits the Poisson ratio in place of `smoothed`; other kinds are returned unchanged.
/// Above a Poisson ratio of 0.25 Lame's lambda exceeds the shear modulus, and elements smoothed over edges alone begin
/// to lock (docs/methods/elasticity.md 7.3).
ElementKind resolved(ElementKind kind, Real poisson_ratio);

/// Makes every tetrahedron an element of constant strain. These elements are the stiffest kind.
void add_tetrahedron_elements(const RestMesh& mesh, ElementList& list);

/// Makes every edge an element. Its deformation gradient F is the mean over the tetrahedra around the edge. Each of
/// these tetrahedra adds a sixth of its volume to the element (Liu, Nguyen-Thoi, Vu-Do, Lam: An edge-based smoothed
/// finite element method, 2009).
void add_edge_elements(const RestMesh& mesh, ElementPart part, ElementList& list);

/// Makes every node an element. Its deformation gradient F is the mean over the tetrahedra around the node, each of
/// which adds a quarter of its volume to the element. Such elements serve for the volumetric part of the stress; for
/// the whole stress they are too soft (selective smoothing: Nguyen-Thoi, Liu, Lam, Zhang: A face-based smoothed finite
/// element method, 2009, 5).
void add_node_elements(const RestMesh& mesh, ElementPart part, ElementList& list);

}  // namespace skerry
