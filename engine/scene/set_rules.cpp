// Keys of sets and of parts of bodies in a scene file.
#include "engine/scene/scene_rules.h"

namespace skerry {

constinit const KeyDoc part_set_doc{.meaning = "name of a set of the body, from its mesh file or from \"sets\""};
constinit const KeyDoc part_box_doc{.meaning = "box around the nodes, in the mesh's own frame"};
constinit const KeyDoc part_nodes_doc{
    .meaning =
        "numbers of nodes, counted from 0 over all nodes of the mesh file in their order; numbers in the file are "
        "ignored",
    .limits = at_least(0)};

template <>
const Rule<PartEntry>& rule_of<PartEntry>() {
    static const auto rule = Rule<PartEntry>("part", "A part of a body.")
                                 .key("set", &PartEntry::set, part_set_doc)
                                 .key("box", &PartEntry::box, part_box_doc)
                                 .key("nodes", &PartEntry::nodes, part_nodes_doc)
                                 .exactly_one({"set", "box", "nodes"});
    return rule;
}

template <>
const Rule<SphereRegion>& rule_of<SphereRegion>() {
    static const auto rule =
        Rule<SphereRegion>("sphere_region", "The points within a distance of a point.")
            .key("center", &SphereRegion::center, {.meaning = "centre", .unit = "m", .required = true})
            .key("radius", &SphereRegion::radius,
                 {.meaning = "radius", .unit = "m", .limits = at_least(0), .required = true});
    return rule;
}

template <>
const Rule<HalfSpaceRegion>& rule_of<HalfSpaceRegion>() {
    static const auto rule =
        Rule<HalfSpaceRegion>("half_space", "The points on one side of a plane, and on the plane.")
            .key("point", &HalfSpaceRegion::point, {.meaning = "a point of the plane", .unit = "m"})
            .key("normal", &HalfSpaceRegion::normal,
                 {.meaning = "normal of the plane, pointing into the half-space; default: z"})
            .check([](const Place& place, const HalfSpaceRegion& region) {
                if (!(region.normal.norm() > 0))
                    place.key("normal").refuse("a vector of length 0", "a vector of nonzero length");
            });
    return rule;
}

template <>
const Rule<SetEntry>& rule_of<SetEntry>() {
    static const auto rule =
        Rule<SetEntry>("set",
                       "A named set of nodes, faces or tetrahedra of a body: all that meet every given condition. A "
                       "face or tetrahedron meets a condition if all of its nodes do. Coordinates are those of the "
                       "mesh, before rotation and position of the body are applied.")
            .key("set", &SetEntry::set,
                 {.meaning = "name of another set, or a list of names of which one must contain the part; the mesh "
                             "file or an earlier entry defines them"})
            .key("box", &SetEntry::box, {.meaning = "box"})
            .key("sphere", &SetEntry::sphere, {.meaning = "sphere"})
            .key("half_space", &SetEntry::half_space, {.meaning = "half-space"})
            .key("label", &SetEntry::label, {.meaning = "label of tetrahedra; the set contains tetrahedra"})
            .key("surface", &SetEntry::surface,
                 {.meaning = "whether the set contains faces of the surface only; default: false"})
            .key("nodes", &SetEntry::nodes, part_nodes_doc);
    return rule;
}

}  // namespace skerry
