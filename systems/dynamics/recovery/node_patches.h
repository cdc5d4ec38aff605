// Neighbourhood of the nodes of a body: tetrahedra, surface triangles and elements around each node.
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "components/ragged.h"
#include "components/types.h"
#include "systems/dynamics/elements/recover_fields.h"
#include "systems/dynamics/kinds/element_list.h"

namespace skerry {

/// Kind of a node, which decides how its stress and strain are recovered. `inner`: not on the surface. `face`: on a
/// smooth part of the surface. `other`: at an edge or corner of the surface, or between two materials.
enum class NodeKind : std::uint8_t { inner, face, other };

/// Tetrahedra and surface triangles around the nodes of a body. All lists are ascending. Kinds of nodes are found when
/// they are first needed.
class NodePatches {
public:
    /// `material`: by tetrahedron; empty if all tetrahedra have one material. `rest`: positions of the nodes [m].
    NodePatches(std::span<const std::array<Index, 4>> tetrahedra, std::span<const std::array<Index, 3>> surface,
                std::span<const Index> material, std::span<const Vec3> rest);

    NodeKind kind(Index node);
    std::span<const Index> tetrahedra(Index node) const { return tetrahedra_of_[static_cast<std::size_t>(node)]; }
    std::span<const Index> triangles(Index node) const { return triangles_of_[static_cast<std::size_t>(node)]; }
    Real volume(Index tetrahedron) const {
        return six_volumes(tetrahedra_[static_cast<std::size_t>(tetrahedron)], rest_) / 6;
    }
    Index material_of(Index tetrahedron) const {
        return material_.empty() ? 0 : material_[static_cast<std::size_t>(tetrahedron)];
    }
    /// Materials of the tetrahedra around a node, each once.
    std::vector<Index> materials_around(Index node) const;
    /// A quarter of the volume of the tetrahedra around a node [m^3]: of all tetrahedra, or of those of one material.
    Real node_volume(Index node) const;
    Real node_volume(Index node, Index material) const;
    /// Nodes of the kind `inner` in the tetrahedra around a node.
    std::vector<Index> inner_neighbours(Index node);
    /// Nodes whose values are extrapolated to a node of the kind `other`: all nodes of the kinds `inner` and `face`
    /// within two rings of tetrahedra of one material around it.
    std::vector<Index> donors(Index node, Index material);

private:
    NodeKind find_kind(Index node) const;

    std::span<const std::array<Index, 4>> tetrahedra_;
    std::span<const std::array<Index, 3>> surface_;
    std::span<const Index> material_;
    std::span<const Vec3> rest_;
    Ragged<Index> tetrahedra_of_, triangles_of_;  // by node
    std::vector<std::optional<NodeKind>> kind_;   // by node; empty until first used
};

/// Blocks with elements that cover at least one of the chosen tetrahedra. An element covers the tetrahedra over which
/// its deformation gradient is averaged. A *place* p is the number of an element: lane p % element_lanes of the block
/// `block[p / element_lanes]`.
struct ElementsNear {
    std::vector<Index> block;  // block numbers, counted from the first block of the body, ascending
    Ragged<Index> covering;    // by tetrahedron: places of the elements that cover it

    ElementsNear() = default;
    /// `chosen`: by tetrahedron, nonzero if it is chosen.
    ElementsNear(const ElementCover& cover, std::span<const std::uint8_t> chosen);

    /// Tetrahedra that the element at a place covers; none for an unused lane.
    std::span<const Index> covered(const ElementCover& cover, std::size_t element) const;
    /// Places of the elements that cover at least one of the tetrahedra, ascending.
    std::vector<Index> around(std::span<const Index> tetrahedra) const;
};

}  // namespace skerry
