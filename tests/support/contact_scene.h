// Small contact problems: point masses, stencils, and sheets of points lying on each other.
#pragma once

#include <Eigen/Dense>
#include <cmath>
#include <memory>
#include <random>
#include <span>
#include <vector>

#include "jobs/executor.h"
#include "systems/contact/separate_regions.h"
#include "systems/solver/inputs/region_inputs.h"
#include "systems/solver/solve_regions.h"

namespace skerry {

struct SolvedScene {
    RegionTable regions;
    std::vector<Vec3> impulse, velocity, push_out;
    std::vector<Vec3> contact_impulse, contact_moment, push_velocity, push_spin;  // by rigid body
};

/// Rigid bodies of a scene. Body 0 of the tables is deformable and owns the nodes that belong to no rigid body.
struct RigidScene {
    std::vector<Index> node_body;
    std::vector<Range> body_nodes, body_rigid;
    std::vector<Vec3> position, center, momentum, angular_momentum, kick, moment_kick;
    std::vector<Real> mass;
    std::vector<Mat3> inverse_inertia;

    RigidNodes nodes() const { return mass.empty() ? RigidNodes{} : RigidNodes{node_body, body_nodes, body_rigid}; }
    RigidInputs inputs() const {
        return {nodes(), position, center, mass, {inverse_inertia, angular_momentum, moment_kick}, momentum, kick};
    }
    /// Adds a body at rest with nodes first .. first + node_positions.size() - 1 of a scene with `count` nodes.
    void add(std::size_t count, Index first, std::span<const Vec3> node_positions, const Vec3& at, Real body_mass,
             const Mat3& inertia) {
        if (body_nodes.empty()) {
            body_nodes.push_back({0, 0});
            body_rigid.push_back({0, 0});
        }
        node_body.resize(count, 0);
        position.resize(count, Vec3::Zero());
        const auto row = static_cast<Index>(mass.size());
        for (std::size_t k = 0; k < node_positions.size(); ++k) {
            node_body[static_cast<std::size_t>(first) + k] = static_cast<Index>(body_nodes.size());
            position[static_cast<std::size_t>(first) + k] = node_positions[k];
        }
        body_nodes.push_back({first, first + static_cast<Index>(node_positions.size())});
        body_rigid.push_back({row, row + 1});
        center.push_back(at);
        mass.push_back(body_mass);
        inverse_inertia.push_back(inertia.inverse());
        for (std::vector<Vec3>* column : {&momentum, &angular_momentum, &kick, &moment_kick})
            column->push_back(Vec3::Zero());
    }
};

struct ContactScene {
    std::vector<Real> inverse_mass;
    std::vector<Vec3> velocity_before, velocity;  // at the start of the step; predicted
    std::vector<Stencil> stencil;
    std::vector<Vec3> normal, surface_velocity, impulse;
    std::vector<Real> gap, static_friction, dynamic_friction, restitution;
    Real gravity = 9.81, h = 1e-3;
    NodeClusters clusters;
    RigidScene rigid;

    Index add_node(Real mass, const Vec3& v) {
        inverse_mass.push_back(mass > 0 ? 1 / mass : 0);
        velocity_before.push_back(v);
        velocity.push_back(v);
        return static_cast<Index>(inverse_mass.size()) - 1;
    }
    std::size_t touch(const Stencil& contact, const Vec3& along, Real mu) {
        stencil.push_back(contact);
        normal.push_back(along.normalized());
        surface_velocity.push_back(Vec3::Zero());
        impulse.push_back(Vec3::Zero());
        gap.push_back(0);
        static_friction.push_back(mu);
        dynamic_friction.push_back(mu);
        restitution.push_back(0);
        return stencil.size() - 1;
    }
    std::size_t touch_floor(Index node, Real mu) {
        return touch({{node, node, node, node}, {1, 0, 0, 0}}, Vec3::UnitZ(), mu);
    }
    std::size_t touch_node(Index first, Index second, const Vec3& along, Real mu) {
        return touch({{first, second, first, first}, {1, -1, 0, 0}}, along, mu);
    }

    SolvedScene solve(const SolverSettings& settings = {}, ContactRegions mode = ContactRegions::separate,
                      Backend backend = Backend::serial, int workers = 1) const {
        SolvedScene result;
        const auto executor = make_executor(backend, workers);
        SeparationMemory memory;
        std::vector<Index> region(stencil.size());
        separate_regions(*executor, stencil, inverse_mass, NodeGroups{&clusters, rigid.nodes()}, mode, memory,
                         result.regions, region);
        result.impulse = impulse;
        result.velocity = velocity;
        result.push_out.assign(velocity.size(), Vec3::Zero());
        SolverMemory solver;
        const std::vector<Vec3> none(rigid.mass.size(), Vec3::Zero());
        result.contact_impulse = result.contact_moment = result.push_velocity = result.push_spin = none;
        solve_regions(*executor, inputs(), settings, h, solver, result.regions,
                      {result.impulse, result.velocity, result.push_out, result.contact_impulse, result.contact_moment,
                       result.push_velocity, result.push_spin});
        return result;
    }
    RegionInputs inputs() const {
        RegionInputs all{stencil,          normal,      gap,          surface_velocity, static_friction,
                         dynamic_friction, restitution, inverse_mass, velocity_before,  gravity};
        all.clusters = &clusters;
        all.rigid = rigid.inputs();
        return all;
    }
    Vec3 relative_velocity(std::size_t contact, const std::vector<Vec3>& v) const {
        Vec3 u = -surface_velocity[contact];
        for (std::size_t a = 0; a < 4; ++a)
            u += stencil[contact].weight[a] * v[static_cast<std::size_t>(stencil[contact].node[a])];
        return u;
    }
    Real kinetic_energy(const std::vector<Vec3>& v) const {
        Real energy = 0;
        for (std::size_t n = 0; n < v.size(); ++n)
            if (inverse_mass[n] > 0) energy += 0.5 * v[n].squaredNorm() / inverse_mass[n];
        return energy;
    }
};

/// Adds two sheets of size x size points. Each inner point touches a triangle of the other sheet: 2 (size - 2)^2
/// contacts in one region, an oblique impact with uneven masses (docs/methods/measuring.md 3.1).
inline void add_sheets(ContactScene& scene, int size, Real mu, unsigned seed) {
    std::mt19937 random(seed);
    std::normal_distribution<Real> noise;
    std::uniform_real_distribution<Real> unit(0, 1);
    const Index first = static_cast<Index>(scene.inverse_mass.size());
    const auto node = [&](int layer, int i, int j) {
        return first + static_cast<Index>((layer * size + i) * size + j);
    };
    const auto noisy = [&](Real scale) {
        return Vec3(scale * noise(random), scale * noise(random), scale * noise(random));
    };
    for (int layer = 0; layer < 2; ++layer)
        for (int k = 0; k < size * size; ++k)
            scene.add_node(std::exp(0.5 * noise(random)), Vec3(layer * Vec3(0.4, 0.1, -1) + noisy(0.15)));
    for (int layer = 0; layer < 2; ++layer)
        for (int i = 1; i + 1 < size; ++i)
            for (int j = 1; j + 1 < size; ++j) {
                Real a = unit(random), b = unit(random);
                if (a + b > 1) {
                    a = 1 - a;
                    b = 1 - b;
                }
                const int other = 1 - layer;
                scene.touch({{node(layer, i, j), node(other, i, j), node(other, i + 1, j), node(other, i, j + 1)},
                             {1, a + b - 1, -a, -b}},
                            Vec3(0, 0, layer == 0 ? -1 : 1) + noisy(0.05), mu);
            }
}

}  // namespace skerry
