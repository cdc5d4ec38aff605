#include "engine/world/ranks/rows/put_record.h"

#include <cstddef>
#include <utility>

namespace skerry {

namespace {

/// Calls visit(member) for all members of a record that ranks send, except for its sets.
void for_each_sent(auto& record, auto&& visit) {
    visit(record.name);
    visit(record.element);
    visit(record.requested_element);
    visit(record.tetrahedra);
    visit(record.surface);
    visit(record.tetrahedron_material);
    visit(record.label);
    visit(record.element_tetrahedra.offset);
    visit(record.element_tetrahedra.item);
    visit(record.settled);
    visit(record.start);
    visit(record.built);
    visit(record.mesh_shape);
    visit(record.given_mass);
    visit(record.choice);
}

void for_each_list(auto& set, auto&& visit) {
    visit(set.nodes);
    visit(set.faces);
    visit(set.tetrahedra);
}

}  // namespace

void put_record(const BodyRecord& record, RankMessage& message) {
    const auto put = [&](const auto& member) { put_value(member, message); };
    for_each_sent(record, put);
    put(record.sets.size());
    for (const auto& [name, set] : record.sets) {
        put(name);
        for_each_list(set, put);
    }
}

BodyRecord take_record(MailReader& message) {
    BodyRecord record{};
    const auto take = [&](auto& member) { take_value(message, member); };
    for_each_sent(record, take);
    for (auto count = message.take<std::size_t>(); count > 0; --count) {
        std::string name;
        take(name);
        for_each_list(record.sets[name], take);
    }
    return record;
}

BodyRecord record_of_name(std::string name) {
    BodyRecord record{};
    record.name = std::move(name);
    return record;
}

}  // namespace skerry
