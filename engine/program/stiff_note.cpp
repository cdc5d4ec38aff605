#include "engine/program/stiff_note.h"

#include <algorithm>
#include <vector>

#include "engine/output/number_text.h"
#include "engine/program/mesh_text.h"
#include "engine/world/step/step.h"
#include "engine/world/world_state.h"

namespace skerry {

namespace {

// Number of steps below which a run needs no note. With a few hundred tetrahedra these steps take about a minute.
constexpr double few_steps = 1e5;
// Factor above which a step counts as much longer than another one:
// - A note is given if the steps would be longer by more than this factor without the stiff bodies, or without the
//   forces on a body.
// - A tetrahedron counts as bad if the median step of all tetrahedra is longer by more than this factor than its own
//   step.
constexpr Real much_longer = 4;
// Longest step by default in a world of rigid and implicit bodies (Settings::step_size) [s].
constexpr Real usual_step = 1.0 / 120;

/// Stiff bodies are the explicit bodies whose stable step is less than `much_longer` times the shortest one. Bodies
/// with automatic dynamics do not count, because the engine itself has chosen explicit dynamics for them.
struct ShortSteps {
    std::size_t first = 0;  // index in ScenePlan::bodies of the body with the shortest step
    std::size_t count = 0;  // number of stiff bodies
    // `step`: shortest stable step of the explicit bodies. `step_without`: shortest one of the bodies that are not
    // stiff [s]
    Real step = infinity, step_without = infinity;
};

ShortSteps short_steps(const ScenePlan& plan, const World& world) {
    const Model& model = WorldAccess::state_of(world).model;
    const std::vector<BodyHandle> bodies = bodies_in_order(world);
    std::vector<Real> step(bodies.size(), infinity);
    ShortSteps stiff;
    for (std::size_t b = 0; b < step.size(); ++b) {
        if (world.dynamics(bodies[b]) != BodyDynamics::explicit_elastic) continue;
        step[b] = model.bodies.stable_step[static_cast<std::size_t>(model.row(bodies[b], "stable_step"))];
        if (!(step[b] < stiff.step)) continue;
        stiff.first = b;
        stiff.step = step[b];
    }
    for (std::size_t b = 0; b < step.size(); ++b) {
        const bool chosen = plan.bodies[b].settings.dynamics == BodyDynamics::automatic;
        if (!chosen && step[b] < much_longer * stiff.step)
            ++stiff.count;
        else
            stiff.step_without = std::min(stiff.step_without, step[b]);
    }
    return stiff;
}

/// Number of tetrahedra that allow less than 1 / `much_longer` of the median step. `step`: step that each tetrahedron
/// allows.
std::size_t count_bad(std::vector<Real> step) {
    const auto middle = step.begin() + static_cast<std::ptrdiff_t>(step.size() / 2);
    std::ranges::nth_element(step, middle);
    const Real usual = *middle;
    return static_cast<std::size_t>(
        std::ranges::count_if(step, [usual](Real each) { return much_longer * each < usual; }));
}

/// Note about a body on which springs, cables or other forces require much shorter steps than its elements do. Returns
/// an empty text if there is no such body. `steps`: estimated number of steps of the run.
std::string note_of_forces(const World& world, double steps) {
    const Model& model = WorldAccess::state_of(world).model;
    Index body = no_index;
    const Real step = stable_step(model, &body);
    if (body == no_index) return {};
    const Real step_without = std::min(model.bodies.stable_step[body], world.settings().step_size.value_or(usual_step));
    if (!(step_without > much_longer * step)) return {};
    return "body \"" + model.body_records[static_cast<std::size_t>(body)].name +
           "\": the springs, cables, cavities, fibres or loads that act on it need steps of " + with_unit(step, "s") +
           ": about " + count_text(steps) + " steps, " + short_text(step_without / step) +
           " times as many as otherwise; reduce their stiffness, tension, pressure or drag";
}

}  // namespace

std::string stiff_note(const ScenePlan& plan, const World& world, double steps, double sample) {
    if (steps < few_steps || plan.bodies.empty()) return {};
    if (std::string text = note_of_forces(world, steps); !text.empty()) return text;
    const ShortSteps stiff = short_steps(plan, world);
    const Real step_without = std::min({stiff.step_without, sample, world.settings().step_size.value_or(usual_step)});
    if (stiff.count == 0 || !(step_without > much_longer * stiff.step)) return {};
    const BodyPlan& body = plan.bodies[stiff.first];
    std::string text = mesh_of_body_text(plan, stiff.first);
    if (stiff.count > 1)
        text += " and " + grouped(stiff.count - 1) + (stiff.count == 2 ? " more body like it" : " more bodies like it");
    text += std::string(stiff.count > 1 ? " are" : " is") + " explicit, of material \"" +
            plan.materials[body.material].first + "\", and " + (stiff.count > 1 ? "need" : "needs") + " steps of " +
            with_unit(stiff.step, "s") + ": about " + count_text(steps) + " steps, " +
            short_text(step_without / stiff.step) + " times as many as otherwise; ";
    const std::vector<Real> each = world.tetrahedron_steps(bodies_in_order(world)[stiff.first]);
    if (const std::size_t bad = count_bad(each); bad > 0)
        return text + "the cause: " + grouped(bad) + " of " + grouped(each.size()) +
               " tetrahedra, the worst tetrahedron " + std::to_string(std::ranges::min_element(each) - each.begin()) +
               ": repair the mesh (`skerry inspect " + plan.file.string() + " --body " + body.settings.name +
               " --repair NEW.msh`)";
    if (body.settings.self_contact)
        return text +
               "reduce young_modulus, coarsen the mesh, or give up self_contact (and plasticity or a loss_factor) and "
               "set \"dynamics\" of the body to \"implicit\"";
    return text +
           "set \"dynamics\" of the body to \"implicit\", or to \"rigid\" if its deformation does not matter "
           "(docs/stiff.md)";
}

}  // namespace skerry
