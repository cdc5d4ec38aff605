// Keys of ties in a scene file.
#include "engine/scene/scene_rules.h"

namespace skerry {

template <>
const Rule<TieEntry>& rule_of<TieEntry>() {
    using Entry = TieEntry;
    static const auto rule =
        Rule<Entry>("tie",
                    "A tie between nodes of a deformable body and another body, a collider or the world. Each node is "
                    "tied in its position at the start to the nearest point of the other object.")
            .key("name", &Entry::name, {.meaning = "name in messages and for probes; default: tie_NUMBER"})
            .key("kind", &Entry::kind,
                 {.meaning = "motion of a node relative to its point. weld (default): none; slide: in the plane of the "
                             "surface; ball: any, but the mean point of all nodes, weighted by their masses, is tied"})
            .key("body", &Entry::body, {.meaning = "name of a deformable body", .required = true})
            .key("set", &Entry::set, part_set_doc)
            .key("box", &Entry::box, part_box_doc)
            .key("nodes", &Entry::nodes, part_nodes_doc)
            .key("to_body", &Entry::to_body, {.meaning = "name of the other body"})
            .key("to_collider", &Entry::to_collider,
                 {.meaning = "name of a collider; without to_body and to_collider, the nodes are tied to the world"})
            .key("break_force", &Entry::break_force,
                 {.meaning = "force at which a node breaks off; default: none", .unit = "N", .limits = above(0)})
            .key("close_gap", &Entry::close_gap,
                 {.meaning = "whether nodes move to the surface, at recovery_speed; default: false, they keep their "
                             "distance"})
            .key("bodies_touch", &Entry::bodies_touch,
                 {.meaning = "whether the two objects can touch each other while a node is tied; default: false"})
            .exactly_one({"set", "box", "nodes"})
            .at_most_one({"to_body", "to_collider"});
    return rule;
}

}  // namespace skerry
