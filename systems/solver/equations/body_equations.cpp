#include "systems/solver/equations/body_equations.h"

#include <Eigen/Geometry>
#include <algorithm>

#include "systems/solver/local/rigid_part.h"

namespace skerry {
namespace {

/// Jacobian of the contact velocity with respect to one unknown: velocity of a node, or velocity and spin of a rigid
/// body. For a node only the first three columns are used.
Eigen::Matrix<Real, 3, 6> jacobian_of(const UnknownEffect& effect) {
    Eigen::Matrix<Real, 3, 6> jacobian;
    jacobian.leftCols<3>() = effect.weight * Mat3::Identity();
    jacobian.rightCols<3>() = -cross_matrix(effect.arm);
    return jacobian;
}
Index numbers_of(const UnknownEffect& effect) {
    return effect.turns ? 6 : 3;
}

}  // namespace

BodyEquations::Square BodyEquations::square(Index numbers) {
    const auto count = static_cast<std::size_t>(numbers);
    if (square_.size() < 2 * count * count) square_.resize(2 * count * count);
    if (pivot_.size() < count) pivot_.resize(count);
    return {{square_.data(), numbers, numbers, numbers},
            {square_.data() + count * count, numbers, numbers, numbers},
            pivot_.data()};
}

void BodyEquations::keep_inertia() {
    inertia_.resize(factor_.numbers().size());
    std::ranges::copy(factor_.numbers(), inertia_.begin());
    for (Column<Real>* column : {&present, &produced, &change, &step, &before}) column->resize(factor_.right().size());
}

void BodyEquations::start_from_inertia() {
    std::ranges::copy(inertia_, factor_.numbers().begin());
}

void BodyEquations::add(Index contact, const Mat3& block) {
    const ContactEffects& contact_effects = effects_[static_cast<std::size_t>(contact)];
    for (const UnknownEffect& row : contact_effects.all())
        for (const UnknownEffect& column : contact_effects.all()) {
            const DenseBlock to = factor_.block(row.part, column.part);
            if (!row.turns && !column.turns) {  // the usual case
                const Real weight = row.weight * column.weight;
                for (Index k = 0; k < 3; ++k)
                    for (Index l = 0; l < 3; ++l)
                        to.column(column.first_entry + k)[row.first_entry + l] += weight * block(l, k);
                continue;
            }
            const Eigen::Matrix<Real, 6, 6> share = jacobian_of(row).transpose() * block * jacobian_of(column);
            for (Index k = 0; k < numbers_of(column); ++k)
                for (Index l = 0; l < numbers_of(row); ++l)
                    to.column(column.first_entry + k)[row.first_entry + l] += share(l, k);
        }
}

Vec3 BodyEquations::velocity(Index contact, std::span<const Real> v) const {
    Vec3 sum = Vec3::Zero();
    for (const UnknownEffect& effect : effects_[static_cast<std::size_t>(contact)].all()) {
        const Real* const at = v.data() + factor_.first(effect.part) + static_cast<std::size_t>(effect.first_entry);
        sum += effect.weight * Vec3(at[0], at[1], at[2]);
        if (effect.turns) sum += Vec3(at[3], at[4], at[5]).cross(effect.arm);
    }
    return sum;
}

Real BodyEquations::set_right(std::span<const Real> x) {
    factor_.multiply(inertia_, x);
    Real sum = 0;
    for (std::size_t k = 0; k < x.size(); ++k) sum += x[k] * factor_.right()[k];
    return sum;
}

void BodyEquations::add_right(Index contact, const Vec3& impulse) {
    for (const UnknownEffect& effect : effects_[static_cast<std::size_t>(contact)].all()) {
        Real* const at =
            factor_.right().data() + factor_.first(effect.part) + static_cast<std::size_t>(effect.first_entry);
        const Vec3 moment = effect.arm.cross(impulse);
        for (Index k = 0; k < 3; ++k) at[k] += effect.weight * impulse[k];
        if (effect.turns)
            for (Index k = 0; k < 3; ++k) at[3 + k] += moment[k];
    }
}

void BodyEquations::start_round() {
    sliding_direction.assign(effects_.size(), Vec3::Zero());
    stops.assign(effects_.size(), 0);
    rises = 0;
}

}  // namespace skerry
