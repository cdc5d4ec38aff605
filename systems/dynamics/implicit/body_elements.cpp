#include "systems/dynamics/implicit/body_elements.h"

#include <Eigen/LU>
#include <algorithm>
#include <cmath>

#include "systems/material/material_law.h"

namespace skerry {

namespace {

/// Block of the stiffness matrix for two nodes of an element, per volume. It contains only those terms of the tangent
/// dP/dF that anisotropic laws have in addition. `g`, `other`: shape function gradients of the two nodes [1/m].
Mat3 anisotropic_block(const Tangent& tangent, const Vec3& g, const Vec3& other) {
    Mat3 block = g.dot(tangent.second_stress * other) * Mat3::Identity();
    for (const Mat3& dyad : tangent.dyads) block += (dyad * g) * (dyad * other).transpose();
    return block;
}

}  // namespace

BodyElements::BodyElements(const ElementList& elements, std::span<const MaterialConstants> constants,
                           std::span<const Index> order_index)
    : first_(elements.first_node), gradient_(elements.gradient), volume_(elements.volume) {
    for (const Index node : elements.node) order_index_.push_back(order_index[static_cast<std::size_t>(node)]);
    std::size_t max_nodes = 0;
    for (std::size_t e = 0; e < size(); ++e) {
        material_.push_back(part_of(constants[static_cast<std::size_t>(elements.material[e])], elements.part[e]));
        any_nonlinear_ |= material_.back().model != MaterialModel::linear;
        Real sum = 0;
        for (const Vec3& gradient : nodes_of(e).gradient) sum += gradient.norm();
        strain_by_displacement_ = std::max(strain_by_displacement_, sum);
        max_nodes = std::max(max_nodes, elements.nodes_of(e));
    }
    turned_.resize(max_nodes);
}

BodyElements::Nodes BodyElements::nodes_of(std::size_t e) const {
    const std::size_t count = first_[e + 1] - first_[e];
    return {std::span(order_index_).subspan(first_[e], count), std::span(gradient_).subspan(first_[e], count)};
}

Mat3 BodyElements::gradient_of(std::size_t e, const Displacements& displacement) const {
    const Nodes nodes = nodes_of(e);
    const Vec3& first = displacement[nodes.order_index[0]];
    Mat3 change = Mat3::Zero();
    for (std::size_t k = 1; k < nodes.order_index.size(); ++k)
        change += (displacement[nodes.order_index[k]] - first) * nodes.gradient[k].transpose();
    return change;
}

Real BodyElements::largest_strain(const Displacements& displacement) const {
    Real squared = 0;
    for (std::size_t e = 0; e < size(); ++e) {
        const Real squared_strain = gradient_of(e, displacement).squaredNorm();
        if (std::isnan(squared_strain)) return squared_strain;
        squared = std::max(squared, squared_strain);
    }
    return std::sqrt(squared);
}

Real BodyElements::energy(const Displacements& displacement) const {
    Real sum = 0;
    for (std::size_t e = 0; e < size(); ++e)
        sum += volume_[e] * energy_density(material_[e], Mat3::Identity() + gradient_of(e, displacement));
    return sum;
}

BodyElements::EnergyDifference BodyElements::compare_energies(const Displacements& displacement) const {
    EnergyDifference sum{0, 0};
    for (std::size_t e = 0; e < size(); ++e) {
        const Mat3 change = gradient_of(e, displacement), F = Mat3::Identity() + change;
        const Real linear = volume_[e] * small_strain_energy(material_[e], change);
        sum.linear += linear;
        sum.difference += std::abs(volume_[e] * energy_density(material_[e], F) - linear);
    }
    return sum;
}

void BodyElements::forces(const Displacements& displacement, std::span<Vec3> out) const {
    std::ranges::fill(out, Vec3::Zero());
    for (std::size_t e = 0; e < size(); ++e) {
        const Nodes nodes = nodes_of(e);
        const Mat3 pull = volume_[e] * stress(material_[e], Mat3::Identity() + gradient_of(e, displacement));
        // Sum of the forces on all nodes but the first. The first node gets minus this sum, because the shape gradients
        // of an element add up to zero.
        Vec3 others = Vec3::Zero();
        for (std::size_t k = 1; k < nodes.order_index.size(); ++k) {
            const Vec3 of_node = pull * nodes.gradient[k];
            out[static_cast<std::size_t>(nodes.order_index[k])] += of_node;
            others += of_node;
        }
        out[static_cast<std::size_t>(nodes.order_index[0])] -= others;
    }
}

void BodyElements::find_blocks(const BlockRows& matrix) {
    for (std::size_t e = 0; e < size(); ++e) {
        const std::span<const Index> order_index = nodes_of(e).order_index;
        for (std::size_t k = 0; k < order_index.size(); ++k)
            for (std::size_t l = 0; l <= k; ++l) {
                const auto [column, row] = std::minmax(order_index[k], order_index[l]);
                const auto first = matrix.column.begin() + matrix.offset[static_cast<std::size_t>(row)],
                           last = matrix.column.begin() + matrix.offset[static_cast<std::size_t>(row) + 1];
                block_.push_back(static_cast<Index>(std::lower_bound(first, last, column) - matrix.column.begin()));
            }
    }
}

void BodyElements::add_tangent(const Displacements& displacement, Real scale, BlockRows& matrix) {
    if (block_.empty()) find_blocks(matrix);
    std::size_t at = 0;
    for (std::size_t e = 0; e < size(); ++e) {
        const Nodes nodes = nodes_of(e);
        const Tangent tangent = skerry::tangent(material_[e], Mat3::Identity() + gradient_of(e, displacement));
        const Real weight = scale * volume_[e];
        // The tangent maps a change dF of the deformation gradient to the change dP of the stress, in the principal
        // axes of F. `normal` couples the diagonal entries. Other entries are dP_ij = diagonal_part_ij dF_ij +
        // crossed_ij dF_ji.
        const Mat3 normal = weight * tangent.normal;
        Mat3 same_entry = Mat3::Zero(), transposed_entry = Mat3::Zero();
        for (Index i = 0; i < 3; ++i) {
            same_entry(i, i) = normal(i, i);
            for (Index j = 0; j < 3; ++j) {
                if (i == j) continue;
                const Index pair = 3 - i - j;
                same_entry(i, j) = weight * (tangent.flip[pair] + tangent.twist[pair]) / 2;
                transposed_entry(i, j) = weight * (tangent.flip[pair] - tangent.twist[pair]) / 2;
            }
        }
        for (std::size_t k = 0; k < nodes.order_index.size(); ++k)
            turned_[k] = tangent.right.transpose() * nodes.gradient[k];
        for (std::size_t k = 0; k < nodes.order_index.size(); ++k)
            for (std::size_t l = 0; l <= k; ++l) {
                const Vec3 &g = turned_[k], &other = turned_[l];
                Mat3 block =
                    normal.cwiseProduct(g * other.transpose()) + transposed_entry.cwiseProduct(other * g.transpose());
                block.diagonal() = same_entry * g.cwiseProduct(other);
                block = tangent.left * block * tangent.left.transpose();
                if (tangent.is_anisotropic)
                    block += weight * anisotropic_block(tangent, nodes.gradient[k], nodes.gradient[l]);
                Mat3& to = matrix.block[static_cast<std::size_t>(block_[at++])];
                if (nodes.order_index[k] >= nodes.order_index[l])
                    to += block;
                else
                    to += block.transpose();
            }
    }
}

}  // namespace skerry
