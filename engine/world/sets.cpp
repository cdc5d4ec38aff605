#include "skerry/sets.h"

#include <utility>

#include "engine/base/complaint.h"
#include "engine/mesh/sets.h"
#include "engine/world/validate.h"
#include "engine/world/world_state.h"

namespace skerry {

namespace {

BodyRecord& record_of(World& world, BodyHandle body, const char* call) {
    WorldState& state = WorldAccess::state_of(world);
    state.settle();
    return state.model.body_records[static_cast<std::size_t>(state.model.row(body, call))];
}

std::string body_title(const BodyRecord& record) {
    return "body '" + record.name + "'";
}

const MeshSet& set_of(const BodyRecord& record, const std::string& name) {
    const auto found = record.sets.find(name);
    if (found == record.sets.end()) {
        const std::vector<std::string> names = mesh::names_of(record.sets);
        refuse(body_title(record), "set", '"' + name + '"', mesh::expected_set(names), nearest_hint(name, names));
    }
    return found->second;
}

/// Returns `numbers`, the faces or tetrahedra of a set. Throws SceneError if there are none.
template <class Numbers>
Numbers require_any(Numbers numbers, const BodyRecord& record, const std::string& name, const char* kind) {
    if (numbers.empty())
        refuse(body_title(record), "set", "the set \"" + name + "\", which contains no " + kind,
               std::string("a set with at least one ") + kind);
    return numbers;
}

}  // namespace

std::vector<std::string> Sets::names(BodyHandle body) const {
    return mesh::names_of(record_of(*world_, body, "sets").sets);
}

const MeshSet& Sets::get(BodyHandle body, const std::string& name) const {
    return set_of(record_of(*world_, body, "sets"), name);
}

void Sets::add(BodyHandle body, const std::string& name, MeshSet set) {
    WorldState& state = WorldAccess::state_of(*world_);
    state.require_between_steps("add_set");
    BodyRecord& record = record_of(*world_, body, "add_set");
    if (name.empty()) refuse(body_title(record), "set", "an empty name", "a name");
    if (record.sets.contains(name))
        refuse(body_title(record), "set", '"' + name + "\", which is already the name of a set", "a different name");
    if (set.empty()) refuse(body_title(record), "set", "the empty set \"" + name + '"', "at least one node");
    const Index nodes = state.model.bodies.nodes[static_cast<std::size_t>(state.model.row(body, "add_set"))].size();
    mesh::require_set(body_title(record), name, set, static_cast<std::size_t>(nodes), record.tetrahedra,
                      record.surface);
    mesh::tidy(set);
    record.sets.emplace(name, std::move(set));
}

void Sets::remove(BodyHandle body, const std::string& name) {
    WorldAccess::state_of(*world_).require_between_steps("remove_set");
    BodyRecord& record = record_of(*world_, body, "remove_set");
    set_of(record, name);
    record.sets.erase(name);
}

std::vector<Index> Sets::nodes(BodyHandle body, const std::string& name) const {
    const BodyRecord& record = record_of(*world_, body, "sets");
    return mesh::nodes_of(set_of(record, name), record.tetrahedra);
}

std::vector<std::array<Index, 3>> Sets::faces(BodyHandle body, const std::string& name) const {
    const BodyRecord& record = record_of(*world_, body, "sets");
    return require_any(mesh::faces_of(set_of(record, name), record.tetrahedra, record.surface), record, name, "face");
}

std::vector<Index> Sets::tetrahedra(BodyHandle body, const std::string& name) const {
    const BodyRecord& record = record_of(*world_, body, "sets");
    return require_any(mesh::tetrahedra_of(set_of(record, name), record.tetrahedra), record, name, "tetrahedron");
}

std::span<const int> Sets::labels(BodyHandle body) const {
    return record_of(*world_, body, "labels").label;
}

}  // namespace skerry
