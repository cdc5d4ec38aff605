// Keys of springs in a scene file.
#include "engine/scene/scene_rules.h"

namespace skerry {

template <>
const Rule<SpringEntry>& rule_of<SpringEntry>() {
    using Entry = SpringEntry;
    static const auto rule =
        Rule<Entry>("spring",
                    "A spring, a damper, or both in parallel, between two points. At least one must be on a body.")
            .key("name", &Entry::name, {.meaning = "name for probes; default: spring_NUMBER"})
            .key("first", &Entry::first, {.meaning = "first point", .required = true})
            .key("second", &Entry::second, {.meaning = "second point", .required = true})
            .key("stiffness", &Entry::stiffness,
                 {.meaning = "stiffness; default: 0", .unit = "N/m", .limits = at_least(0)})
            .key("damping", &Entry::damping,
                 {.meaning = "force of the damper per rate of the length; default: 0",
                  .unit = "N s/m",
                  .limits = at_least(0)})
            .key("rest_length", &Entry::rest_length,
                 {.meaning = "length without elastic force: a number, or pairs [time, length] between which it changes "
                             "linearly; default: the length at the start",
                  .unit = "m",
                  .limits = at_least(0)})
            .key("only", &Entry::only,
                 {.meaning = "side on which the spring and its damper act. both (default); tension: only while it is "
                             "longer than its rest length; compression: only while it is shorter"})
            .key("strength", &Entry::strength,
                 {.meaning = "largest force; default: unlimited", .unit = "N", .limits = above(0)});
    return rule;
}

}  // namespace skerry
