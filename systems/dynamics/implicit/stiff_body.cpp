#include "systems/dynamics/implicit/stiff_body.h"

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <utility>

#include "systems/geometry/rotation.h"
#include "systems/material/material_law.h"

namespace skerry {

namespace {

Mat3 crossing(const Vec3& a) {
    Mat3 matrix;
    matrix << 0, -a.z(), a.y(), a.z(), 0, -a.x(), -a.y(), a.x(), 0;
    return matrix;
}

std::span<const Index> nodes_of_element(const ElementList& elements, std::size_t e) {
    return std::span(elements.node).subspan(elements.first_node[e], elements.nodes_of(e));
}

std::vector<std::vector<Index>> neighbours_of(const ElementList& elements, std::size_t nodes) {
    std::vector<std::vector<Index>> neighbours(nodes);
    for (std::size_t e = 0; e < elements.size(); ++e)
        for (const Index a : nodes_of_element(elements, e))
            for (const Index b : nodes_of_element(elements, e))
                if (a != b) neighbours[static_cast<std::size_t>(a)].push_back(b);
    for (std::vector<Index>& of_node : neighbours) {
        std::ranges::sort(of_node);
        of_node.erase(std::unique(of_node.begin(), of_node.end()), of_node.end());
    }
    return neighbours;
}

std::vector<Index> inverse_of(std::span<const Index> order_index) {
    std::vector<Index> node(order_index.size());
    for (std::size_t n = 0; n < order_index.size(); ++n)
        node[static_cast<std::size_t>(order_index[n])] = static_cast<Index>(n);
    return node;
}

/// Matrix of zero blocks. It has a block on the diagonal for each node and a block for each pair of nodes that share an
/// element.
BlockRows pattern_of(const std::vector<std::vector<Index>>& neighbours, std::span<const Index> order_index,
                     std::span<const Index> node) {
    BlockRows rows;
    for (std::size_t k = 0; k < order_index.size(); ++k) {
        const std::size_t first = rows.column.size();
        for (const Index other : neighbours[static_cast<std::size_t>(node[k])])
            if (const Index column = order_index[static_cast<std::size_t>(other)]; column < static_cast<Index>(k))
                rows.column.push_back(column);
        std::sort(rows.column.begin() + static_cast<std::ptrdiff_t>(first), rows.column.end());
        rows.column.push_back(static_cast<Index>(k));
        rows.offset.push_back(static_cast<Index>(rows.column.size()));
    }
    rows.block.assign(rows.column.size(), Mat3::Zero());
    return rows;
}

Mat3& block_at(BlockRows& rows, Index row, Index column) {
    const auto first = rows.column.begin() + rows.offset[static_cast<std::size_t>(row)],
               last = rows.column.begin() + rows.offset[static_cast<std::size_t>(row) + 1];
    return rows.block[static_cast<std::size_t>(std::lower_bound(first, last, column) - rows.column.begin())];
}

/// Restricts the matrix to free nodes. In rows and columns of held nodes only the inertia on the diagonal remains.
void decouple_held(std::span<const std::uint8_t> held, std::span<const Real> mass, Real inertia, BlockRows& matrix) {
    for (std::size_t k = 0; k < matrix.size(); ++k)
        for (auto i = static_cast<std::size_t>(matrix.offset[k]); i < static_cast<std::size_t>(matrix.offset[k + 1]);
             ++i) {
            const auto column = static_cast<std::size_t>(matrix.column[i]);
            if (!held[k] && !held[column]) continue;
            matrix.block[i] = column == k ? Mat3(inertia * mass[k] * Mat3::Identity()) : Mat3(Mat3::Zero());
        }
}

}  // namespace

StiffBody::StiffBody(const ElementList& elements, std::span<const MaterialConstants> constants,
                     std::span<const Real> mass, std::span<const Vec3> rest_position,
                     std::span<const std::array<Index, 4>> tetrahedra, std::span<const Real> tetrahedron_mass) {
    const std::vector<std::vector<Index>> neighbours = neighbours_of(elements, mass.size());
    order_index_ = elimination_order(neighbours);
    node_ = inverse_of(order_index_);
    stiffness_ = pattern_of(neighbours, order_index_, node_);
    for (std::size_t e = 0; e < elements.size(); ++e) {
        const MaterialConstants material =
            part_of(constants[static_cast<std::size_t>(elements.material[e])], elements.part[e]);
        const std::span<const Index> nodes = nodes_of_element(elements, e);
        const auto gradients = std::span(elements.gradient).subspan(elements.first_node[e], nodes.size());
        for (std::size_t k = 0; k < nodes.size(); ++k)
            for (std::size_t l = 0; l < nodes.size(); ++l) {
                const Index row = order_index_[static_cast<std::size_t>(nodes[k])],
                            column = order_index_[static_cast<std::size_t>(nodes[l])];
                if (column <= row)
                    block_at(stiffness_, row, column) +=
                        elements.volume[e] * small_strain_stiffness(material, gradients[k], gradients[l]);
            }
    }
    mass_.resize(mass.size());
    arm_.resize(mass.size());
    Vec3 center = Vec3::Zero();
    for (std::size_t n = 0; n < mass.size(); ++n) {
        total_mass_ += mass[n];
        center += mass[n] * rest_position[n];
    }
    center /= total_mass_;
    Mat3 inertia = Mat3::Zero();
    for (std::size_t n = 0; n < mass.size(); ++n) {
        const auto k = static_cast<std::size_t>(order_index_[n]);
        mass_[k] = mass[n];
        arm_[k] = rest_position[n] - center;
        inertia += mass[n] * (arm_[k].squaredNorm() * Mat3::Identity() - arm_[k] * arm_[k].transpose());
    }
    inverse_inertia_ = inertia.inverse();
    solid_ = SolidMasses(tetrahedra, tetrahedron_mass, order_index_);
    BodyShape rest{arm_, {}};
    solid_.find_arms(rest);
    inverse_solid_inertia_ = rest.inertia().inverse();
    // Energy of the spin at which centrifugal forces stretch a bar by the strain small_strain. A bar of length l and
    // density rho at the angular velocity omega has the energy density w = rho (omega l)^2 / 24, and in its middle the
    // greatest stress, rho (omega l)^2 / 8 = 3 w. The softest material of the body counts.
    Real volume = 0, least = infinity;
    for (const std::array<Index, 4>& corners : tetrahedra) volume += six_volumes(corners, rest_position) / 6;
    for (const Index m : elements.material) {
        const Real lambda = constants[static_cast<std::size_t>(m)].lame_lambda,
                   shear = constants[static_cast<std::size_t>(m)].shear_modulus;
        least = std::min(least, shear * (3 * lambda + 2 * shear) / (lambda + shear));
    }
    stretching_spin_ = small_strain / 3 * volume * least;
    matrix_ = stiffness_;
    factor_ = BlockCholesky(stiffness_);
    elements_ = BodyElements(elements, constants, order_index_);
    slot_of_.assign(mass.size(), no_index);
}

void StiffBody::hold(std::span<const Real> inverse_mass) {
    std::vector<std::uint8_t> held;
    if (std::ranges::any_of(inverse_mass, [](Real inverse) { return !(inverse > 0); })) {
        held.resize(size());
        for (std::size_t n = 0; n < inverse_mass.size(); ++n)
            held[static_cast<std::size_t>(order_index_[n])] = !(inverse_mass[n] > 0);
    }
    if (held == held_) return;
    held_ = std::move(held);
    forget_factor();
}

void StiffBody::forget_factor() {
    inertia_factor_ = stiffness_factor_ = 0;
    tangent_ = false;
}

void StiffBody::forget_columns() {
    std::ranges::fill(slot_of_, no_index);
    std::ranges::fill(node_in_, no_index);
    std::ranges::fill(used_at_, 0);
    touched_.clear();
}

bool StiffBody::is_inaccurate(const Displacements& displacement, const Vec3& angular_momentum, Real factor) {
    const BodyElements::EnergyDifference energies = elements_.compare_energies(displacement);
    if (!(energies.difference <= factor * energy_share * energies.linear)) return true;
    if (!(energy_of_spin(angular_momentum) > factor * energy_share * energies.linear)) return false;
    BodyShape& shape = large_step.shape;
    find_shape(displacement, shape);
    const Vec3 spin = inverse_solid_inertia_ * angular_momentum;
    return (shape.inertia().ldlt().solve(angular_momentum) - spin).norm() > factor * small_strain * spin.norm();
}

bool StiffBody::is_large(const Displacements& displacement, const Vec3& angular_momentum) {
    if (!elements_.any_nonlinear()) return false;
    return energy_of_spin(angular_momentum) > stretching_spin_ ||
           (!(elements_.largest_strain(displacement) <= small_strain) &&
            is_inaccurate(displacement, angular_momentum, 1));
}

bool StiffBody::becomes_large_in_order(std::span<const Vec3> displacement, const Vec3& angular_momentum) {
    if (!elements_.any_nonlinear()) return false;
    if (energy_of_spin(angular_momentum) > stretching_spin_) return true;
    if (!evaluated_at_.empty()) {
        Real squared_change = 0;  // largest squared change of a node's displacement since the last evaluation [m^2]
        for (std::size_t k = 0; k < displacement.size(); ++k)
            squared_change = std::max(squared_change, (displacement[k] - evaluated_at_[k]).squaredNorm());
        if (squared_change == 0 && angular_momentum == evaluated_with_) return evaluated_large_;
        constexpr Real surely = 1 - 1e-9;  // margin for rounding errors
        if (evaluated_strain_ + elements_.strain_by_displacement() * std::sqrt(squared_change) < surely * small_strain)
            return false;
    }
    evaluated_at_.assign(displacement.begin(), displacement.end());
    evaluated_with_ = angular_momentum;
    evaluated_strain_ = elements_.largest_strain(displacement);
    evaluated_large_ = is_large(displacement, angular_momentum);
    if (!std::isfinite(evaluated_strain_)) evaluated_at_.clear();
    return evaluated_large_;
}

bool StiffBody::becomes_small(std::span<const Vec3> displacement, const Vec3& angular_momentum) {
    // Limits below which strain counts as small again, as fractions of the limits of becomes_large():
    // - `accuracy_fraction`: for energies and spin
    // - `strain_fraction`: for strains; below it the energies are not tested, because their difference is mostly a
    //   rounding error
    constexpr Real accuracy_fraction = 0.25, strain_fraction = 0.1;
    if (energy_of_spin(angular_momentum) > accuracy_fraction * stretching_spin_) return false;
    const Displacements at(displacement, node_);
    return elements_.largest_strain(at) <= strain_fraction * small_strain ||
           !is_inaccurate(at, angular_momentum, accuracy_fraction);
}

Real StiffBody::elastic_energy(std::span<const Vec3> displacement, bool large) const {
    const Displacements at(displacement, node_);
    if (large) return elements_.energy(at);
    Real twice = 0;
    for (std::size_t k = 0; k < size(); ++k) {
        const auto row = static_cast<Index>(k);
        for (auto i = static_cast<std::size_t>(stiffness_.offset[k]);
             i < static_cast<std::size_t>(stiffness_.offset[k + 1]); ++i) {
            const Index column = stiffness_.column[i];
            twice += (column == row ? 1 : 2) * at[row].dot(stiffness_.block[i] * at[column]);
        }
    }
    return twice / 2;
}

void StiffBody::remove_rigid_motion(std::span<Vec3> velocity) const {
    Vec3 momentum = Vec3::Zero(), moment = Vec3::Zero();
    for (std::size_t k = 0; k < size(); ++k) {
        const Vec3 of_node = mass_[k] * velocity[static_cast<std::size_t>(node_[k])];
        momentum += of_node;
        moment += arm_[k].cross(of_node);
    }
    const Vec3 mean = momentum / total_mass_, spin = inverse_inertia_ * moment;
    for (std::size_t k = 0; k < size(); ++k) velocity[static_cast<std::size_t>(node_[k])] -= mean + spin.cross(arm_[k]);
}

void StiffBody::find_shape(const Displacements& displacement, BodyShape& shape) const {
    shape.position.resize(size());
    for (std::size_t k = 0; k < size(); ++k) shape.position[k] = arm_[k] + displacement[static_cast<Index>(k)];
    solid_.find_arms(shape);
}

void StiffBody::set_shape(const Displacements& displacement) {
    find_shape(displacement, shape_);
    Mat3 inertia = Mat3::Zero();
    for (std::size_t k = 0; k < size(); ++k) {
        const Vec3& arm = shape_.arm[k];
        inertia += (arm.squaredNorm() * Mat3::Identity() - arm * arm.transpose()) / mass_[k];
    }
    inverse_arm_inertia_ = inertia.inverse();
}

Mat3 StiffBody::rotate_to_own_frame(std::span<Vec3> displacement) const {
    // Newton's method for the rotation at which the sum of m cross(X, y) over the nodes is zero. m is the mass of a
    // node, X and y are its rest and present positions relative to the centre of mass.
    constexpr int most = 20;  // a few suffice, as a body rotates only little against its frame in one step
    constexpr Real rounding = 1e-15;
    Mat3 turn = Mat3::Identity();
    for (int k = 0; k < most; ++k) {
        Vec3 moment = Vec3::Zero();
        Mat3 moment_matrix = Mat3::Zero();
        for (std::size_t p = 0; p < size(); ++p) {
            const Vec3 position = arm_[p] + displacement[static_cast<std::size_t>(node_[p])];
            moment += mass_[p] * arm_[p].cross(position);
            moment_matrix += mass_[p] * position * arm_[p].transpose();
        }
        const Mat3 slope = moment_matrix.trace() * Mat3::Identity() - (moment_matrix + moment_matrix.transpose()) / 2;
        const Vec3 angle = slope.ldlt().solve(moment);
        if (!(angle.norm() > rounding)) break;
        const Mat3 back = rotation_matrix(-angle);
        for (std::size_t p = 0; p < size(); ++p) {
            Vec3& of_node = displacement[static_cast<std::size_t>(node_[p])];
            of_node = back * (arm_[p] + of_node) - arm_[p];
        }
        turn = turn * back.transpose();
        if (!(angle.norm() > 1e-8)) break;  // the error is about the square of this angle
    }
    return turn;
}

bool StiffBody::prepare(Real inertia, Real stiffness) {
    if (inertia == inertia_factor_ && stiffness == stiffness_factor_) return true;
    tangent_ = false;
    inertia_factor_ = inertia;
    stiffness_factor_ = stiffness;
    for (std::size_t i = 0; i < matrix_.block.size(); ++i) matrix_.block[i] = stiffness * stiffness_.block[i];
    for (std::size_t k = 0; k < size(); ++k)
        matrix_.block[static_cast<std::size_t>(matrix_.offset[k + 1]) - 1].diagonal().array() += inertia * mass_[k];
    if (is_held()) decouple_held(held_, mass_, inertia, matrix_);
    forget_columns();
    if (factor_.factor(matrix_)) return true;
    forget_factor();
    return false;
}

bool StiffBody::prepare_tangent(Real inertia, Real stiffness, std::span<const Vec3> displacement) {
    forget_factor();
    forget_columns();
    std::ranges::fill(matrix_.block, Mat3::Zero());
    elements_.add_tangent(displacement, stiffness, matrix_);
    for (std::size_t k = 0; k < size(); ++k)
        matrix_.block[static_cast<std::size_t>(matrix_.offset[k + 1]) - 1].diagonal().array() += inertia * mass_[k];
    if (is_held()) decouple_held(held_, mass_, inertia, matrix_);
    tangent_ = factor_.factor(matrix_);
    if (tangent_ && !is_held()) prepare_rigid_responses();
    return tangent_;
}

void StiffBody::prepare_rigid_responses() {
    shifts_.resize(size());
    turns_.resize(size());
    for (std::size_t k = 0; k < size(); ++k) {
        shifts_[k] = mass_[k] * Mat3::Identity();
        turns_[k] = -crossing(shape_.arm[k]);
    }
    factor_.solve(std::span(shifts_));
    factor_.solve(std::span(turns_));
    Eigen::Matrix<Real, 6, 6> momenta = Eigen::Matrix<Real, 6, 6>::Zero();
    for (std::size_t k = 0; k < size(); ++k) {
        const Mat3 moment = crossing(shape_.arm[k]);
        momenta.topLeftCorner<3, 3>() += mass_[k] * shifts_[k];
        momenta.topRightCorner<3, 3>() += mass_[k] * turns_[k];
        momenta.bottomLeftCorner<3, 3>() += moment * shifts_[k];
        momenta.bottomRightCorner<3, 3>() += moment * turns_[k];
    }
    rigid_inverse_ = momenta.inverse();
}

template <class X>
void StiffBody::remove_rigid_response(std::span<X> velocity) const {
    X momentum = X::Zero(), moment = X::Zero();
    for (std::size_t k = 0; k < velocity.size(); ++k) {
        momentum += mass_[k] * velocity[k];
        moment += crossing(shape_.arm[k]) * velocity[k];
    }
    const X shift = rigid_inverse_.topLeftCorner<3, 3>() * momentum + rigid_inverse_.topRightCorner<3, 3>() * moment,
            turn =
                rigid_inverse_.bottomLeftCorner<3, 3>() * momentum + rigid_inverse_.bottomRightCorner<3, 3>() * moment;
    for (std::size_t k = 0; k < velocity.size(); ++k) velocity[k] -= shifts_[k] * shift + turns_[k] * turn;
}

template <class X>
void StiffBody::remove_momenta_of(std::span<X> velocity) const {
    X momentum = X::Zero(), moment = X::Zero();
    for (std::size_t k = 0; k < velocity.size(); ++k) {
        momentum += mass_[k] * velocity[k];
        moment += crossing(shape_.arm[k]) * velocity[k];
    }
    const X mean = momentum / total_mass_, spin = inverse_arm_inertia_ * moment;
    for (std::size_t k = 0; k < velocity.size(); ++k) velocity[k] -= mean - crossing(shape_.arm[k]) * spin / mass_[k];
}

template <class X>
void StiffBody::remove_rigid_part(std::span<X> impulse) const {
    X sum = X::Zero(), moment = X::Zero();
    for (std::size_t k = 0; k < impulse.size(); ++k) {
        sum += impulse[k];
        moment += crossing(arm_[k]) * impulse[k];
    }
    const X velocity = sum / total_mass_, spin = inverse_inertia_ * moment;
    for (std::size_t k = 0; k < impulse.size(); ++k) impulse[k] -= mass_[k] * (velocity - crossing(arm_[k]) * spin);
}

template <class X>
void StiffBody::respond_to(std::span<X> impulse) const {
    if (is_held()) {
        for (std::size_t k = 0; k < impulse.size(); ++k)
            if (held_[k]) impulse[k].setZero();
        factor_.solve(impulse);
        return;
    }
    if (tangent_) {
        factor_.solve(impulse);
        remove_rigid_response(impulse);
        remove_momenta_of(impulse);  // this call removes only rounding errors
        return;
    }
    remove_rigid_part(impulse);
    factor_.solve(impulse);
    // Removes the rounding errors that have the form of rigid motion. They matter for stiff bodies, whose rigid
    // response is far larger than their elastic response.
    for (std::size_t k = 0; k < impulse.size(); ++k) impulse[k] *= mass_[k];
    remove_rigid_part(impulse);
    for (std::size_t k = 0; k < impulse.size(); ++k) impulse[k] /= mass_[k];
}

void StiffBody::respond(std::span<Vec3> impulse) const {
    respond_to(impulse);
}

std::span<const Mat3> StiffBody::column(std::size_t node) {
    Index& slot = slot_of_[node];
    ++uses_;
    if (slot == no_index) {
        // There are at least as many slots for columns as touched nodes. With fewer slots, the columns of one step
        // would replace each other, and every step would compute all of them again.
        const std::size_t most = std::max({std::size_t(1), column_memory / (size() * sizeof(Mat3)), touched_.size()});
        ++columns_made_;
        if (node_in_.size() < std::min(most, size())) {
            slot = static_cast<Index>(node_in_.size());
            node_in_.push_back(no_index);
            used_at_.push_back(0);
            columns_.resize(columns_.size() + size());
        } else {
            slot = static_cast<Index>(std::ranges::min_element(used_at_) - used_at_.begin());
        }
        const auto s = static_cast<std::size_t>(slot);
        if (node_in_[s] != no_index) slot_of_[static_cast<std::size_t>(node_in_[s])] = no_index;
        node_in_[s] = static_cast<Index>(node);
        const auto values = std::span(columns_).subspan(s * size(), size());
        std::ranges::fill(values, Mat3::Zero());
        values[static_cast<std::size_t>(order_index_[node])].setIdentity();
        respond_to(values);
    }
    used_at_[static_cast<std::size_t>(slot)] = uses_;
    return std::span<const Mat3>(columns_).subspan(static_cast<std::size_t>(slot) * size(), size());
}

std::span<const Real> StiffBody::responses(std::span<const Index> nodes, Index first) {
    const auto same = [first](Index kept, Index asked) { return kept == asked - first; };
    if (!std::ranges::equal(touched_, nodes, same)) {
        touched_.resize(nodes.size());
        std::ranges::transform(nodes, touched_.begin(), [first](Index node) { return node - first; });
        find_responses();
    }
    const std::size_t numbers = 3 * nodes.size();
    return std::span<const Real>(responses_).first(numbers * numbers);
}

void StiffBody::find_responses() {
    const std::size_t count = touched_.size(), numbers = 3 * count;
    if (responses_.size() < numbers * numbers) responses_.resize(numbers * numbers);
    if (inertia_factor_ == 0 && !tangent_) {
        std::ranges::fill(responses_, 0);
        return;
    }
    // Marks the stored columns of the touched nodes as just used, so that new columns replace only those of untouched
    // nodes.
    ++uses_;
    for (const Index node : touched_)
        if (const Index slot = slot_of_[static_cast<std::size_t>(node)]; slot != no_index)
            used_at_[static_cast<std::size_t>(slot)] = uses_;
    for (std::size_t i = 0; i < count; ++i) {
        const std::span<const Mat3> from = column(static_cast<std::size_t>(touched_[i]));
        // Each column is written to both triangles, so the matrix is bitwise symmetric.
        for (std::size_t j = i; j < count; ++j) {
            const Mat3& block = from[static_cast<std::size_t>(order_index(static_cast<std::size_t>(touched_[j])))];
            for (std::size_t c = 0; c < 3; ++c)
                for (std::size_t r = 0; r < 3; ++r) {
                    const Real number = block(static_cast<Index>(r), static_cast<Index>(c));
                    responses_[(3 * i + c) * numbers + 3 * j + r] = number;
                    responses_[(3 * j + r) * numbers + 3 * i + c] = number;
                }
        }
    }
}

}  // namespace skerry
