// Keys of probes in a scene file, and the keys that each quantity accepts.
#include <algorithm>

#include "engine/scene/scene_rules.h"

namespace skerry {

namespace {

KeysOfKind keys_of(ProbeQuantity quantity) {
    switch (quantity) {
        case ProbeQuantity::contacts:
            return {{"body"}, {"box", "set"}};
        case ProbeQuantity::motion:
            return {{"body"}, {"point"}};
        case ProbeQuantity::force:
            return {{}, {"body", "collider", "by"}};
        case ProbeQuantity::reaction:
            return {{"body"}, {"pin"}};
        case ProbeQuantity::joint:
            return {{"joint"}, {}};
        case ProbeQuantity::tie:
            return {{"tie"}, {}};
        case ProbeQuantity::cable:
            return {{"cable"}, {}};
        case ProbeQuantity::spring:
            return {{"spring"}, {}};
        case ProbeQuantity::energy:
            return {{}, {}};
        case ProbeQuantity::stress:
            return {{"body"}, {"box", "set"}};
        case ProbeQuantity::cavity:
            return {{"cavity"}, {}};
        case ProbeQuantity::volume:
            return {{"body"}, {}};
    }
    return {};
}

void check_keys(const Place& place, const ProbeEntry& probe) {
    const std::vector<std::pair<std::string, bool>> given{
        {"body", probe.body.has_value()},     {"collider", probe.collider.has_value()},
        {"by", probe.by.has_value()},         {"box", probe.box.has_value()},
        {"point", probe.point.has_value()},   {"pin", probe.pin.has_value()},
        {"joint", probe.joint.has_value()},   {"set", probe.set.has_value()},
        {"cable", probe.cable.has_value()},   {"cavity", probe.cavity.has_value()},
        {"spring", probe.spring.has_value()}, {"tie", probe.tie.has_value()}};
    check_keys_of_kind(place, "the quantity " + in_quotes(name_of(probe.quantity)), keys_of(probe.quantity), given,
                       "only the keys \"name\" and \"quantity\"");
    if (probe.quantity == ProbeQuantity::force && probe.body.has_value() == probe.collider.has_value())
        place.refuse(probe.body ? "both \"body\" and \"collider\"" : "neither \"body\" nor \"collider\"",
                     "exactly one of the two keys, which names the object on which the force acts");
    const bool odd = std::ranges::any_of(
        probe.name, [](char c) { return c == '/' || static_cast<unsigned char>(c) < ' ' || c == 127; });
    if (probe.quantity != ProbeQuantity::contacts && (odd || probe.name == "." || probe.name == "time"))
        place.key("name").refuse(in_quotes(probe.name),
                                 "a name other than \"time\" and \".\", without / and control characters, because "
                                 "column headings contain the name");
}

}  // namespace

template <>
const Rule<ProbeEntry>& rule_of<ProbeEntry>() {
    using P = ProbeEntry;
    static const auto rule =
        Rule<P>("probe",
                "A recorded quantity. The quantity \"contacts\" describes the contacts of a part of a body and goes to "
                "the report: sticking or sliding, number of changes, slip speed. All other quantities are time series, "
                "which --probes writes (docs/outputs.md).")
            .key("name", &P::name, {.meaning = "name in the report and in column headings", .required = true})
            .key("quantity", &P::quantity,
                 {.meaning = "recorded quantity: contacts (default); motion of a point or of the centre of mass; force "
                             "of contacts on a body or a collider; reaction of a pin; coordinate and forces of a "
                             "joint; force, moment and error of a tie; tensions and length of a cable; energy of the "
                             "world; largest "
                             "stress; smallest ratio of current volume to rest volume; pressure, volume, gas mass, "
                             "energy and force of a cavity; length, force and energy of a spring"})
            .key("body", &P::body, {.meaning = "name of a body"})
            .key("collider", &P::collider, {.meaning = "for a force: name of the collider on which it acts"})
            .key("by", &P::by,
                 {.meaning = "for a force: name of the body or collider that exerts the force; default: all bodies and "
                             "colliders"})
            .key("joint", &P::joint, {.meaning = "for a joint: name of the joint"})
            .key("tie", &P::tie, {.meaning = "for a tie: name of the tie"})
            .key("cable", &P::cable, {.meaning = "for a cable: name of the cable"})
            .key("cavity", &P::cavity, {.meaning = "for a cavity: name of the cavity"})
            .key("spring", &P::spring, {.meaning = "for a spring: name of the spring"})
            .key("box", &P::box,
                 {.meaning = "box around the recorded nodes, in the mesh's own frame; default for a stress: all nodes"})
            .key("set", &P::set, {.meaning = "set of the body that contains the recorded nodes, instead of \"box\""})
            .key("point", &P::point,
                 {.meaning = "for a motion: recorded point, in the mesh's own frame; default: the centre of mass",
                  .unit = "m"})
            .key("pin", &P::pin,
                 {.meaning = "for a reaction: number of the pin of the body, counted from 0; default: the first pin",
                  .limits = at_least(0)})
            .at_most_one({"box", "set"})
            .check(check_keys);
    return rule;
}

}  // namespace skerry
