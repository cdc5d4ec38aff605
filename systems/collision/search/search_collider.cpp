#include "systems/collision/search/search_pair.h"

#include <algorithm>
#include <array>

#include "systems/collision/colliders/collider_shape.h"
#include "systems/collision/colliders/edge_contact.h"
#include "systems/collision/inputs/contact_key.h"
#include "systems/collision/narrow/rigid_frame.h"
#include "systems/collision/search/sort_found.h"
#include "systems/collision/tree/box.h"

namespace skerry {

namespace {

class ColliderSearch {
public:
    ColliderSearch(const CollisionInputs& inputs, const PairToSearch& pair, Column<FoundCandidate>& found)
        : inputs_(inputs),
          pair_(pair),
          found_(found),
          geometry_(inputs.collider.geometry[pair.second]),
          motion_(inputs.collider.motion[pair.second]),
          parts_(collider_part_count(geometry_.shape)),
          face_zone_(face_zone(pair.scale)) {}

    Real run() {
        const Real points = add_points();
        const Real between = distance_between_nodes();
        if (between < face_zone_ + pair_.margin) {
            // A round body has no faces, but the axis of a capsule is an edge.
            if (inputs_.body.core_nodes[pair_.first] == 0) add_faces();
            add_edges();
        }
        return pair_.travel_base + std::max(pair_.margin, std::min(points - pair_.scale.zone, between - face_zone_));
    }

private:
    const Vec3& position(Index node) const { return inputs_.position[node]; }
    Vec3 local(Index node) const { return to_local(motion_, position(node)); }
    Range vertices() const { return inputs_.body.vertices[pair_.first]; }

    /// Adds the nodes close to the collider as candidates. Returns the least signed distance of any node from the
    /// collider [m].
    Real add_points() {
        const Real radius = pair_.scale.zone + pair_.margin;
        Real nearest = infinity;
        for (Index v = vertices().begin; v < vertices().end; ++v) {
            const Index node = inputs_.surface.vertices.node[v];
            for (Index part = 0; part < parts_; ++part) {
                const Real distance = distance_to_collider_part(geometry_, motion_, part, position(node)).distance;
                if (distance < nearest) {
                    nearest = distance;
                    nearest_node_ = node;
                }
                if (!(distance < radius)) continue;
                found_.push_back({{point_collider_feature(v - vertices().begin, part), v, pair_.second},
                                  pair_.travel_base + distance - pair_.scale.zone});
            }
        }
        return nearest;
    }

    /// Lower bound of the distance that the body has to move before the interior of an edge or face can touch [m].
    Real distance_between_nodes() const {
        const bool has_edges = inputs_.body.edges[pair_.first].size() > 0;
        if (!has_edges || nearest_node_ == no_index || collider_point_count(geometry_.shape) == 0) return infinity;
        const Vec3 middle = local(nearest_node_);
        // Two lower bounds for the complete body; the larger one is used:
        // - `hull`: smallest lower bound of the distance of a node, by the tangent at the node nearest to the collider
        //   (hull_tangent).
        // - `flat`: distance that all nodes can move within one flat region of the collider, where only nodes can
        //   touch.
        Real hull = infinity, flat = infinity;
        const Index region = flat_region(geometry_, middle);
        const HullTangent tangent = hull_tangent(geometry_, middle);
        for (Index v = vertices().begin; v < vertices().end; ++v) {
            const Vec3 point = local(inputs_.surface.vertices.node[v]);
            hull = std::min(hull, tangent.bound(point));
            flat = std::min(flat, flat_reach(geometry_, region, point));
        }
        return std::max(hull, flat);
    }

    void add_faces() {
        const TriangleTable& table = inputs_.surface.triangles;
        const Range triangles = inputs_.body.triangles[pair_.first];
        const Index points = collider_point_count(geometry_.shape);
        const Real radius = face_zone_ + pair_.margin;
        const std::size_t first = found_.size();
        for (Index t = triangles.begin; t < triangles.end; ++t) {
            const auto& node = table.node[t];
            const LocalFace face{local(node[0]), local(node[1]), local(node[2])};
            if (!(hull_distance(geometry_, face) < radius)) continue;
            const Real flat = flat_reach(geometry_, face);
            if (!(flat < pair_.margin)) continue;
            for (Index k = 0; k < points; ++k) {
                const Real nearest = face_contact(geometry_, k, face).nearest;
                if (!(nearest < radius)) continue;
                found_.push_back({{face_collider_feature(k, t - triangles.begin), t, pair_.second},
                                  pair_.travel_base + std::max(nearest - face_zone_, flat)});
            }
        }
        std::sort(found_.begin() + static_cast<std::ptrdiff_t>(first), found_.end(), feature_before);
    }

    void add_edges() {
        const Range edges = inputs_.body.edges[pair_.first];
        const Real radius = pair_.scale.zone + pair_.margin;
        for (Index e = edges.begin; e < edges.end; ++e) {
            const auto& node = inputs_.surface.edges.node[e];
            const std::array<Vec3, 2> end{local(node[0]), local(node[1])};
            if (!(hull_distance(geometry_, end) < radius)) continue;
            const Real flat = flat_reach(geometry_, end);
            if (!(flat < pair_.margin)) continue;
            for (Index part = 0; part < parts_; ++part) {
                const Real nearest = edge_distance(geometry_, part, end[0], end[1]);
                if (!(nearest < radius)) continue;
                found_.push_back({{edge_collider_feature(e - edges.begin, part), e, pair_.second},
                                  pair_.travel_base + std::max(nearest - pair_.scale.zone, flat)});
            }
        }
    }

    const CollisionInputs& inputs_;
    const PairToSearch& pair_;
    Column<FoundCandidate>& found_;
    const ColliderGeometry& geometry_;
    const RigidMotion& motion_;
    const Index parts_;
    const Real face_zone_;
    Index nearest_node_ = no_index;
};

}  // namespace

Real search_collider(const CollisionInputs& inputs, const PairToSearch& pair, Column<FoundCandidate>& found) {
    return ColliderSearch(inputs, pair, found).run();
}

}  // namespace skerry
