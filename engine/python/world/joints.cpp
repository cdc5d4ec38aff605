// Joints of rigid bodies.
#include "skerry/joint.h"

#include "engine/python/read_settings.h"
#include "engine/python/world/parts.h"

namespace skerry::python {

namespace {

JointHandle add_joint(WorldObject& object, const BodyHandle& first, std::optional<BodyHandle> second,
                      nb::handle settings_object) {
    Use use(object);
    JointSettings settings;
    read(settings_object, settings);
    settings.first = first;
    settings.second = second;
    return Joints(object.world).add(settings);
}

nb::dict values_of(const JointState& state) {
    nb::dict values;
    values["kind"] = std::string(name_of(state.kind));
    values["first"] = object_of(state.first);
    values["second"] = state.second ? object_of(*state.second) : nb::none();
    values["point"] = tuple_of(state.point);
    values["axis"] = tuple_of(state.axis);
    values["coordinate"] = state.coordinate;
    values["speed"] = state.speed;
    values["force"] = tuple_of(state.force);
    values["moment"] = tuple_of(state.moment);
    values["motor"] = state.motor;
    values["passive"] = state.passive;
    values["limit"] = state.limit;
    values["mimic"] = state.mimic;
    values["error"] = state.error;
    return values;
}

nb::dict settings_of_joint(World& world, const JointHandle& joint) {
    const JointSettings settings = Joints(world).settings(joint);
    nb::dict values = python::values_of(settings);
    values["first"] = object_of(settings.first);
    values["second"] = settings.second ? object_of(*settings.second) : nb::none();
    return values;
}

nb::object motor_of(World& world, const JointHandle& joint) {
    const std::optional<JointMotor> motor = Joints(world).motor(joint);
    return motor ? object_of(*motor) : nb::none();
}

nb::object mimic_of(World& world, const JointHandle& joint) {
    const std::optional<JointMimic> mimic = Joints(world).mimic(joint);
    if (!mimic) return nb::none();
    return nb::make_tuple(mimic->leader, mimic->ratio, mimic->offset);
}

nb::tuple limits_of(World& world, const JointHandle& joint) {
    const JointLimits limits = Joints(world).limits(joint);
    return nb::make_tuple(limits.lower, limits.upper);
}

void set_passive(WorldObject& object, const JointHandle& joint, nb::handle settings_object) {
    Use use(object);
    JointPassive passive;
    read(settings_object, passive);
    Joints(object.world).set_passive(joint, passive);
}

void set_motor(WorldObject& object, const JointHandle& joint, nb::handle settings_object) {
    Use use(object);
    std::optional<JointMotor> motor;
    if (!settings_object.is_none()) read(settings_object, motor.emplace());
    Joints(object.world).set_motor(joint, motor);
}

}  // namespace

void bind_joints(WorldClass& type) {
    bind_view<JointHandle>(type, "joints");
    type.def("add_joint", &add_joint, nb::arg("first"), nb::arg("second").none(), nb::arg("given"))
        .def("joint_state",
             guarded([](World& world, const JointHandle& joint) { return values_of(Joints(world).state(joint)); }))
        .def("joint_settings", guarded(settings_of_joint))
        .def("set_motor", &set_motor, nb::arg("joint"), nb::arg("motor").none())
        .def("set_passive", &set_passive, nb::arg("joint"), nb::arg("passive"))
        .def("set_mimic",
             guarded([](World& world, const JointHandle& joint, std::optional<JointHandle> leader, Real ratio,
                        Real offset) {
                 Joints(world).set_mimic(
                     joint, leader ? std::optional(JointMimic{*leader, ratio, offset}) : std::optional<JointMimic>());
             }),
             nb::arg("joint"), nb::arg("leader").none(), nb::arg("ratio"), nb::arg("offset"))
        .def("mimic", guarded(mimic_of))
        .def("motor", guarded(motor_of))
        .def("limits", guarded(limits_of))
        .def("passive",
             guarded([](World& world, const JointHandle& joint) { return object_of(Joints(world).passive(joint)); }))
        .def("set_limits",
             guarded([](World& world, const JointHandle& joint, std::optional<Real> lower, std::optional<Real> upper) {
                 Joints(world).set_limits(joint, lower, upper);
             }),
             nb::arg("joint"), nb::arg("lower").none(), nb::arg("upper").none());
}

}  // namespace skerry::python
