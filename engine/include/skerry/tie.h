// Ties: nodes of a deformable body that are fixed to another object (docs/methods/ties.md).
#pragma once

#include <optional>
#include <vector>

#include "components/handle.h"
#include "components/tie_kind.h"
#include "components/types.h"
#include "skerry/object_view.h"

#pragma GCC visibility push(default)
namespace skerry {

/// A tie between nodes of a deformable body and another object: the body `to_body`, which may be of any kind, the
/// collider `to_collider`, or the world if neither is given.
///
/// - The kinds `weld` and `slide` tie each node, in its present position, to the nearest surface point of the other
///   object. The tie of a single node acts like a ball joint. Ties::add() throws SceneError if the surface point is
///   farther away than the mean edge length of the surface of `body`.
/// - The kind `ball` ties only one point: the mean point of all nodes, weighted by their masses. It may be at any
///   distance from a rigid object when the tie is made, and from then on keeps its position relative to it. The impulse
///   of the tie acts on the nodes in proportion to their masses.
struct TieSettings {
    TieKind kind = TieKind::weld;  // motion that the tie permits
    BodyHandle body{};             // a deformable body
    std::vector<Index> nodes{};    // numbers of the tied nodes in the mesh of `body`, each given once
    // The other object, if it is a body. A tie of kind `slide` needs a body or a collider, since the world has no
    // surface.
    std::optional<BodyHandle> to_body{};
    std::optional<ColliderHandle> to_collider{};  // the other object, if it is a collider; not together with `to_body`
    // Upper limit of the force on a tied node, > 0 [N]. By default, a tie does not break.
    // - Each node breaks off by itself, at the end of the first step in which its force exceeds the limit.
    // - A tie of the kind `ball` breaks as a whole if the total force exceeds the limit.
    Real break_force = infinity;
    // false: each node keeps its initial distance from the surface. true: the tie closes this distance, at a speed
    // limited by Settings::recovery_speed.
    bool close_gap = false;
    // false: the body and the other object do not collide while at least one node is tied.
    bool bodies_touch = false;
};

/// State of a tied node.
struct TiedNode {
    Index node = 0;             // number in the mesh of the body
    Vec3 force = Vec3::Zero();  // force of the last step on the node [N]
    // distance of the node (for a ball: of the mean point) from the position that the tie prescribes [m]
    Real error = 0;
    std::optional<Real> broken{};  // time at which the node broke off [s]
};

/// State of a tie after the last step. Force and moment act on the body whose nodes are tied.
struct TieState {
    TieKind kind = TieKind::weld;                 // motion that the tie permits
    BodyHandle body{};                            // body of the tied nodes
    std::optional<BodyHandle> to_body{};          // the other object, if it is a body
    std::optional<ColliderHandle> to_collider{};  // the other object, if it is a collider
    Real break_force = infinity;                  // TieSettings::break_force [N]
    Vec3 point = Vec3::Zero();      // mean position of all nodes, also broken ones; for a ball weighted by mass [m]
    Vec3 force = Vec3::Zero();      // force on `body` [N]
    Vec3 moment = Vec3::Zero();     // moment about `point` [N m]
    Real largest_force = 0;         // largest magnitude of `force` in a step since the tie was added [N]
    Real error = 0;                 // largest TiedNode::error of the nodes that have not broken off [m]
    std::vector<TiedNode> nodes{};  // state of each node, in the order of the settings
};

extern template class __attribute__((visibility("default"))) ObjectView<TieHandle>;

/// A view of the ties of a world.
class Ties : public ObjectView<TieHandle> {
public:
    using ObjectView::ObjectView;

    /// Ties nodes of a body to another object or to the world.
    TieHandle add(const TieSettings& tie);
    /// Nodes and forces of a tie after the last step.
    TieState state(TieHandle tie) const;
    /// Settings of a tie.
    TieSettings settings(TieHandle tie) const;
    /// Sets the force at which a node breaks off [N]. Nodes that have broken off are not tied again.
    void set_break_force(TieHandle tie, Real force);
};

}  // namespace skerry
#pragma GCC visibility pop
