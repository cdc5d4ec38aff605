// Rollouts: many copies of a world that follow given controls.
#include "skerry/rollout.h"

#include <nanobind/stl/tuple.h>

#include <algorithm>
#include <deque>
#include <string>
#include <tuple>
#include <utility>
#include <vector>

#include "engine/python/bind.h"
#include "engine/python/world_object.h"

namespace skerry::python {

namespace {

using Values = nb::ndarray<const Real, nb::ndim<1>, nb::c_contig, nb::device::cpu>;

[[noreturn]] void refuse_kind(const std::string& kind) {
    throw nb::value_error(("unknown kind '" + kind + "'").c_str());
}

/// A collider or an attachment.
std::variant<ColliderHandle, AttachmentHandle> movable(nb::handle object) {
    if (nb::isinstance<AttachmentHandle>(object)) return nb::cast<AttachmentHandle>(object);
    return nb::cast<ColliderHandle>(object);
}
/// A body, a collider or an attachment.
std::variant<BodyHandle, ColliderHandle, AttachmentHandle> placed(nb::handle object) {
    if (nb::isinstance<BodyHandle>(object)) return nb::cast<BodyHandle>(object);
    if (nb::isinstance<AttachmentHandle>(object)) return nb::cast<AttachmentHandle>(object);
    return nb::cast<ColliderHandle>(object);
}

/// A control of Python: kind, handle (None for gravity) and values in the order of RolloutControl::values.
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
    else
        refuse_kind(kind);
    return control;
}

/// A probe of Python: name, kind and object. The object is a handle, None for the energy of the world, or for a
/// material point its body, nodes and weights.
using Record = std::tuple<std::string, std::string, nb::object>;
using Point = std::tuple<BodyHandle, std::array<Index, 4>, std::array<Real, 4>>;

RecordedProbe probe_of(const Record& given) {
    const auto& [name, kind, object] = given;
    if (kind == "point") {
        const auto [body, node, weight] = nb::cast<Point>(object);
        return {name, PointProbe{.body = body, .node = node, .weight = weight, .origin = {}}};
    }
    if (kind == "body") return {name, BodyProbe{nb::cast<BodyHandle>(object), {}}};
    if (kind == "nodes") return {name, NodesProbe{nb::cast<BodyHandle>(object)}};
    if (kind == "stress") return {name, StressProbe{nb::cast<BodyHandle>(object), {}}};
    if (kind == "volume") return {name, VolumeProbe{nb::cast<BodyHandle>(object)}};
    if (kind == "pose") return {name, PoseProbe{placed(object)}};
    if (kind == "velocity") return {name, VelocityProbe{placed(object)}};
    if (kind == "joint") return {name, JointProbe{nb::cast<JointHandle>(object)}};
    if (kind == "energy") return {name, EnergyProbe{}};
    if (kind != "force") refuse_kind(kind);
    if (nb::isinstance<BodyHandle>(object)) return {name, BodyForceProbe{nb::cast<BodyHandle>(object), {}}};
    if (nb::isinstance<ColliderHandle>(object)) return {name, ColliderForceProbe{nb::cast<ColliderHandle>(object), {}}};
    return {name, ReactionProbe{nb::cast<AttachmentHandle>(object)}};
}

/// The result as a dictionary. `count` is the number of worlds.
nb::dict dict_of(RolloutResult&& result, std::size_t count, std::size_t intervals) {
    nb::dict values;
    values["time"] = array_of<Real>(std::span<const Real>(result.time));
    nb::list series, status, worlds;
    for (const RolloutSeries& recorded : result.series) {
        nb::list quantities;
        for (const SeriesColumn& column : recorded.columns) quantities.append(column.quantity);
        series.append(nb::make_tuple(quantities, array_of<Real>(std::span<const Real>(recorded.values))));
    }
    for (const RolloutStatus& world : result.status)
        status.append(nb::make_tuple(world.intervals, world.message(), world.distrust));
    for (World& world : result.worlds) worlds.append(nb::cast(new WorldObject(std::move(world))));
    values["series"] = series;
    values["status"] = status;
    values["worlds"] = worlds;
    values["shape"] = nb::make_tuple(count, intervals);
    return values;
}

nb::dict run_rollout(const std::vector<WorldObject*>& objects, const std::vector<Control>& controls,
                     const std::vector<Record>& records, Real dt, std::size_t intervals, int threads,
                     bool keep_worlds) {
    std::deque<Use> used;  // a deque never moves its elements
    std::vector<const World*> worlds;
    for (WorldObject* object : objects) {
        used.emplace_back(*object);
        worlds.push_back(&object->world);
    }
    RolloutSettings settings{.intervals = intervals, .dt = dt, .threads = threads, .keep_worlds = keep_worlds};
    std::ranges::transform(controls, std::back_inserter(settings.controls), control_of);
    std::ranges::transform(records, std::back_inserter(settings.record), probe_of);
    settings.go_on = [](const RolloutProgress&) {
        nb::gil_scoped_acquire held;
        if (PyErr_CheckSignals() != 0) throw nb::python_error();
        return true;
    };
    if (threads != 1) Use::note_threads();
    return dict_of(without_gil([&] { return rollout(worlds, settings); }), worlds.size(), intervals);
}

}  // namespace

void bind_rollout(nb::module_& module) {
    module.def("rollout", &run_rollout);
}

}  // namespace skerry::python
