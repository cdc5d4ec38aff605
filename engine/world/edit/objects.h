// The kinds of objects that have a view (skerry/object_view.h): tables, handles and nouns.
#pragma once

#include <string>

#include "engine/world/state/model.h"
#include "skerry/cable.h"
#include "skerry/cavity.h"
#include "skerry/fibre.h"
#include "skerry/joint.h"
#include "skerry/load.h"
#include "skerry/spring.h"
#include "skerry/tie.h"

namespace skerry {

template <auto table_member, auto handles_member>
struct ObjectColumns {
    static auto& table(auto& model) { return model.*table_member; }
    static auto& handles(auto& model) { return model.*handles_member; }
};

/// For each type of handle: table and handles of its objects, and a noun for these objects.
template <class HandleType>
struct ObjectsOf;
template <>
struct ObjectsOf<JointHandle> : ObjectColumns<&Model::joints, &Model::joint_map> {
    static constexpr const char* noun = "joint";
};
template <>
struct ObjectsOf<TieHandle> : ObjectColumns<&Model::ties, &Model::tie_map> {
    static constexpr const char* noun = "tie";
};
template <>
struct ObjectsOf<CableHandle> : ObjectColumns<&Model::cables, &Model::cable_map> {
    static constexpr const char* noun = "cable";
};
template <>
struct ObjectsOf<CavityHandle> : ObjectColumns<&Model::cavities, &Model::cavity_map> {
    static constexpr const char* noun = "cavity";
};
template <>
struct ObjectsOf<PipeHandle> : ObjectColumns<&Model::pipes, &Model::pipe_map> {
    static constexpr const char* noun = "pipe";
};
template <>
struct ObjectsOf<FibreHandle> : ObjectColumns<&Model::fibres, &Model::fibre_map> {
    static constexpr const char* noun = "fibres";
};
template <>
struct ObjectsOf<LoadHandle> : ObjectColumns<&Model::loads, &Model::load_map> {
    static constexpr const char* noun = "load";
};
template <>
struct ObjectsOf<SpringHandle> : ObjectColumns<&Model::springs, &Model::spring_map> {
    static constexpr const char* noun = "spring";
};
template <>
struct ObjectsOf<SurfaceSetHandle> : ObjectColumns<&Model::surface_sets, &Model::surface_set_map> {
    static constexpr const char* noun = "surface_set";
};

/// Handles of all objects of a kind, in the order of their rows.
template <class HandleType>
std::vector<HandleType> handles_of(const Model& model) {
    std::vector<HandleType> handles;
    for (const std::uint32_t slot : ObjectsOf<HandleType>::table(model).slot)
        handles.push_back(ObjectsOf<HandleType>::handles(model).handle_of_slot(slot));
    return handles;
}

/// Name of an object. Without a given name, it is made of the noun and the handle slot, such as "joint_3".
template <class HandleType>
std::string object_name(const Model& model, HandleType object) {
    const auto& names = ObjectsOf<HandleType>::handles(model).names;
    const auto given = names.find(object);
    return given != names.end() ? given->second : ObjectsOf<HandleType>::noun + ("_" + std::to_string(object.slot));
}

// Each of the following functions is called before an object is removed. `object`: a live handle.

/// Switches the collisions of the two joined objects on again, unless another row of the same table (joints or ties)
/// keeps them off.
void prepare_removal(World& world, JointHandle joint);
void prepare_removal(World& world, TieHandle tie);
/// Removes the pipes of a cavity.
void prepare_removal(World& world, CavityHandle cavity);
/// Wakes the body on which the load acts, or all bodies if the load acts on all.
void prepare_removal(World& world, LoadHandle load);

}  // namespace skerry
