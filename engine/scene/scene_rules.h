// Keys of scene files: declarations of the rules that the files *_rules.cpp define.
#pragma once

#include "engine/scene/scene_file.h"

namespace skerry {

template <>
const Rule<BoxMesh>& rule_of<BoxMesh>();
template <>
const Rule<BallMesh>& rule_of<BallMesh>();
template <>
const Rule<CylinderMesh>& rule_of<CylinderMesh>();
template <>
const Rule<LatheMesh>& rule_of<LatheMesh>();
template <>
const Rule<SkittleMesh>& rule_of<SkittleMesh>();
template <>
const Rule<mesh::TableShape>& rule_of<mesh::TableShape>();
template <>
const Rule<MeshEntry>& rule_of<MeshEntry>();
template <>
const Rule<RestBox>& rule_of<RestBox>();
template <>
const Rule<PartEntry>& rule_of<PartEntry>();
template <>
const Rule<SphereRegion>& rule_of<SphereRegion>();
template <>
const Rule<HalfSpaceRegion>& rule_of<HalfSpaceRegion>();
template <>
const Rule<SetEntry>& rule_of<SetEntry>();
template <>
const Rule<KeyEntry>& rule_of<KeyEntry>();
template <>
const Rule<MotionEntry>& rule_of<MotionEntry>();
template <>
const Rule<PinEntry>& rule_of<PinEntry>();
template <>
const Rule<RepeatEntry>& rule_of<RepeatEntry>();
template <>
const Rule<VisualEntry>& rule_of<VisualEntry>();
template <>
const Rule<BodyEntry>& rule_of<BodyEntry>();
template <>
const Rule<BodyShapeEntry>& rule_of<BodyShapeEntry>();
template <>
const Rule<Plane>& rule_of<Plane>();
template <>
const Rule<Sphere>& rule_of<Sphere>();
template <>
const Rule<Box>& rule_of<Box>();
template <>
const Rule<Capsule>& rule_of<Capsule>();
template <>
const Rule<Cylinder>& rule_of<Cylinder>();
template <>
const Rule<Bucket>& rule_of<Bucket>();
template <>
const Rule<ShapeEntry>& rule_of<ShapeEntry>();
template <>
const Rule<ColliderEntry>& rule_of<ColliderEntry>();
template <>
const Rule<SurfaceEntry>& rule_of<SurfaceEntry>();
template <>
const Rule<PairEntry>& rule_of<PairEntry>();
template <>
const Rule<NoCollisionEntry>& rule_of<NoCollisionEntry>();
template <>
const Rule<AnchorEntry>& rule_of<AnchorEntry>();
template <>
const Rule<CableEntry>& rule_of<CableEntry>();
template <>
const Rule<MotorKey>& rule_of<MotorKey>();
template <>
const Rule<MotorEntry>& rule_of<MotorEntry>();
template <>
const Rule<JointPassive>& rule_of<JointPassive>();
template <>
const Rule<MimicEntry>& rule_of<MimicEntry>();
template <>
const Rule<JointEntry>& rule_of<JointEntry>();
template <>
const Rule<TieEntry>& rule_of<TieEntry>();
template <>
const Rule<GasFilling>& rule_of<GasFilling>();
template <>
const Rule<LiquidFilling>& rule_of<LiquidFilling>();
template <>
const Rule<CavityEntry>& rule_of<CavityEntry>();
template <>
const Rule<PipeEntry>& rule_of<PipeEntry>();
template <>
const Rule<LoadEntry>& rule_of<LoadEntry>();
template <>
const Rule<FibreEntry>& rule_of<FibreEntry>();
template <>
const Rule<SpringEntry>& rule_of<SpringEntry>();
template <>
const Rule<ProbeEntry>& rule_of<ProbeEntry>();
template <>
const Rule<SliderEntry>& rule_of<SliderEntry>();
template <>
const Rule<IncludeEntry>& rule_of<IncludeEntry>();
template <>
const Rule<MaterialSettings>& rule_of<MaterialSettings>();
template <>
const Rule<Settings>& rule_of<Settings>();
template <>
const Rule<SceneFile>& rule_of<SceneFile>();

/// A value in a scene file: the path of a file, or an object whose member `file` holds the path.
template <class Entry, FilePath Entry::*file>
struct PathOrObject {
    static void read(const Json& json, const Place& place, const KeyDoc& doc, Entry& out) {
        out.place = place;
        if (json.is_string())
            Value<FilePath>::read(json, place, doc, out.*file);
        else
            rule_of<Entry>().read(json, place, out);
    }
    static Json schema(SchemaBook& book, const KeyDoc&) {
        return either_schema(text_schema(), rule_schema(book, rule_of<Entry>()));
    }
};
template <>
struct Value<IncludeEntry> : PathOrObject<IncludeEntry, &IncludeEntry::scene> {};
template <>
struct Value<VisualEntry> : PathOrObject<VisualEntry, &VisualEntry::file> {};

/// Adds the keys of friction and restitution. `friction` and `restitution`: documentation of these two keys.
template <class Entry>
void add_surface_keys(Rule<Entry>& rule, const KeyDoc& friction, const KeyDoc& restitution) {
    rule.key("friction", &Entry::friction, friction)
        .key("static_friction", &Entry::static_friction,
             {.meaning = "friction coefficient of sticking contacts", .limits = at_least(0)})
        .key("dynamic_friction", &Entry::dynamic_friction,
             {.meaning = "friction coefficient of sliding contacts", .limits = at_least(0)})
        .key("restitution", &Entry::restitution, restitution)
        .together({"static_friction", "dynamic_friction"})
        .at_most_one({"friction", "static_friction"})
        .at_most_one({"mu", "static_friction"})
        .check([](const Place& place, const Entry& entry) {
            if (entry.static_friction && *entry.dynamic_friction > *entry.static_friction)
                place.key("dynamic_friction")
                    .refuse(Json(*entry.dynamic_friction).dump(),
                            "at most the value of \"static_friction\", " + Json(*entry.static_friction).dump());
        });
}

/// Keys that an object of one kind must have, and further ones that it may have.
struct KeysOfKind {
    std::vector<std::string> required, optional;
};
/// Throws SceneError unless the keys of an object suit its kind. `given`: pairs (key that only some kinds use, true if
/// the object has it). `kind`: text for the message, for example: the quantity "force". `no_keys`: text that the
/// message gives instead of a list of keys if the kind uses none of these keys.
void check_keys_of_kind(const Place& place, const std::string& kind, const KeysOfKind& keys,
                        const std::vector<std::pair<std::string, bool>>& given, const char* no_keys = "");

/// Documentation of the keys "set", "box" and "nodes" of an entry that derives from PartEntry.
extern const KeyDoc part_set_doc, part_box_doc, part_nodes_doc;

}  // namespace skerry
