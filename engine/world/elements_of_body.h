// Elements of one body, with the positions of their nodes.
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

/// Elements of a body in its present shape: in the mesh frame for an implicit body, in world coordinates for an
/// explicit body, no elements for a rigid body. Valid until the world changes.
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
    /// Stress and strain at the given nodes of the body, in their order, in the frame of the elements.
    NodeFields node_fields(std::span<const Index> nodes) const;

private:
    const Model& model_;
    std::size_t row_;
    bool is_implicit_;
    // of an implicit body: its elements, and the node positions in the mesh frame [m]; otherwise empty
    std::shared_ptr<const OwnElements> own_;
    std::vector<Vec3> shape_;
};

/// Numbers of all nodes of a body: 0, 1, and so on.
std::vector<Index> all_nodes(const Model& model, std::size_t row);
/// Stress and strain at the given nodes of a body, in world axes.
NodeFields fields_of_nodes(const Model& model, std::size_t row, std::span<const Index> nodes);

}  // namespace skerry
