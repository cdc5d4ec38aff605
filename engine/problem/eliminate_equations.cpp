#include "engine/problem/eliminate_equations.h"

#include <Eigen/Dense>
#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <utility>

#include "components/union_find.h"
#include "engine/problem/gather_blocks.h"
#include "systems/contact/tangent_frame.h"

namespace skerry {

namespace {

/// A linear function u of velocities, which is one row of a constraint matrix. It is the sum of `along` . v over nodes,
/// plus the sum of `along` . v + `turn` . w over bodies, with the velocities v and angular velocities w. An impulse s
/// of the row gives nodes and bodies the impulses s `along`, and bodies the angular impulses s `turn`.
struct VelocityRow {
    struct OnNode {
        Index node;
        Vec3 along;
    };
    struct OnFrame {
        Index frame;  // row of RigidBodyTable
        // coefficients of velocity [1] and angular velocity [m]; a row for a rotation has along = 0 and turn in [1]
        Vec3 along, turn;
    };
    // coefficients of node velocities; for an implicit body, of the velocities relative to its frame
    std::vector<OnNode> nodes;
    std::vector<OnFrame> frames;  // coefficients of the rigid motion of rigid and implicit bodies

    void add_frame(Index frame, const Vec3& along, const Vec3& turn) {
        for (OnFrame& term : frames)
            if (term.frame == frame) {
                term.along += along;
                term.turn += turn;
                return;
            }
        frames.push_back({frame, along, turn});
    }
};

/// Quantity of an equation that keeps its value of the step when the contact impulses change.
/// - velocity: the velocity of the row. The impulse of the row in the step is known.
/// - impulse: the impulse of the row.
/// - velocity_with_unknown_impulse: the velocity of the row. The impulse of the row in the step is not known;
///   find_held_impulses() computes it.
enum class KeptQuantity { velocity, impulse, velocity_with_unknown_impulse };

struct EquationRow {
    VelocityRow row;
    KeptQuantity keeps = KeptQuantity::velocity;
    Real impulse = 0;  // [N s] or [N m s]
};

/// Computes velocity changes due to impulses, from the inverse masses of a step.
class Mobilities {
public:
    explicit Mobilities(const RegionInputs& inputs) : inputs_(inputs) {}

    /// Adds `weight` times the velocity component of a node in the direction `along` to a row.
    /// - `acts_at`: point of the node's body at which the row acts; nullptr: the node itself.
    /// - `beside`: additional lever arm, already multiplied by the weight [m].
    void add_node(VelocityRow& row, Index node, Real weight, const Vec3& along, const Vec3* acts_at,
                  const Vec3& beside) const {
        const auto n = static_cast<std::size_t>(node);
        if (weight == 0 || !(inputs_.inverse_mass[n] > 0)) return;
        const Index frame = inputs_.rigid.nodes.row(node);
        if (frame != no_index) {
            const Vec3 arm = (acts_at != nullptr ? *acts_at : inputs_.rigid.position[n]) -
                             inputs_.rigid.center[static_cast<std::size_t>(frame)];
            row.add_frame(frame, weight * along, (weight * arm + beside).cross(along));
            if (inputs_.implicit.row(node, inputs_.rigid.nodes) == no_index) return;
        }
        row.nodes.push_back({node, weight * along});
    }
    VelocityRow of_stencil(const Stencil& stencil, const Vec3& along, const Vec3* acts_at) const {
        VelocityRow row;
        for (std::size_t a = 0; a < 4; ++a)
            add_node(row, stencil.node[a], stencil.weight[a], along, acts_at, Vec3::Zero());
        return row;
    }
    VelocityRow of_contact(Index contact, const Vec3& along) const {
        const auto c = static_cast<std::size_t>(contact);
        const Stencil& stencil = inputs_.stencil[c];
        VelocityRow row;
        for (std::size_t a = 0; a < 4; ++a) {
            const Index node = stencil.node[a];
            const Real weight = stencil.weight[a];
            // The lever arm from the core of a round body (its centre or axis) to the contact point is added only once,
            // with the first node of the body, because core_arm() already multiplies it by the sum of the weights of
            // all nodes of the body.
            const Index frame = inputs_.rigid.nodes.row(node);
            const bool is_first =
                std::ranges::none_of(row.frames, [&](const VelocityRow::OnFrame& term) { return term.frame == frame; });
            const Vec3 beside = frame != no_index && is_first && weight != 0
                                    ? inputs_.rigid.nodes.core_arm(node, weight, c, inputs_.normal[c], inputs_.touch)
                                    : Vec3(Vec3::Zero());
            add_node(row, node, weight, along, nullptr, beside);
        }
        return row;
    }
    /// Velocity change of row `a` per unit impulse of row `b`.
    Real coupling(const VelocityRow& a, const VelocityRow& b) const {
        Real sum = 0;
        for (const auto& of_a : a.frames)
            for (const auto& of_b : b.frames)
                if (of_a.frame == of_b.frame) {
                    const auto r = static_cast<std::size_t>(of_a.frame);
                    sum += inputs_.rigid.inverse_mass(r) * of_a.along.dot(of_b.along) +
                           of_a.turn.dot(inputs_.rigid.spins.inverse_inertia[r] * of_b.turn);
                }
        for (const auto& of_a : a.nodes)
            for (const auto& of_b : b.nodes) sum += of_a.along.dot(of_nodes(of_a.node, of_b.node, of_b.along));
        return sum;
    }
    /// Calls visit(leader) for each node and frame of a row. The leader is the node that represents all nodes whose
    /// masses are coupled with each other: the nodes of a rigid body, an implicit body, or a cluster (nodes of an
    /// explicit body with a common inertia matrix).
    void for_each_leader(const VelocityRow& row, auto&& visit) const {
        for (const auto& term : row.frames) visit(leader_of_frame(term.frame));
        for (const auto& term : row.nodes) visit(leader_of_node(term.node));
    }
    /// The first leader of a row; no_index if the row moves nothing.
    Index leader(const VelocityRow& row) const {
        Index first = no_index;
        for_each_leader(row, [&](Index found) { first = first == no_index ? found : first; });
        return first;
    }

private:
    /// Velocity change of node `a` due to the impulse `impulse` on node `b`. For nodes of an implicit body it is
    /// relative to the rigid motion of the body, which VelocityRow::frames describes.
    Vec3 of_nodes(Index a, Index b, const Vec3& impulse) const {
        const Index frame = inputs_.rigid.nodes.row(a);
        if (frame != no_index) {
            if (inputs_.rigid.nodes.row(b) != frame) return Vec3::Zero();
            const ImplicitCoupling& coupling = *inputs_.implicit.coupling;
            const auto place = [&](Index node) {
                return coupling
                    .touched_index[static_cast<std::size_t>(inputs_.implicit.row(node, inputs_.rigid.nodes))];
            };
            return coupling.block(static_cast<std::size_t>(frame), place(a), place(b)) * impulse;
        }
        const Index cluster = inputs_.clustered() ? inputs_.clusters->cluster(a) : no_index;
        if (cluster == no_index)
            return a == b ? Vec3(inputs_.inverse_mass[static_cast<std::size_t>(a)] * impulse) : Vec3(Vec3::Zero());
        if (inputs_.clusters->cluster(b) != cluster) return Vec3::Zero();
        const std::span<const Index> nodes = inputs_.clusters->nodes[static_cast<std::size_t>(cluster)];
        const auto at = [&](Index node) {
            return static_cast<std::size_t>(std::ranges::find(nodes, node) - nodes.begin());
        };
        const std::size_t first = inputs_.clusters->first_entry[static_cast<std::size_t>(cluster)];
        return inputs_.clusters->inverse[first + at(a) * nodes.size() + at(b)] * impulse;
    }
    Index leader_of_frame(Index frame) const {
        const auto body = static_cast<std::size_t>(inputs_.rigid.body[static_cast<std::size_t>(frame)]);
        return inputs_.rigid.nodes.body_nodes[body].begin;
    }
    Index leader_of_node(Index node) const {
        if (const Index frame = inputs_.rigid.nodes.row(node); frame != no_index) return leader_of_frame(frame);
        return inputs_.clustered() ? inputs_.clusters->leader(node) : node;
    }

    const RegionInputs& inputs_;
};

VelocityRow row_of_joint(const JointBlock& block, const RegionInputs& inputs, const Vec3& along) {
    VelocityRow row;
    const auto add = [&](Index body, Index node, Real sign) {
        if (node == no_index) return;
        if (block.turning) return row.add_frame(body, Vec3::Zero(), sign * along);
        const Vec3 arm = block.point - inputs.rigid.center[static_cast<std::size_t>(body)];
        row.add_frame(body, sign * along, sign * arm.cross(along));
    };
    add(block.first, block.first_node, 1);
    add(block.second, block.second_node, -1);
    return row;
}

void list_joints(const JointBlockTable& joints, const RegionInputs& inputs, std::vector<EquationRow>& rows) {
    for (std::size_t j = 0; j < joints.size(); ++j) {
        const JointBlock& block = joints.block[j];
        const Vec3& impulse = joints.impulse[j];
        if (const Real c = block.mimic.coefficient; c != 0) {
            VelocityRow row = row_of_joint(block, inputs, c * block.frame.col(2));
            if (block.mimic.leads) {  // rows.back() is the row of the joint that mimics this one
                for (const auto& term : row.frames) rows.back().row.add_frame(term.frame, term.along, term.turn);
                continue;
            }
            rows.push_back({std::move(row), KeptQuantity::velocity, impulse.z() / c});
            continue;
        }
        for (Index k = 0; k < 3; ++k)
            rows.push_back({row_of_joint(block, inputs, block.frame.col(k)),
                            k == 2 && !block.axis.locked ? KeptQuantity::impulse : KeptQuantity::velocity, impulse[k]});
    }
}

/// Adds the rows of the ties:
/// - weld (a tie without motion): three rows, along the world axes,
/// - slide (a tie with tangential motion): one row. Its direction is the whole impulse vector of the tie in the step,
///   not a unit vector, so the impulse of the row is 1.
void list_ties(const StepEquations& equations, const Mobilities& mobilities, std::vector<EquationRow>& rows) {
    const TieRowTable& ties = equations.tie_rows;
    for (std::size_t i = 0; i < ties.size() && !equations.tie_kind.empty(); ++i) {
        const bool is_weld = equations.tie_kind[static_cast<std::size_t>(ties.tie[i])] == TieKind::weld;
        for (Index k = 0; k < (is_weld ? 3 : 1); ++k)
            rows.push_back({mobilities.of_stencil(ties.stencil[i], is_weld ? Vec3(Vec3::Unit(k)) : ties.impulse[i],
                                                  &ties.point[i]),
                            is_weld ? KeptQuantity::velocity : KeptQuantity::impulse,
                            is_weld ? ties.impulse[i][k] : 1});
    }
}

/// Adds a row for each point of a cable. The direction of the row is the impulse vector that the two adjacent segments
/// exert on the point, not a unit vector, so the impulse of the row is 1.
void list_cable(const CableBlockTable& cables, const CableBlock& block, const Mobilities& mobilities,
                std::vector<EquationRow>& rows) {
    Vec3 last = Vec3::Zero();
    for (Index p = block.points.begin; p < block.points.end; ++p) {
        const Vec3 next = cables.impulse[p] * cables.direction[p];
        rows.push_back({mobilities.of_stencil(cables.stencil[p], next - last, nullptr), KeptQuantity::impulse, 1});
        last = next;
    }
}

/// Adds the three rows of a ball tie, which holds only the centre of mass of the tied nodes. Row k sums the velocity
/// component k over all points of the tie. The stencil weights of a point contain its share of the mass.
void list_ball(const CableBlockTable& cables, const CableBlock& block, const Mobilities& mobilities,
               std::vector<EquationRow>& rows) {
    for (Index k = 0; k < 3; ++k) {
        VelocityRow sum;
        for (Index p = block.points.begin; p < block.points.end; ++p) {
            const VelocityRow row = mobilities.of_stencil(cables.stencil[p], Vec3::Unit(k), block.acting_point(p));
            sum.nodes.insert(sum.nodes.end(), row.nodes.begin(), row.nodes.end());
            for (const auto& frame : row.frames) sum.add_frame(frame.frame, frame.along, frame.turn);
        }
        rows.push_back({std::move(sum), KeptQuantity::velocity, cables.impulse[block.points.begin + k]});
    }
}

/// Largest eigenvalue of a matrix, scaled to a unit diagonal, that counts as zero. For two rows whose directions differ
/// by a small angle, the smallest eigenvalue is about the square of the angle. The solver's tolerance lets redundant
/// joints drift apart by less than 3e-4 rad, which gives this limit.
constexpr Real negligible_part = 1e-7;

/// Largest inverse mass of an immovable contact: normal component after elimination, as a fraction of that without
/// joints. The fraction is the square of an angle of 1e-3 rad, like `negligible_part`. It may exceed `negligible_part`,
/// because an immovable contact still acts on the others, whose q includes its impulse in the step.
constexpr Real immovable_part = 1e-6;

/// Pseudoinverse of a symmetric positive semidefinite matrix. Rows may have different units, so the matrix is first
/// scaled to a unit diagonal. Rows may depend on each other: eigenvalues of the scaled matrix up to `negligible_part`
/// count as zero.
Eigen::MatrixXd inverse_of(const Eigen::MatrixXd& matrix) {
    if (matrix.rows() == 0) return matrix;
    const Eigen::VectorXd scale =
        matrix.diagonal().unaryExpr([](Real value) { return value > 0 ? 1 / std::sqrt(value) : Real(0); });
    const Eigen::MatrixXd scaled = scale.asDiagonal() * matrix * scale.asDiagonal();
    // The solver gets the size here, because Eigen does not resize it later (EIGEN_NO_AUTOMATIC_RESIZING).
    Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd> factors(matrix.rows());
    factors.compute(scaled);
    const Eigen::VectorXd roots = factors.eigenvalues().unaryExpr(
        [](Real value) { return value > negligible_part ? 1 / std::sqrt(value) : Real(0); });
    const Eigen::MatrixXd half = scale.asDiagonal() * factors.eigenvectors() * roots.asDiagonal();
    return half * half.transpose();
}

/// Normal velocity of each contact per unit of its own normal impulse [1/kg].
std::vector<Real> normal_mobilities(const ContactProblem& problem) {
    std::vector<Real> mobilities(problem.q.size());
    for (std::size_t i = 0; i < mobilities.size(); ++i)
        for (Index k = problem.row_offset[i]; k < problem.row_offset[i + 1]; ++k)
            if (problem.column[static_cast<std::size_t>(k)] == static_cast<Index>(i))
                mobilities[i] = problem.block[static_cast<std::size_t>(k)](0, 0);
    return mobilities;
}

/// Equations and contacts that act on the same coupled masses.
struct CoupledEquations {
    std::vector<EquationRow*> kept_velocity, kept_impulse;
    std::vector<Index> contacts;  // indices of the contacts in ContactProblem
};

Eigen::MatrixXd couplings(const Mobilities& mobilities, const std::vector<VelocityRow>& rows,
                          const std::vector<EquationRow*>& equations) {
    Eigen::MatrixXd matrix(rows.size(), equations.size());
    for (std::size_t i = 0; i < rows.size(); ++i)
        for (std::size_t j = 0; j < equations.size(); ++j)
            matrix(static_cast<Index>(i), static_cast<Index>(j)) = mobilities.coupling(rows[i], equations[j]->row);
    return matrix;
}

std::vector<VelocityRow> rows_of_equations(const std::vector<EquationRow*>& equations) {
    std::vector<VelocityRow> rows;
    for (const EquationRow* const equation : equations) rows.push_back(equation->row);
    return rows;
}

Eigen::VectorXd impulses_of(const std::vector<EquationRow*>& equations) {
    Eigen::VectorXd impulses(equations.size());
    for (std::size_t k = 0; k < equations.size(); ++k) impulses[static_cast<Index>(k)] = equations[k]->impulse;
    return impulses;
}

/// Finds the impulses of the rows of the kind velocity_with_unknown_impulse. They are the impulses with which the
/// velocities of these rows stay as before the solve.
/// - `E`: velocity change of each equation per unit impulse of each equation.
/// - `rate_by_others`: velocity changes of all equations due to contacts and known impulses.
void find_held_impulses(const Eigen::MatrixXd& E, const Eigen::VectorXd& rate_by_others,
                        const std::vector<EquationRow*>& equations) {
    std::vector<Index> held;
    for (std::size_t k = 0; k < equations.size(); ++k)
        if (equations[k]->keeps == KeptQuantity::velocity_with_unknown_impulse) held.push_back(static_cast<Index>(k));
    if (held.empty()) return;
    const Eigen::VectorXd rate = rate_by_others + E * impulses_of(equations);
    const Eigen::VectorXd found = -(inverse_of(E(held, held)) * rate(held));
    for (std::size_t k = 0; k < held.size(); ++k)
        equations[static_cast<std::size_t>(held[k])]->impulse = found[static_cast<Index>(k)];
}

}  // namespace

std::optional<std::vector<Index>> eliminate_equations(const StepEquations& equations, const RegionInputs& inputs,
                                                      std::span<const Index> contact, std::span<const Vec3> impulse,
                                                      ContactProblem& problem) {
    const Mobilities mobilities(inputs);
    std::vector<EquationRow> rows;
    list_joints(equations.joints, inputs, rows);
    list_ties(equations, mobilities, rows);
    for (const CableBlock& block : equations.cables.solved())
        (block.is_tie ? list_ball : list_cable)(equations.cables, block, mobilities, rows);
    for (const HeldDirection& held : equations.held)
        rows.push_back({mobilities.of_stencil({{held.node, held.node, held.node, held.node}, {1, 0, 0, 0}},
                                              held.direction, nullptr),
                        KeptQuantity::velocity_with_unknown_impulse, 0});
    std::erase_if(rows, [&](const EquationRow& equation) { return mobilities.leader(equation.row) == no_index; });
    if (rows.empty()) return {};
    UnionFind sets;
    sets.start(inputs.inverse_mass.size());
    for (const EquationRow& equation : rows)
        mobilities.for_each_leader(equation.row,
                                   [&](Index leader) { sets.join(mobilities.leader(equation.row), leader); });
    // Each group holds the equations whose leaders are in one set of `sets`. Key: root of the set (element that stands
    // for all of its elements).
    std::map<Index, CoupledEquations> groups;
    for (EquationRow& equation : rows) {
        CoupledEquations& group = groups[sets.root(mobilities.leader(equation.row))];
        (equation.keeps == KeptQuantity::impulse ? group.kept_impulse : group.kept_velocity).push_back(&equation);
    }
    std::vector<std::array<VelocityRow, 3>> of_contact;
    for (std::size_t i = 0; i < contact.size(); ++i) {
        const Vec3& normal = inputs.normal[static_cast<std::size_t>(contact[i])];
        const TangentFrame tangents = tangent_frame(normal);
        auto& axes = of_contact.emplace_back();
        for (std::size_t k = 0; k < 3; ++k)
            axes[k] = mobilities.of_contact(contact[i], k == 0 ? normal : k == 1 ? tangents.first : tangents.second);
        const auto note = [&](Index leader) {
            const auto group = groups.find(sets.root(leader));
            if (group == groups.end()) return;
            std::vector<Index>& list = group->second.contacts;
            if (list.empty() || list.back() != static_cast<Index>(i)) list.push_back(static_cast<Index>(i));
        };
        mobilities.for_each_leader(axes[0], note);
    }
    std::vector<BlockPart> parts;
    for (std::size_t i = 0; i < problem.q.size(); ++i)
        for (Index k = problem.row_offset[i]; k < problem.row_offset[i + 1]; ++k)
            parts.push_back({static_cast<Index>(i), problem.column[static_cast<std::size_t>(k)],
                             problem.block[static_cast<std::size_t>(k)]});
    bool any = false;
    for (auto& [root, group] : groups) {
        if (group.contacts.empty()) continue;
        any = true;
        std::vector<VelocityRow> contacts;
        Eigen::VectorXd r(3 * group.contacts.size());
        for (std::size_t i = 0; i < group.contacts.size(); ++i) {
            const auto at = static_cast<std::size_t>(group.contacts[i]);
            contacts.insert(contacts.end(), of_contact[at].begin(), of_contact[at].end());
            r.segment<3>(3 * static_cast<Index>(i)) = impulse[at];
        }
        const Eigen::MatrixXd C = couplings(mobilities, contacts, group.kept_velocity),
                              impulse_couplings = couplings(mobilities, contacts, group.kept_impulse);
        const std::vector<VelocityRow> of_equations = rows_of_equations(group.kept_velocity);
        const Eigen::MatrixXd E = couplings(mobilities, of_equations, group.kept_velocity);
        const Eigen::VectorXd known_impulses = impulses_of(group.kept_impulse);
        find_held_impulses(E,
                           C.transpose() * r + couplings(mobilities, of_equations, group.kept_impulse) * known_impulses,
                           group.kept_velocity);
        const Eigen::MatrixXd product = C * (inverse_of(E) * C.transpose());
        const Eigen::MatrixXd reduction =
            (product + product.transpose()) / 2;  // symmetric to the last bit, as W must be
        const Eigen::VectorXd velocity_shift =
            impulse_couplings * known_impulses + C * impulses_of(group.kept_velocity) + reduction * r;
        for (std::size_t i = 0; i < group.contacts.size(); ++i) {
            const auto row = static_cast<Index>(3 * i);
            problem.q[static_cast<std::size_t>(group.contacts[i])] += velocity_shift.segment<3>(row);
            for (std::size_t j = 0; j < group.contacts.size(); ++j) {
                const auto column = static_cast<Index>(3 * j);
                parts.push_back({group.contacts[i], group.contacts[j], -reduction.block<3, 3>(row, column)});
            }
        }
    }
    if (!any) return {};
    const std::vector<Real> before = normal_mobilities(problem);
    gather_blocks(std::move(parts), problem);
    const std::vector<Real> after = normal_mobilities(problem);
    std::vector<Index> immovable;
    for (std::size_t i = 0; i < after.size(); ++i)
        if (!(after[i] > immovable_part * before[i])) immovable.push_back(static_cast<Index>(i));
    // Immovable contacts act on the other contacts with the impulses that they had in the step.
    const auto is_immovable = [&](Index i) { return std::ranges::binary_search(immovable, i); };
    for (Index i = 0; i < problem.contacts(); ++i)
        for (Index k = problem.row_offset[i]; k < problem.row_offset[i + 1]; ++k) {
            const Index j = problem.column[k];
            if (!is_immovable(i) && !is_immovable(j)) continue;
            if (!is_immovable(i)) problem.q[i] += problem.block[k] * impulse[j];
            problem.block[k].setZero();
        }
    return immovable;
}

}  // namespace skerry
