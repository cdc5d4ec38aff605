// Stress, strain and stable steps of bodies, for each tetrahedron or node.
#include <algorithm>
#include <numeric>

#include "engine/world/edit/edit_model.h"
#include "engine/world/edit/rigid_bodies.h"
#include "engine/world/elements_of_body.h"
#include "engine/world/kernels.h"
#include "engine/world/validate.h"
#include "engine/world/world_state.h"
#include "systems/dynamics/elements/build_elements.h"
#include "systems/dynamics/elements/element_energy.h"
#include "systems/dynamics/elements/recover_fields.h"
#include "systems/dynamics/recovery/recover_nodes.h"
#include "systems/dynamics/stability/stiffness_share.h"

namespace skerry {

namespace {

using OfElements = void (*)(const ElementInputs&, Range, std::span<const Vec3>, std::span<Mat3>);
using OfTetrahedra = std::vector<Mat3> (*)(const ElementCover&, std::span<const Mat3>, std::size_t);

std::vector<Mat3> tetrahedron_field(const Model& model, std::size_t row, OfElements of_elements,
                                    OfTetrahedra of_tetrahedra) {
    const ElementsOfBody body(model, row);
    std::vector<Mat3> values(static_cast<std::size_t>(body.blocks.size()) * element_lanes);
    of_elements(body.elements, body.blocks, body.position, values);
    body.turn(values);
    return of_tetrahedra(body.cover, values, static_cast<std::size_t>(model.bodies.tetrahedron_count[row]));
}

}  // namespace

ElementsOfBody::ElementsOfBody(const Model& model, std::size_t row)
    : model_(model), row_(row), is_implicit_(model.dynamics_of(row) == BodyDynamics::implicit_elastic) {
    const BodyRecord& record = model.body_records[row];
    if (!is_implicit_) {
        elements = model.all_elements();
        blocks = model.bodies.blocks[row];
        cover = {rows_of(model.elements.part, blocks), record.element_tetrahedra.view()};
        position = model.nodes.position.span();
        first_node = model.bodies.nodes[row].begin;
        built = record.built;
        return;
    }
    const std::span<const Vec3> rest = rows_of(model.nodes.rest_position, model.bodies.nodes[row]),
                                displacement = rows_of(model.implicit_nodes.displacement, model.bodies.implicit[row]);
    own_ = record.fields.elements([&] {
        const ElementList list = model.elements_of_implicit(row);
        OwnElements own;
        const AppendedElements appended = append_elements(list, rest, 0, 0, own.table, own.nodes);
        own.blocks = appended.blocks;
        own.covered = covered_tetrahedra(list, appended.element);
        return own;
    });
    shape_.assign(rest.begin(), rest.end());
    for (std::size_t n = 0; n < shape_.size(); ++n) shape_[n] += displacement[n];
    elements = ElementInputs::bind({}, own_->table, own_->nodes, model.materials);
    blocks = own_->blocks;
    cover = {own_->table.part, own_->covered.view()};
    position = shape_;
}

void ElementsOfBody::turn(std::span<Mat3> values) const {
    if (!is_implicit_) return;
    const Mat3 turn = pose_of_body(model_, row_).rotation;
    for (Mat3& value : values) value = turn * value * turn.transpose();
}

NodeFields ElementsOfBody::node_fields(std::span<const Index> nodes) const {
    if (blocks.size() == 0)
        return {std::vector<Mat3>(nodes.size(), Mat3::Zero()), std::vector<Mat3>(nodes.size(), Mat3::Zero()),
                std::vector<bool>(nodes.size())};
    const BodyRecord& record = model_.body_records[row_];
    const auto plan = record.fields.plan(nodes, [&] {
        return plan_recovery({.elements = elements,
                              .blocks = blocks,
                              .cover = cover,
                              .tetrahedra = record.tetrahedra,
                              .surface = record.surface,
                              .material_of_tetrahedra = record.tetrahedron_material,
                              .rest_position = rows_of(model_.nodes.rest_position, model_.bodies.nodes[row_]),
                              .first_node = first_node},
                             nodes);
    });
    return recover_nodes(*plan,
                         {.elements = elements, .blocks = blocks, .position = position, .first_node = first_node},
                         kernels().element_fields);
}

std::vector<Index> all_nodes(const Model& model, std::size_t row) {
    std::vector<Index> nodes(static_cast<std::size_t>(model.bodies.nodes[row].size()));
    std::iota(nodes.begin(), nodes.end(), Index{0});
    return nodes;
}

NodeFields fields_of_nodes(const Model& model, std::size_t row, std::span<const Index> nodes) {
    const ElementsOfBody body(model, row);
    NodeFields fields = body.node_fields(nodes);
    body.turn(fields.stress);
    body.turn(fields.strain);
    return fields;
}

std::vector<Mat3> World::stress(BodyHandle body) const {
    return tetrahedron_field(state_->model, static_cast<std::size_t>(state_->model.row(body, "stress")),
                             kernels().cauchy_stress, kernels().stress_of_tetrahedra);
}

std::vector<Mat3> World::strain(BodyHandle body) const {
    return tetrahedron_field(state_->model, static_cast<std::size_t>(state_->model.row(body, "strain")),
                             kernels().element_strains, kernels().strain_of_tetrahedra);
}

std::vector<Real> World::plastic_strain(BodyHandle body) const {
    const Model& model = state_->model;
    const auto row = static_cast<std::size_t>(model.row(body, "plastic_strain"));
    const Range blocks = model.bodies.blocks[row];
    const ElementCover cover{rows_of(model.elements.part, blocks), model.body_records[row].element_tetrahedra.view()};
    return kernels().mean_of_tetrahedra(cover, rows_of(model.elements.plastic_strain, blocks),
                                        static_cast<std::size_t>(model.bodies.tetrahedron_count[row]));
}

std::vector<Mat3> World::node_stress(BodyHandle body) const {
    const Model& model = state_->model;
    const auto row = static_cast<std::size_t>(model.row(body, "node_stress"));
    return fields_of_nodes(model, row, all_nodes(model, row)).stress;
}

std::vector<Mat3> World::node_stress(BodyHandle body, std::span<const Index> nodes) const {
    const Model& model = state_->model;
    const auto row = static_cast<std::size_t>(model.row(body, "node_stress"));
    require_nodes("node_stress", nodes, model.bodies.nodes[row].size());
    return fields_of_nodes(model, row, nodes).stress;
}

std::vector<Mat3> World::node_strain(BodyHandle body) const {
    const Model& model = state_->model;
    const auto row = static_cast<std::size_t>(model.row(body, "node_strain"));
    return fields_of_nodes(model, row, all_nodes(model, row)).strain;
}

std::vector<Real> World::node_von_mises_stress(BodyHandle body) const {
    std::vector<Real> of_nodes;
    for (const Mat3& cauchy : node_stress(body)) of_nodes.push_back(von_mises(cauchy));
    return of_nodes;
}

std::vector<Vec3> World::node_principal_stresses(BodyHandle body) const {
    std::vector<Vec3> of_nodes;
    for (const Mat3& cauchy : node_stress(body)) of_nodes.push_back(principal_stresses(cauchy));
    return of_nodes;
}

std::vector<Real> World::tetrahedron_steps(BodyHandle body) const {
    const Model& model = state_->model;
    const auto row = static_cast<std::size_t>(model.row(body, "tetrahedron_steps"));
    const Range blocks = model.bodies.blocks[row];
    std::vector<Real> stiffness_sum(model.nodes.position.size());
    std::vector<ElementLane> step(static_cast<std::size_t>(blocks.size()));
    kernels().element_bounds.steps(model.all_elements(), blocks, model.nodes.position, model.nodes.mass, stiffness_sum,
                                   step);
    if (blocks.size() > 0 && has_mass_form(model.all_elements(), static_cast<std::size_t>(blocks.begin))) {
        // The element steps are multiplied by one factor, so that the shortest becomes the stable step of the body.
        // That step is longer, because it is computed with mass forms (mass_forms.h), and the element steps with scalar
        // shares of the node masses.
        Real shortest = infinity;
        for (const ElementLane& lanes : step) shortest = std::min(shortest, *std::ranges::min_element(lanes.lane));
        const Real longer =
            kernels()
                .stable_step(model.all_elements(), blocks, model.nodes.position, model.nodes.mass, stiffness_sum)
                .step /
            shortest;
        for (ElementLane& lanes : step)
            for (Real& own : lanes.lane) own *= longer;
    }
    const RaggedView<Index> covered = model.body_records[row].element_tetrahedra.view();
    std::vector<Real> of_tetrahedra(static_cast<std::size_t>(model.bodies.tetrahedron_count[row]), infinity);
    for (std::size_t place = 0; place < covered.size(); ++place)
        for (const Index t : covered[place]) {
            Real& shortest = of_tetrahedra[static_cast<std::size_t>(t)];
            shortest = std::min(shortest, step[place / element_lanes][place % element_lanes]);
        }
    return of_tetrahedra;
}

std::vector<Real> World::von_mises_stress(BodyHandle body) const {
    std::vector<Real> of_tetrahedra;
    for (const Mat3& cauchy : stress(body)) of_tetrahedra.push_back(von_mises(cauchy));
    return of_tetrahedra;
}

}  // namespace skerry
