#include <algorithm>
#include <cmath>

#include "engine/problem/gather_blocks.h"
#include "skerry/problem.h"
#include "systems/contact/tangent_frame.h"

namespace skerry {
namespace {

/// Contact frame as a matrix with the columns normal, tangent 1 and tangent 2.
Mat3 frame_of(const Vec3& normal) {
    const TangentFrame tangents = tangent_frame(normal);
    Mat3 frame;
    frame << normal, tangents.first, tangents.second;
    return frame;
}

/// Weight of a node in the stencil of a contact (see LumpedContacts).
struct NodeWeight {
    Index node, contact;
    Real weight;
};

/// Lists the stencil weights of all nodes that can move and whose mass is not coupled to other nodes. The list is
/// sorted by node, then by contact.
std::vector<NodeWeight> list_node_weights(const LumpedContacts& contacts) {
    std::vector<bool> is_coupled(contacts.inverse_mass.size(), false);
    for (const CoupledNodes& group : contacts.coupled)
        for (const Index node : group.node) is_coupled[static_cast<std::size_t>(node)] = true;
    for (const RigidPoints& body : contacts.rigid)
        for (const Index node : body.node) is_coupled[static_cast<std::size_t>(node)] = true;
    std::vector<NodeWeight> weights;
    for (std::size_t i = 0; i < contacts.node.size(); ++i)
        for (std::size_t a = 0; a < 4; ++a) {
            const Index node = contacts.node[i][a];
            const Real weight = contacts.weight[i][a];
            if (weight != 0 && contacts.inverse_mass[node] > 0 && !is_coupled[node])
                weights.push_back({node, static_cast<Index>(i), weight});
        }
    std::stable_sort(weights.begin(), weights.end(),
                     [](const NodeWeight& a, const NodeWeight& b) { return a.node < b.node; });
    return weights;
}

/// Finds the stencil weights of a group of nodes in all contacts. In the result, NodeWeight::node is the index of the
/// node within the group.
class NodeWeightsOfGroup {
public:
    explicit NodeWeightsOfGroup(const LumpedContacts& contacts)
        : contacts_(contacts), place_(contacts.inverse_mass.size()) {}

    std::vector<NodeWeight> of(const std::vector<Index>& group) {
        const std::size_t count = group.size();
        std::ranges::fill(place_, count);
        for (std::size_t k = 0; k < count; ++k) place_[static_cast<std::size_t>(group[k])] = k;
        std::vector<NodeWeight> weights;
        for (std::size_t i = 0; i < contacts_.node.size(); ++i)
            for (std::size_t a = 0; a < 4; ++a)
                if (const std::size_t at = place_[static_cast<std::size_t>(contacts_.node[i][a])];
                    contacts_.weight[i][a] != 0 && at < count)
                    weights.push_back({static_cast<Index>(at), static_cast<Index>(i), contacts_.weight[i][a]});
        return weights;
    }

private:
    const LumpedContacts& contacts_;
    std::vector<std::size_t> place_;
};

/// Adds the blocks of W between contacts on the same rigid body, and between contacts on the same implicit body due to
/// its rigid motion. Each pair (a, b) of entries of `weights`, which are nodes of the body at contacts, contributes
///
///     w_a w_b (I / m + [x_a] J^-1 [x_b]^T)
///
/// with the stencil weight w of the node, the mass m and inertia tensor J of the body, and the matrix [x] of the cross
/// product: [x] v = x cross v. The arm x leads from the centre of mass to the node, for a round body to its contact
/// point.
void add_rigid(const LumpedContacts& contacts, const std::vector<Mat3>& frame, std::vector<BlockPart>& parts) {
    NodeWeightsOfGroup find(contacts);
    const auto crossing = [](const Vec3& v) {
        Mat3 matrix;
        matrix << 0, -v.z(), v.y(), v.z(), 0, -v.x(), -v.y(), v.x(), 0;
        return matrix;
    };
    const auto arm_of = [&](const RigidPoints& body, const NodeWeight& entry) {
        if (!body.touch.empty()) return body.touch[static_cast<std::size_t>(entry.contact)];
        return Vec3(body.arm[static_cast<std::size_t>(entry.node)] -
                    std::copysign(body.radius, entry.weight) *
                        contacts.normal[static_cast<std::size_t>(entry.contact)]);
    };
    for (const RigidPoints& body : contacts.rigid) {
        const std::vector<NodeWeight> weights = find.of(body.node);
        for (const NodeWeight& a : weights)
            for (const NodeWeight& b : weights) {
                const Mat3 arm = crossing(arm_of(body, a)), other = crossing(arm_of(body, b));
                const Mat3 block =
                    a.weight * b.weight *
                    (body.inverse_mass * Mat3::Identity() + arm * body.inverse_inertia * other.transpose());
                parts.push_back({a.contact, b.contact,
                                 frame[static_cast<std::size_t>(a.contact)].transpose() * block *
                                     frame[static_cast<std::size_t>(b.contact)]});
            }
    }
}

/// Adds the blocks of W between contacts on the same implicit body, due to the deformation of this body.
void add_strained(const LumpedContacts& contacts, const std::vector<Mat3>& frame, std::vector<BlockPart>& parts) {
    NodeWeightsOfGroup find(contacts);
    for (const StrainedPoints& body : contacts.strained) {
        const std::size_t count = body.node.size();
        const std::vector<NodeWeight> weights = find.of(body.node);
        for (const NodeWeight& a : weights)
            for (const NodeWeight& b : weights) {
                const Mat3& response =
                    body.response[static_cast<std::size_t>(a.node) * count + static_cast<std::size_t>(b.node)];
                parts.push_back({a.contact, b.contact,
                                 a.weight * b.weight * frame[static_cast<std::size_t>(a.contact)].transpose() *
                                     response * frame[static_cast<std::size_t>(b.contact)]});
            }
    }
}

/// Adds the blocks of W between contacts on the same group of nodes with a coupled mass matrix.
void add_coupled(const LumpedContacts& contacts, const std::vector<Mat3>& frame, std::vector<BlockPart>& parts) {
    NodeWeightsOfGroup find(contacts);
    for (const CoupledNodes& group : contacts.coupled) {
        const std::size_t count = group.node.size();
        const std::vector<NodeWeight> weights = find.of(group.node);
        for (const NodeWeight& a : weights)
            for (const NodeWeight& b : weights) {
                const Real inverse =
                    group.inverse[static_cast<std::size_t>(a.node) * count + static_cast<std::size_t>(b.node)];
                const Real coupling = a.weight * b.weight * inverse;
                const auto i = static_cast<std::size_t>(a.contact), j = static_cast<std::size_t>(b.contact);
                parts.push_back(
                    {a.contact, b.contact,
                     i == j ? Mat3(coupling * Mat3::Identity()) : Mat3(coupling * (frame[i].transpose() * frame[j]))});
            }
    }
}

}  // namespace

ContactProblem assemble_problem(const LumpedContacts& contacts, const std::string& name) {
    ContactProblem problem;
    problem.name = name;
    problem.mu = contacts.friction;
    std::vector<Mat3> frame;
    for (std::size_t i = 0; i < contacts.node.size(); ++i) {
        frame.push_back(frame_of(contacts.normal[i]));
        Vec3 velocity = contacts.offset[i];
        for (std::size_t a = 0; a < 4; ++a) velocity += contacts.weight[i][a] * contacts.velocity[contacts.node[i][a]];
        problem.q.push_back(frame[i].transpose() * velocity);
    }
    const std::vector<NodeWeight> weights = list_node_weights(contacts);
    std::vector<BlockPart> parts;
    for (std::size_t begin = 0, end = 0; begin < weights.size(); begin = end) {
        while (end < weights.size() && weights[end].node == weights[begin].node) ++end;
        const Real inverse_mass = contacts.inverse_mass[weights[begin].node];
        for (std::size_t a = begin; a < end; ++a)
            for (std::size_t b = begin; b < end; ++b) {
                const Index i = weights[a].contact, j = weights[b].contact;
                // Contribution w_i w_j / m of one node to W_ij = S_ij I (docs/methods/contact.md 2.1), rotated into the
                // frames of both contacts so that W is bitwise symmetric. In a diagonal block the rotations cancel, and
                // are left out to avoid rounding errors.
                const Real coupling = weights[a].weight * weights[b].weight * inverse_mass;
                parts.push_back(
                    {i, j,
                     i == j ? Mat3(coupling * Mat3::Identity()) : Mat3(coupling * (frame[i].transpose() * frame[j]))});
            }
    }
    add_coupled(contacts, frame, parts);
    add_rigid(contacts, frame, parts);
    add_strained(contacts, frame, parts);
    gather_blocks(std::move(parts), problem);
    return problem;
}

std::vector<Vec3> in_contact_frames(const LumpedContacts& contacts, std::span<const Vec3> vectors) {
    std::vector<Vec3> turned;
    for (std::size_t i = 0; i < vectors.size(); ++i)
        turned.push_back(frame_of(contacts.normal[i]).transpose() * vectors[i]);
    return turned;
}

}  // namespace skerry
