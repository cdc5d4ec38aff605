// Rollouts: copies of worlds that follow given controls.
#include "skerry/rollout.h"

#include <memory>
#include <string>
#include <utility>

#include "engine/python/world/parts.h"

namespace skerry::python {

namespace {

using Moved = std::variant<ColliderHandle, AttachmentHandle>;

/// A control and the array of its values, which must live as long as the rollout.
struct ControlObject {
    RolloutControl control;
    nb::ndarray<const Real, nb::c_contig, nb::device::cpu> values;
};

template <class Control, class Object>
void bind_control_of(nb::module_& module, const char* name) {
    module.def(name, [](const Object& object, const nb::ndarray<const Real, nb::c_contig, nb::device::cpu>& values) {
        return ControlObject{{.what = Control{object}, .values = {values.data(), values.size()}}, values};
    });
}

nb::dict values_of(const RolloutSeries& series) {
    nb::list columns;
    for (const SeriesColumn& column : series.columns) columns.append(column.quantity);
    nb::dict values;
    values["name"] = series.name;
    values["columns"] = columns;
    values["values"] = array_of<Real>(std::span<const Real>(series.values));
    return values;
}

nb::dict values_of(RolloutResult&& result) {
    nb::list series, messages, distrust, worlds;
    for (const RolloutSeries& one : result.series) series.append(values_of(one));
    for (const RolloutStatus& status : result.status) {
        messages.append(status.message());
        distrust.append(status.distrust);
    }
    for (World& world : result.worlds)
        worlds.append(nb::cast(new WorldObject(std::move(world)), nb::rv_policy::take_ownership));
    nb::dict values;
    values["time"] = array_of<Real>(std::span<const Real>(result.time));
    values["series"] = series;
    values["message"] = messages;
    values["distrust"] = distrust;
    values["worlds"] = worlds;
    return values;
}

/// Rolls out the given worlds, or `count` copies if there is one. `progress` is None or is called about every 20 ms
/// with the numbers of worlds that are done and of all worlds.
nb::dict roll_out(const std::vector<WorldObject*>& objects, std::size_t count, std::size_t intervals, Real dt,
                  const std::vector<ControlObject*>& controls, std::vector<RecordedProbe> record, int threads,
                  bool keep_worlds, const nb::object& progress) {
    std::vector<std::unique_ptr<Use>> uses;
    std::vector<const World*> worlds;
    for (WorldObject* object : objects) {
        uses.push_back(std::make_unique<Use>(*object));
        worlds.push_back(&object->world);
    }
    RolloutSettings settings{
        .intervals = intervals, .dt = dt, .record = std::move(record), .threads = threads, .keep_worlds = keep_worlds};
    for (const ControlObject* control : controls) settings.controls.push_back(control->control);
    settings.go_on = [&](const RolloutProgress& so_far) {
        nb::gil_scoped_acquire held;
        if (PyErr_CheckSignals() != 0) throw nb::python_error();
        if (!progress.is_none()) progress(so_far.worlds_done, so_far.worlds);
        return true;
    };
    if (threads != 1) Use::note_threads();
    return values_of(without_gil([&] {
        return worlds.size() == 1 ? rollout(*worlds.front(), count, settings)
                                  : rollout(std::span<const World* const>(worlds), settings);
    }));
}

}  // namespace

void bind_rollout(nb::module_& module) {
    const nb::class_<ControlObject> type(module, "RolloutControl");
    bind_control_of<PoseControl, Moved>(module, "pose_control");
    bind_control_of<VelocityControl, Moved>(module, "velocity_control");
    bind_control_of<MotorSpeedControl, JointHandle>(module, "motor_speed_control");
    bind_control_of<MotorPositionControl, JointHandle>(module, "motor_position_control");
    bind_control_of<NodeForceControl, BodyHandle>(module, "node_force_control");
    bind_control_of<BodyForceControl, BodyHandle>(module, "body_force_control");
    module.def("gravity_control", [](const nb::ndarray<const Real, nb::c_contig, nb::device::cpu>& values) {
        return ControlObject{{.what = GravityControl{}, .values = {values.data(), values.size()}}, values};
    });
    module.def("rollout", &roll_out, nb::arg(), nb::arg(), nb::arg(), nb::arg(), nb::arg(), nb::arg(), nb::arg(),
               nb::arg(), nb::arg().none());
}

}  // namespace skerry::python
