// Properties of a body that follow from its materials: masses, relaxation of elements and the stable step.
#include <algorithm>
#include <cmath>
#include <numbers>
#include <numeric>
#include <utility>

#include "engine/world/edit/edit_model.h"
#include "engine/world/edit/rigid_bodies.h"
#include "engine/world/kernels.h"
#include "systems/dynamics/clusters/arm_guards.h"
#include "systems/dynamics/elements/build_elements.h"
#include "systems/dynamics/rigid/rigid_motion.h"
#include "systems/dynamics/stability/find_relaxation.h"
#include "systems/dynamics/stability/frame_masses.h"
#include "systems/dynamics/stability/mass_forms.h"
#include "systems/dynamics/stability/stable_step.h"
#include "systems/dynamics/stability/stiffness_share.h"

namespace skerry {

namespace {

/// Speed of longitudinal waves in a thin bar of the materials of a body: sqrt(E / rho) [m/s]. rho is the mean density.
/// Young's modulus E is the geometric mean of the Voigt bound (materials in parallel) and the Reuss bound (materials in
/// series).
Real bar_speed(const Model& model, const NewBody& body, std::span<const MaterialZone> zones) {
    Real volume = 0, mass = 0, stiffness = 0, compliance = 0;
    for (const MaterialZone& zone : zones) {
        const auto row = static_cast<std::size_t>(zone.material);
        const Real modulus = model.materials.young_modulus[row], density = model.materials.constants[row].density;
        if (zones.size() == 1) return std::sqrt(modulus / density);
        Real of_zone = 0;
        for (const Index t : zone.tetrahedra)
            of_zone += six_volumes(body.tetrahedra[static_cast<std::size_t>(t)], body.nodes) / 6;
        volume += of_zone;
        mass += of_zone * density;
        stiffness += of_zone * modulus;
        compliance += of_zone / modulus;
    }
    return std::sqrt(std::sqrt(stiffness / compliance) * volume / mass);
}

/// Sets the rates at which the Maxwell elements of a body relax. `step`: stable step of the body without Maxwell
/// elements [s]. `speed`: result of bar_speed [m/s].
void set_relaxation(Model& model, Range nodes, Range blocks, std::span<const Real> stiffness_sum, Real speed,
                    Real step) {
    ElementBlockTable& elements = model.elements;
    const std::span<const Vec3> position = model.nodes.rest_position;
    const Real lowest = lowest_frequency_estimate(
        position.subspan(static_cast<std::size_t>(nodes.begin), static_cast<std::size_t>(nodes.size())),
        rows_of(model.nodes.mass, nodes), speed);
    kernels().find_relaxation(model.all_elements(), blocks, position, model.nodes.mass, stiffness_sum, lowest,
                              step_times_frequency / step,
                              {rows_of(elements.relaxation_rate, blocks), rows_of(elements.own_frequency, blocks),
                               rows_of(elements.relaxing_share, blocks)});
}

}  // namespace

std::vector<MaterialZone> zones_of(const Model& model, const NewBody& body) {
    std::vector<MaterialZone> zones;
    for (std::size_t t = 0; t < body.tetrahedra.size(); ++t) {
        const Index material = body.material_of(t);
        auto zone = std::find_if(zones.begin(), zones.end(), [&](const auto& z) { return z.material == material; });
        if (zone == zones.end()) {
            // Plastic flow keeps the volume, so the element kind for a material that yields is chosen as for an
            // incompressible material.
            const auto row = static_cast<std::size_t>(material);
            const Real poisson_ratio =
                model.materials.constants[row].yields() ? 0.5 : model.materials.poisson_ratio[row];
            zone = zones.insert(zones.end(), {material, resolved(body.element, poisson_ratio), {}});
        }
        zone->tetrahedra.push_back(static_cast<Index>(t));
    }
    return zones;
}

std::vector<Real> densities(const Model& model, const NewBody& body) {
    std::vector<Real> density(body.tetrahedra.size());
    for (std::size_t t = 0; t < density.size(); ++t)
        density[t] = model.materials.constants[static_cast<std::size_t>(body.material_of(t))].density;
    return density;
}

RoundMass round_mass(const Model& model, const NewBody& body) {
    const Real density = model.materials.constants[static_cast<std::size_t>(body.material)].density,
               radius = body.round_radius, length = body.axis_length();
    if (body.is_cylinder())
        return {0, 2 * std::numbers::pi * density * body.rim_radius() * body.rim_radius() * body.half_height()};
    return {4 * std::numbers::pi / 3 * density * radius * radius * radius,
            std::numbers::pi * density * radius * radius * length};
}

namespace {

/// Integrates the mass properties of a body from its shape and its densities.
MassProperties mass_of_shape(const Model& model, const NewBody& body) {
    if (body.is_cylinder()) {
        const Real mass = round_mass(model, body).sum(), radius = body.rim_radius(), half = body.half_height(),
                   across = mass * (radius * radius / 4 + half * half / 3);
        return {mass, body.nodes[0], {across, across, mass * radius * radius / 2}, Mat3::Identity()};
    }
    if (body.core_nodes > 0) {
        const auto [ball, shaft] = round_mass(model, body);
        const Real radius = body.round_radius, length = body.axis_length();
        const Real axial = ball * radius * radius * 2 / 5 + shaft * radius * radius / 2;
        const Real across = ball * radius * radius * 2 / 5 + ball * length * (length / 4 + radius * 3 / 8) +
                            shaft * (radius * radius / 4 + length * length / 12);
        const Vec3 center = (body.nodes[0] + body.nodes[static_cast<std::size_t>(body.core_nodes) - 1]) / 2;
        return {ball + shaft, center, {across, across, axial}, Mat3::Identity()};
    }
    // A closed surface is divided into tetrahedra, which its first node forms with the triangles. If the outer side of
    // a triangle faces this node, the volume is negative. So sums over the tetrahedra are integrals over the inside
    // (divergence theorem).
    std::vector<std::array<Index, 4>> fan;
    for (const auto& [a, b, c] : body.triangles) fan.push_back({0, a, b, c});
    const std::span<const std::array<Index, 4>> tetrahedra = fan.empty() ? body.tetrahedra : fan;
    std::vector<Real> density = densities(model, body);
    density.resize(tetrahedra.size(), model.materials.constants[static_cast<std::size_t>(body.material)].density);
    MassProperties found;
    std::vector<Real> mass(tetrahedra.size());
    const auto corner = [&](std::size_t t, std::size_t k) -> const Vec3& {
        return body.nodes[static_cast<std::size_t>(tetrahedra[t][k])];
    };
    for (std::size_t t = 0; t < mass.size(); ++t) {
        mass[t] = density[t] * six_volumes(tetrahedra[t], body.shape_of_masses()) / 6;
        found.mass += mass[t];
        found.center += mass[t] / 4 * (corner(t, 0) + corner(t, 1) + corner(t, 2) + corner(t, 3));
    }
    found.center /= found.mass;
    // Integral of density times x x^T over the body, with the position x relative to the centre of mass [kg m^2]. A
    // tetrahedron of mass m with corners x_k adds m/20 (sum of x_k x_k^T + (sum of x_k)(sum of x_k)^T).
    Mat3 second = Mat3::Zero();
    for (std::size_t t = 0; t < mass.size(); ++t) {
        Mat3 squares = Mat3::Zero();
        Vec3 sum = Vec3::Zero();
        for (std::size_t k = 0; k < 4; ++k) {
            const Vec3 x = corner(t, k) - found.center;
            squares += x * x.transpose();
            sum += x;
        }
        second += mass[t] / 20 * (squares + sum * sum.transpose());
    }
    const Mat3 inertia = second.trace() * Mat3::Identity() - second;
    const PrincipalInertia principal(inertia);
    found.moments = principal.moments;
    found.axes = principal.axes;
    return found;
}

}  // namespace

MassProperties mass_properties(const Model& model, const NewBody& body) {
    if (body.inertia) {
        const PrincipalInertia principal(*body.inertia);
        return {*body.mass, *body.center_of_mass, principal.moments, principal.axes};
    }
    MassProperties found = mass_of_shape(model, body);
    if (body.mass) {
        found.moments *= *body.mass / found.mass;
        found.mass = *body.mass;
    }
    return found;
}

void set_masses(Model& model, const NewBody& body, Range range) {
    NodeTable& nodes = model.nodes;
    // Nodes without a tetrahedron would get the inverse mass 0, as if they were held. In a rigid body without
    // tetrahedra, or with a given mass, all nodes therefore start with positive masses, which share_mass() replaces
    // later.
    if (body.tetrahedra.empty() || body.mass) std::ranges::fill(rows_of(nodes.mass, range), Real(1));
    add_lumped_mass(body.tetrahedra, body.shape_of_masses(), densities(model, body), rows_of(nodes.mass, range));
    // A round body is drawn with a mesh that lies inside the exact shape and has less volume. The masses of its nodes
    // are scaled to the mass of the exact shape.
    if (body.core_nodes > 0) {
        const std::span<Real> mass = rows_of(nodes.mass, range);
        const Real drawn = std::accumulate(mass.begin(), mass.end(), Real(0)), whole = round_mass(model, body).sum();
        for (Real& of_node : mass) of_node *= whole / drawn;
    }
    for (auto n = static_cast<std::size_t>(range.begin); n < static_cast<std::size_t>(range.end); ++n)
        nodes.inverse_mass[n] = nodes.mass[n] > 0 ? 1 / nodes.mass[n] : 0;
}

Real choose_mass_forms(Model& model, Index row, std::span<Real> stiffness_sum) {
    const std::span<const Vec3> position = model.nodes.rest_position;
    const Range blocks = model.bodies.blocks[static_cast<std::size_t>(row)];
    const auto step = [&] {
        return kernels().stable_step(model.all_elements(), blocks, position, model.nodes.mass, stiffness_sum).step;
    };
    const std::span<ElementForm> form = rows_of(model.elements.mass_form, blocks);
    forget_mass_forms(model, blocks);
    const Real by_shares = step();
    kernels().find_mass_forms(model.all_elements(), blocks, position, model.nodes.mass, products_of_group, form);
    // Mass forms divide the node masses among the elements, to lengthen the stable step (docs/methods/stable_step.md
    // 2.3). In a large body, their sum is bounded for groups of elements instead of the whole body, so they may gain
    // nothing. Forms without gain are dropped.
    const Real by_forms = step();
    if (!(by_forms > by_shares)) std::ranges::fill(form, ElementForm{});
    // Frame masses (docs/methods/stable_step.md 2.4) are chosen for linear elements only. The mass forms of smoothed
    // elements already allow steps near the stability limit. Longer steps would make the energies of the highest
    // frequencies less accurate.
    const Real by_either = by_forms > by_shares ? by_forms : by_shares;
    // A body that yields gets no frame masses either, because frame masses are not updated after plastic flow.
    const auto b = static_cast<std::size_t>(row);
    if (model.body_records[b].element != ElementKind::linear || model.yields(b)) return by_either;
    // Frame masses are kept if they lengthen the stable step at least by this factor. With frame masses, strained
    // bodies need a second evaluation of the stable step, whose time a smaller gain would not save.
    constexpr Real least_gain = 1.1;
    const std::span<Real> bound = rows_of(model.elements.frame_bound, blocks);
    const std::span<FrameMass> in_frame = rows_of(model.elements.frame_mass, blocks);
    kernels().find_frame_masses(model.all_elements(), blocks, position, model.nodes.mass, products_of_frame, in_frame,
                                bound);
    if (bound.empty() || !(bound.front() > 0)) return by_either;
    if (const Real by_frame = step(); by_frame > least_gain * by_either) return by_frame;
    std::ranges::fill(in_frame, FrameMass{});
    std::ranges::fill(bound, Real(0));
    return by_either;
}

void forget_mass_forms(Model& model, Range blocks) {
    std::ranges::fill(rows_of(model.elements.mass_form, blocks), ElementForm{});
    std::ranges::fill(rows_of(model.elements.frame_mass, blocks), FrameMass{});
    std::ranges::fill(rows_of(model.elements.frame_bound, blocks), Real(0));
}

void find_steps(Model& model, Index row, const NewBody& body, std::span<const MaterialZone> zones,
                Column<Real>& stiffness_sum) {
    const auto b = static_cast<std::size_t>(row);
    BodyTable& bodies = model.bodies;
    const Range blocks = bodies.blocks[b];
    const std::span<const Vec3> position = model.nodes.rest_position;
    const auto step = [&] {
        return kernels().stable_step(model.all_elements(), blocks, position, model.nodes.mass, stiffness_sum).step;
    };
    if (zones.empty()) {
        bodies.rest_step[b] = bodies.stable_step[b] = step();
        return;
    }
    const auto relaxes = [&](const MaterialZone& zone) {
        return model.materials.constants[static_cast<std::size_t>(zone.material)].relaxes();
    };
    if (std::any_of(zones.begin(), zones.end(), relaxes)) {
        const Real before = step();
        set_relaxation(model, bodies.nodes[b], blocks, stiffness_sum, bar_speed(model, body, zones), before);
    }
    kernels().find_mass_shares(model.all_elements(), blocks, position, model.nodes.mass, stiffness_sum,
                               rows_of(model.elements.mass_share, blocks));
    bodies.rest_step[b] = bodies.stable_step[b] = choose_mass_forms(model, row, stiffness_sum);
}

const KnownElements* known_elements(const Model& model, const NewBody& body) {
    const auto fits = [&](const KnownElements& known) {
        const auto b = static_cast<std::size_t>(known.body);
        if (known.element != body.element || !model.has_mesh(b, {body.tetrahedra, body.nodes})) return false;
        const std::span<const Index> material = model.body_records[b].tetrahedron_material;
        for (std::size_t t = 0; t < body.tetrahedra.size(); ++t)
            if (body.material_of(t) != (material.empty() ? model.bodies.material[b] : material[t])) return false;
        return true;
    };
    if (body.kind != BodyKind::deformable || body.has_frame()) return nullptr;
    const auto found = std::ranges::find_if(model.known_elements, fits);
    return found == model.known_elements.end() ? nullptr : &*found;
}

void take_steps(const KnownElements& known, Index row, Model& model) {
    const Range blocks = model.bodies.blocks[static_cast<std::size_t>(row)];
    KnownElements::for_each_column(known, model.elements, [&](const auto& of_mesh, auto& column) {
        std::ranges::copy(of_mesh, rows_of(column, blocks).begin());
    });
    model.bodies.rest_step[static_cast<std::size_t>(row)] = known.rest_step;
}

void remember_elements(Model& model, Index row, KnownElements known) {
    // Largest number of entries in Model::known_elements. It limits the time of known_elements(), which compares each
    // new mesh with the mesh of every entry.
    constexpr std::size_t most_known = 64;
    if (model.known_elements.size() == most_known) model.known_elements.erase(model.known_elements.begin());
    known.body = row;
    model.known_elements.push_back(std::move(known));
}

void remember_elements(Model& model, Index row, const NewBody& body, ElementPlaces places) {
    const auto b = static_cast<std::size_t>(row);
    const Range blocks = model.bodies.blocks[b];
    if (body.kind != BodyKind::deformable || body.has_frame()) return;
    KnownElements known;
    known.element = body.element;
    known.places = std::move(places);
    KnownElements::for_each_column(known, model.elements, [&](auto& of_mesh, const auto& column) {
        of_mesh.resize(static_cast<std::size_t>(blocks.size()));
        std::ranges::copy(rows_of(column, blocks), of_mesh.begin());
    });
    known.rest_step = model.bodies.rest_step[b];
    remember_elements(model, row, std::move(known));
}

void restart_elements(Model& model, Index row, const NewBody& body, Column<Real>& stiffness_sum) {
    const auto b = static_cast<std::size_t>(row);
    const Range nodes = model.bodies.nodes[b], blocks = model.bodies.blocks[b];
    std::vector<char> held(static_cast<std::size_t>(nodes.size()));
    for (std::size_t n = 0; n < held.size(); ++n)
        held[n] = !(model.nodes.inverse_mass[static_cast<std::size_t>(nodes.begin) + n] > 0);
    std::ranges::fill(rows_of(model.nodes.mass, nodes), Real(0));
    set_masses(model, body, nodes);
    for (std::size_t n = 0; n < held.size(); ++n)
        if (held[n]) model.nodes.inverse_mass[static_cast<std::size_t>(nodes.begin) + n] = 0;

    ElementBlockTable& elements = model.elements;
    start_mass_shares(model.all_elements(), blocks, rows_of(elements.mass_share, blocks));
    forget_mass_forms(model, blocks);
    std::ranges::fill(rows_of(elements.implicit_modulus, blocks), ElementLane{});
    disarm_guards(rows_of(elements.part, blocks), rows_of(elements.volume, blocks));
    if (model.bodies.cluster_step[b] > 0) std::ranges::fill(rows_of(elements.viscous_time, blocks), Real(0));
    std::ranges::fill(rows_of(elements.relaxation_rate, blocks), RelaxationRates{});
    std::ranges::fill(rows_of(elements.own_frequency, blocks), ElementLane{});
    std::ranges::fill(rows_of(elements.relaxing_share, blocks), Real(0));
    stiffness_sum.resize(model.nodes.position.size());
    find_steps(model, row, body, model.has_frame(b) ? std::vector<MaterialZone>() : zones_of(model, body),
               stiffness_sum);
    if (model.has_frame(b)) weigh_rigid_body(model, b, body);
    if (model.dynamics_of(b) == BodyDynamics::implicit_elastic) {
        model.stiffen(b);
        if (model.is_held(b))
            follow_attachments(model, b);
        else
            follow_weight(model, b);
    }
    model.bodies.stable_step[b] =
        kernels().stable_step(model.all_elements(), blocks, model.nodes.position, model.nodes.mass, stiffness_sum).step;
    model.watch.forget(b);
}

}  // namespace skerry
