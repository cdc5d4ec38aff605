// Springs, and the anchors at which they act.
#include "skerry/spring.h"

#include "engine/python/read_settings.h"
#include "engine/python/world/parts.h"

namespace skerry::python {

namespace {

Anchor make_anchor(std::optional<BodyHandle> body, std::optional<ColliderHandle> collider,
                   const std::array<Real, 3>& point) {
    return {.body = body, .collider = collider, .point = {point[0], point[1], point[2]}};
}

nb::object handle_of(const auto& handle) {
    return handle ? object_of(*handle) : nb::none();
}

SpringHandle add_spring(WorldObject& object, const Anchor& first, const Anchor& second, nb::handle settings_object) {
    Use use(object);
    SpringSettings settings;
    read(settings_object, settings);
    settings.first = first;
    settings.second = second;
    return Springs(object.world).add(settings);
}

nb::dict values_of(const SpringState& state) {
    nb::dict values;
    values["first"] = state.first;
    values["second"] = state.second;
    values["length"] = state.length;
    values["rate"] = state.rate;
    values["rest_length"] = state.rest_length;
    values["force"] = state.force;
    values["energy"] = state.energy;
    return values;
}

nb::dict settings_of_spring(World& world, const SpringHandle& spring) {
    const SpringSettings settings = Springs(world).settings(spring);
    nb::dict values = python::values_of(settings);
    values["first"] = settings.first;
    values["second"] = settings.second;
    return values;
}

}  // namespace

void bind_anchors(nb::module_& module) {
    nb::class_<Anchor>(module, "Anchor").def_prop_ro("values", [](const Anchor& anchor) {
        return nb::make_tuple(handle_of(anchor.body), handle_of(anchor.collider), tuple_of(anchor.point));
    });
    module.def("anchor", &make_anchor, nb::arg("body").none(), nb::arg("collider").none(), nb::arg("point"));
}

void bind_springs(WorldClass& type) {
    bind_view<SpringHandle>(type, "springs");
    type.def("add_spring", &add_spring, nb::arg("first"), nb::arg("second"), nb::arg("given"))
        .def("spring_state",
             guarded([](World& world, const SpringHandle& spring) { return values_of(Springs(world).state(spring)); }))
        .def("spring_settings", guarded(settings_of_spring))
        .def("set_second", guarded([](World& world, const SpringHandle& spring, const Anchor& anchor) {
                 Springs(world).set_second(spring, anchor);
             }))
        .def("set_rest_length",
             guarded([](World& world, const SpringHandle& spring, const std::vector<std::array<Real, 2>>& pairs) {
                 Springs(world).set_rest_length(spring, table_of(pairs));
             }))
        .def("set_stiffness", guarded([](World& world, const SpringHandle& spring, Real stiffness) {
                 Springs(world).set_stiffness(spring, stiffness);
             }))
        .def("set_damping", guarded([](World& world, const SpringHandle& spring, Real damping) {
                 Springs(world).set_damping(spring, damping);
             }));
}

}  // namespace skerry::python
