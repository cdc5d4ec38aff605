// Keys of contacts in a scene file: friction for pairs of materials and for parts of surfaces, and objects that do not
// collide.
#include "engine/scene/scene_rules.h"

namespace skerry {

template <>
const Rule<SurfaceEntry>& rule_of<SurfaceEntry>() {
    using Entry = SurfaceEntry;
    static const auto rule = [] {
        auto made = Rule<Entry>("surface",
                                "A part of the surface of a body with its own friction and restitution. They take "
                                "precedence over \"pairs\". A set of faces also contains their edges and nodes; nodes "
                                "also contain the edges and faces between them.");
        made.key("set", &Entry::set, part_set_doc)
            .key("box", &Entry::box, part_box_doc)
            .key("nodes", &Entry::nodes, part_nodes_doc)
            .exactly_one({"set", "box", "nodes"});
        add_surface_keys(
            made, {.meaning = "friction coefficient; default: that of the body", .alias = "mu", .limits = at_least(0)},
            {.meaning = "coefficient of restitution; default: that of the body", .limits = within(0, 1)});
        made.key("friction_across", &Entry::friction_across,
                 {.meaning = "friction coefficient of sliding contacts across \"direction\". The friction then applies "
                             "along it; default: the same in all directions",
                  .limits = above(0)})
            .key("direction", &Entry::direction,
                 {.meaning = "direction in the mesh's own frame, which rotates with the faces"})
            .together({"friction_across", "direction"});
        return made;
    }();
    return rule;
}

template <>
const Rule<PairEntry>& rule_of<PairEntry>() {
    using Entry = PairEntry;
    static const auto rule = [] {
        auto made = Rule<Entry>("pair",
                                "Surface properties of contacts between two materials. They take precedence over the "
                                "properties of materials, bodies and colliders.");
        made.key("materials", &Entry::materials,
                 {.meaning = "names of the two materials, in any order. A collider has a material if it names one",
                  .required = true});
        add_surface_keys(made,
                         {.meaning = "friction coefficient; default: the geometric mean of both surfaces",
                          .alias = "mu",
                          .limits = at_least(0)},
                         {.meaning = "coefficient of restitution; default: the larger value of both surfaces",
                          .limits = within(0, 1)});
        return made;
    }();
    return rule;
}

template <>
const Rule<NoCollisionEntry>& rule_of<NoCollisionEntry>() {
    using Entry = NoCollisionEntry;
    static const auto rule =
        Rule<Entry>("no_collision", "Two objects that do not collide with each other.")
            .key("body", &Entry::body, {.meaning = "name of a body", .required = true})
            .key("to_body", &Entry::to_body, {.meaning = "name of another body"})
            .key("to_collider", &Entry::to_collider, {.meaning = "name of a collider"})
            .exactly_one({"to_body", "to_collider"})
            .check([](const Place& place, const Entry& entry) {
                if (entry.to_body == entry.body)
                    place.key("to_body").refuse(in_quotes(entry.body) + ", the name under \"body\"",
                                                "another body; \"self_contact\" of a body is for the body itself");
            });
    return rule;
}

}  // namespace skerry
