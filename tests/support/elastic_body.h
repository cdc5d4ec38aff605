// Tables of one elastic body, built like those of a world.
#pragma once

#include <Eigen/LU>
#include <cmath>

#include "components/body_table.h"
#include "components/node_table.h"
#include "systems/dynamics/elements/build_elements.h"
#include "systems/dynamics/elements/compute_element_forces.h"
#include "systems/dynamics/stability/stiffness_share.h"
#include "systems/material/material_law.h"
#include "tests/support/jittered_box.h"
#include "tests/support/node_forces.h"

namespace skerry::test {

struct ElasticBody {
    std::vector<Vec3> position, velocity, load, force;
    std::vector<Real> mass, inverse_mass;
    TetMesh mesh;
    std::vector<Real> tetrahedron_mass;  // [kg]
    TetrahedronBlockTable tetrahedra;
    ElementBlockTable elements;
    ElementNodeTable element_nodes;
    Range blocks;
    ElementPatches patches;
    Column<MaterialConstants> constants;
    ElementList list;
    std::vector<Index> element_at;  // index in `list` of the element in each lane; no_index in an unused lane

    ElasticBody(const TetMesh& tet_mesh, const MaterialConstants& material, const Mat3& rotation = Mat3::Identity(),
                ElementKind kind = ElementKind::linear)
        : ElasticBody(tet_mesh, {material}, std::vector<Index>(tet_mesh.tetrahedra.size(), 0), rotation, kind) {}

    /// Builds a body of several materials; `material_of` gives the material of each tetrahedron.
    ElasticBody(const TetMesh& tet_mesh, const std::vector<MaterialConstants>& materials,
                const std::vector<Index>& material_of, const Mat3& rotation = Mat3::Identity(),
                ElementKind kind = ElementKind::linear)
        : mesh(tet_mesh) {
        const std::size_t n = mesh.nodes.size();
        for (const Vec3& x : mesh.nodes) position.push_back(rotation * x);
        velocity.assign(n, Vec3::Zero());
        load.assign(n, Vec3::Zero());
        force.assign(n, Vec3::Zero());
        mass.assign(n, 0);
        std::vector<MaterialZone> zones;
        for (std::size_t m = 0; m < materials.size(); ++m) {
            constants.push_back(materials[m]);
            zones.push_back({static_cast<Index>(m), kind, {}});
        }
        std::vector<Real> density;
        for (std::size_t t = 0; t < mesh.tetrahedra.size(); ++t) {
            zones[static_cast<std::size_t>(material_of[t])].tetrahedra.push_back(static_cast<Index>(t));
            density.push_back(materials[static_cast<std::size_t>(material_of[t])].density);
            tetrahedron_mass.push_back(density.back() * six_volumes(mesh.tetrahedra[t], mesh.nodes) / 6);
        }
        append_tetrahedra(mesh.tetrahedra, mesh.nodes, 0, tetrahedra);
        list = elements_of({mesh.tetrahedra, mesh.nodes}, zones);
        const AppendedElements appended = append_elements(list, mesh.nodes, 0, 0, elements, element_nodes);
        blocks = appended.blocks;
        turn_elements(rotation, blocks, elements, element_nodes);
        element_at = appended.element;
        start_mass_shares(inputs(), blocks, elements.mass_share);
        add_lumped_mass(mesh.tetrahedra, mesh.nodes, density, mass);
        for (Real m : mass) inverse_mass.push_back(1 / m);
        build_patches(elements, n, element_nodes, patches);
    }

    ElementInputs inputs() const {
        return {.first = elements.first,
                .count = elements.count,
                .node = element_nodes.node,
                .gradient = element_nodes.gradient,
                .volume = elements.volume,
                .mass_share = elements.mass_share,
                .material = elements.material,
                .part = elements.part,
                .constants = constants,
                .relaxation_rate = elements.relaxation_rate,
                .own_frequency = elements.own_frequency,
                .relaxing_share = elements.relaxing_share,
                .spring_strain = elements.spring_strain,
                .mass_form = elements.mass_form,
                .frame_mass = elements.frame_mass,
                .frame_bound = elements.frame_bound};
    }

    /// Computes element forces. Springs relax for `h`, the time since the last evaluation [s]. Returns the
    /// dissipated energy [J].
    Real compute_elements(Executor& executor, Real h = 0) {
        return compute_element_forces(executor, inputs(), position, velocity, h, elements.rotation,
                                      {elements.rotation_next, elements.spring_strain_next}, patch_forces());
    }
    PatchForces patch_forces() {
        return {.blocks = patches.blocks,
                .slots = patches.slots,
                .node = patches.node,
                .slot = element_nodes.slot,
                .position = patches.position,
                .force = patches.force,
                .relaxed = patches.relaxed};
    }
    void gather(const Vec3& gravity = Vec3::Zero()) {
        gather_node_forces(patches.slots_of_node.view(), patches.force, mass, gravity, load, force);
    }
    void compute_forces(Executor& executor, const Vec3& gravity = Vec3::Zero()) {
        compute_elements(executor);
        gather(gravity);
        swap(elements.rotation, elements.rotation_next);
    }

    /// Number of nodes of an element, its node k, and its gradient k.
    std::size_t node_count(std::size_t element) const {
        return static_cast<std::size_t>(elements.count[element / element_lanes]);
    }
    std::size_t node(std::size_t element, std::size_t k) const {
        return static_cast<std::size_t>(element_nodes.node[row(element) + k][element % element_lanes]);
    }
    Vec3 gradient(std::size_t element, std::size_t k) const {
        const ElementGradient& g = element_nodes.gradient[row(element) + k];
        const std::size_t l = element % element_lanes;
        return {g[0][l], g[1][l], g[2][l]};
    }

    /// F of one element by the textbook formula, for comparison with the kernels.
    Mat3 deformation(std::size_t element) const {
        Mat3 F = Mat3::Zero();
        for (std::size_t k = 0; k < node_count(element); ++k)
            F += position[node(element, k)] * gradient(element, k).transpose();
        return F;
    }
    Real volume(std::size_t element) const { return elements.volume[element / element_lanes][element % element_lanes]; }

private:
    std::size_t row(std::size_t element) const {
        return static_cast<std::size_t>(elements.first[element / element_lanes]);
    }
};

}  // namespace skerry::test
