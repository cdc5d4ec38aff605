#include "engine/rollout/controls.h"

#include <array>
#include <cmath>
#include <type_traits>

#include "engine/base/complaint.h"
#include "engine/world/edit/objects.h"
#include "engine/world/world_state.h"
#include "skerry/cable.h"
#include "skerry/cavity.h"
#include "skerry/fibre.h"
#include "skerry/joint.h"
#include "skerry/load.h"
#include "skerry/spring.h"

namespace skerry {

namespace {

const Model& model_of(const World& world) {
    return WorldAccess::state_of(world).model;
}

std::size_t row_of(const World& world, auto handle) {
    return static_cast<std::size_t>(model_of(world).row(handle, "rollout"));
}

std::string name_of_object(const World&, std::monostate) {
    return {};
}
std::string name_of_object(const World& world, BodyHandle body) {
    return "body '" + world.name(body) + "'";
}
std::string name_of_object(const World& world, ColliderHandle collider) {
    return "collider '" + world.name(collider) + "'";
}
std::string name_of_object(const World& world, AttachmentHandle attachment) {
    const auto body = static_cast<std::size_t>(model_of(world).attachments.body[row_of(world, attachment)]);
    return "attachment of body '" + model_of(world).body_records[body].name + "'";
}
template <class HandleType>
requires requires {
    ObjectsOf<HandleType>::noun;
}
std::string name_of_object(const World& world, HandleType object) {
    return ObjectsOf<HandleType>::noun + (" '" + object_name(model_of(world), object) + "'");
}

/// The object of a control; gravity has none.
using ControlledObject = std::variant<std::monostate, BodyHandle, ColliderHandle, AttachmentHandle, JointHandle,
                                      CableHandle, CavityHandle, PipeHandle, SpringHandle, LoadHandle, FibreHandle>;

ControlledObject object_of(const RolloutControl& control) {
    return std::visit(
        [](const auto& quantity) -> ControlledObject {
            if constexpr (requires { quantity.body; })
                return quantity.body;
            else if constexpr (requires { quantity.joint; })
                return quantity.joint;
            else if constexpr (requires { quantity.object; })
                return std::visit([](auto handle) -> ControlledObject { return handle; }, quantity.object);
            else
                return std::monostate();
        },
        control.what);
}

/// For each kind of control: the words of its title in front of the name of the object, and the number of values per
/// interval.
struct ControlKind {
    const char* title;
    std::size_t count;
};
constexpr std::array<ControlKind, std::variant_size_v<decltype(RolloutControl::what)>> control_kinds{{
    {"pose of ", 6},
    {"velocity of ", 6},
    {"motor speed of ", 1},
    {"motor position of ", 1},
    {"forces on the nodes of ", 3},  // for each node
    {"force on ", 3},
    {"gravity", 3},
    {"value of ", 1},
}};

/// Text such as "pose of collider 'finger'".
std::string title_of(const World& world, const RolloutControl& control) {
    return control_kinds[control.what.index()].title +
           std::visit([&](auto handle) { return name_of_object(world, handle); }, object_of(control));
}

std::string indexed_name(const char* list, std::size_t number) {
    return list + ("[" + std::to_string(number) + "]");
}

Vec3 vector_at(std::span<const Real> values, std::size_t first) {
    return {values[first], values[first + 1], values[first + 2]};
}

/// Values of a control for one interval of one world. A control has values for each world, or one list that all worlds
/// use. `count`: number of values per interval.
std::span<const Real> values_of(const RolloutControl& control, std::size_t count, std::size_t intervals,
                                std::size_t world, std::size_t interval) {
    const bool for_all = control.values.size() == intervals * count;
    return control.values.subspan(((for_all ? 0 : world * intervals) + interval) * count, count);
}

/// Applies the values of one interval to a world.
struct ApplyControl {
    std::span<const Real> values;
    Real dt;  // length of the interval [s]
    std::vector<Vec3>& forces;
    World& world;

    void operator()(const PoseControl& control) const {
        const Pose pose{vector_at(values, 0), vector_at(values, 3)};
        std::visit([&](auto object) { world.move_to(object, pose, dt); }, control.object);
    }
    void operator()(const VelocityControl& control) const {
        std::visit([&](auto object) { world.set_velocity(object, vector_at(values, 0), vector_at(values, 3)); },
                   control.object);
    }
    void operator()(const MotorSpeedControl& control) const {
        set_motor_target(world, control.joint, {.speed = values[0]});
    }
    void operator()(const MotorPositionControl& control) const {
        set_motor_target(world, control.joint, {.position = values[0]});
    }
    void operator()(const NodeForceControl& control) const {
        forces.resize(values.size() / 3);
        for (std::size_t n = 0; n < forces.size(); ++n) forces[n] = vector_at(values, 3 * n);
        world.set_loads(control.body, forces);
    }
    void operator()(const BodyForceControl& control) const {
        const Model& model = model_of(world);
        const auto mass = rows_of(model.nodes.mass, model.bodies.nodes[row_of(world, control.body)]);
        const Vec3 per_mass = vector_at(values, 0) / world.mass(control.body);
        forces.resize(mass.size());
        for (std::size_t n = 0; n < forces.size(); ++n) forces[n] = mass[n] * per_mass;
        world.set_loads(control.body, forces);
    }
    void operator()(const GravityControl&) const { world.set_gravity(vector_at(values, 0)); }
    void operator()(const ValueControl& control) const { set_controlled_value(world, control, values[0]); }
};

/// Sets the quantity that a ValueControl prescribes for its kind of object, such as the rest length of a spring.
struct SetValue {
    World& world;
    const TimeTable& value;

    void operator()(CableHandle cable) const {
        CableDrive drive = Cables(world).settings(cable).drive;
        for (std::optional<TimeTable>* table : {&drive.tension, &drive.length, &drive.rate})
            if (*table) *table = value;
        Cables(world).set_drive(cable, drive);
    }
    void operator()(CavityHandle cavity) const {
        Cavities cavities(world);
        switch (cavities.state(cavity).law) {
            case CavityLaw::pressure:
                return cavities.set_pressure(cavity, value);
            case CavityLaw::gas:
                return cavities.set_inflow(cavity, value);
            case CavityLaw::liquid:
                return cavities.set_liquid_volume(cavity, value);
        }
    }
    void operator()(PipeHandle pipe) const { Cavities(world).set_reservoir(pipe, value); }
    void operator()(SpringHandle spring) const { Springs(world).set_rest_length(spring, value); }
    void operator()(LoadHandle load) const { Loads(world).set_scale(load, value); }
    void operator()(FibreHandle fibres) const { Fibres(world).set_tension(fibres, value); }
};

}  // namespace

void set_controlled_value(World& world, const ValueControl& control, const TimeTable& value) {
    std::visit(SetValue{world, value}, control.object);
}

void set_motor_target(World& world, JointHandle joint, JointMotor target) {
    const JointMotorRow now = model_of(world).joints.motor[row_of(world, joint)];
    target.strength = now.most;
    target.fastest = now.most_speed;
    Joints(world).set_motor(joint, target);
}

std::size_t number_count(const World& world, const RolloutControl& control) {
    const auto require_live = [&](auto handle) {
        if constexpr (!std::is_same_v<decltype(handle), std::monostate>) (void)row_of(world, handle);
    };
    const ControlledObject object = object_of(control);
    std::visit(require_live, object);
    if (const auto* const joint = std::get_if<JointHandle>(&object))
        if (model_of(world).joints.drive[row_of(world, *joint)] == JointDrive::none)
            refuse(name_of_object(world, *joint), "motor", "no motor",
                   "a hinge or slider with a motor (Joints::set_motor)");
    const std::size_t count = control_kinds[control.what.index()].count;
    const auto* const nodes = std::get_if<NodeForceControl>(&control.what);
    return nodes ? count * world.positions(nodes->body).size() : count;
}

std::size_t agreed_count(std::span<const World* const> worlds, const std::string& title,
                         FunctionRef<std::size_t(const World&)> count_in) {
    std::size_t count = 0;
    for (std::size_t w = 0; w < worlds.size(); ++w) {
        if (w > 0 && worlds[w] == worlds[w - 1]) continue;
        std::size_t in_world = 0;
        try {
            in_world = count_in(*worlds[w]);
        } catch (const SceneError& error) {
            throw error_at({{}, title, "world " + std::to_string(w), {}, {}, {}}, error);
        }
        if (w == 0) count = in_world;
        if (in_world != count)
            refuse(title, "world " + std::to_string(w), std::to_string(in_world),
                   std::to_string(count) + " as in world 0; all worlds must be copies of it");
    }
    return count;
}

void check_controls(std::span<const World* const> worlds, const RolloutSettings& settings) {
    for (std::size_t c = 0; c < settings.controls.size(); ++c) {
        const RolloutControl& control = settings.controls[c];
        const std::string field = indexed_name("controls", c);
        const std::size_t count = agreed_count(worlds, field + ": number of values per interval",
                                               [&](const World& world) { return number_count(world, control); });
        const std::string title = field + " (" + title_of(*worlds[0], control) + ")";
        for (std::size_t earlier = 0; earlier < c; ++earlier)
            if (object_of(settings.controls[earlier]) == object_of(control))
                refuse(title, {}, "an object that " + indexed_name("controls", earlier) + " also controls",
                       "one control for each object");
        const std::size_t of_one = settings.intervals * count, of_all = worlds.size() * of_one;
        if (control.values.size() != of_one && control.values.size() != of_all)
            refuse(title, "values", std::to_string(control.values.size()) + " values",
                   std::to_string(of_all) + " (worlds " + std::to_string(worlds.size()) + ", intervals " +
                       std::to_string(settings.intervals) + ", numbers " + std::to_string(count) + ") or " +
                       std::to_string(of_one) + " for all worlds");
        for (std::size_t i = 0; i < control.values.size(); ++i)
            if (!std::isfinite(control.values[i]))
                refuse(title,
                       "world " + std::to_string(i / of_one) + ", interval " + std::to_string(i % of_one / count) +
                           ", number " + std::to_string(i % count),
                       short_text(control.values[i]), "a finite number");
    }
}

void apply_controls(const RolloutSettings& settings, std::span<const std::size_t> counts, std::size_t number,
                    std::size_t interval, std::vector<Vec3>& forces, World& world) {
    for (std::size_t c = 0; c < settings.controls.size(); ++c) {
        const RolloutControl& control = settings.controls[c];
        const std::span<const Real> values = values_of(control, counts[c], settings.intervals, number, interval);
        try {
            std::visit(ApplyControl{values, settings.dt, forces, world}, control.what);
        } catch (const SceneError& error) {
            throw error_at({{}, indexed_name("controls", c), {}, {}, {}, {}}, error);
        }
    }
}

}  // namespace skerry
