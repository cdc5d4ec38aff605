// Named sets of nodes, faces and tetrahedra of bodies.
#pragma once

#include <array>
#include <span>
#include <string>
#include <vector>

#include "components/handle.h"
#include "components/types.h"
#include "skerry/mesh.h"

#pragma GCC visibility push(default)
namespace skerry {

class World;

/// A view of the named sets of the bodies of a world. It is valid until the world is moved or destroyed. A new body has
/// the sets of its mesh (Mesh::sets), with nodes and tetrahedra numbered within the body. Sets are saved and cloned,
/// and steps do not depend on them.
///
/// Functions throw SceneError if a handle is stale or a body has no set of the given name; the message lists the sets
/// that the body has.
class Sets {
public:
    /// `world` must exist as long as the view.
    explicit Sets(World& world) : world_(&world) {}

    std::vector<std::string> names(BodyHandle body) const;  // in alphabetical order
    /// Nodes, faces and tetrahedra that a set lists. Items that follow from other lists, such as the nodes of listed
    /// faces, are not included; for these see nodes(). The reference is valid until sets or bodies change.
    const MeshSet& get(BodyHandle body, const std::string& name) const;
    /// Adds a set. Sorts the numbers and drops repeated ones. Throws SceneError if the body already has a set of this
    /// name, if the set or its name is empty, or if a number is out of range.
    void add(BodyHandle body, const std::string& name, MeshSet set);
    /// Removes a set. Objects that were made from it, such as attachments and loads, do not change.
    void remove(BodyHandle body, const std::string& name);

    /// Numbers of all nodes of a set, also those of its faces and tetrahedra (mesh::nodes_of). Throws SceneError if
    /// there are none.
    std::vector<Index> nodes(BodyHandle body, const std::string& name) const;
    /// Faces of a set, each by the numbers of its nodes (mesh::faces_of). Throws SceneError if there are none.
    std::vector<std::array<Index, 3>> faces(BodyHandle body, const std::string& name) const;
    /// Numbers of the tetrahedra of a set (mesh::tetrahedra_of). Throws SceneError if there are none.
    std::vector<Index> tetrahedra(BodyHandle body, const std::string& name) const;

    /// Labels of the tetrahedra of a body (Mesh::label); empty if its mesh has none.
    std::span<const int> labels(BodyHandle body) const;

private:
    World* world_;
};

}  // namespace skerry
#pragma GCC visibility pop
