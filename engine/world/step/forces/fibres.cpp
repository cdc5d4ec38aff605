// Force element of fibres, and its contribution to the stable step (docs/methods/elasticity.md 2.7).
#include "systems/forces/fibres.h"

#include <algorithm>
#include <vector>

#include "engine/world/step/seams.h"

namespace skerry {

namespace {

bool any_fibre(const Model& model) {
    return model.fibres.size() > 0;
}

auto if_any_fibre(const Model& m) {
    return only_if([](std::span<const std::uint32_t> slot) { return !slot.empty(); }, read(m.fibres.slot));
}

FibreInputs fibres_of(const Model& model) {
    return FibreInputs::bind({}, model.fibres, model.bodies, model.nodes);
}

void list_fibre_forces(WorldState& w, TaskGraph& g) {
    Model& m = w.model;
    g.stage("forces/add_fibre_forces", add_fibre_forces, inputs<FibreInputs>(m.fibres, m.bodies, m.nodes),
            value(w.scratch.parameters.intervals), write(m.fibres.next), write(m.nodes.applied_force), if_any_fibre(m));
}

/// Computes FibreTable::mobility, by which fibres limit the stable step (docs/methods/elasticity.md 2.7). It is the sum
/// of s_n^2 V_n/m_n over the nodes n of a tetrahedron, with these symbols:
/// - s_n: derivative of the node's shape function along the fibres
/// - V_n: volume of all tetrahedra of the family (set of fibres) at the node
/// - m_n: mass of the node, which these tetrahedra divide in proportion to their volumes
/// With the modulus k along the fibres, the squared circular frequency of the tetrahedron is at most k times its
/// mobility. The whole family has at most the largest of these values.
void weigh_fibres(Model& model) {
    FibreTable& table = model.fibres;
    const FibreInputs fibres = fibres_of(model);
    table.mobility.resize(table.node.size());
    table.next.resize(table.node.size());
    std::vector<Real> volume(model.nodes.position.size());
    for (std::size_t row = 0; row < table.size(); ++row) {
        const auto begin = static_cast<std::size_t>(table.tetrahedra[row].begin),
                   end = static_cast<std::size_t>(table.tetrahedra[row].end);
        std::ranges::fill(volume, Real{0});
        for (std::size_t t = begin; t < end; ++t)
            for (std::size_t c = 0; c < 4; ++c) volume[fibres.node_of(row, t, c)] += table.volume[t];
        for (std::size_t t = begin; t < end; ++t) {
            table.mobility[t] = 0;
            for (std::size_t c = 0; c < 4; ++c) {
                const std::size_t n = fibres.node_of(row, t, c);
                table.mobility[t] += table.slope[t][c] * table.slope[t][c] * volume[n] * model.nodes.inverse_mass[n];
            }
        }
    }
}

void add_fibre_rate(Model& model, std::span<Real> of_body) {
    const FibreTable& table = model.fibres;
    const FibreInputs fibres = fibres_of(model);
    for (std::size_t row = 0; row < table.size(); ++row) {
        const auto body = static_cast<std::size_t>(table.body[row]);
        if (model.is_rigid(body)) continue;
        Real tension = 0, most = 0;
        for (const TimeKey& key : table.keys_of(row)) tension = std::max(tension, key.value);
        for (auto t = static_cast<std::size_t>(table.tetrahedra[row].begin);
             t < static_cast<std::size_t>(table.tetrahedra[row].end); ++t)
            most =
                std::max(most, table.mobility[t] * fibres.law(row).stiffness_bound(fibres.stretched(row, t), tension));
        of_body[body] += most;
    }
}

void list_activated_fibres(WorldState& w, TaskGraph& g) {
    Model& m = w.model;
    g.stage("forces/mark_activated", mark_activated, inputs<FibreInputs>(m.fibres, m.bodies, m.nodes),
            value(w.clock.time), value(w.scratch.parameters.h), write(w.scratch.driven), if_sleepy(w));
}

bool a_fibre_is_activated(const Model& model, Real t, Real h) {
    return mark_activated(fibres_of(model), t, h, {});
}

void list_fibre_measures(WorldState& w, TaskGraph& g) {
    Model& m = w.model;
    const StepParameters& p = w.scratch.parameters;
    g.stage_with_result("forces/measure_fibres", w.scratch.findings.fibre_work, measure_fibres,
                        inputs<FibreInputs>(m.fibres, m.bodies, m.nodes),
                        inputs<FibreWorkInputs>(m.fibres, m.nodes, m.bodies, m.rigid_bodies), value(p.h),
                        value(p.work_lag), if_any_fibre(m));
}

void list_fibre_memory(WorldState& w, TaskGraph& g) {
    FibreTable& fibres = w.model.fibres;
    g.stage("forces/keep_fibre_stress", keep_fibre_stress, read(fibres.next), write(fibres.passive), if_taken(w));
}

Real energy_of_fibres(const Model& model, Real, Real lag) {
    return fibre_energy(fibres_of(model),
                        FibreWorkInputs::bind({}, model.fibres, model.nodes, model.bodies, model.rigid_bodies), lag);
}

}  // namespace

constinit const ForceElement fibre_forces{.any = any_fibre,
                                          .add_forces = list_fibre_forces,
                                          .derive = weigh_fibres,
                                          .add_rate = add_fibre_rate,
                                          .rate_moves = true,
                                          .mark_driven = list_activated_fibres,
                                          .is_driven = a_fibre_is_activated,
                                          .measure = list_fibre_measures,
                                          .remember = list_fibre_memory,
                                          .energy = energy_of_fibres};

}  // namespace skerry
