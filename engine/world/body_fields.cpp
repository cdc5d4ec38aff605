// Stress, strain and steps of bodies, by tetrahedron or node.
#include <algorithm>
#include <limits>

#include "engine/world/edit/edit_model.h"
#include "engine/world/edit/rigid_bodies.h"
#include "engine/world/kernels.h"
#include "engine/world/world_state.h"
#include "systems/dynamics/elements/build_elements.h"
#include "systems/dynamics/elements/element_energy.h"
#include "systems/dynamics/elements/recover_fields.h"
#include "systems/dynamics/stability/stiffness_share.h"

namespace skerry {

namespace {

using OfElements = void (*)(const ElementInputs&, Range, std::span<const Vec3>, std::span<Mat3>);
using OfTetrahedra = std::vector<Mat3> (*)(const ElementCover&, std::span<const Mat3>, std::size_t);

/// Of a body that moves implicitly, whose elements are in no table: of its shape in the frame of its mesh, turned with
/// that.
std::vector<Mat3> implicit_field(const Model& model, std::size_t row, OfElements of_elements,
                                 OfTetrahedra of_tetrahedra) {
    const ElementList list = model.elements_of_implicit(row);
    const std::span<const Vec3> rest = rows_of(model.nodes.rest_position, model.bodies.nodes[row]),
                                displacement = rows_of(model.implicit_nodes.displacement, model.bodies.implicit[row]);
    std::vector<Vec3> shape(rest.begin(), rest.end());
    for (std::size_t n = 0; n < shape.size(); ++n) shape[n] += displacement[n];
    ElementBlockTable elements;
    ElementNodeTable nodes;
    const AppendedElements appended = append_elements(list, rest, {}, BlockOrder::compact, 0, 0, elements, nodes);
    std::vector<Mat3> values(static_cast<std::size_t>(appended.blocks.size()) * element_lanes);
    of_elements(ElementInputs::bind({}, elements, nodes, model.materials, model.bodies), appended.blocks, shape,
                values);
    const Mat3 turn = pose_of_body(model, row).rotation;
    for (Mat3& value : values) value = turn * value * turn.transpose();
    Ragged<Index> covered = covered_tetrahedra(list, appended.element);
    return of_tetrahedra({elements.part, covered.view()}, values,
                         static_cast<std::size_t>(model.bodies.tetrahedron_count[row]));
}

std::vector<Mat3> tetrahedron_field(const Model& model, std::size_t row, OfElements of_elements,
                                    OfTetrahedra of_tetrahedra) {
    if (model.dynamics_of(row) == BodyDynamics::implicit_elastic)
        return implicit_field(model, row, of_elements, of_tetrahedra);
    const Range blocks = model.bodies.blocks[row];
    std::vector<Mat3> values(static_cast<std::size_t>(blocks.size()) * element_lanes);
    of_elements(model.all_elements(), blocks, model.nodes.position, values);
    const ElementCover cover{model.elements.part.span().subspan(static_cast<std::size_t>(blocks.begin),
                                                                static_cast<std::size_t>(blocks.size())),
                             model.body_records[row].element_tetrahedra.view()};
    return of_tetrahedra(cover, values, static_cast<std::size_t>(model.bodies.tetrahedron_count[row]));
}

std::vector<Mat3> node_field(const Model& model, std::size_t row, std::span<const Mat3> of_tetrahedra) {
    const auto first = static_cast<std::size_t>(model.bodies.tetrahedron_blocks[row].begin);
    std::vector<Real> volume(of_tetrahedra.size());
    for (std::size_t t = 0; t < volume.size(); ++t)
        volume[t] = model.tetrahedra.volume[first + t / element_lanes][t % element_lanes];
    return kernels().means_of_nodes(model.body_records[row].tetrahedra, volume, of_tetrahedra,
                                    static_cast<std::size_t>(model.bodies.nodes[row].size()));
}

}  // namespace

std::vector<Mat3> World::stress(BodyHandle body) const {
    return tetrahedron_field(state_->model, static_cast<std::size_t>(state_->model.row(body, "stress")),
                             kernels().cauchy_stress, kernels().stress_of_tetrahedra);
}

std::vector<Mat3> World::strain(BodyHandle body) const {
    return tetrahedron_field(state_->model, static_cast<std::size_t>(state_->model.row(body, "strain")),
                             kernels().element_strains, kernels().strain_of_tetrahedra);
}

std::vector<Mat3> World::node_stress(BodyHandle body) const {
    const auto row = static_cast<std::size_t>(state_->model.row(body, "node_stress"));
    return node_field(state_->model, row, stress(body));
}

std::vector<Mat3> World::node_strain(BodyHandle body) const {
    const auto row = static_cast<std::size_t>(state_->model.row(body, "node_strain"));
    return node_field(state_->model, row, strain(body));
}

std::vector<Real> World::tetrahedron_steps(BodyHandle body) const {
    const Model& model = state_->model;
    const auto row = static_cast<std::size_t>(model.row(body, "tetrahedron_steps"));
    const Range blocks = model.bodies.blocks[row];
    std::vector<Real> stiffness_sum(model.nodes.position.size());
    std::vector<ElementLane> step(static_cast<std::size_t>(blocks.size()));
    kernels().element_steps(model.all_elements(), blocks, model.nodes.position, model.nodes.mass, stiffness_sum, step);
    if (blocks.size() > 0 && has_mass_form(model.all_elements(), static_cast<std::size_t>(blocks.begin))) {
        // Shares tell which elements are stiff, for themselves; how long the step is they tell too low.
        Real shortest = std::numeric_limits<Real>::infinity();
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
    std::vector<Real> of_tetrahedra(static_cast<std::size_t>(model.bodies.tetrahedron_count[row]),
                                    std::numeric_limits<Real>::infinity());
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
