// Keys of cables in a scene file.
#include "engine/scene/scene_rules.h"

namespace skerry {

template <>
const Rule<CableEntry>& rule_of<CableEntry>() {
    using Entry = CableEntry;
    static const auto rule =
        Rule<Entry>(
            "cable",
            "A cable that runs straight from point to point and never pushes. It is drawn in and let out at its "
            "first point.")
            .key("name", &Entry::name, {.meaning = "name for probes; default: cable_NUMBER"})
            .key("points", &Entry::points,
                 {.meaning = "points through which the cable runs; at least two, and at least one on a body",
                  .required = true})
            .key("tension", &Entry::tension,
                 {.meaning = "tension between the first two points", .unit = "N", .limits = at_least(0)})
            .key("length", &Entry::length, {.meaning = "greatest length", .unit = "m", .limits = above(0)})
            .key("rate", &Entry::rate,
                 {.meaning = "rate of the greatest length, which is the length at the start; negative: the cable is "
                             "drawn in",
                  .unit = "m/s"})
            .key("friction", &Entry::friction,
                 {.meaning = "friction coefficient mu at the points between the first and the last; a cable that bends "
                             "by the angle theta slides if the ratio of the tensions is exp(mu theta); default: 0",
                  .limits = at_least(0)})
            .exactly_one({"tension", "length", "rate"});
    return rule;
}

}  // namespace skerry
