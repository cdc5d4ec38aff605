// Rollouts: many copies of a world that follow given controls.
#include "skerry/rollout.h"

#include <nanobind/stl/tuple.h>

#include <algorithm>
#include <deque>
#include <iterator>
#include <span>
#include <string>
#include <tuple>
#include <utility>
#include <variant>
#include <vector>

#include "engine/python/bind.h"
#include "engine/python/world_object.h"

namespace skerry::python {

namespace {

using Values = nb::ndarray<const Real, nb::ndim<1>, nb::c_contig, nb::device::cpu>;

[[noreturn]] void refuse_kind(const std::string& kind) {
    throw nb::value_error(("unknown kind '" + kind + "'").c_str());
}

/// Returns the handle of a collider or of an attachment.
std::variant<ColliderHandle, AttachmentHandle> movable(nb::handle object) {
    if (nb::isinstance<AttachmentHandle>(object)) return nb::cast<AttachmentHandle>(object);
    return nb::cast<ColliderHandle>(object);
}

/// Returns the handle of a cable, a cavity, a pipe, a spring, a load or fibres.
decltype(ValueControl::object) valued(nb::handle object) {
    if (nb::isinstance<CableHandle>(object)) return nb::cast<CableHandle>(object);
    if (nb::isinstance<CavityHandle>(object)) return nb::cast<CavityHandle>(object);
    if (nb::isinstance<PipeHandle>(object)) return nb::cast<PipeHandle>(object);
    if (nb::isinstance<SpringHandle>(object)) return nb::cast<SpringHandle>(object);
    if (nb::isinstance<FibreHandle>(object)) return nb::cast<FibreHandle>(object);
    return nb::cast<LoadHandle>(object);
}

/// A control as Python passes it: kind, handle (None for gravity) and values in the order of RolloutControl::values.
using Control = std::tuple<std::string, nb::object, Values>;

RolloutControl control_of(const Control& given) {
    const auto& [kind, object, values] = given;
    RolloutControl control;
    control.values = {values.data(), values.size()};
    if (kind == "pose")
        control.what = PoseControl{movable(object)};
    else if (kind == "velocity")
        control.what = VelocityControl{movable(object)};
    else if (kind == "speed")
        control.what = MotorSpeedControl{nb::cast<JointHandle>(object)};
    else if (kind == "coordinate")
        control.what = MotorPositionControl{nb::cast<JointHandle>(object)};
    else if (kind == "loads")
        control.what = NodeForceControl{nb::cast<BodyHandle>(object)};
    else if (kind == "force")
        control.what = BodyForceControl{nb::cast<BodyHandle>(object)};
    else if (kind == "gravity")
        control.what = GravityControl{};
    else if (kind == "value")
        control.what = ValueControl{valued(object)};
    else
        refuse_kind(kind);
    return control;
}

/// The members of a result by name.
nb::dict dict_of(RolloutResult&& result) {
    nb::dict values;
    values["time"] = array_of<Real>(std::span<const Real>(result.time));
    nb::list series, status, worlds;
    for (const RolloutSeries& recorded : result.series) {
        nb::list quantities;
        for (const SeriesColumn& column : recorded.columns) quantities.append(column.quantity);
        series.append(nb::make_tuple(quantities, array_of<Real>(std::span<const Real>(recorded.values))));
    }
    for (const RolloutStatus& world : result.status) status.append(nb::make_tuple(world.message(), world.distrust));
    for (World& world : result.worlds)
        worlds.append(nb::cast(new WorldObject(std::move(world)), nb::rv_policy::take_ownership));
    values["series"] = series;
    values["status"] = status;
    values["worlds"] = worlds;
    return values;
}

/// Rolls out the given worlds. The same world may occur several times. `progress` is None, or is called about every 20
/// ms with the number of completed intervals and the number of all intervals, summed over the worlds.
nb::dict run_rollout(const std::vector<WorldObject*>& objects, const std::vector<Control>& controls,
                     std::vector<RecordedProbe> record, Real dt, std::size_t intervals, int threads, bool keep_worlds,
                     const nb::object& progress) {
    std::deque<Use> used;  // a deque, because a Use cannot be moved
    std::vector<const World*> worlds;
    for (WorldObject* object : objects) {
        if (object) used.emplace_back(*object);
        worlds.push_back(object ? &object->world : nullptr);  // rollout() refuses a null pointer
    }
    RolloutSettings settings{.intervals = intervals, .dt = dt, .threads = threads, .keep_worlds = keep_worlds};
    std::ranges::transform(controls, std::back_inserter(settings.controls), control_of);
    settings.record = std::move(record);
    settings.go_on = [&](const RolloutProgress& so_far) {
        CallScope::raise_at_exit();
        nb::gil_scoped_acquire held;
        if (PyErr_CheckSignals() != 0) throw nb::python_error();
        if (!progress.is_none()) progress(so_far.intervals_done, so_far.worlds * intervals);
        return true;
    };
    if (threads != 1) Use::note_threads();
    return dict_of(without_gil([&] { return rollout(worlds, settings); }));
}

}  // namespace

void bind_rollout(nb::module_& module) {
    module.def("rollout", &run_rollout, nb::arg(), nb::arg(), nb::arg(), nb::arg(), nb::arg(), nb::arg(), nb::arg(),
               nb::arg().none());
}

}  // namespace skerry::python
