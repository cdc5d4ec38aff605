// Keys of anchors in a scene file.
#include "engine/scene/scene_rules.h"

namespace skerry {

template <>
const Rule<AnchorEntry>& rule_of<AnchorEntry>() {
    static const auto rule =
        Rule<AnchorEntry>("anchor", "A point that is fixed to a body, to a collider, or to the world.")
            .key("body", &AnchorEntry::body, {.meaning = "name of a body"})
            .key("collider", &AnchorEntry::collider, {.meaning = "name of a collider"})
            .key("point", &AnchorEntry::point,
                 {.meaning = "position in the own frame of the mesh, the round body or the collider; without body and "
                             "collider: in the world",
                  .unit = "m"})
            .at_most_one({"body", "collider"});
    return rule;
}

}  // namespace skerry
