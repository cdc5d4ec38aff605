#include "systems/dynamics/elements/build_elements.h"

#include <Eigen/LU>
#include <limits>

#include "components/check.h"

namespace skerry {

namespace {

using Tetrahedron = std::array<Index, 4>;

/// Columns: corners 1 to 3 minus corner 0.
Mat3 rest_edges(const Tetrahedron& tet, std::span<const Vec3> position) {
    const auto at = [&](std::size_t a) -> const Vec3& { return position[static_cast<std::size_t>(tet[a])]; };
    Mat3 Dm;
    Dm << at(1) - at(0), at(2) - at(0), at(3) - at(0);
    return Dm;
}

}  // namespace

Range append_elements(std::span<const Tetrahedron> tetrahedra, std::span<const Vec3> rest_position, Index first_node,
                      Index body, Index material, const Mat3& rotation, ElementBlockTable& elements) {
    const Index first_block = static_cast<Index>(elements.node.size());
    for (std::size_t first = 0; first < tetrahedra.size(); first += element_lanes) {
        ElementNodes node;
        for (auto& corner : node)
            for (Index& n : corner.lane) n = first_node;
        ElementRest rest{};
        ElementLane volume{};
        ElementRotation quaternion{};
        for (Real& w : quaternion[0].lane) w = 1;
        for (std::size_t l = 0; l < element_lanes && first + l < tetrahedra.size(); ++l) {
            const Tetrahedron& tet = tetrahedra[first + l];
            const Mat3 Dm = rotation * rest_edges(tet, rest_position);
            const Real determinant = Dm.determinant();
            SKERRY_CHECK(determinant > 0);
            const Mat3 B = Dm.inverse();
            for (std::size_t a = 0; a < 4; ++a) node[a][l] = first_node + tet[a];
            for (std::size_t i = 0; i < 9; ++i) rest[i][l] = B.data()[i];
            volume[l] = determinant / 6;
        }
        elements.node.push_back(node);
        elements.inverse_rest.push_back(rest);
        elements.volume.push_back(volume);
        elements.rotation.push_back(quaternion);
        // both: kernels of other models touch neither, and the step swaps them
        elements.rotation_next.push_back(quaternion);
        elements.force.push_back(ElementForces{});
        elements.body.push_back(body);
        elements.material.push_back(material);
        elements.viscous_strain.push_back(ElementStrain{});
        elements.viscous_strain_next.push_back(ElementStrain{});
        elements.relaxation_rate.push_back(ElementLane{});
        elements.own_frequency.push_back(ElementLane{});
        elements.relaxing_share.push_back(0);
        elements.relaxed.push_back(0);
        elements.viscous_time.push_back(0);
        elements.uninverted_until.push_back(-std::numeric_limits<Real>::infinity());
        elements.level.push_back(0);
    }
    for (std::size_t b = static_cast<std::size_t>(first_block); b < elements.force.size(); ++b)
        for (auto& lane : elements.force[b]) lane.fill(Vec3::Zero());
    return {first_block, static_cast<Index>(elements.node.size())};
}

void add_lumped_mass(std::span<const Tetrahedron> tetrahedra, std::span<const Vec3> rest_position, Real density,
                     std::span<Real> mass) {
    for (const Tetrahedron& tet : tetrahedra) {
        const Real share = density * rest_edges(tet, rest_position).determinant() / 24;  // rho V / 4
        for (Index n : tet) mass[static_cast<std::size_t>(n)] += share;
    }
}

void build_corners(std::span<const ElementNodes> node, std::span<const ElementLane> volume, std::size_t node_count,
                   Ragged<Index>& corners) {
    // Counting sort: count, sum up, fill in element order.
    const auto for_each_corner = [&](auto&& visit) {
        for (std::size_t b = 0; b < node.size(); ++b)
            for (std::size_t l = 0; l < element_lanes; ++l)
                for (std::size_t a = 0; a < 4; ++a)
                    if (volume[b][l] > 0)
                        visit(static_cast<std::size_t>(node[b][a][l]), 4 * (b * element_lanes + l) + a);
    };
    corners.offset.assign(node_count + 1, 0);
    for_each_corner([&](std::size_t n, std::size_t) { ++corners.offset[n + 1]; });
    for (std::size_t n = 0; n < node_count; ++n) corners.offset[n + 1] += corners.offset[n];
    corners.item.resize(static_cast<std::size_t>(corners.offset[node_count]));
    for_each_corner([&](std::size_t n, std::size_t corner) {
        corners.item[static_cast<std::size_t>(corners.offset[n]++)] = static_cast<Index>(corner);
    });
    for (std::size_t n = node_count; n > 0; --n) corners.offset[n] = corners.offset[n - 1];
    corners.offset[0] = 0;
}

}  // namespace skerry
