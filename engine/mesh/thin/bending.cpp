#include "engine/mesh/thin/bending.h"

#include <Eigen/Geometry>
#include <algorithm>

namespace skerry::mesh {

namespace {

// Share of the computed excess of bending energy (energy of the elements minus exact energy) that remains in a static
// solution. The excess is computed with all nodes at the positions of exact bending; free nodes find a state of lower
// energy.
//
// In strips of one or two layers of cells the share is 0.65 to 1, with the smallest value for a width of two flat
// cells.
constexpr Real remaining_excess = 0.8;

/// Displacements of pure bending (Saint-Venant) with a curvature of 1 per metre. The neutral axis crosses the column,
/// which leads through the thickness of the part (ThinColumn).
struct Bending {
    std::size_t part, column;
    Vec3 middle;                   // point on the neutral axis [m]
    Vec3 tangent, across, normal;  // orthonormal: axis of the bent part, axis of rotation, and direction of the column
    Real poisson_ratio, young_modulus;

    Vec3 displacement(const Vec3& point) const {
        const Vec3 d = point - middle;
        const Real s = d.dot(tangent), y = d.dot(across), z = d.dot(normal);
        return -s * z * tangent + poisson_ratio * z * y * across +
               (s * s + poisson_ratio * (z * z - y * y)) / 2 * normal;
    }
};

/// Energy density of a small strain [J/m^3]. `part`: whether the element carries the volumetric part of the stress
/// (lambda), the shear part (mu), or both.
Real energy_density(const Mat3& displacement_gradient, const Bending& bending, ElementPart part) {
    const Real E = bending.young_modulus, nu = bending.poisson_ratio;
    const Real mu = part == ElementPart::volume ? 0 : E / (2 * (1 + nu));
    const Real lambda = part == ElementPart::shear ? 0 : E * nu / ((1 + nu) * (1 - 2 * nu));
    const Mat3 strain = (displacement_gradient + displacement_gradient.transpose()) / 2;
    return mu * strain.squaredNorm() + lambda / 2 * strain.trace() * strain.trace();
}

/// The tetrahedra that columns cross, and the tetrahedra that share a node with them. The latter are needed because
/// smoothed elements average the strain over the tetrahedra around an edge or a node.
struct Surroundings {
    std::vector<std::array<Index, 4>> tetrahedra;
    std::vector<MaterialZone> zones;  // zones whose tetrahedra are numbered as in `tetrahedra`
    std::vector<Index> row;           // for each tetrahedron of the mesh: its index in `tetrahedra`, or no_index
    std::vector<Index> material;      // index of the material of each entry of `tetrahedra`
};

Surroundings surroundings_of(const Mesh& mesh, std::span<const BentColumn> columns,
                             std::span<const MaterialZone> zones) {
    std::vector<bool> used(mesh.nodes.size(), false);
    for (const BentColumn& bent : columns)
        for (const Crossing& crossing : bent.column->crossings)
            for (const Index n : mesh.tetrahedra[static_cast<std::size_t>(crossing.tetrahedron)])
                used[static_cast<std::size_t>(n)] = true;
    Surroundings nearby;
    nearby.row.assign(mesh.tetrahedra.size(), no_index);
    for (const MaterialZone& zone : zones) {
        MaterialZone near{zone.material, zone.kind, {}};
        for (const Index t : zone.tetrahedra) {
            const std::array<Index, 4>& tetrahedron = mesh.tetrahedra[static_cast<std::size_t>(t)];
            if (std::ranges::none_of(tetrahedron, [&](Index n) { return used[static_cast<std::size_t>(n)]; })) continue;
            nearby.row[static_cast<std::size_t>(t)] = static_cast<Index>(nearby.tetrahedra.size());
            near.tetrahedra.push_back(static_cast<Index>(nearby.tetrahedra.size()));
            nearby.tetrahedra.push_back(tetrahedron);
            nearby.material.push_back(zone.material);
        }
        if (!near.tetrahedra.empty()) nearby.zones.push_back(std::move(near));
    }
    return nearby;
}

/// Distance of the neutral axis from the start of a column, int E z dz / int E dz [m]. E: Young's modulus along the
/// column. z: distance from the start of the column.
Real neutral_distance(const ThinColumn& column, const Surroundings& nearby,
                      std::span<const ElasticConstants> materials) {
    Real moment = 0, stiffness = 0;
    for (const Crossing& crossing : column.crossings) {
        const auto row = static_cast<std::size_t>(nearby.row[static_cast<std::size_t>(crossing.tetrahedron)]);
        const Real modulus = materials[static_cast<std::size_t>(nearby.material[row])].young_modulus;
        stiffness += modulus * (crossing.end - crossing.begin);
        moment += modulus * (crossing.end * crossing.end - crossing.begin * crossing.begin) / 2;
    }
    return moment / stiffness;
}

/// Energy in a tetrahedron of exact bending with a curvature of 1 per metre: int E z^2 / 2 dV [J]. E: Young's modulus.
/// z: distance from the neutral axis.
Real exact_energy(const std::array<Index, 4>& tetrahedron, std::span<const Vec3> position, const Bending& bending) {
    Real sum = 0, squares = 0;
    for (const Index n : tetrahedron) {
        const Real z = (position[static_cast<std::size_t>(n)] - bending.middle).dot(bending.normal);
        sum += z;
        squares += z * z;
    }
    const Real mean_square = (squares + sum * sum) / 20;  // mean of z^2, where z is linear in the tetrahedron [m^2]
    return bending.young_modulus / 2 * mean_square * skerry::six_volumes(tetrahedron, position) / 6;
}

}  // namespace

std::vector<Real> bending_stiffness(const Mesh& mesh, std::span<const BentColumn> columns, std::size_t part_count,
                                    std::span<const MaterialZone> zones, std::span<const ElasticConstants> materials) {
    const Surroundings nearby = surroundings_of(mesh, columns, zones);
    // Several columns of a part may cross a tetrahedron. The first of these columns defines the neutral axis and the
    // directions of bending in the tetrahedron.
    std::vector<std::vector<Bending>> bendings(nearby.tetrahedra.size());
    // bending energy of each column: `exact` by the theory of beams, `element_energy` with the elements [J]
    std::vector<Real> exact(columns.size(), 0), element_energy(columns.size(), 0);
    for (std::size_t c = 0; c < columns.size(); ++c) {
        const BentColumn& bent = columns[c];
        const ThinColumn& column = *bent.column;
        const Vec3 middle = column.start + neutral_distance(column, nearby, materials) * column.direction;
        for (const Crossing& crossing : column.crossings) {
            const auto row = static_cast<std::size_t>(nearby.row[static_cast<std::size_t>(crossing.tetrahedron)]);
            std::vector<Bending>& known = bendings[row];
            if (std::ranges::find(known, bent.part, &Bending::part) != known.end()) continue;
            const ElasticConstants& material = materials[static_cast<std::size_t>(nearby.material[row])];
            known.push_back({bent.part, c, middle, bent.tangent, column.direction.cross(bent.tangent), column.direction,
                             material.poisson_ratio, material.young_modulus});
            exact[c] += exact_energy(nearby.tetrahedra[row], mesh.nodes, known.back());
        }
    }

    const ElementList elements = elements_of({nearby.tetrahedra, mesh.nodes}, nearby.zones);
    const auto for_each_share = [&](auto&& visit) {
        for (std::size_t e = 0; e < elements.size(); ++e)
            for (std::size_t i = elements.first_tetrahedron[e]; i < elements.first_tetrahedron[e + 1]; ++i) {
                const auto row = static_cast<std::size_t>(elements.tetrahedron[i]);
                visit(e, row, elements.part[e] == ElementPart::volume ? 1U : 0U);
            }
    };
    // For each tetrahedron, the numbers of elements that include it, by the part of the stress that they carry:
    // - entry 0: the shear part or both parts,
    // - entry 1: only the volumetric part.
    //
    // The volume of the tetrahedron is divided equally among the elements of each entry.
    std::vector<std::array<int, 2>> covered(nearby.tetrahedra.size(), {0, 0});
    for_each_share([&](std::size_t, std::size_t row, std::size_t kind) { ++covered[row][kind]; });
    for_each_share([&](std::size_t e, std::size_t row, std::size_t kind) {
        for (const Bending& bending : bendings[row]) {
            Mat3 gradient = Mat3::Zero();
            for (std::size_t k = elements.first_node[e]; k < elements.first_node[e + 1]; ++k)
                gradient += bending.displacement(mesh.nodes[static_cast<std::size_t>(elements.node[k])]) *
                            elements.gradient[k].transpose();
            const Real volume = skerry::six_volumes(nearby.tetrahedra[row], mesh.nodes) / 6 / covered[row][kind];
            element_energy[bending.column] += volume * energy_density(gradient, bending, elements.part[e]);
        }
    });

    // Relative bending stiffness of each part, from the mean compliance (exact / element_energy) of its columns,
    // weighted by exact energy. Compliances are averaged because all columns carry about the same bending moment. A
    // mean of the stiffnesses would be dominated by a few slivers.
    std::vector<Real> energy(part_count, 0), compliance(part_count, 0);
    for (std::size_t c = 0; c < columns.size(); ++c) {
        if (!(exact[c] > 0)) continue;
        energy[columns[c].part] += exact[c];
        compliance[columns[c].part] += exact[c] * exact[c] / element_energy[c];
    }
    std::vector<Real> stiffness(part_count, 1);
    for (std::size_t p = 0; p < part_count; ++p)
        if (energy[p] > 0) stiffness[p] = 1 + remaining_excess * (energy[p] / compliance[p] - 1);
    return stiffness;
}

}  // namespace skerry::mesh
