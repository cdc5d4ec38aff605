// Ties of deformable bodies.
#include "skerry/tie.h"

#include "engine/python/bind.h"
#include "engine/python/read_settings.h"
#include "engine/python/world/parts.h"

namespace skerry::python {

namespace {

TieHandle add_tie(WorldObject& object, const BodyHandle& body, const Indices& nodes, std::optional<BodyHandle> to_body,
                  std::optional<ColliderHandle> to_collider, nb::handle settings_object) {
    Use use(object);
    require_no_views(object, "add_tie");
    TieSettings settings;
    read(settings_object, settings);
    settings.body = body;
    settings.nodes.assign(span_of(nodes).begin(), span_of(nodes).end());
    settings.to_body = to_body;
    settings.to_collider = to_collider;
    return Ties(object.world).add(settings);
}

nb::dict values_of(const TieState& state) {
    std::vector<Index> node;
    std::vector<Vec3> force;
    std::vector<Real> error, broken;
    for (const TiedNode& tied : state.nodes) {
        node.push_back(tied.node);
        force.push_back(tied.force);
        error.push_back(tied.error);
        broken.push_back(tied.broken.value_or(infinity));
    }
    nb::dict values;
    values["kind"] = std::string(name_of(state.kind));
    values["body"] = object_of(state.body);
    values["to_body"] = state.to_body ? object_of(*state.to_body) : nb::none();
    values["to_collider"] = state.to_collider ? object_of(*state.to_collider) : nb::none();
    values["break_force"] = state.break_force;
    values["point"] = tuple_of(state.point);
    values["force"] = tuple_of(state.force);
    values["moment"] = tuple_of(state.moment);
    values["largest_force"] = state.largest_force;
    values["error"] = state.error;
    values["nodes"] = array_of<Index>(std::span<const Index>(node));
    values["node_forces"] = array_of(force);
    values["node_errors"] = array_of<Real>(std::span<const Real>(error));
    values["broken"] = array_of<Real>(std::span<const Real>(broken));
    return values;
}

nb::dict settings_of_tie(World& world, const TieHandle& tie) {
    const TieSettings settings = Ties(world).settings(tie);
    nb::dict values = python::values_of(settings);
    values["body"] = settings.body;
    values["nodes"] = array_of<Index>(std::span<const Index>(settings.nodes));
    values["to_body"] = settings.to_body ? object_of(*settings.to_body) : nb::none();
    values["to_collider"] = settings.to_collider ? object_of(*settings.to_collider) : nb::none();
    return values;
}

}  // namespace

void bind_ties(WorldClass& type) {
    bind_view<TieHandle>(type, "ties");
    type.def("add_tie", &add_tie, nb::arg("body"), nb::arg("nodes"), nb::arg("to_body").none(),
             nb::arg("to_collider").none(), nb::arg("given"))
        .def("tie_state", guarded([](World& world, const TieHandle& tie) { return values_of(Ties(world).state(tie)); }))
        .def("tie_settings", guarded(settings_of_tie))
        .def("set_break_force",
             guarded([](World& world, const TieHandle& tie, Real force) { Ties(world).set_break_force(tie, force); }));
}

}  // namespace skerry::python
