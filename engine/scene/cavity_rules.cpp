// Keys of cavities and pipes in a scene file.
#include "engine/scene/scene_rules.h"

namespace skerry {

template <>
const Rule<GasFilling>& rule_of<GasFilling>() {
    static const auto rule =
        Rule<GasFilling>("gas", "A gas with p V^exponent = const while its mass is constant.")
            .key("pressure", &GasFilling::pressure,
                 {.meaning = "pressure above ambient at the start; default: 0", .unit = "Pa"})
            .key("exponent", &GasFilling::exponent,
                 {.meaning = "polytropic exponent; 1: isothermal; default: 1.4, adiabatic air", .limits = at_least(1)})
            .key(
                "ambient", &GasFilling::ambient,
                {.meaning = "absolute pressure outside of the body; default: 101325", .unit = "Pa", .limits = above(0)})
            .key("density", &GasFilling::density,
                 {.meaning = "density at ambient pressure; default: 1.204", .unit = "kg/m^3", .limits = above(0)})
            .key("inflow", &GasFilling::inflow,
                 {.meaning = "flow of gas into the cavity, negative to draw gas out: a number, or pairs [time, flow] "
                             "with times in s; default: 0",
                  .unit = "kg/s"});
    return rule;
}

template <>
const Rule<LiquidFilling>& rule_of<LiquidFilling>() {
    static const auto rule =
        Rule<LiquidFilling>("liquid",
                            "A liquid whose volume is prescribed, as by a syringe. A smaller bulk modulus allows "
                            "longer steps.")
            .key("bulk_modulus", &LiquidFilling::bulk_modulus,
                 {.meaning = "bulk modulus; default: 2.2e9, water", .unit = "Pa", .limits = above(0)})
            .key("volume", &LiquidFilling::volume,
                 {.meaning = "volume of the liquid at ambient pressure: a number, or pairs [time, volume] with times "
                             "in s; default: the volume of the cavity at the start",
                  .unit = "m^3"})
            .key("ambient", &LiquidFilling::ambient,
                 {.meaning = "absolute pressure outside of the body; default: 101325",
                  .unit = "Pa",
                  .limits = at_least(0)});
    return rule;
}

template <>
const Rule<CavityEntry>& rule_of<CavityEntry>() {
    using Entry = CavityEntry;
    static const auto rule =
        Rule<Entry>("cavity",
                    "Faces of a body under one pressure. Default: the walls of all hollows inside of the body, or the "
                    "whole surface of a body without hollows.")
            .key("name", &Entry::name, {.meaning = "name for pipes and probes; default: cavity_NUMBER"})
            .key("body", &Entry::body, {.meaning = "name of the body", .required = true})
            .key("set", &Entry::set, part_set_doc)
            .key("box", &Entry::box, part_box_doc)
            .key("nodes", &Entry::nodes, part_nodes_doc)
            .key("pressure", &Entry::pressure,
                 {.meaning = "prescribed pressure above ambient: a number, or pairs [time, pressure] with times in s",
                  .unit = "Pa"})
            .key("gas", &Entry::gas, {.meaning = "gas in the cavity"})
            .key("liquid", &Entry::liquid, {.meaning = "liquid in the cavity"})
            .key("volume", &Entry::volume,
                 {.meaning = "volume of the gas or liquid at the start, only for faces that do not enclose a volume, "
                             "as those of a piston",
                  .unit = "m^3",
                  .limits = above(0)})
            .at_most_one({"set", "box", "nodes"})
            .exactly_one({"pressure", "gas", "liquid"});
    return rule;
}

template <>
const Rule<PipeEntry>& rule_of<PipeEntry>() {
    static const auto rule =
        Rule<PipeEntry>("pipe", "A pipe between two cavities with the same gas, or between a cavity and a reservoir.")
            .key("name", &PipeEntry::name, {.meaning = "name for sliders; default: pipe_NUMBER"})
            .key("first", &PipeEntry::first, {.meaning = "name of a cavity", .required = true})
            .key("second", &PipeEntry::second, {.meaning = "name of another cavity; default: a reservoir"})
            .key("conductance", &PipeEntry::conductance,
                 {.meaning = "mass flow divided by the pressure difference",
                  .unit = "kg/(s Pa)",
                  .limits = at_least(0),
                  .required = true})
            .key("pressure", &PipeEntry::pressure,
                 {.meaning = "pressure of the reservoir above ambient: a number, or pairs [time, pressure] with times "
                             "in s; default: 0, the atmosphere",
                  .unit = "Pa"})
            .at_most_one({"second", "pressure"});
    return rule;
}

}  // namespace skerry
