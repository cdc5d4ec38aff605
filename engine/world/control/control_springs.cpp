// Functions that add, read and change springs between steps (docs/methods/springs.md).
#include <algorithm>
#include <cmath>

#include "engine/base/complaint.h"
#include "engine/world/control/control.h"
#include "engine/world/query/place_anchor.h"
#include "engine/world/step/step.h"
#include "engine/world/validate.h"
#include "skerry/spring.h"

namespace skerry {

namespace {

std::string title_of_spring(const std::string& first, const std::string& second) {
    return "spring between " + first + " and " + second;
}

std::string title_of_spring(const Model& model, std::size_t row) {
    const SpringTable& table = model.springs;
    return title_of_spring(title_of_end(model, table.first.body[row], table.first.collider[row]),
                           title_of_end(model, table.second.body[row], table.second.collider[row]));
}

// In the following functions `object` names the spring in error messages (title_of_spring).

void require_not_negative(const std::string& object, const char* field, Real found, const char* unit) {
    if (!(std::isfinite(found) && found >= 0))
        refuse(object, field, short_text(found), std::string("a number >= 0 (") + unit + ")");
}

void validate_rest_length(const std::string& object, const TimeTable& rest_length) {
    require_table(object, "rest_length", rest_length);
    for (std::size_t k = 0; k < rest_length.keys.size(); ++k)
        if (!(rest_length.keys[k].value >= 0))
            refuse(object, rest_length.keys.size() == 1 ? "rest_length" : "rest_length.keys",
                   short_text(rest_length.keys[k].value), "a length >= 0 (m)");
}

/// Throws SceneError if the anchor is on an implicit body and Settings::theta is below 1. The spring force follows the
/// deformation, and with this theta it would add energy to the body.
void require_stable(const Model& model, const std::string& object, const PlacedAnchor& anchor, const char* field) {
    if (anchor.body == no_index || model.settings.theta == 1) return;
    const auto body = static_cast<std::size_t>(anchor.body);
    if (model.dynamics_of(body) == BodyDynamics::implicit_elastic)
        refuse(object, field,
               "implicit body '" + model.body_records[body].name + "' in a world with theta " +
                   short_text(model.settings.theta),
               "theta 1 in the settings, or a body that is not implicit");
}

void require_body(const std::string& object, const PlacedAnchor& first, const PlacedAnchor& second) {
    if (first.body == no_index && second.body == no_index)
        refuse(object, "first, second", "no body", "a body in at least one of the two anchors");
}

void wake_bodies_of(Model& model, std::size_t row) {
    for (const Index body : {model.springs.first.body[row], model.springs.second.body[row]})
        if (body != no_index) model.wake(static_cast<std::size_t>(body));
}

/// Completes a change of a spring: wakes its bodies, updates the data of force elements, and starts a new energy
/// balance, which does not count the energy of the change as an error.
void note_change(WorldState& world, std::size_t row) {
    wake_bodies_of(world.model, row);
    note_forces(world.model);
    world.record.balance.close();
}

Real length_of(const WorldState& world, std::size_t row) {
    const AnchorsBetweenSteps anchors(world);
    return (anchors.of(world.model.springs.first).at(row) - anchors.of(world.model.springs.second).at(row)).norm();
}

/// Access to a spring for a function that changes it. The constructor throws SceneError during a step, and for a stale
/// handle.
struct Changed {
    WorldState& world;
    SpringTable& springs;
    std::size_t row;

    Changed(World& of, SpringHandle spring, const char* call)
        : world(WorldAccess::state_of(of)), springs(world.model.springs), row(0) {
        world.require_between_steps(call);
        row = static_cast<std::size_t>(world.model.row(spring, call));
    }
    std::string title() const { return title_of_spring(world.model, row); }
    void set(Column<Real>& column, Real value) const {
        if (column[row] == value) return;
        column[row] = value;
        note_change(world, row);
    }
};

}  // namespace

SpringHandle Springs::add(const SpringSettings& spring) {
    WorldState& world = WorldAccess::state_of(*world_);
    world.require_between_steps("add_spring");
    const std::string object =
        title_of_spring(title_of_end(world.model, spring.first), title_of_end(world.model, spring.second));
    require_not_negative(object, "stiffness", spring.stiffness, "N/m");
    require_not_negative(object, "damping", spring.damping, "N s/m");
    if (!(spring.strength > 0)) refuse(object, "strength", short_text(spring.strength), "a force > 0 (N)");
    if (spring.rest_length) validate_rest_length(object, *spring.rest_length);
    const PlacedAnchor first = place_anchor(world, spring.first, object, "first"),
                       second = place_anchor(world, spring.second, object, "second");
    require_body(object, first, second);
    require_stable(world.model, object, first, "first");
    require_stable(world.model, object, second, "second");
    if (spring.stiffness == 0 && spring.damping == 0)
        refuse(object, "stiffness, damping", "0 and 0, so that no force acts", "a number > 0 for at least one of them");
    Model& model = world.model;
    SpringTable& table = model.springs;
    const std::size_t row = table.size();
    AnyTable(table).resize(row + 1);
    const SpringHandle handle = model.spring_map.insert(static_cast<Index>(row));
    table.slot[row] = handle.slot;
    table.side[row] = spring.only;
    first.store(table.first, row);
    second.store(table.second, row);
    table.stiffness[row] = spring.stiffness;
    table.damping[row] = spring.damping;
    table.strength[row] = spring.strength;
    const TimeTable rest = spring.rest_length.value_or(TimeTable(length_of(world, row)));
    table.rest_length[row] = {};
    set_keys(table.rest_length, table.key, row, rest.keys);
    model.links_open = true;
    note_change(world, row);
    return handle;
}

SpringState Springs::state(SpringHandle spring) const {
    return spring_state(WorldAccess::state_of(*world_), spring);
}

SpringState spring_state(const WorldState& world, SpringHandle spring) {
    const Model& model = world.model;
    const auto row = static_cast<std::size_t>(model.row(spring, "spring"));
    const AnchorsBetweenSteps anchors(world);
    SpringInputs inputs =
        SpringInputs::bind({}, model.springs, model.bodies, model.nodes, model.colliders, model.any_asleep);
    inputs.first = anchors.of(model.springs.first);
    inputs.second = anchors.of(model.springs.second);
    SpringState state;
    state.first = anchors.at(model.springs.first, row);
    state.second = anchors.at(model.springs.second, row);
    const Vec3 separation = state.first.point - state.second.point;
    state.length = separation.norm();
    if (state.length > 0)
        state.rate = separation.dot(inputs.first.velocity(row) - inputs.second.velocity(row)) / state.length;
    state.rest_length = inputs.rest(row, world.clock.time);
    state.force = model.springs.tension[row];
    state.energy = inputs.law(row).energy(state.length - state.rest_length);
    return state;
}

SpringSettings Springs::settings(SpringHandle spring) const {
    const WorldState& world = WorldAccess::state_of(*world_);
    const SpringTable& table = world.model.springs;
    const auto row = static_cast<std::size_t>(world.model.row(spring, "settings"));
    const AnchorsBetweenSteps anchors(world);
    return {.first = anchors.at(table.first, row),
            .second = anchors.at(table.second, row),
            .stiffness = table.stiffness[row],
            .damping = table.damping[row],
            .rest_length = time_table_of(table.keys_of(row)),
            .only = table.side[row],
            .strength = table.strength[row]};
}

void Springs::set_second(SpringHandle spring, const Anchor& anchor) {
    const Changed change(*world_, spring, "set_second");
    const std::string object = change.title();
    const PlacedAnchor placed = place_anchor(change.world, anchor, object, "second");
    AnchorColumns& columns = change.springs.second;
    PlacedAnchor first;
    first.body = change.springs.first.body[change.row];
    require_body(object, first, placed);
    require_stable(change.world.model, object, placed, "second");
    if (columns.body[change.row] == placed.body && columns.collider[change.row] == placed.collider &&
        columns.point[change.row] == placed.point)
        return;
    wake_bodies_of(change.world.model, change.row);
    change.world.model.links_open |= columns.body[change.row] != placed.body;
    placed.store(columns, change.row);
    note_change(change.world, change.row);
}

void Springs::set_rest_length(SpringHandle spring, const TimeTable& rest_length) {
    const Changed change(*world_, spring, "set_rest_length");
    validate_rest_length(change.title(), rest_length);
    if (std::ranges::equal(change.springs.keys_of(change.row), rest_length.keys)) return;
    set_keys(change.springs.rest_length, change.springs.key, change.row, rest_length.keys);
    note_change(change.world, change.row);
}

void Springs::set_stiffness(SpringHandle spring, Real stiffness) {
    const Changed change(*world_, spring, "set_stiffness");
    require_not_negative(change.title(), "stiffness", stiffness, "N/m");
    change.set(change.springs.stiffness, stiffness);
}

void Springs::set_damping(SpringHandle spring, Real damping) {
    const Changed change(*world_, spring, "set_damping");
    require_not_negative(change.title(), "damping", damping, "N s/m");
    change.set(change.springs.damping, damping);
}

}  // namespace skerry
