// Elements of one body and the present positions of their nodes, from which stress and strain are computed.
#pragma once

#include <memory>
#include <span>
#include <vector>

#include "engine/world/state/field_cache.h"
#include "engine/world/state/model.h"
#include "systems/dynamics/elements/compute_element_forces.h"
#include "systems/dynamics/elements/recover_fields.h"
#include "systems/dynamics/recovery/recover_nodes.h"

namespace skerry {

/// Elements of a body in its present shape. Their frame is the frame of the mesh for an implicit body, and the world
/// frame for an explicit body. A rigid body has no elements. Valid until the world changes.
class ElementsOfBody {
public:
    ElementsOfBody(const Model& model, std::size_t row);
    ElementsOfBody(const ElementsOfBody&) = delete;
    ElementsOfBody& operator=(const ElementsOfBody&) = delete;

    ElementInputs elements;
    Range blocks;
    ElementCover cover;
    std::span<const Vec3> position;  // positions of the nodes that `elements` refers to [m]
    Index first_node = 0;            // first node of the body in `position`
    Mat3 built = Mat3::Identity();   // rotation of the elements at rest relative to the mesh

    /// Rotates tensors from the frame of the elements to world axes.
    void turn(std::span<Mat3> values) const;
    /// Stress and strain at the nodes `nodes` of the body, in this order and in the frame of the elements.
    NodeFields node_fields(std::span<const Index> nodes) const;

private:
    const Model& model_;
    std::size_t row_;
    bool is_implicit_;
    // For an implicit body: its elements, and the positions of its nodes in the frame of the mesh [m]. Empty for other
    // bodies.
    std::shared_ptr<const OwnElements> own_;
    std::vector<Vec3> shape_;
};

/// Returns the numbers of all nodes of a body within the body: 0, 1, and so on.
std::vector<Index> all_nodes(const Model& model, std::size_t row);
/// Returns stress and strain at the given nodes of a body, in world axes. `row`: row of BodyTable.
NodeFields fields_of_nodes(const Model& model, std::size_t row, std::span<const Index> nodes);

}  // namespace skerry
