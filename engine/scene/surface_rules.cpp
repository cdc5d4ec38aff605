// Keys of friction by pair of materials in a scene file.
#include "engine/scene/scene_rules.h"

namespace skerry {

template <>
const Rule<PairEntry>& rule_of<PairEntry>() {
    using Entry = PairEntry;
    static const auto rule =
        Rule<Entry>("pair",
                    "Surface properties of contacts between two materials. They take precedence over the properties of "
                    "materials, bodies and colliders.")
            .key("materials", &Entry::materials,
                 {.meaning = "names of the two materials, in any order. A collider has a material if it names one",
                  .required = true})
            .key("friction", &Entry::friction,
                 {.meaning = "friction coefficient; default: the geometric mean of both surfaces",
                  .alias = "mu",
                  .limits = at_least(0)})
            .key("static_friction", &Entry::static_friction,
                 {.meaning = "friction coefficient of sticking contacts", .limits = at_least(0)})
            .key("dynamic_friction", &Entry::dynamic_friction,
                 {.meaning = "friction coefficient of sliding contacts", .limits = at_least(0)})
            .key("restitution", &Entry::restitution,
                 {.meaning = "coefficient of restitution; default: the larger value of both surfaces",
                  .limits = within(0, 1)})
            .together({"static_friction", "dynamic_friction"})
            .at_most_one({"friction", "static_friction"})
            .at_most_one({"mu", "static_friction"})
            .check([](const Place& place, const Entry& pair) {
                if (pair.static_friction && *pair.dynamic_friction > *pair.static_friction)
                    place.key("dynamic_friction")
                        .refuse(Json(*pair.dynamic_friction).dump(),
                                "at most the value of \"static_friction\", " + Json(*pair.static_friction).dump());
            });
    return rule;
}

}  // namespace skerry
