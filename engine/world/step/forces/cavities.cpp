// Force element for prescribed pressure on faces and for the pressure of fillings of cavities, and its contribution to
// the stable step (docs/methods/cavities.md 3).
#include "systems/forces/cavities.h"

#include <Eigen/Dense>
#include <algorithm>

#include "engine/world/step/seams.h"

namespace skerry {

namespace {

bool any_cavity(const Model& model) {
    return model.cavities.size() > 0;
}

auto if_any_cavity(const Model& m) {
    return only_if([](std::span<const CavityLaw> law) { return !law.empty(); }, read(m.cavities.law));
}

void list_cavity_forces(WorldState& w, TaskGraph& g) {
    CavityTable& c = w.model.cavities;
    const StepParameters& p = w.scratch.parameters;
    g.stage("forces/add_cavity_forces", add_cavity_forces, inputs<CavityInputs>(c, w.model.bodies, w.model.nodes),
            value(w.clock.time), value(p.lag), value(p.kick_time), outputs<CavityOutputs>(c, w.model.nodes),
            if_any_cavity(w.model));
}

/// Upper bound by which one cavity raises the squared circular frequencies of a body that deforms [1/s^2]
/// (docs/methods/cavities.md 3). For explicit bodies it includes the bound for pressure forces that rotate with the
/// faces. `p`: largest pressure [Pa]. `stiffness`: decrease of pressure per increase of volume [Pa/m^3].
Real rate_of_nodes(Model& model, const CavityInputs& cavities, std::size_t c, Real p, Real stiffness,
                   bool is_implicit) {
    const Range nodes = model.bodies.nodes[static_cast<std::size_t>(cavities.body[c])];
    Column<Vec3>& area = model.face_areas;
    Column<Real>& edges = model.face_edges;
    area.assign(static_cast<std::size_t>(nodes.size()), Vec3::Zero());
    edges.assign(static_cast<std::size_t>(nodes.size()), 0);
    for (auto f = static_cast<std::size_t>(cavities.faces[c].begin);
         f < static_cast<std::size_t>(cavities.faces[c].end); ++f) {
        const Mat3 x = cavities.corners_now(c, f);
        const Vec3 third = area_of(x) / 3;
        const Real longest = longest_edge(x);
        for (const Index n : cavities.face[f]) {
            area[static_cast<std::size_t>(n)] += third;
            edges[static_cast<std::size_t>(n)] += longest;
        }
    }
    Real of_filling = 0, of_turning = 0;
    for (Index n = 0; n < nodes.size(); ++n) {
        const Real inverse_mass = model.nodes.inverse_mass[nodes.begin + n];
        of_filling += inverse_mass * area[static_cast<std::size_t>(n)].squaredNorm();
        of_turning = std::max(of_turning, inverse_mass * edges[static_cast<std::size_t>(n)] / 2);
    }
    return stiffness * of_filling + (is_implicit ? 0 : p * of_turning);
}

/// Upper bound by which the filling of one cavity raises the squared circular frequencies of a rigid body [1/s^2]
/// (docs/methods/cavities.md 3). `stiffness`: decrease of pressure per increase of volume [Pa/m^3].
Real rate_of_rigid(const Model& model, const CavityInputs& cavities, std::size_t c, Real stiffness) {
    const auto body = static_cast<std::size_t>(cavities.body[c]);
    if (model.is_held(body)) return 0;
    const auto r = static_cast<std::size_t>(model.bodies.rigid[body].begin);
    const RigidBodyTable& rigid = model.rigid_bodies;
    // sum of the area vectors of the faces, and of their moments about the centre of mass
    Vec3 area = Vec3::Zero(), moment = Vec3::Zero();
    for (auto f = static_cast<std::size_t>(cavities.faces[c].begin);
         f < static_cast<std::size_t>(cavities.faces[c].end); ++f) {
        const Mat3 x = cavities.corners_now(c, f);
        area += area_of(x);
        moment += (x.rowwise().mean() - rigid.center[r]).cross(area_of(x));
    }
    const Vec3 about_axes = rigid.rotation[r].transpose() * moment;
    return stiffness *
           (area.squaredNorm() / rigid.mass[r] + about_axes.cwiseAbs2().cwiseQuotient(rigid.moments[r]).sum());
}

void add_cavity_rate(Model& model, std::span<Real> of_body) {
    const CavityTable& table = model.cavities;
    const CavityInputs cavities = CavityInputs::bind({}, table, model.bodies, model.nodes);
    for (std::size_t c = 0; c < cavities.size(); ++c) {
        const auto body = static_cast<std::size_t>(cavities.body[c]);
        const CavityLaw law = cavities.law[c];
        Real p = std::abs(table.pressure_now[c]);
        if (law == CavityLaw::pressure)
            for (const TimeKey& key : cavities.keys_of(c)) p = std::max(p, std::abs(key.value));
        const Real factor = law == CavityLaw::pressure ? 0 : law == CavityLaw::liquid ? kink_factor : 1;
        const Real stiffness =
            factor > 0 ? factor * filling_stiffness(law, cavities.fluid[c], p, cavities.volume(c)) : 0;
        const Real rate = model.is_rigid(body) ? rate_of_rigid(model, cavities, c, stiffness)
                                               : rate_of_nodes(model, cavities, c, p, stiffness, model.has_frame(body));
        of_body[body] += rate;
    }
}

void list_filled_cavities(WorldState& w, TaskGraph& g) {
    Model& m = w.model;
    g.stage("forces/mark_filled", mark_filled, inputs<CavityInputs>(m.cavities, m.bodies, m.nodes),
            inputs<PipeInputs>(m.pipes), value(m.cavity_map), value(w.clock.time), value(w.scratch.parameters.h),
            write(w.scratch.driven), if_sleepy(w));
}

bool a_cavity_fills(const Model& model, Real t, Real h) {
    return mark_filled(CavityInputs::bind({}, model.cavities, model.bodies, model.nodes),
                       PipeInputs::bind({}, model.pipes), model.cavity_map, t, h, {});
}

void list_cavity_memory(WorldState& w, TaskGraph& g) {
    Model& m = w.model;
    CavityTable& c = m.cavities;
    g.stage_with_result("forces/store_cavities", w.scratch.findings.cavity_supply, store_cavities,
                        inputs<CavityInputs>(c, m.bodies, m.nodes), inputs<PipeInputs>(m.pipes), value(m.cavity_map),
                        inputs<CavityWorkInputs>(c, m.nodes, m.bodies, m.rigid_bodies), value(w.clock.time),
                        value(w.scratch.parameters.h), outputs<CavityMemory>(c, m.pipes), if_taken(w),
                        if_any_cavity(m));
}

void list_cavity_measures(WorldState& w, TaskGraph& g) {
    Model& m = w.model;
    const StepParameters& p = w.scratch.parameters;
    g.stage_with_result("forces/measure_cavities", w.scratch.findings.cavity_work, measure_cavities,
                        inputs<CavityInputs>(m.cavities, m.bodies, m.nodes),
                        inputs<CavityWorkInputs>(m.cavities, m.nodes, m.bodies, m.rigid_bodies), value(w.clock.time),
                        value(p.h), value(p.work_lag), if_any_cavity(m));
}

Real energy_of_cavities(const Model& model, Real t, Real lag) {
    return cavity_energy(CavityInputs::bind({}, model.cavities, model.bodies, model.nodes),
                         CavityWorkInputs::bind({}, model.cavities, model.nodes, model.bodies, model.rigid_bodies), t,
                         lag);
}

}  // namespace

constinit const ForceElement cavity_pressures{.any = any_cavity,
                                              .add_forces = list_cavity_forces,
                                              .add_rate = add_cavity_rate,
                                              .rate_moves = true,
                                              .mark_driven = list_filled_cavities,
                                              .is_driven = a_cavity_fills,
                                              .measure = list_cavity_measures,
                                              .remember = list_cavity_memory,
                                              .energy = energy_of_cavities};

}  // namespace skerry
