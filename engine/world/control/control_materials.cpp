// Changes of materials in use, and of surface properties of single bodies and colliders.
#include <algorithm>
#include <vector>

#include "engine/base/complaint.h"
#include "engine/world/control/control.h"
#include "engine/world/edit/edit_model.h"
#include "engine/world/edit/material_row.h"
#include "engine/world/edit/rigid_bodies.h"
#include "engine/world/step/step.h"
#include "engine/world/validate.h"

namespace skerry {

namespace {

/// Copy of the element data, node masses and stable steps of a body. put_back() restores them if a change of the body's
/// material fails.
class KeptBody {
public:
    KeptBody(Model& model, std::size_t body) : body_(body) {
        visit(model, [&](auto& kept, auto rows) { kept.assign(rows.begin(), rows.end()); });
        rest_step_ = model.bodies.rest_step[body];
        stable_step_ = model.bodies.stable_step[body];
    }
    void put_back(Model& model) {
        visit(model, [](auto& kept, auto rows) { std::ranges::copy(kept, rows.begin()); });
        model.bodies.rest_step[body_] = rest_step_;
        model.bodies.stable_step[body_] = stable_step_;
    }

private:
    void visit(Model& model, auto&& with) {
        const Range nodes = model.bodies.nodes[body_], blocks = model.bodies.blocks[body_];
        const auto rows = [](auto& column, Range range) {
            return column.span().subspan(static_cast<std::size_t>(range.begin), static_cast<std::size_t>(range.size()));
        };
        with(mass_, rows(model.nodes.mass, nodes));
        with(inverse_mass_, rows(model.nodes.inverse_mass, nodes));
        with(mass_share_, rows(model.elements.mass_share, blocks));
        with(mass_form_, rows(model.elements.mass_form, blocks));
        with(frame_mass_, rows(model.elements.frame_mass, blocks));
        with(frame_bound_, rows(model.elements.frame_bound, blocks));
        with(volume_, rows(model.elements.volume, blocks));
        with(implicit_modulus_, rows(model.elements.implicit_modulus, blocks));
        with(relaxation_rate_, rows(model.elements.relaxation_rate, blocks));
        with(own_frequency_, rows(model.elements.own_frequency, blocks));
        with(viscous_time_, rows(model.elements.viscous_time, blocks));
        with(relaxing_share_, rows(model.elements.relaxing_share, blocks));
    }

    std::size_t body_;
    std::vector<Real> mass_, inverse_mass_, relaxing_share_, viscous_time_;
    std::vector<ElementForm> mass_form_;
    std::vector<FrameMass> frame_mass_;
    std::vector<Real> frame_bound_;
    std::vector<ElementLane> mass_share_, volume_, implicit_modulus_, own_frequency_;
    std::vector<RelaxationRates> relaxation_rate_;
    Real rest_step_ = 0, stable_step_ = 0;
};

std::vector<std::size_t> bodies_of(const Model& model, Index material) {
    std::vector<std::size_t> found;
    for (std::size_t b = 0; b < model.bodies.slot.size(); ++b) {
        if (model.bodies.kind[b] != BodyKind::deformable) continue;
        const std::vector<Index>& of_tetrahedra = model.body_records[b].tetrahedron_material;
        if (model.bodies.material[b] == material ||
            std::find(of_tetrahedra.begin(), of_tetrahedra.end(), material) != of_tetrahedra.end())
            found.push_back(b);
    }
    return found;
}

void restart(WorldState& world, std::size_t body) {
    Model& model = world.model;
    const BodyRecord& record = model.body_records[body];
    const Range nodes = model.bodies.nodes[body];
    NewBody as_new;
    as_new.element = record.element;
    as_new.material = model.bodies.material[body];
    as_new.tetrahedron_material = record.tetrahedron_material;
    as_new.core_nodes = model.bodies.core_nodes[body];
    as_new.round_radius = model.bodies.round_radius[body];
    as_new.nodes = model.nodes.rest_position.span().subspan(static_cast<std::size_t>(nodes.begin),
                                                            static_cast<std::size_t>(nodes.size()));
    as_new.mesh_shape = record.mesh_shape;
    as_new.tetrahedra = record.tetrahedra;
    if (record.tetrahedra.empty()) as_new.triangles = record.surface;
    if (model.has_frame(body)) keep_given_mass(model, body, as_new);
    restart_elements(model, static_cast<Index>(body), as_new, world.scratch.stiffness_sum);
    validate_step(model, static_cast<Index>(body), record.name);
}

void weigh(Model& model, std::size_t body) {
    const Range nodes = model.bodies.nodes[body];
    model.body_mass[body] = 0;
    for (Index n = nodes.begin; n < nodes.end; ++n)
        model.body_mass[body] += model.nodes.mass[static_cast<std::size_t>(n)];
}

void require_changeable(const Model& model, const MaterialRow& now, const MaterialRow& next,
                        std::span<const std::size_t> bodies) {
    if (now.constants.yields() != next.constants.yields())
        refuse("material", "plasticity", next.constants.yields() ? "plasticity" : "no plasticity",
               now.constants.yields() ? "plasticity" : "no plasticity",
               "plasticity can change, but neither appear nor vanish; add a body with a new material");
    const auto flowed = std::ranges::find_if(bodies, [&](std::size_t body) { return has_flowed(model, body); });
    if (flowed != bodies.end() && !now.same_elements(next))
        refuse("material", "young_modulus, poisson_ratio, density, losses",
               "other values for body '" + model.body_records[*flowed].name + "', which has deformed plastically",
               "the present values, or another yield_stress or hardening; or call reset() for the body first");
    if (now.constants.model != next.constants.model)
        refuse("material", "model", std::string(name_of(next.constants.model)),
               std::string(name_of(now.constants.model)) +
                   ", because the law of an existing material cannot change; for another law, add a new material");
}

}  // namespace

SurfaceSettings set_values_of(const SurfaceProperties& surface) {
    const auto given = [](Real value) { return value < 0 ? std::optional<Real>() : value; };
    if (surface.static_friction == surface.dynamic_friction)
        return {.friction = given(surface.dynamic_friction), .restitution = given(surface.restitution)};
    return {.static_friction = given(surface.static_friction),
            .dynamic_friction = given(surface.dynamic_friction),
            .restitution = given(surface.restitution)};
}

std::vector<MaterialHandle> World::materials() const {
    std::vector<MaterialHandle> handles;
    for (const std::uint32_t slot : state_->model.materials.slot)
        handles.push_back(state_->model.material_map.handle_of_slot(slot));
    return handles;
}

MaterialHandle World::material(BodyHandle body) const {
    const Model& model = state_->model;
    const Index row = model.bodies.material[static_cast<std::size_t>(model.row(body, "material"))];
    return model.material_map.handle_of_slot(model.materials.slot[static_cast<std::size_t>(row)]);
}

MaterialSettings World::material(MaterialHandle material) const {
    const auto row = static_cast<std::size_t>(state_->model.row(material, "material"));
    const MaterialRow now = MaterialRow::of(state_->model.materials, row);
    MaterialSettings settings{.young_modulus = now.young_modulus,
                              .poisson_ratio = now.poisson_ratio,
                              .density = now.constants.density,
                              .friction = now.surface.dynamic_friction,
                              .restitution = now.surface.restitution,
                              .damping = now.damping,
                              .loss_factor = now.constants.loss_factor == default_loss_factor && !now.sets_losses
                                                 ? std::optional<Real>()
                                                 : now.constants.loss_factor,
                              .bulk_viscosity = now.constants.bulk_viscosity,
                              .model = now.constants.model};
    settings.orthotropic = now.orthotropic;
    for (std::size_t p = 0; p < settings.terms.size(); ++p)
        settings.terms[p] = {now.constants.share[p], now.constants.exponent[p]};
    if (now.constants.yields()) settings.plasticity = {now.constants.yield_stress, now.constants.hardening};
    if (now.surface.static_friction != now.surface.dynamic_friction) {
        settings.static_friction = now.surface.static_friction;
        settings.dynamic_friction = now.surface.dynamic_friction;
    }
    return settings;
}

void World::set_material(MaterialHandle material, const MaterialSettings& settings) {
    state_->require_between_steps("set_material");
    Model& model = state_->model;
    const Index row = model.row(material, "set_material");
    validate(settings);
    const MaterialRow now = MaterialRow::of(model.materials, static_cast<std::size_t>(row)),
                      next = MaterialRow::of(settings);
    std::vector<std::size_t> bodies = bodies_of(model, row);
    require_changeable(model, now, next, bodies);
    if (now.same_elements(next) && now.same_rest(next)) return;
    state_->settle();
    if (next.sets_losses)
        for (const std::size_t body : bodies)
            if (model.dynamics_of(body) == BodyDynamics::implicit_elastic) refuse_losses(model.body_records[body].name);
    // Explicit bodies are changed first, because only they can fail: the new material may leave them without a stable
    // step. At a failure, rigid and implicit bodies are thus still unchanged, and KeptBody need not restore their
    // masses.
    std::stable_partition(bodies.begin(), bodies.end(), [&](std::size_t body) { return !model.has_frame(body); });
    next.write(model.materials, static_cast<std::size_t>(row));
    if (!now.same_elements(next)) {
        std::vector<KeptBody> kept;
        try {
            for (const std::size_t body : bodies) {
                kept.emplace_back(model, body);
                restart(*state_, body);
            }
        } catch (const SceneError&) {
            for (KeptBody& body : kept) body.put_back(model);
            now.write(model.materials, static_cast<std::size_t>(row));
            throw;
        }
        for (const std::size_t body : bodies) weigh(model, body);
        note_forces(model);  // frequency bounds of force elements depend on the node masses
        model.clusters_open |= !bodies.empty();
        settle_clusters(model, state_->scratch.stiffness_sum);
        // If the new material does not relax, a step writes neither spring_strain nor spring_strain_next, but swaps
        // these two columns. Their values must therefore be equal.
        model.elements.spring_strain_next = model.elements.spring_strain;
    }
    state_->record.balance.close();
    for (const std::size_t body : bodies) model.wake(body);
}

SurfaceSettings World::surface_properties(BodyHandle body) const {
    const auto row = static_cast<std::size_t>(state_->model.row(body, "surface_properties"));
    return set_values_of(state_->model.bodies.surface[row]);
}

SurfaceSettings World::surface_properties(ColliderHandle collider) const {
    const auto row = static_cast<std::size_t>(state_->model.row(collider, "surface_properties"));
    return set_values_of(state_->model.colliders.surface[row]);
}

void World::set_surface_properties(BodyHandle body, const SurfaceSettings& surface) {
    state_->require_between_steps("set_surface_properties");
    Model& model = state_->model;
    const auto row = static_cast<std::size_t>(model.row(body, "set_surface_properties"));
    validate(surface, "body '" + model.body_records[row].name + "'");
    const SurfaceProperties next = skerry::surface_properties(surface);
    if (model.bodies.surface[row] == next) return;
    model.bodies.surface[row] = next;
    model.wake(row);
}

void World::set_surface_properties(ColliderHandle collider, const SurfaceSettings& surface) {
    state_->require_between_steps("set_surface_properties");
    Model& model = state_->model;
    const auto row = static_cast<std::size_t>(model.row(collider, "set_surface_properties"));
    validate(surface, "collider '" + model.collider_records[row].name + "'");
    const SurfaceProperties next = skerry::surface_properties(surface);
    if (model.colliders.surface[row] == next) return;
    model.colliders.surface[row] = next;
    state_->edits.places.add_collider(model, row, time());  // wakes bodies that lie on the collider
}

}  // namespace skerry
