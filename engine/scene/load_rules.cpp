// Keys of loads and force fields in a scene file, and the keys that each kind accepts.
#include "engine/scene/scene_rules.h"

namespace skerry {

namespace {

struct KeysOfLoad : KeysOfKind {
    bool has_part = false;  // true if the load acts on chosen nodes or faces of a body
};

KeysOfLoad keys_of_load(LoadKind kind) {
    switch (kind) {
        case LoadKind::force:
            return {{{"body", "force"}, {"scale"}}, true};
        case LoadKind::traction:
            return {{{"body", "traction"}, {"area", "scale"}}, true};
        case LoadKind::acceleration:
            return {{{"acceleration"}, {"body", "scale"}}};
        case LoadKind::gravity:
            return {{{"scale"}, {"body"}}};
        case LoadKind::drag:
            return {{{"rate"}, {"body", "wind", "scale"}}};
    }
    return {};
}

void check_load_keys(const Place& place, const LoadEntry& load) {
    KeysOfLoad keys = keys_of_load(load.kind);
    const std::vector<std::string> part{"set", "box", "nodes"};
    if (keys.has_part) keys.optional.insert(keys.optional.end(), part.begin(), part.end());
    const std::vector<std::pair<std::string, bool>> given{{"body", load.body.has_value()},
                                                          {"set", load.set.has_value()},
                                                          {"box", load.box.has_value()},
                                                          {"nodes", !load.nodes.empty()},
                                                          {"force", load.force.has_value()},
                                                          {"traction", load.traction.has_value()},
                                                          {"acceleration", load.acceleration.has_value()},
                                                          {"area", load.area.has_value()},
                                                          {"rate", load.rate.has_value()},
                                                          {"wind", load.wind.has_value()},
                                                          {"scale", load.scale.has_value()}};
    check_keys_of_kind(place, "a load of the kind " + in_quotes(name_of(load.kind)), keys, given);
    if (keys.has_part && !load.set && !load.box && load.nodes.empty())
        place.refuse("none of the keys " + listed(part), "one of them, to choose the part of the body that is loaded");
}

}  // namespace

template <>
const Rule<LoadEntry>& rule_of<LoadEntry>() {
    using Entry = LoadEntry;
    static const auto rule =
        Rule<Entry>("load", "A load on a part of a body, or a force field.")
            .key("name", &Entry::name, {.meaning = "name in messages and for sliders; default: load_NUMBER"})
            .key("kind", &Entry::kind,
                 {.meaning = "force: total force on nodes, shared in proportion to their masses; traction: force per "
                             "area of surface faces, in a fixed direction; acceleration: uniform acceleration; "
                             "gravity: factor of the weight; drag: force towards the velocity of a wind, in "
                             "proportion to mass and relative velocity",
                  .required = true})
            .key("body", &Entry::body, {.meaning = "name of the loaded body; default for fields: all bodies"})
            .key("set", &Entry::set, part_set_doc)
            .key("box", &Entry::box, part_box_doc)
            .key("nodes", &Entry::nodes, part_nodes_doc)
            .key("force", &Entry::force, {.meaning = "for a force: total force, in world axes", .unit = "N"})
            .key("traction", &Entry::traction,
                 {.meaning = "for a traction: force per area, in world axes", .unit = "Pa"})
            .key("area", &Entry::area,
                 {.meaning = "for a traction: reference (area in the rest shape; default) or present area"})
            .key("acceleration", &Entry::acceleration,
                 {.meaning = "for an acceleration: value, in world axes", .unit = "m/s^2"})
            .key("rate", &Entry::rate,
                 {.meaning = "for a drag: rate of the approach to the velocity of the wind",
                  .unit = "1/s",
                  .limits = above(0)})
            .key("wind", &Entry::wind, {.meaning = "for a drag: velocity of the wind; default: 0", .unit = "m/s"})
            .key("scale", &Entry::scale,
                 {.meaning = "factor of the load, for a drag of the wind: a number, or pairs [time, factor] with "
                             "times in s; default: 1"})
            .at_most_one({"set", "box", "nodes"})
            .check(check_load_keys);
    return rule;
}

}  // namespace skerry
