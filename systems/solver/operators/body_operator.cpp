#include "systems/solver/operators/body_operator.h"

#include <Eigen/LU>
#include <algorithm>
#include <cmath>

namespace skerry {

static_assert(ContactOperator<BodyOperator>);
template class RegionOperatorBase<BodyOperator, ThroughGroups, BodyMemory>;

namespace {

Vec4 in_frame(const Columns3& frame, const Vec4& vector) {
    return {frame[0].dot(vector), frame[1].dot(vector), frame[2].dot(vector), 0};
}

/// Impulse r of one contact or tie in world axes. b = u - W_ii r is the velocity without this impulse, where
/// u is the contact velocity and W_ii the diagonal block of the contact.
Vec4 solve_in_frame(RigidPart& part, const Vec4& b, FrictionLimits mu) {
    if (mu.ties()) {
        if (mu.stick == 0) return -(part.frame[0].dot(b) / part.block.normal) * part.frame[0];
        return padded(-(matrix_of(part.mobility).inverse() * b.head<3>()));
    }
    Vec3 local = in_frame(part.frame, b).head<3>();
    local[2] *= part.across;
    Vec3 impulse = solve_block(part.block, local, mu.stick);
    // A contact at the limit of static friction slides, so the dynamic coefficient applies.
    constexpr Real rounding = 1e-12;
    if (mu.slide != mu.stick && impulse.tail<2>().norm() >= mu.stick * impulse[0] * (1 - rounding))
        impulse = solve_block(part.block, local, mu.slide);
    impulse[2] *= part.across;
    return times(part.frame, padded(impulse));
}

const Vec4 first_axis{1, 0, 0, 0};

}  // namespace

Vec4 BodyOperator::solve_law(Index i, const Vec4& impulse, const Vec4& u) {
    RigidPart& own_part = memory_.part[static_cast<std::size_t>(i)];
    if (const JointLaw* law = joint(i)) {
        const Vec3 r = in_frame(own_part.frame, impulse).head<3>();
        return times(own_part.frame, padded(law->solve(in_frame(own_part.frame, u).head<3>() - law->block * r)));
    }
    if (own_part.across != 1 || (own_part.term_count > 0 && friction_ == Friction::cone))
        return solve_in_frame(own_part, u - times(own_part.mobility, impulse), contact(i).friction);
    // The exact step would use the diagonal block W_ii. This step replaces W_ii by an upper bound on its eigenvalues.
    // It is exact if W_ii is a scalar times the identity, otherwise the step is shorter than the exact one.
    return project(i, impulse - u / own_part.max_eigenvalue);
}

Real BodyOperator::push_tie(Index i, const Vec4& held_velocity, Vec4* velocity) const {
    if (held_velocity.isZero(0)) return 0;
    Vec4 change = -held_velocity / part(i).along_normal;
    if (limits(i).stick > 0) {
        const Mat3 mobility = traversal_.undeformed_coupling(contact(i), contact(i)) + rigid_coupling(part(i), part(i));
        change = -padded(mobility.inverse() * held_velocity.head<3>());
    }
    apply_undeformed(i, change, velocity);
    return -change.dot(held_velocity);
}

Vec4 BodyOperator::project_in_frame(Index i, const Vec4& impulse) const {
    const RigidPart& own_part = part(i);
    Vec4 local = in_frame(own_part.frame, impulse);
    local[2] /= own_part.across;
    local = project_coulomb(local, first_axis, contact(i).friction);
    local[2] *= own_part.across;
    return times(own_part.frame, local);
}

Real BodyOperator::step(Index i, Real relaxation) {
    if (!(mobility(i) > 0)) return 0;
    if (const JointLaw* law = joint(i); law != nullptr && law->mimic != 0)
        return solve_mimic(
            i, relaxation, [&](Index k) { return velocity(k); },
            [&](Index k, const Vec4& change) {
                apply(k, change);
                memory_.impulse[static_cast<std::size_t>(k)] += change;
            });
    Vec4& impulse = memory_.impulse[static_cast<std::size_t>(i)];
    Vec4 next = solve_law(i, impulse, velocity(i));
    if (relaxation != 1) next = project(i, impulse + relaxation * (next - impulse));
    const Vec4 change = next - impulse;
    if (change.isZero(0)) return 0;
    apply(i, change);
    impulse = next;
    return inner(i, change, change);
}

void BodyOperator::list_runs() const {
    if (!runs_->listed())
        runs_->list(memory_.contact.first(static_cast<std::size_t>(swept_count())), traversal_,
                    memory_.velocity.size());
}

void BodyOperator::for_each_in_sweep(auto&& visit) {
    // Sweeps with and without runs (ContactRuns) share one loop, because compilers would not inline the function
    // `visit` twice.
    const ContactRuns::Run all{0, swept_count(), 0, 0};
    std::span<const ContactRuns::Run> runs(&all, 1);
    if (runs_) {
        list_runs();
        runs = runs_->runs();
    }
    for (const ContactRuns::Run& run : runs) {
        for (Index i = run.begin; i < run.end; ++i) visit(i);
        if (runs_) runs_->spread(run, traversal_, memory_.velocity.data());
    }
}

void BodyOperator::apply(Index i, const Vec4& impulse) {
    Vec4* const velocity = memory_.velocity.data();
    if (runs_)
        runs_->apply(static_cast<std::size_t>(i), contact(i), traversal_, impulse, velocity);
    else
        traversal_.apply_undeformed(contact(i), impulse, velocity);
    apply_to_rigid(part(i), impulse, velocity);
}

Real BodyOperator::sweep(Real relaxation) {
    Real change = 0;
    for_each_in_sweep([&](Index i) { change += step(i, relaxation); });
    SweepChange cable_change;
    sweep_cables(relaxation, cable_change);
    return change + cable_change.squared_change;
}

SweepChange BodyOperator::accelerated_sweep(Real relaxation) {
    const std::span<const Vec4> present = memory_.impulse, previous = memory_.workspace[1];
    SweepChange sum;
    for_each_in_sweep([&](Index i) {
        const auto at = static_cast<std::size_t>(i);
        const Vec4 before = present[at];
        const Real size = step(i, relaxation);
        if (size == 0) return;
        sum.squared_change += size;
        sum.reversal -= inner(i, present[at] - before, present[at] - previous[at]);
    });
    sweep_cables(relaxation, sum);
    return sum;
}

const CableLaw& BodyOperator::read_cable(Index cable) const {
    const CableLaw& law = memory_.cable_law[static_cast<std::size_t>(cable)];
    law.read(memory_.impulse.subspan(static_cast<std::size_t>(law.first)), law.impulse);
    if (law.is_tie) {
        Vec4 sum = Vec4::Zero();
        for (Index p = 0; p < law.points; ++p) sum += velocity(law.first + p);
        for (std::size_t k = 0; k < 3; ++k) law.rate[k] = sum[static_cast<Index>(k)];
        return law;
    }
    Vec4 start = velocity(law.first);
    for (std::size_t s = 0; s < law.segments(); ++s) {
        const Vec4 end = velocity(law.first + static_cast<Index>(s) + 1);
        law.rate[s] = law.direction[s].dot((end - start).head<3>());
        start = end;
    }
    return law;
}

void BodyOperator::sweep_cables(Real relaxation, SweepChange& sum) {
    Vec4* const velocity = memory_.velocity.data();
    for (const Index cable : memory_.cable) {
        const CableLaw& law = read_cable(cable);
        const auto first = static_cast<std::size_t>(law.first);
        std::ranges::copy(law.impulse, law.before.begin());
        law.solve();
        if (relaxation != 1)
            for (std::size_t s = 0; s < law.segments(); ++s)
                law.impulse[s] = law.before[s] + relaxation * (law.impulse[s] - law.before[s]);
        if (std::ranges::equal(law.impulse, law.before)) continue;
        Vec4* const nodes = runs_ ? runs_->sums(memory_.velocity.size()).data() : nullptr;
        for (std::size_t s = 0; s < law.segments(); ++s) law.before[s] = law.impulse[s] - law.before[s];
        for (std::size_t p = 0; p < static_cast<std::size_t>(law.points); ++p) {
            const Vec4 change = padded(law.at_point(law.before, p));
            const auto i = static_cast<Index>(first + p);
            if (nodes != nullptr)
                traversal_.collect(contact(i), change, nodes, velocity);
            else
                traversal_.apply_undeformed(contact(i), change, velocity);
            apply_to_rigid(part(i), change, velocity);
            memory_.impulse[first + p] += change;
        }
        if (nodes != nullptr) runs_->spread_sums(traversal_, velocity);
        if (!memory_.workspace[1].empty()) law.read(memory_.workspace[1].subspan(first), law.previous);
        for (std::size_t s = 0; s < law.segments(); ++s) law.previous[s] = law.impulse[s] - law.previous[s];
        sum.squared_change += law.product(law.before, law.before);
        sum.reversal -= law.product(law.before, law.previous);
    }
}

void BodyOperator::extrapolate(Real factor) {
    extrapolate_range(0, memory_.impulse.size(), factor, memory_.impulse, memory_.workspace[1]);
    extrapolate_range(0, memory_.velocity.size(), factor, memory_.velocity, memory_.scratch);
}

Real BodyOperator::squared_residual(Index i) const {
    if (i >= swept_count()) {
        // All points of a cable have one common residual. It counts once, at the first point that impulses can move.
        for (const Index cable : memory_.cable)
            if (memory_.cable_law[static_cast<std::size_t>(cable)].moving == i)
                return read_cable(cable).squared_residual();
        return 0;
    }
    const Vec4& impulse = memory_.impulse[static_cast<std::size_t>(i)];
    const JointLaw* const law = joint(i);
    if (law != nullptr && law->mimic != 0) {
        const Real rate = mimic_rate(i, [&](Index k) { return velocity(k); });
        return contact(i).inverse_diagonal * rate * rate;
    }
    if (law == nullptr && part(i).across != 1) {
        // In the scaled variables r_2 / across and across u_2 friction is isotropic (docs/methods/friction.md 4.2).
        Vec4 r = in_frame(part(i).frame, impulse), u = in_frame(part(i).frame, velocity(i));
        r[2] /= part(i).across;
        u[2] *= part(i).across;
        LumpedContact scaled = contact(i);
        scaled.normal = first_axis;
        return contact(i).diagonal * natural_map(scaled, Friction::cone, r, u).squaredNorm();
    }
    if (law == nullptr)
        return contact(i).diagonal * natural_map(contact(i), friction_, impulse, velocity(i)).squaredNorm();
    const Columns3& frame = part(i).frame;
    return mobility(i) *
           law->natural_map(in_frame(frame, impulse).head<3>(), in_frame(frame, velocity(i)).head<3>(), mobility(i))
               .squaredNorm();
}

void BodyOperator::add_response(std::span<const Vec4> impulse, std::span<Vec4> velocity) const {
    Vec4* const sum = runs_ ? runs_->sums(velocity.size()).data() : nullptr;
    for (Index i = 0; i < size(); ++i) {
        const Vec4& own_impulse = impulse[static_cast<std::size_t>(i)];
        if (own_impulse.isZero(0)) continue;
        if (runs_)
            traversal_.collect(contact(i), own_impulse, sum, velocity.data());
        else
            traversal_.apply_undeformed(contact(i), own_impulse, velocity.data());
        apply_to_rigid(part(i), own_impulse, velocity.data());
    }
    if (runs_) runs_->spread_sums(traversal_, velocity.data());
}

void BodyOperator::assemble(Eigen::MatrixXd& matrix) const {
    matrix.setZero(3 * size(), 3 * size());
    for (Index i = 0; i < size(); ++i)
        for (Index j = 0; j < size(); ++j)
            matrix.block<3, 3>(3 * i, 3 * j) =
                traversal_.coupling(contact(i), contact(j)) + rigid_coupling(part(i), part(j));
}

Real BodyOperator::sweep_cost() const {
    // Costs per contact and per update of a node velocity, measured on a 3 GHz core [ns]
    constexpr Real contact_cost = 100, node_cost = 3;
    Real cost = contact_cost * static_cast<Real>(size());
    if (!runs_) return cost;
    list_runs();
    return cost + node_cost * runs_->moved();
}

}  // namespace skerry
