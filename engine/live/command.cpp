#include "engine/live/command.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "engine/base/complaint.h"
#include "skerry/error.h"

namespace skerry {

namespace {

using CommandJson = nlohmann::json;

/// The beginning of a value as JSON, for messages.
std::string short_dump(const CommandJson& value) {
    return value.dump(-1, ' ', false, CommandJson::error_handler_t::replace).substr(0, 60);
}

[[noreturn]] void refuse_value(const std::string& field, const CommandJson& found, const std::string& expected) {
    refuse("command", field, short_dump(found), expected);
}

Real number_from(const std::string& field, const CommandJson& value) {
    if (!value.is_number() || !std::isfinite(value.get<Real>())) refuse_value(field, value, "a number");
    return value.get<Real>();
}

std::uint64_t count_from(const std::string& field, const CommandJson& value) {
    if (!value.is_number_unsigned()) refuse_value(field, value, "a whole number of at least 0");
    return value.get<std::uint64_t>();
}

Vec3 point_from(const std::string& field, const CommandJson& value) {
    if (!value.is_array() || value.size() != 3) refuse_value(field, value, "three coordinates [m]");
    return {number_from(field, value[0]), number_from(field, value[1]), number_from(field, value[2])};
}

bool on_from(const std::string& field, const CommandJson& value) {
    if (!value.is_boolean()) refuse_value(field, value, "true or false");
    return value.get<bool>();
}

FrameContent content_from(const std::string& field, const CommandJson& value) {
    static const std::map<CommandJson, FrameContent> known{{"speed", FrameContent::motion},
                                                           {"stress", FrameContent::node_fields},
                                                           {"strain", FrameContent::node_fields},
                                                           {"error", FrameContent::mesh_error}};
    FrameContent content = FrameContent::motion;
    if (!value.is_array() || !std::ranges::all_of(value, [](const auto& name) { return known.contains(name); }))
        refuse_value(field, value, "a list of speed, stress, strain and error");
    for (const CommandJson& name : value) content = std::max(content, known.at(name));
    return content;
}

/// A member of a command, and the function that reads it.
struct CommandMember {
    const char* name;
    void (*read)(const std::string& field, const CommandJson& value, LiveCommand& command);
};

/// Sets a member of `command` to the result of the function `read`.
template <auto member, auto read>
void read_to(const std::string& field, const CommandJson& value, LiveCommand& command) {
    command.*member = read(field, value);
}

/// JSON members that a command with this action must have besides "do". No others are allowed.
std::vector<CommandMember> members_of(LiveAction action) {
    constexpr CommandMember number{"number", read_to<&LiveCommand::number, count_from>},
        value{"value", read_to<&LiveCommand::value, number_from>}, on{"on", read_to<&LiveCommand::on, on_from>},
        names{"names", read_to<&LiveCommand::content, content_from>},
        body{"body", read_to<&LiveCommand::body_number, count_from>},
        point{"point", read_to<&LiveCommand::point, point_from>}, to{"to", read_to<&LiveCommand::to, point_from>};
    switch (action) {
        case LiveAction::seen:
            return {number};
        case LiveAction::fields:
            return {names};
        case LiveAction::rate:
            return {value};
        case LiveAction::gravity:
            return {on};
        case LiveAction::slider:
            return {number, value};
        case LiveAction::pull:
            return {body, point, to};
        case LiveAction::move:
            return {to};
        case LiveAction::play:
        case LiveAction::pause:
        case LiveAction::step:
        case LiveAction::reset:
        case LiveAction::release:
            return {};
    }
    return {};
}

}  // namespace

LiveCommand read_command(std::string_view text) {
    const CommandJson json = CommandJson::parse(text, nullptr, false);
    if (!json.is_object())
        refuse("command", "", text.empty() ? "nothing" : std::string(text.substr(0, 60)),
               "a JSON object such as {\"do\":\"play\"}");
    const CommandJson& name = json.contains("do") ? json["do"] : CommandJson();
    const auto action = name.is_string() ? from_name<LiveAction>(name.get<std::string>()) : std::nullopt;
    if (!action) {
        std::vector<std::string> known;
        std::string list;
        for (const auto& row : EnumNames<LiveAction>::table) {
            known.emplace_back(row.second);
            list += (list.empty() ? "" : ", ") + known.back();
        }
        refuse("command", "do", short_dump(name), "one of " + list,
               name.is_string() ? nearest_hint(name.get<std::string>(), known) : "");
    }
    LiveCommand command{.action = *action};
    const std::vector<CommandMember> members = members_of(*action);
    for (const CommandMember& member : members) {
        if (!json.contains(member.name)) refuse("command", member.name, "nothing", "a value");
        member.read(member.name, json[member.name], command);
    }
    if (json.size() != members.size() + 1)
        for (const auto& [key, unused] : json.items())
            if (key != "do" && std::ranges::find(members, key, &CommandMember::name) == members.end())
                refuse("command", key, "an unknown member", "only the members of \"" + name.get<std::string>() + "\"");
    return command;
}

}  // namespace skerry
