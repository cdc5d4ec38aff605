#include "systems/contact/apply_surface_sets.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>

#include "components/node_block_table.h"
#include "jobs/parallel_for.h"
#include "systems/collision/contact_rows.h"
#include "systems/collision/inputs/contact_key.h"
#include "systems/collision/inputs/contact_reach.h"
#include "systems/contact/tangent_frame.h"

namespace skerry {

namespace {

constexpr std::size_t contacts_per_task = 256;
// If the projection of a direction onto the tangent plane is shorter than this fraction of its length, the direction
// counts as perpendicular to the surface. It then has no tangent, so friction is isotropic.
constexpr Real least_projection = 1e-6;

enum class FeatureKind { vertex, edge, triangle };

/// Vertex, edge or face of one partner at which a contact acts.
struct Feature {
    Index body;
    FeatureKind kind;
    Index row;             // row of VertexTable, EdgeTable or TriangleTable
    Index set = no_index;  // row of SurfaceSetTable, or no_index
};

class SetContacts {
public:
    SetContacts(const CollisionInputs& inputs, const SurfaceSetTable& sets, const SetOfFeature& set_of,
                ContactTable& contacts)
        : inputs_(inputs), sets_(sets), set_of_(set_of), contacts_(contacts) {}

    void apply(std::size_t c) const {
        const Feature first = first_feature(c), second = second_feature(c);
        if (first.set == no_index && second.set == no_index) return;
        const Index body = contacts_.first_body[c];
        // If a collider specifies no friction, combine() uses only the friction of its argument `own`. So `own` must be
        // the feature of the deformable body.
        if (is_body(body))
            combine(c, first, second);
        else
            combine(c, second, first);
    }

private:
    bool is_body(Index body) const { return body != no_index && inputs_.body.kind[body] == BodyKind::deformable; }

    static Index row_at(const Column<Index>& column, Index row) {
        return static_cast<std::size_t>(row) < column.size() ? column[row] : no_index;
    }
    /// Feature `local` of a body, counted from 0 in the body. A collider or a round body has no features: `set` is then
    /// no_index.
    Feature feature(Index body, FeatureKind kind, Index local) const {
        const BodyTable& table = inputs_.body;
        if (!is_body(body) || table.core_nodes[body] > 0) return {body, kind, no_index};
        switch (kind) {
            case FeatureKind::vertex: {
                const Index row = table.vertices[body].begin + local;
                return {body, kind, row, row_at(set_of_.vertex, row)};
            }
            case FeatureKind::edge: {
                const Index row = table.edges[body].begin + local;
                return {body, kind, row, row_at(set_of_.edge, row)};
            }
            default: {
                const Index row = table.triangles[body].begin + local;
                return {body, kind, row, row_at(set_of_.triangle, row)};
            }
        }
    }
    Feature first_feature(std::size_t c) const {
        const std::uint64_t key = contacts_.key[c].feature;
        const Index body = contacts_.first_body[c];
        switch (contacts_.kind[c]) {
            case ContactKind::edge_edge:
            case ContactKind::edge_collider:
                return feature(body, FeatureKind::edge, first_local(key));
            case ContactKind::face_collider:
                return feature(body, FeatureKind::triangle, second_local(key));
            default:
                return feature(body, FeatureKind::vertex, first_local(key));
        }
    }
    Feature second_feature(std::size_t c) const {
        const std::uint64_t key = contacts_.key[c].feature;
        const Index first = contacts_.first_body[c], body = contacts_.second_body[c];
        if (contacts_.kind[c] == ContactKind::edge_edge) return feature(body, FeatureKind::edge, second_local(key));
        // A face and a cylinder have up to touches_of_triangle contacts. The key contains touches_of_triangle times the
        // number of the face, plus the number of the contact on the face (feature_of_touch).
        const bool cylinder = inputs_.body.core_nodes[first] == cylinder_core_nodes;
        return feature(body, FeatureKind::triangle, second_local(key) / (cylinder ? touches_of_triangle : 1));
    }

    PartnerSurface partner(std::size_t c, const Feature& touched) const {
        PartnerSurface surface =
            partner_surface(inputs_, touched.body, touched.body == no_index ? contacts_.collider[c] : no_index);
        if (touched.set != no_index) surface.surface = with_given(surface.surface, sets_.surface[touched.set]);
        return surface;
    }
    bool sets_friction(const Feature& touched) const {
        return touched.set != no_index && sets_.surface[touched.set].dynamic_friction >= 0;
    }
    bool sets_restitution(const Feature& touched) const {
        return touched.set != no_index && sets_.surface[touched.set].restitution >= 0;
    }

    void combine(std::size_t c, const Feature& own, const Feature& other) const {
        const SurfaceProperties own_surface = partner(c, own).surface, other_surface = partner(c, other).surface;
        const SurfaceProperties mean = mean_surface(own_surface, other_surface);
        if (sets_restitution(own) || sets_restitution(other)) contacts_.restitution[c] = mean.restitution;
        if (!sets_friction(own) && !sets_friction(other)) return;
        const Vec3& normal = contacts_.normal[c];
        const FrictionShape shape = shape_of(own, normal);
        const MeanShape both =
            mean_shape(shape, other_surface.dynamic_friction < 0 ? shape : shape_of(other, normal), normal);
        contacts_.static_friction[c] = both.scale * mean.static_friction;
        contacts_.dynamic_friction[c] = both.scale * mean.dynamic_friction;
        contacts_.friction_axis[c] = both.axis;
    }

    FrictionShape shape_of(const Feature& touched, const Vec3& normal) const {
        if (touched.set == no_index || sets_.across[touched.set] == 1) return {};
        const Vec3 direction = present_direction(touched);
        const Vec3 tangent = direction - normal.dot(direction) * normal;
        const Real length = tangent.norm();
        if (!(length > least_projection * direction.norm())) return {};
        return {tangent / length, sets_.across[touched.set]};
    }

    /// Direction of the feature's set, mapped to the present shape; its length is arbitrary. It is the sum of the
    /// directions on the faces at the feature that are in the set (mapped_to_present), or on all faces at the feature
    /// if that sum is zero.
    Vec3 present_direction(const Feature& touched) const {
        for (const bool in_set : {true, false}) {
            Vec3 sum = Vec3::Zero();
            for_each_triangle(touched, [&](Index t) {
                if (!in_set || row_at(set_of_.triangle, t) == touched.set)
                    sum += mapped_to_present(sets_.direction[touched.set], t);
            });
            if (!sum.isZero(0)) return sum;
        }
        return Vec3::Zero();
    }
    void for_each_triangle(const Feature& touched, auto&& visit) const {
        const SurfaceTables& surface = inputs_.surface;
        if (touched.kind == FeatureKind::triangle) {
            visit(touched.row);
        } else if (touched.kind == FeatureKind::edge) {
            for (const Index t : surface.edges.triangle[touched.row])
                if (t != no_index) visit(t);
        } else {
            for (Index i = surface.vertices.triangle_begin[touched.row]; i < surface.vertices.triangle_end[touched.row];
                 ++i)
                visit(surface.vertex_triangle[i]);
        }
    }
    /// Projects a direction of the rest shape onto face t, and maps the projection to the present shape by the
    /// deformation of the face. Returns zero for a face without area.
    Vec3 mapped_to_present(const Vec3& direction, Index t) const {
        const auto& node = inputs_.surface.triangles.node[t];
        const auto side = [&](std::span<const Vec3> position, std::size_t k) {
            return Vec3(position[node[k]] - position[node[0]]);
        };
        const Vec3 a = side(inputs_.rest_position, 1), b = side(inputs_.rest_position, 2);
        const Real aa = a.dot(a), ab = a.dot(b), bb = b.dot(b), area = aa * bb - ab * ab;
        if (!(area > 0)) return Vec3::Zero();
        const Real p = direction.dot(a), q = direction.dot(b);
        return ((bb * p - ab * q) / area) * side(inputs_.position, 1) +
               ((aa * q - ab * p) / area) * side(inputs_.position, 2);
    }

    const CollisionInputs& inputs_;
    const SurfaceSetTable& sets_;
    const SetOfFeature& set_of_;
    ContactTable& contacts_;
};

/// Symmetric 2x2 matrix.
struct Symmetric2 {
    Real xx, xy, yy;
    Real determinant() const { return xx * yy - xy * xy; }
};
Symmetric2 tensor_of(const FrictionShape& shape, const TangentFrame& frame) {
    if (shape.across == 1) return {1, 0, 1};
    const Real x = shape.direction.dot(frame.first), y = shape.direction.dot(frame.second), s = shape.across;
    return {x * x + s * y * y, (1 - s) * x * y, y * y + s * x * x};
}

}  // namespace

MeanShape mean_shape(const FrictionShape& first, const FrictionShape& second, const Vec3& normal) {
    if (first.across == 1 && second.across == 1) return {};
    const TangentFrame frame = tangent_frame(normal);
    const Symmetric2 a = tensor_of(first, frame), b = tensor_of(second, frame);
    const Real first_scale = 1 / std::sqrt(first.across), second_scale = 1 / std::sqrt(second.across);
    const Symmetric2 sum{first_scale * a.xx + second_scale * b.xx, first_scale * a.xy + second_scale * b.xy,
                         first_scale * a.yy + second_scale * b.yy};
    const Real factor = 1 / std::sqrt(first_scale * second_scale * sum.determinant());
    const Real middle = (sum.xx + sum.yy) / 2, radius = std::hypot((sum.xx - sum.yy) / 2, sum.xy);
    MeanShape mean;
    mean.scale = factor * (middle + radius);
    // If the anisotropies of the two tensors cancel, both eigenvalues are equal. Rounding would still make `across`
    // differ from 1.
    constexpr Real rounding = 1e-12;
    if (radius <= rounding * middle) return mean;
    const Real angle = std::atan2(sum.xy, (sum.xx - sum.yy) / 2) / 2;
    mean.axis = {std::cos(angle) * frame.first + std::sin(angle) * frame.second, (middle - radius) / (middle + radius)};
    return mean;
}

bool apply_surface_sets(Executor& executor, const CollisionInputs& inputs, const SurfaceSetTable& sets,
                        const SetOfFeature& set_of, ContactTable& contacts) {
    if (sets.size() == 0) return false;
    const SetContacts apply(inputs, sets, set_of, contacts);
    parallel_for(executor, contacts.size(), contacts_per_task, [&](std::size_t begin, std::size_t end) {
        for (std::size_t c = begin; c < end; ++c) apply.apply(c);
    });
    return true;
}

}  // namespace skerry
