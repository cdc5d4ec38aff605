#include "skerry/object_view.h"

#include <algorithm>

#include "engine/world/edit/joining_rows.h"
#include "engine/world/edit/objects.h"
#include "engine/world/step/step.h"
#include "engine/world/validate.h"
#include "engine/world/world_state.h"

namespace skerry {

template <class HandleType>
void ObjectView<HandleType>::remove(HandleType object) {
    WorldState& world = WorldAccess::state_of(*world_);
    world.require_between_steps("remove");
    Model& model = world.model;
    const auto row = static_cast<std::size_t>(model.row(object, "remove"));
    if constexpr (requires { prepare_removal(*world_, object); }) prepare_removal(*world_, object);
    auto& table = ObjectsOf<HandleType>::table(model);
    std::vector<bool> removed(table.slot.size(), false);
    removed[row] = true;
    wake_and_erase_rows(removed, table, ObjectsOf<HandleType>::handles(model), model);
    model.links_open = true;
    note_forces(model);
    world.record.balance.close();  // the energy stored in a spring, or in the gas of a cavity, vanishes with it
}

template <class HandleType>
bool ObjectView<HandleType>::alive(HandleType object) const {
    return ObjectsOf<HandleType>::handles(WorldAccess::state_of(*world_).model).row(object) != no_index;
}

template <class HandleType>
std::vector<HandleType> ObjectView<HandleType>::all() const {
    return handles_of<HandleType>(WorldAccess::state_of(*world_).model);
}

template <class HandleType>
std::string ObjectView<HandleType>::name(HandleType object) const {
    const Model& model = WorldAccess::state_of(*world_).model;
    (void)model.row(object, "name");  // refuses a stale handle
    return object_name(model, object);
}

template <class HandleType>
void ObjectView<HandleType>::set_name(HandleType object, const std::string& name) {
    WorldState& world = WorldAccess::state_of(*world_);
    world.require_between_steps("set_name");
    (void)world.model.row(object, "set_name");
    ObjectsOf<HandleType>::handles(world.model).names[object] = name;
}

template <class HandleType>
HandleType ObjectView<HandleType>::find(const std::string& name) const {
    const Model& model = WorldAccess::state_of(*world_).model;
    const std::vector<HandleType> handles = handles_of<HandleType>(model);
    const auto has_name = [&](HandleType handle) { return object_name(model, handle) == name; };
    const auto found = std::ranges::find_if(handles, has_name);
    if (std::ranges::count_if(handles, has_name) == 1) return *found;
    std::string names;
    for (const HandleType handle : handles) names += (names.empty() ? "'" : ", '") + object_name(model, handle) + "'";
    const std::string noun = ObjectsOf<HandleType>::noun;
    refuse(noun, "name", "'" + name + "'" + (found == handles.end() ? "" : ", which several objects have"),
           names.empty() ? "the name of a " + noun + ", but the world has none" : "one of " + names);
}

template class ObjectView<JointHandle>;
template class ObjectView<TieHandle>;
template class ObjectView<CableHandle>;
template class ObjectView<CavityHandle>;
template class ObjectView<PipeHandle>;
template class ObjectView<FibreHandle>;
template class ObjectView<LoadHandle>;
template class ObjectView<SpringHandle>;
template class ObjectView<SurfaceSetHandle>;

}  // namespace skerry
