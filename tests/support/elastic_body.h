// Tables of one elastic body, as the world would make them.
#pragma once

#include <Eigen/LU>
#include <cmath>

#include "components/body_table.h"
#include "components/node_table.h"
#include "systems/dynamics/elements/build_elements.h"
#include "systems/dynamics/elements/compute_element_forces.h"
#include "systems/material/material_law.h"
#include "tests/support/jittered_box.h"
#include "tests/support/node_forces.h"

namespace skerry::test {

struct ElasticBody {
    std::vector<Vec3> position, velocity, load, force;
    std::vector<Real> mass, inverse_mass;
    ElementBlockTable elements;
    Range blocks;
    Ragged<Index> corners;
    Column<MaterialConstants> constants;

    ElasticBody(const TetMesh& mesh, const MaterialConstants& material, const Mat3& rotation = Mat3::Identity()) {
        const std::size_t n = mesh.nodes.size();
        for (const Vec3& x : mesh.nodes) position.push_back(rotation * x);
        velocity.assign(n, Vec3::Zero());
        load.assign(n, Vec3::Zero());
        force.assign(n, Vec3::Zero());
        mass.assign(n, 0);
        constants.push_back(material);
        blocks = append_elements(mesh.tetrahedra, mesh.nodes, 0, 0, 0, rotation, elements);
        add_lumped_mass(mesh.tetrahedra, mesh.nodes, material.density, mass);
        for (Real m : mass) inverse_mass.push_back(1 / m);
        build_corners(elements.node, elements.volume, n, corners);
    }

    ElementInputs inputs() const {
        return {.node = elements.node,
                .inverse_rest = elements.inverse_rest,
                .volume = elements.volume,
                .material = elements.material,
                .constants = constants,
                .relaxation_rate = elements.relaxation_rate,
                .own_frequency = elements.own_frequency,
                .relaxing_share = elements.relaxing_share,
                .viscous_strain = elements.viscous_strain};
    }

    /// `h`: s, since the elements were last looked at: what relaxes does so for this long. Returns what that
    /// dissipates, J.
    Real compute_elements(Executor& executor, Real h = 0) {
        return compute_element_forces(executor, inputs(), position, velocity, h, elements.rotation,
                                      {elements.rotation_next, elements.viscous_strain_next, elements.relaxed},
                                      elements.force);
    }
    void gather(const Vec3& gravity = Vec3::Zero()) {
        gather_node_forces(corners.view(), elements.force, mass, gravity, load, force);
    }
    void compute_forces(Executor& executor, const Vec3& gravity = Vec3::Zero()) {
        compute_elements(executor);
        gather(gravity);
        swap(elements.rotation, elements.rotation_next);
    }

    /// F of one element by the textbook, for comparison with the kernels.
    Mat3 deformation(std::size_t element) const {
        const std::size_t b = element / element_lanes, l = element % element_lanes;
        const auto at = [&](std::size_t a) -> const Vec3& {
            return position[static_cast<std::size_t>(elements.node[b][a][l])];
        };
        Mat3 Ds, B;
        Ds << at(1) - at(0), at(2) - at(0), at(3) - at(0);
        for (std::size_t i = 0; i < 9; ++i) B.data()[i] = elements.inverse_rest[b][i][l];
        return Ds * B;
    }
    Real volume(std::size_t element) const { return elements.volume[element / element_lanes][element % element_lanes]; }
};

}  // namespace skerry::test
