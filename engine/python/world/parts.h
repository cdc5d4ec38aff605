// Declares the functions that bind the methods of the Python class World, one function per group of methods.
#pragma once

#include "engine/python/world_object.h"
#include "skerry/cable.h"
#include "skerry/joint.h"
#include "skerry/load.h"
#include "skerry/report.h"
#include "skerry/spring.h"
#include "skerry/tie.h"

namespace skerry::python {

using WorldClass = nb::class_<WorldObject>;

void bind_building(WorldClass& type);
void bind_advance(WorldClass& type);
void bind_state(WorldClass& type);
void bind_control(WorldClass& type);
void bind_joints(WorldClass& type);
void bind_cables(WorldClass& type);
void bind_surface(WorldClass& type);
void bind_ties(WorldClass& type);
void bind_cavities(WorldClass& type);
void bind_fibres(WorldClass& type);
void bind_loads(WorldClass& type);
void bind_sets(WorldClass& type);
void bind_springs(WorldClass& type);
void bind_anchors(nb::module_& module);
void bind_views(WorldClass& type);
void bind_visuals(WorldClass& type);
void bind_results(WorldClass& type);

/// Binds the methods that are common to all kinds of objects with an ObjectView (skerry/object_view.h), such as joints.
/// `list`: name of the Python method that returns the handles of all objects of the kind.
template <class HandleType>
void bind_view(WorldClass& type, const char* list) {
    using View = ObjectView<HandleType>;
    type.def(list, guarded([](World& world) { return View(world).all(); }))
        .def("remove", guarded([](World& world, const HandleType& object) { View(world).remove(object); }))
        .def("alive", guarded([](World& world, const HandleType& object) { return View(world).alive(object); }))
        .def("name", guarded([](World& world, const HandleType& object) { return View(world).name(object); }))
        .def("set_name", guarded([](World& world, const HandleType& object, const std::string& name) {
                 View(world).set_name(object, name);
             }));
}

/// Dictionary of the members of a report or another struct, with their names as keys.
nb::dict values_of(const StepReport& report);
nb::dict values_of(const StepProblem& step);
nb::dict values_of(const WorldReport& report);
nb::dict values_of(const Energy& energy);
nb::dict values_of(const DynamicsEstimate& estimate);

/// The handle as a Python object; None for a default-constructed handle, which names no object.
template <class HandleType>
nb::object object_of(const HandleType& handle) {
    return handle == HandleType{} ? nb::none() : nb::cast(handle);
}

inline nb::tuple tuple_of(const Vec3& vector) {
    return nb::make_tuple(vector.x(), vector.y(), vector.z());
}

}  // namespace skerry::python
