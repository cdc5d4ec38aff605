#include "engine/scene/peer_drop.h"

#include "engine/scene/scene_rules.h"

namespace skerry {

namespace {

struct DropBucket {
    Real floor_y = 0, wall_x = 0, wall_z = 0;  // m
};
struct DropBody {
    Vec3 position = Vec3::Zero();
    RotationRows rotation_rows;
};
struct DropFile {
    FilePath mesh;
    MaterialSettings material;
    Vec3 gravity = Vec3::Zero();
    DropBucket bucket;
    Real seconds = 2;
    std::vector<DropBody> bodies;
};

}  // namespace

template <>
const Rule<DropBucket>& rule_of<DropBucket>() {
    static const auto rule =
        Rule<DropBucket>("drop_bucket", "A floor and four walls.")
            .key("floor_y", &DropBucket::floor_y, {.meaning = "height of the floor", .unit = "m", .required = true})
            .key("wall_x", &DropBucket::wall_x, {.meaning = "walls at x = +-wall_x", .unit = "m", .limits = above(0), .required = true})
            .key("wall_z", &DropBucket::wall_z, {.meaning = "walls at z = +-wall_z", .unit = "m", .limits = above(0), .required = true});
    return rule;
}

template <>
const Rule<DropBody>& rule_of<DropBody>() {
    static const auto rule =
        Rule<DropBody>("drop_body", "One copy.")
            .key("position", &DropBody::position, {.meaning = "position", .unit = "m", .required = true})
            .key("rotation_rows", &DropBody::rotation_rows, {.meaning = "rows of the rotation matrix", .required = true});
    return rule;
}

template <>
const Rule<DropFile>& rule_of<DropFile>() {
    static const auto rule = Rule<DropFile>("drop_file", "Copies of one mesh that fall into a box.")
                                 .key("mesh", &DropFile::mesh, {.meaning = "mesh file", .required = true})
                                 .key("material", &DropFile::material, {.meaning = "of all bodies", .required = true})
                                 .key("gravity", &DropFile::gravity, {.meaning = "gravity", .unit = "m/s^2", .required = true})
                                 .key("bucket", &DropFile::bucket, {.meaning = "the box", .required = true})
                                 .key("seconds", &DropFile::seconds, {.meaning = "length of a run", .unit = "s", .limits = above(0)})
                                 .key("bodies", &DropFile::bodies, {.meaning = "placements", .required = true});
    return rule;
}

bool is_drop_file(const Json& json) {
    return json.is_object() && json.contains("bucket") && json.contains("mesh");
}

void read_drop_file(const Json& json, const Place& place, SceneFile& scene) {
    DropFile drop;
    rule_of<DropFile>().read(json, place, drop);
    scene.seconds = drop.seconds;
    scene.settings.gravity = drop.gravity;
    scene.materials.items.emplace_back("drop", drop.material);

    BodyEntry body;
    body.name = "drop";
    body.material = "drop";
    body.mesh.file = drop.mesh;
    body.mesh.place = place.key("mesh");
    body.place = place.key("bodies");
    for (const DropBody& copy : drop.bodies) body.placements.push_back({copy.position, {copy.rotation_rows.value}});
    if (body.placements.empty()) body.place.refuse("an empty list", "at least one body");
    scene.bodies.push_back(std::move(body));

    const auto add_plane = [&](const char* name, const Vec3& normal, const Vec3& point) {
        ColliderEntry collider;
        collider.name = name;
        collider.shape.plane = Plane{normal, point};
        collider.place = place.key("bucket");
        scene.colliders.push_back(std::move(collider));
    };
    const DropBucket& box = drop.bucket;
    add_plane("floor", Vec3::UnitY(), Vec3(0, box.floor_y, 0));
    add_plane("wall_left", Vec3::UnitX(), Vec3(-box.wall_x, 0, 0));
    add_plane("wall_right", -Vec3::UnitX(), Vec3(box.wall_x, 0, 0));
    add_plane("wall_back", Vec3::UnitZ(), Vec3(0, 0, -box.wall_z));
    add_plane("wall_front", -Vec3::UnitZ(), Vec3(0, 0, box.wall_z));
}

}  // namespace skerry
