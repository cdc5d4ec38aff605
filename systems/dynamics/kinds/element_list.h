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
    std::vector<std::size_t> first_node{0};  // of element e in node and gradient; one more than elements
    std::vector<Index> node;                 // the first of each element is the one that others are compared with
    std::vector<Vec3> gradient;              // 1/m, sums up to zero in each element
    std::vector<std::size_t> first_tetrahedron{0};  // of element e in tetrahedron; one more than elements
    std::vector<Index> tetrahedron;                 // those that the element covers
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

/// m^3, at rest.
Real six_volumes(const std::array<Index, 4>& tetrahedron, std::span<const Vec3> rest_position);

/// Of a tetrahedron with positive volume.
TetrahedronGradients tetrahedron_gradients(const std::array<Index, 4>& tetrahedron,
                                           std::span<const Vec3> rest_position);

/// What elements are made from.
struct RestMesh {
    std::span<const std::array<Index, 4>> tetrahedra;
    std::span<const Vec3> position;  // m
};

/// The elements of a kind, all of one material; `smoothed` has been resolved to one of the two that it stands for.
ElementList elements_of(const RestMesh& mesh, ElementKind kind, Index material = 0);

/// Tetrahedra of one material, and the kind of their elements.
struct MaterialZone {
    Index material;  // row of MaterialTable
    ElementKind kind;
    std::vector<Index> tetrahedra;  // ascending
};

/// The elements of each zone by itself, zone after zone: none covers tetrahedra of two, so that no strain is averaged
/// across an interface, where it jumps (docs/methods/elasticity.md 7.6).
ElementList elements_of(const RestMesh& mesh, std::span<const MaterialZone> zones);

/// A tetrahedron with less than this share of the mean volume of the tetrahedra around each of its corners is a sliver:
/// no step is shortened to keep it from turning over (docs/methods/time_stepping.md 4.2).
inline constexpr Real sliver_volume = 0.05;

/// Of each tetrahedron, whether it is a sliver.
std::vector<std::uint8_t> sliver_tetrahedra(const RestMesh& mesh);

/// Tetrahedra below this share of the mean volume have guards: what is as small shows little in the means around its
/// edges and nodes (docs/methods/elasticity.md 7.7).
inline constexpr Real guarded_volume = 0.5;

/// Adds a guard for every small tetrahedron that is no sliver of the zones of smoothed elements, behind all other
/// elements. It covers none, since it tells nothing of stress or strain, and its volume is zero until it acts
/// (clusters/arm_guards.h).
void add_guards(const RestMesh& mesh, std::span<const MaterialZone> zones, ElementList& list);

/// Which kind `smoothed` stands for: above a Poisson ratio of 0.25 the volumetric modulus lambda is more than the shear
/// modulus, and elements by edges alone begin to lock (docs/methods/elasticity.md 7.3).
ElementKind resolved(ElementKind kind, Real poisson_ratio);

/// Every tetrahedron is an element: constant strain, the stiffest there is.
void add_tetrahedron_elements(const RestMesh& mesh, ElementList& list);

/// Every edge is an element: F is the mean over the tetrahedra around it, each of which gives it a sixth of its volume
/// (Liu, Nguyen-Thoi, Vu-Do, Lam: An edge-based smoothed finite element method, 2009).
void add_edge_elements(const RestMesh& mesh, ElementPart part, ElementList& list);

/// The same by nodes, with a quarter of each tetrahedron: too soft for all of the stress, right for its volumetric part
/// (selective smoothing: Nguyen-Thoi, Liu, Lam, Zhang: A face-based smoothed finite element method, 2009, 5).
void add_node_elements(const RestMesh& mesh, ElementPart part, ElementList& list);

}  // namespace skerry
