// Newton steps of regions that touch rigid or implicit bodies: the unknowns, their inertia matrix K, and the steps
// (docs/methods/region_solver.md 5.9).
#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <optional>
#include <span>
#include <utility>

#include "systems/solver/operators/body_operator.h"

namespace skerry {
namespace {

using Unknown = BodyEquations::Unknown;

/// Calls `visit(first, last)` for the range [first, last) of unknowns of each body.
void for_each_body(const Column<Unknown>& unknown, auto&& visit) {
    for (std::size_t begin = 0, end = 0; begin < unknown.size(); begin = end) {
        while (end < unknown.size() && unknown[end].body == unknown[begin].body) ++end;
        visit(begin, end);
    }
}

void add_identity(const DenseBlock& block, Index at, Real number) {
    for (Index k = 0; k < 3; ++k) block.column(at + k)[at + k] += number;
}

}  // namespace

/// Lists the unknowns: first the rigid bodies, then the nodes with contacts, sorted by their body, by the other body
/// that they touch, and by velocity row.
void BodyOperator::list_unknowns(BodyEquations& equations) const {
    Column<Unknown>& unknown = equations.unknown();
    Column<Index>& unknown_of_row = equations.unknown_of_row();
    unknown.clear();
    unknown_of_row.assign(memory_.velocity.size(), no_index);
    const auto list = [&](const Unknown& added) {
        if (std::exchange(unknown_of_row[static_cast<std::size_t>(added.row)], 0) == no_index) unknown.push_back(added);
    };
    for (Index i = 0; i < size(); ++i) {
        std::array<Index, 2> body_id{no_index, no_index};  // identifiers of the bodies of the contact
        const auto add = [&](Index body) {
            if (body_id[0] != body && body_id[1] != body) body_id[body_id[0] == no_index ? 0 : 1] = body;
        };
        const auto partner = [&](Index body) { return body_id[0] == body ? body_id[1] : body_id[0]; };
        for (const RigidTerm& term : part(i).terms())
            if (moves_rigidly(equations, term)) add(term.slot);
        const LumpedContact& lumped = contact(i);
        for (std::size_t a = 0; a < static_cast<std::size_t>(lumped.node_count); ++a)
            if (is_unknown(equations, lumped.node[a])) add(body_id_of_node(lumped.node[a]));
        for (const RigidTerm& term : part(i).terms())
            if (moves_rigidly(equations, term))
                list({.body = term.slot, .partner = no_index, .row = term.slot, .rigid = term.row});
        for (std::size_t a = 0; a < static_cast<std::size_t>(lumped.node_count); ++a) {
            if (!is_unknown(equations, lumped.node[a])) continue;
            const Index body = body_id_of_node(lumped.node[a]);
            Unknown node{.body = body, .partner = partner(body), .row = lumped.node[a]};
            node.mass = lumped.weight[a] / lumped.step[a];
            for (const RigidTerm& term : part(i).terms())
                if (term.row == traversal_.rigid_row(lumped.node[a])) node.slot = term.slot;
            list(node);
        }
    }
    std::ranges::sort(unknown, {}, [](const Unknown& u) { return std::array{u.body, u.partner, u.row}; });
    for (std::size_t k = 0; k < unknown.size(); ++k)
        unknown_of_row[static_cast<std::size_t>(unknown[k].row)] = static_cast<Index>(k);
}

Index BodyOperator::body_id_of_node(Index node) const {
    return static_cast<Index>(memory_.velocity.size()) + traversal_.owner(node);
}

/// Groups the unknowns into parts, the blocks of the matrix. A part is a rigid body, or a group of nodes of one
/// deformable body that touch the same other body (decided by the first contact of a node). Most of these nodes couple
/// only to these two bodies, which keeps the matrix sparse.
void BodyOperator::list_parts(BodyEquations& equations) const {
    Column<Unknown>& unknown = equations.unknown();
    BlockFactor& factor = equations.factor();
    factor.start();
    for (std::size_t begin = 0, end = 0; begin < unknown.size(); begin = end) {
        const bool turns = is_rigid(unknown[begin]);
        while (end < unknown.size() && unknown[end].body == unknown[begin].body &&
               unknown[end].partner == unknown[begin].partner) {
            unknown[end].part = factor.part_count();
            unknown[end].first_entry = 3 * static_cast<Index>(end - begin);
            ++end;
        }
        factor.add_part(turns ? 6 : 3 * static_cast<Index>(end - begin));
    }
}

void BodyOperator::list_effects(BodyEquations& equations) const {
    Column<BodyEquations::ContactEffects>& effects = equations.effects();
    effects.resize(static_cast<std::size_t>(size()));
    equations.derivative.resize(static_cast<std::size_t>(size()));
    const auto unknown_of = [&](Index row) -> const Unknown& {
        return equations.unknown()[static_cast<std::size_t>(equations.unknown_of_row()[static_cast<std::size_t>(row)])];
    };
    for (Index i = 0; i < size(); ++i) {
        BodyEquations::ContactEffects& contact_effects = effects[static_cast<std::size_t>(i)];
        contact_effects.count = 0;
        for (const RigidTerm& term : part(i).terms()) {
            // The rigid motion of a deformable body is an unknown only with rigid_modes, and only if the body is not
            // held. Without rigid_modes its nodes are the unknowns, and their velocities include the rigid motion.
            if (!moves_rigidly(equations, term)) continue;
            contact_effects.add(
                {.part = unknown_of(term.slot).part, .turns = true, .weight = term.weight, .arm = term.arm.head<3>()});
        }
        for (std::size_t a = 0; a < static_cast<std::size_t>(contact(i).node_count); ++a) {
            if (!is_unknown(equations, contact(i).node[a])) continue;
            const Unknown& node = unknown_of(contact(i).node[a]);
            contact_effects.add({.part = node.part, .first_entry = node.first_entry, .weight = contact(i).weight[a]});
        }
    }
}

/// Couples the parts whose blocks are nonzero: parts that share a contact, and parts of one implicit body.
void BodyOperator::couple_parts(BodyEquations& equations) const {
    BlockFactor& factor = equations.factor();
    factor.close_parts();
    for (const BodyEquations::ContactEffects& contact_effects : equations.effects())
        for (const UnknownEffect& a : contact_effects.all())
            for (const UnknownEffect& b : contact_effects.all()) factor.couple(a.part, b.part);
    for_each_body(equations.unknown(), [&](std::size_t begin, std::size_t end) {
        if (!deforms(equations.unknown()[begin])) return;
        for (Index g = equations.unknown()[begin].part; g <= equations.unknown()[end - 1].part; ++g)
            for (Index h = g; h <= equations.unknown()[end - 1].part; ++h) factor.couple(g, h);
    });
}

bool BodyOperator::touches_clusters() const {
    for (const LumpedContact& lumped : memory_.contact)
        for (std::size_t a = 0; a < static_cast<std::size_t>(lumped.node_count); ++a)
            if (traversal_.in_cluster(lumped.node[a])) return true;
    return false;
}
bool BodyOperator::is_rigid(const Unknown& unknown) const {
    return unknown.rigid != no_index;
}
bool BodyOperator::deforms(const Unknown& unknown) const {
    return !is_rigid(unknown) && traversal_.moves_with_rigid(unknown.row);
}

BodyEquations& BodyOperator::newton_memory() {
    if (!newton_) newton_ = pool_->lease();
    return std::exchange(own_are_listed_, true) ? newton_->own : list_equations(newton_->own);
}

BodyEquations& BodyOperator::list_equations(BodyEquations& equations) {
    equations.set_cost(infinity);
    // The inertia matrix K is not known for nodes of clusters. The cost stays infinite, so no Newton steps are taken.
    if (touches_clusters()) return equations;
    list_unknowns(equations);
    list_parts(equations);
    list_effects(equations);
    constexpr Index max_parts = 4000;  // the memory for all pairs of parts grows with the square of this number
    if (equations.factor().part_count() > max_parts) return equations;
    couple_parts(equations);
    if (!equations.factor().analyse()) return equations;
    Real work = equations.factor().work();
    for_each_body(equations.unknown(), [&](std::size_t begin, std::size_t end) {
        const Real numbers = 3 * static_cast<Real>(end - begin);
        // Inverting the response matrix of a body takes about 4/3 n^3 operations, once for about ten Newton steps. So a
        // tenth of them counts for each step.
        if (deforms(equations.unknown()[begin])) work += numbers * numbers * numbers * 0.13;
    });
    // Cost per operation in small blocks, cost per operation in large blocks (which fill the registers), and cost per
    // contact, all measured on a 3 GHz core [ns].
    constexpr Real small_operation_cost = 0.25, operation_cost = 0.06, contact_cost = 2000;
    equations.set_cost((runs_ ? operation_cost : small_operation_cost) * work +
                       contact_cost * static_cast<Real>(size()));
    return equations;
}

void BodyOperator::assemble(BodyEquations& equations) const {
    BlockFactor& factor = equations.factor();
    const Column<Unknown>& unknown = equations.unknown();
    std::ranges::fill(factor.numbers(), Real(0));
    for_each_body(unknown, [&](std::size_t begin, std::size_t end) {
        if (deforms(unknown[begin])) {
            assemble_deforming(equations, begin, end);
            return;
        }
        for (std::size_t k = begin; k < end; ++k) {
            const DenseBlock block = factor.block(unknown[k].part, unknown[k].part);
            if (!is_rigid(unknown[k])) {
                add_identity(block, unknown[k].first_entry, unknown[k].mass);
                continue;
            }
            const auto body = static_cast<std::size_t>(unknown[k].rigid);
            add_identity(block, 0, traversal_.rigid().mass[body]);
            const Mat3 inertia = traversal_.rigid().spins.inverse_inertia[body].inverse();
            for (Index c = 0; c < 3; ++c)
                for (Index r = 0; r < 3; ++r) block.column(3 + c)[3 + r] = inertia(r, c);
        }
    });
    equations.keep_inertia();
}

/// Sets the blocks of K for the listed nodes of a deformable body: the inverse of the matrix of velocity responses to
/// impulses on these nodes. The responses include rigid motion and deformation.
void BodyOperator::assemble_deforming(BodyEquations& equations, std::size_t begin, std::size_t end) const {
    const Column<Unknown>& unknown = equations.unknown();
    const auto count = static_cast<Index>(end - begin), numbers = 3 * count;
    const BodyEquations::Square square = equations.square(numbers);
    std::ranges::fill_n(square.inverse.data, static_cast<std::ptrdiff_t>(numbers) * numbers, Real(0));
    for (Index l = 0; l < count; ++l)
        for (Index k = 0; k < count; ++k) {
            const Index node = unknown[begin + std::size_t(k)].row, pushed_node = unknown[begin + std::size_t(l)].row;
            const Mat3 response = traversal_.response(node, pushed_node);
            for (Index c = 0; c < 3; ++c)
                for (Index r = 0; r < 3; ++r) square.matrix.column(3 * l + c)[3 * k + r] = response(r, c);
        }
    for (Index k = 0; k < numbers; ++k) square.inverse.column(k)[k] = 1;
    if (factor_dense(square.matrix, square.pivot)) solve_dense(square.matrix, square.pivot, square.inverse);
    for (Index l = 0; l < count; ++l)
        for (Index k = 0; k < count; ++k) {
            const Unknown &row = unknown[begin + std::size_t(k)], &column = unknown[begin + std::size_t(l)];
            const DenseBlock block = equations.factor().block(row.part, column.part);
            for (Index c = 0; c < 3; ++c)
                for (Index r = 0; r < 3; ++r)
                    block.column(column.first_entry + c)[row.first_entry + r] =
                        square.inverse.column(3 * l + c)[3 * k + r];
        }
}

void BodyOperator::gather(BodyEquations& equations, Column<Real>& velocity) const {
    for (const Unknown& entry : equations.unknown()) {
        Real* const target = velocity.data() + equations.factor().first(entry.part) + std::size_t(entry.first_entry);
        const auto put = [&](Real* at, const Vec4& v) { std::copy_n(v.data(), 3, at); };
        const Vec4* const row = memory_.velocity.data() + entry.row;
        if (is_rigid(entry)) {
            put(target, row[0]);
            put(target + 3, row[1]);
        } else if (entry.slot == no_index) {
            put(target, *row);
        } else {
            const Vec4* const frame = memory_.velocity.data() + entry.slot;
            put(target, *row + frame[0] + cross(frame[1], padded(traversal_.arm(entry.row))));
        }
    }
}

namespace {

/// Impulse P(z) of Coulomb's law for a trial impulse z, which would stop the contact: z if the contact sticks, z with
/// its tangential part cut to the friction limit if it slides, 0 if it opens. `derivative`: derivative of P by z.
struct LawImpulse {
    Vec3 impulse;
    Mat3 derivative;
    bool open = false;
    Vec3 sliding_direction = Vec3::Zero();  // zero if the contact does not slide
};
LawImpulse coulomb_response(const Vec3& z, const Vec3& normal, FrictionLimits mu) {
    if (mu.ties())
        return {project_tie(z, normal, mu), mu.stick == 0 ? Mat3(normal * normal.transpose()) : Mat3::Identity()};
    const Real along = normal.dot(z);
    if (!(along > 0)) return {Vec3::Zero(), Mat3::Zero(), true};
    const Vec3 tangential = z - along * normal;
    const Real length = tangential.norm();
    if (length <= mu.stick * along) return {z, Mat3::Identity()};
    const Vec3 h = tangential / length;
    const Mat3 pressing = normal * normal.transpose();
    const Mat3 turning = (mu.slide * along / length) * (Mat3::Identity() - pressing - h * h.transpose());
    return {along * normal + mu.slide * along * h, pressing + turning + mu.slide * h * normal.transpose(), false, h};
}

/// Columns of the contact frame: normal, first and second tangent. The second tangent is multiplied by the ratio
/// `across` of the friction coefficients along both tangents (matrix F S, docs/methods/friction.md 4.2).
Mat3 scaled_frame(const RigidPart& part) {
    Mat3 frame = matrix_of(part.frame);
    frame.col(2) *= part.across;
    return frame;
}

/// Matrix A of a sticking contact: its impulse at the velocity u is start - A u / soft (`soft`: its compliance).
Mat3 sticking(const RigidPart& part) {
    if (part.across == 1) return Mat3::Identity();
    const Mat3 scaled = scaled_frame(part);
    return scaled * scaled.transpose();
}

/// Impulse that the law of a contact gives for the velocity u, and its derivative by the trial impulse z = start - u /
/// soft. `soft`: compliance of the contact. If friction depends on the direction, Coulomb's law is applied to scaled
/// variables (docs/methods/friction.md 4.2), and the derivative is by -u / soft.
LawImpulse law_impulse(const RigidPart& part, const Vec3& start, const Vec3& u, Real soft, FrictionLimits mu) {
    if (part.across == 1) return coulomb_response(start - u / soft, part.frame[0].head<3>(), mu);
    const Mat3 scaled = scaled_frame(part);
    Vec3 z = matrix_of(part.frame).transpose() * start;
    z[2] /= part.across;
    LawImpulse response = coulomb_response(z - scaled.transpose() * u / soft, Vec3::UnitX(), mu);
    response.impulse = scaled * response.impulse;
    response.derivative = scaled * response.derivative * scaled.transpose();
    response.sliding_direction = matrix_of(part.frame) * response.sliding_direction;
    return response;
}

}  // namespace

/// Evaluates the motion `present`: returns its merit d . K d [J], with d = produced - present and the inertia matrix K.
/// 1. Sets the impulses r_i = P(start_i - u_i / (softness D_i)), with P of LawImpulse, the contact velocities u_i, the
///    mobilities D_i, and the softness, the compliance of the contacts as a fraction of D_i.
/// 2. Sets the velocities of the region and `produced` to the motion that these impulses produce.
/// 3. Sets the right-hand side to K d and, unless `evaluation` is `value`, builds the matrix.
/// 4. If `evaluation` is `turns` and the region has implicit bodies, marks contacts whose sliding direction is opposite
///    to that in the last matrix. stop_reversed then changes their equations.
Real BodyOperator::evaluate_motion(BodyEquations& equations, std::span<const Vec4> start, Evaluation evaluation) {
    const bool with_matrix = evaluation != Evaluation::value;
    if (with_matrix) equations.start_from_inertia();
    for (Index i = 0; i < size(); ++i) {
        if (!(mobility(i) > 0)) continue;
        const auto at = static_cast<std::size_t>(i);
        const Real soft = equations.softness * contact(i).diagonal;
        const Vec3 u = equations.offset[at] + equations.velocity(i, equations.present.span());
        const LawImpulse response = law_impulse(part(i), start[at].head<3>(), u, soft, limits(i));
        memory_.impulse[at] = padded(response.impulse);
        if (!with_matrix) continue;
        equations.derivative[at] = response.derivative;
        if (runs_ && evaluation == Evaluation::turns)
            equations.stops[at] = equations.sliding_direction[at].dot(response.sliding_direction) < 0 ? 1 : 0;
        equations.sliding_direction[at] = response.sliding_direction;
        if (response.open) continue;
        equations.add(i, (equations.stops[at] != 0 ? sticking(part(i)) : response.derivative) / soft);
    }
    const Real merit = compare_motion(equations, start);
    if (with_matrix) stop_reversed(equations, start);
    return merit;
}

/// Changes the right-hand side for contacts whose sliding direction has reversed: it gets the impulses that would stop
/// them, because the matrix treats them as sticking. Newton steps for sliding would jump again and again over the small
/// range of velocities at which a hard contact sticks.
void BodyOperator::stop_reversed(BodyEquations& equations, std::span<const Vec4> start) {
    for (Index i = 0; i < size(); ++i) {
        const auto at = static_cast<std::size_t>(i);
        if (equations.stops[at] == 0 || equations.sliding_direction[at].isZero(0)) continue;
        const Vec3 u = equations.offset[at] + equations.velocity(i, equations.present.span());
        const Vec3 stopping = start[at].head<3>() - sticking(part(i)) * u / (equations.softness * contact(i).diagonal);
        equations.add_right(i, stopping - memory_.impulse[at].head<3>());
    }
}

/// Updates the velocities of the region and `produced` to the motion that the present impulses produce. With d =
/// produced - present and the inertia matrix K, sets the right-hand side to K d and returns d . K d [J]
Real BodyOperator::compare_motion(BodyEquations& equations, std::span<const Vec4> start) {
    if (equations.rigid_modes)
        push_rigid_modes(start);
    else
        refresh();
    gather(equations, equations.produced);
    for (std::size_t k = 0; k < equations.change.size(); ++k)
        equations.change[k] = equations.produced[k] - equations.present[k];
    return equations.set_right(equations.change.span());
}

/// First step of a round, if the round before it converged. It assumes that each contact sticks, slides or is open as
/// in the last matrix. Returns the merit of the new motion, or nothing if the factorisation broke down.
std::optional<Real> BodyOperator::step_with_last_states(BodyEquations& equations, std::span<const Vec4> start) {
    equations.start_from_inertia();
    for (Index i = 0; i < size(); ++i) {
        if (!(mobility(i) > 0)) continue;
        const auto at = static_cast<std::size_t>(i);
        const Mat3 response = equations.derivative[at] / (equations.softness * contact(i).diagonal);
        const Vec3 u = equations.offset[at] + equations.velocity(i, equations.present.span());
        memory_.impulse[at] = padded(Vec3(start[at].head<3>() - response * u));
        equations.add(i, response);
    }
    compare_motion(equations, start);
    if (!equations.factor().solve()) return std::nullopt;
    const std::span<const Real> step = equations.factor().right();
    for (std::size_t k = 0; k < equations.present.size(); ++k) equations.present[k] += step[k];
    return evaluate_motion(equations, start, Evaluation::turns);
}

/// One Newton step from the present motion, with a line search. `merit`: merit of this motion. Returns the new merit,
/// or nothing if the factorisation broke down. The length of the step is
/// - the first of 1, 1/2, 1/4, ... with a merit below 0.9 times `merit`, otherwise the length with the smallest merit,
/// - or, a few times per round, 1 in spite of a higher merit, if the step stops contacts whose sliding has reversed.
std::optional<Real> BodyOperator::step_motion(BodyEquations& equations, std::span<const Vec4> start, Real merit) {
    constexpr int halvings = 6;
    constexpr Real enough = 0.9;
    constexpr Index max_rises = 3;
    const bool stops = std::ranges::find(equations.stops, 1) != equations.stops.end();
    if (!equations.factor().solve()) return std::nullopt;
    std::ranges::copy(equations.present, equations.before.begin());
    std::ranges::copy(equations.factor().right(), equations.step.begin());
    const auto move_to = [&](Real length) {
        for (std::size_t k = 0; k < equations.present.size(); ++k)
            equations.present[k] = equations.before[k] + length * equations.step[k];
    };
    Real least = infinity, best_length = 1;
    for (int k = 0; k < halvings; ++k) {
        const Real length = std::ldexp(Real(1), -k);
        move_to(length);
        const Real next = evaluate_motion(equations, start, k == 0 ? Evaluation::turns : Evaluation::value);
        if (k == 0 && next < enough * merit) return next;  // the usual case
        if (k == 0 && stops && equations.rises < max_rises) {
            ++equations.rises;
            return next;
        }
        if (next < least) {
            least = next;
            best_length = length;
        }
        if (next < enough * merit) break;
    }
    move_to(best_length);
    return evaluate_motion(equations, start, Evaluation::matrix);
}

namespace {

// A round is a sequence of Newton steps with fixed start impulses and compliant contacts. The softness is this
// compliance as a fraction of the mobility D. A smaller value needs fewer rounds, but more steps per round.
//
// Soft bodies converge at the largest softness, stiff bodies at a hundredth of it, and a light body under a heavy one
// at a small fraction of the mass ratio. So the softness is adapted to the number of steps of the last round.
constexpr Real max_softness = 0.3, min_softness = 1e-9;
// Softness of the first round for regions with deformable bodies. Their rounds converge even at a small softness, since
// contacts that reverse their sliding are stopped (stop_reversed).
constexpr Real first_softness = 0.03;

/// Softness (compliance of contacts) of the next round if the last round took this number of steps.
Real softness_after(Index steps, Real softness, bool deforming) {
    constexpr Index few = 4;
    const Real change = steps <= few / 2 ? 0.03 : steps > few ? 1.0 : deforming ? 0.1 : 0.3;
    return std::max(min_softness, change * softness);
}

}  // namespace

SolveResult BodyOperator::take_newton_steps(Real error, Real tolerance, Index limit) {
    // Let e be the relative error of the region at the start of a round, and scale_ its scale [sqrt(J)]. The round ends
    // when sqrt(d . K d), the square root of the merit function, is at most the bound `enough` scale_ e.
    constexpr Real enough = 0.1;
    // Factor on this bound while the present error of the region is e or more: a round that has not reduced the error
    // is solved more accurately.
    constexpr Real solved = 1e-3;
    constexpr Index max_steps_in_round = 14;  // upper limit; a longer round is unlikely to converge soon
    constexpr Real softer = 10;               // factor by which the softness grows after a round that did not converge
    BodyEquations& equations = newton_memory();
    if (!std::exchange(inertia_is_known_, true)) assemble(equations);
    const std::span<Vec4> start = memory_.workspace[1], best = memory_.workspace[2];
    std::ranges::copy(memory_.impulse, start.begin());
    std::ranges::copy(memory_.impulse, best.begin());
    gather(equations, equations.present);
    equations.offset.resize(static_cast<std::size_t>(size()));
    for (Index i = 0; i < size(); ++i) equations.offset[static_cast<std::size_t>(i)] = contact(i).offset.head<3>();
    SolveResult result{0, error, error <= tolerance};
    equations.softness = runs_ ? first_softness : max_softness;
    Real error_at_start = error;
    Index in_round = 0;
    bool keeps_states = false;  // true: the next round begins with the contact states of the last round
    equations.start_round();
    std::optional<Real> merit = evaluate_motion(equations, start, Evaluation::matrix);
    while (!result.converged && result.iterations < limit) {
        ++result.iterations;
        ++in_round;
        merit = keeps_states ? step_with_last_states(equations, start) : step_motion(equations, start, *merit);
        if (!merit) break;
        keeps_states = false;
        const Real now = this->error();
        if (now < result.error) {
            result.error = now;
            result.converged = now <= tolerance;
            std::ranges::copy(memory_.impulse, best.begin());
        }
        const Real merit_bound = enough * scale_ * error_at_start;
        const Index steps = in_round;
        const bool ended = std::sqrt(*merit) <= (now < error_at_start ? merit_bound : solved * merit_bound);
        if (!ended && steps < max_steps_in_round) continue;
        in_round = 0;
        // The next round starts from the present impulses and the motion they produce. A round that did not converge is
        // restarted with a larger softness.
        if (ended) {
            equations.softness = softness_after(steps, equations.softness, static_cast<bool>(runs_));
            error_at_start = now;
            std::ranges::copy(memory_.impulse, start.begin());
        } else {
            if (!(equations.softness < max_softness)) break;
            equations.softness = std::min(max_softness, softer * equations.softness);
            std::ranges::copy(start, memory_.impulse.begin());
            refresh();
            gather(equations, equations.produced);
        }
        std::ranges::copy(equations.produced, equations.present.begin());
        keeps_states = ended;
        std::ranges::fill(equations.stops, std::uint8_t(0));
        equations.rises = 0;
        if (!keeps_states) merit = evaluate_motion(equations, start, Evaluation::matrix);
    }
    std::ranges::copy(best, memory_.impulse.begin());
    refresh();
    return result;
}

}  // namespace skerry
