// Keys of meshes, collider shapes and motions in a scene file.
#include "engine/scene/mesh_levels.h"
#include "engine/scene/scene_rules.h"

namespace skerry {

namespace {

// A larger number of cells would not fit into memory and is probably a typing mistake.
constexpr Limits cell_count = within(1, 1000);
constexpr Limits positive = above(0);

constexpr KeyDoc resolution_doc{.meaning = "number of elements across the smallest extent of the shape",
                                .limits = within(1, 200),
                                .required = true};

}  // namespace

template <>
const Rule<BoxMesh>& rule_of<BoxMesh>() {
    static const auto rule =
        Rule<BoxMesh>("box_mesh", "A box, centred at the origin.")
            .key("size", &BoxMesh::size, {.meaning = "edge lengths", .unit = "m", .limits = positive, .required = true})
            .key("cells", &BoxMesh::cells,
                 {.meaning = "numbers of cells along x, y and z; each cell consists of five or six tetrahedra",
                  .limits = cell_count,
                  .required = true});
    return rule;
}

template <>
const Rule<BallMesh>& rule_of<BallMesh>() {
    static const auto rule =
        Rule<BallMesh>("ball_mesh", "A ball, centred at the origin.")
            .key("radius", &BallMesh::radius, {.meaning = "radius", .unit = "m", .limits = positive, .required = true})
            .key("resolution", &BallMesh::resolution, resolution_doc);
    return rule;
}

template <>
const Rule<CylinderMesh>& rule_of<CylinderMesh>() {
    static const auto rule = Rule<CylinderMesh>("cylinder_mesh", "A solid cylinder along z, centred at the origin.")
                                 .key("radius", &CylinderMesh::radius,
                                      {.meaning = "radius", .unit = "m", .limits = positive, .required = true})
                                 .key("height", &CylinderMesh::height,
                                      {.meaning = "height", .unit = "m", .limits = positive, .required = true})
                                 .key("resolution", &CylinderMesh::resolution, resolution_doc);
    return rule;
}

template <>
const Rule<LatheMesh>& rule_of<LatheMesh>() {
    static const auto rule = Rule<LatheMesh>("lathe_mesh", "A body of revolution about z.")
                                 .key("profile", &LatheMesh::profile,
                                      {.meaning = "points [radius, z] of the outline from bottom to top, connected by "
                                                  "straight lines; z must ascend, and radii must be positive",
                                       .unit = "m",
                                       .required = true})
                                 .key("resolution", &LatheMesh::resolution, resolution_doc);
    return rule;
}

template <>
const Rule<SkittleMesh>& rule_of<SkittleMesh>() {
    static const auto rule = Rule<SkittleMesh>("skittle_mesh", "A skittle that stands on z = 0.")
                                 .key("height", &SkittleMesh::height,
                                      {.meaning = "height", .unit = "m", .limits = positive, .required = true})
                                 .key("resolution", &SkittleMesh::resolution, resolution_doc);
    return rule;
}

template <>
const Rule<mesh::TableShape>& rule_of<mesh::TableShape>() {
    using Table = mesh::TableShape;
    static const auto rule =
        Rule<Table>("table_mesh", "A table on four legs that stands on z = 0.")
            .key("length", &Table::length, {.meaning = "length of the top along x", .unit = "m", .limits = positive})
            .key("width", &Table::width, {.meaning = "width of the top along y", .unit = "m", .limits = positive})
            .key("height", &Table::height,
                 {.meaning = "height of the upper side of the top above the floor", .unit = "m", .limits = positive})
            .key("thickness", &Table::thickness, {.meaning = "thickness of the top", .unit = "m", .limits = positive})
            .key("leg", &Table::leg,
                 {.meaning = "edge length of the cross-section of a leg", .unit = "m", .limits = positive})
            .key("cells_per_leg", &Table::cells_per_leg,
                 {.meaning = "number of elements across a leg", .limits = within(1, 50)});
    return rule;
}

template <>
const Rule<MeshEntry>& rule_of<MeshEntry>() {
    static const auto rule =
        Rule<MeshEntry>("mesh", "A built-in mesh or a mesh file.")
            .key("box", &MeshEntry::box, {.meaning = "a box"})
            .key("ball", &MeshEntry::ball, {.meaning = "a ball"})
            .key("cylinder", &MeshEntry::cylinder, {.meaning = "a cylinder"})
            .key("lathe", &MeshEntry::lathe, {.meaning = "a body of revolution"})
            .key("skittle", &MeshEntry::skittle, {.meaning = "a skittle"})
            .key("table", &MeshEntry::table, {.meaning = "a table"})
            .key("file", &MeshEntry::file,
                 {.meaning =
                      "path of a mesh file, relative to the folder of the scene: Gmsh .msh, VTK .vtk or .vtu, TetGen "
                      ".node/.ele, Medit .mesh/.meshb or Abaqus .inp; rigid bodies and colliders also take .obj, "
                      ".ply and .stl"})
            .key("surface", &MeshEntry::surface,
                 {.meaning =
                      "path of a surface, for example .obj, .ply or .stl, relative to the folder of the scene. It is "
                      "filled with tetrahedra as by `skerry fill`, and the mesh is kept in a file beside it"})
            .key("edge", &MeshEntry::edge,
                 {.meaning = "with \"surface\": edge length of the tetrahedra, after scaling; default: the triangles "
                             "of a surface without faults are kept",
                  .unit = "m",
                  .limits = positive})
            .key("tolerance", &MeshEntry::tolerance,
                 {.meaning = "with \"surface\": largest distance between surface and mesh, as a fraction of the "
                             "diagonal of the bounding box; default: 0.001",
                  .limits = {.at_least = 0, .above = {}, .at_most = {}, .below = 1}})
            .key("cavities", &MeshEntry::cavities,
                 {.meaning = "with \"surface\": leave the inside of inner shells empty; default: false"})
            .key("scale", &MeshEntry::scale,
                 {.meaning = "factor for all coordinates of the mesh; default: 1", .limits = positive})
            .key(
                "refine", &MeshEntry::refine,
                {.meaning =
                     "number n of refinements; default: 0. The edges become 2^-n times as long: shapes other than "
                     "\"table\" get more cells, and tetrahedra of other meshes are divided into eight each. With n < 0 "
                     "they become longer: numbers of cells are halved, and the surface of a file is filled again",
                 .limits = within(-most_refinements, most_refinements)})
            .exactly_one({"box", "ball", "cylinder", "lathe", "skittle", "table", "file", "surface"})
            .check([](const Place& place, const MeshEntry& mesh) {
                if (!mesh.surface && (mesh.edge || mesh.tolerance || mesh.cavities))
                    place.refuse("\"edge\", \"tolerance\" or \"cavities\" without \"surface\"",
                                 "these keys only beside \"surface\"");
            });
    return rule;
}

template <>
const Rule<VisualEntry>& rule_of<VisualEntry>() {
    static const auto rule =
        Rule<VisualEntry>("visual",
                          "A triangle surface, in the frame of the body's mesh, which is drawn in place of the body.")
            .key("file", &VisualEntry::file,
                 {.meaning = "path of a surface file, for example .obj or .stl, relative to the folder of the scene",
                  .required = true})
            .key("scale", &VisualEntry::scale,
                 {.meaning = "factor for all coordinates of the surface; default: that of \"mesh\"",
                  .limits = above(0)});
    return rule;
}

template <>
const Rule<RestBox>& rule_of<RestBox>() {
    static const auto rule =
        Rule<RestBox>(
            "rest_box",
            "A box with edges along the axes of the mesh's own frame, in which the body is not yet rotated or moved.")
            .key("lower", &RestBox::lower,
                 {.meaning = "corner with the smallest coordinates", .unit = "m", .required = true})
            .key("upper", &RestBox::upper,
                 {.meaning = "corner with the largest coordinates", .unit = "m", .required = true})
            .check([](const Place& place, const RestBox& box) {
                if (!(box.lower.array() <= box.upper.array()).all())
                    place.refuse("\"lower\" above \"upper\" in at least one coordinate",
                                 "lower <= upper in all coordinates");
            });
    return rule;
}

template <>
const Rule<KeyEntry>& rule_of<KeyEntry>() {
    static const auto rule =
        Rule<KeyEntry>("motion_key",
                       "A pose at a given time. Between two keys the position changes linearly, and the rotation is "
                       "about a fixed axis.")
            .key("time", &KeyEntry::time, {.meaning = "time", .unit = "s", .limits = at_least(0), .required = true})
            .key("position", &KeyEntry::position,
                 {.meaning = "position in the world; a pin moves with the key and rotates about this point; default: "
                             "the origin",
                  .unit = "m"})
            .key("rotation", &KeyEntry::rotation, {.meaning = "rotation"});
    return rule;
}

template <>
const Rule<MotionEntry>& rule_of<MotionEntry>() {
    static const auto rule =
        Rule<MotionEntry>("motion", "A scripted motion: constant velocities, or poses at given times.")
            .key("velocity", &MotionEntry::velocity, {.meaning = "velocity", .unit = "m/s"})
            .key("angular_velocity", &MotionEntry::angular_velocity, {.meaning = "angular velocity", .unit = "rad/s"})
            .key("keys", &MotionEntry::keys,
                 {.meaning =
                      "poses in the order of ascending time. The poses of a collider replace its own pose and the "
                      "point of a plane. If no key has a rotation, the collider keeps its own rotation"})
            .at_most_one({"velocity", "keys"})
            .at_most_one({"angular_velocity", "keys"})
            .check([](const Place& place, const MotionEntry& motion) {
                for (std::size_t i = 1; i < motion.keys.size(); ++i)
                    if (!(motion.keys[i].time > motion.keys[i - 1].time))
                        place.key("keys").item(i).key("time").refuse(
                            Json(motion.keys[i].time).dump(),
                            "a time after the time of the previous key, " + Json(motion.keys[i - 1].time).dump());
            });
    return rule;
}

template <>
const Rule<Plane>& rule_of<Plane>() {
    static const auto rule =
        Rule<Plane>("plane", "A half space.")
            .key("normal", &Plane::normal, {.meaning = "outward normal, of any nonzero length; default: +z"})
            .key("point", &Plane::point, {.meaning = "a point of the plane; default: the origin", .unit = "m"})
            .check([](const Place& place, const Plane& plane) {
                if (!(plane.normal.norm() > 0))
                    place.key("normal").refuse("a vector of length 0", "a vector of nonzero length");
            });
    return rule;
}

template <>
const Rule<Sphere>& rule_of<Sphere>() {
    static const auto rule =
        Rule<Sphere>("sphere", "A solid sphere, centred at the origin.")
            .key("radius", &Sphere::radius, {.meaning = "radius", .unit = "m", .limits = positive, .required = true});
    return rule;
}

template <>
const Rule<Box>& rule_of<Box>() {
    static const auto rule =
        Rule<Box>("box", "A solid box, centred at the origin.")
            .key("size", &Box::size, {.meaning = "edge lengths", .unit = "m", .limits = positive, .required = true});
    return rule;
}

template <>
const Rule<Capsule>& rule_of<Capsule>() {
    static const auto rule =
        Rule<Capsule>("capsule", "A cylinder along z with hemispherical ends, centred at the origin.")
            .key("radius", &Capsule::radius, {.meaning = "radius", .unit = "m", .limits = positive, .required = true})
            .key("length", &Capsule::length,
                 {.meaning = "length of the cylindrical part", .unit = "m", .limits = positive, .required = true});
    return rule;
}

template <>
const Rule<Cylinder>& rule_of<Cylinder>() {
    static const auto rule =
        Rule<Cylinder>("cylinder", "A solid cylinder along z, centred at the origin.")
            .key("radius", &Cylinder::radius, {.meaning = "radius", .unit = "m", .limits = positive, .required = true})
            .key("height", &Cylinder::height, {.meaning = "height", .unit = "m", .limits = positive, .required = true});
    return rule;
}

template <>
const Rule<Bucket>& rule_of<Bucket>() {
    static const auto rule = Rule<Bucket>("bucket",
                                          "A cylindrical container that is open at the top, along z; the floor is at z "
                                          "= 0 in the frame of the collider.")
                                 .key("radius", &Bucket::radius,
                                      {.meaning = "inner radius", .unit = "m", .limits = positive, .required = true})
                                 .key("height", &Bucket::height,
                                      {.meaning = "inner height", .unit = "m", .limits = positive, .required = true})
                                 .key("thickness", &Bucket::thickness,
                                      {.meaning = "thickness of wall and floor", .unit = "m", .limits = positive});
    return rule;
}

template <>
const Rule<BodyShapeEntry>& rule_of<BodyShapeEntry>() {
    static const auto rule = Rule<BodyShapeEntry>("body_shape", "The shape of a rigid body without a mesh.")
                                 .key("sphere", &BodyShapeEntry::sphere, {.meaning = "a solid sphere"})
                                 .key("capsule", &BodyShapeEntry::capsule, {.meaning = "a solid capsule"})
                                 .key("cylinder", &BodyShapeEntry::cylinder, {.meaning = "a solid cylinder"})
                                 .exactly_one({"sphere", "capsule", "cylinder"});
    return rule;
}

template <>
const Rule<ShapeEntry>& rule_of<ShapeEntry>() {
    static const auto rule = Rule<ShapeEntry>("shape", "The shape of a collider.")
                                 .key("plane", &ShapeEntry::plane, {.meaning = "a half space"})
                                 .key("sphere", &ShapeEntry::sphere, {.meaning = "a solid sphere"})
                                 .key("box", &ShapeEntry::box, {.meaning = "a solid box"})
                                 .key("capsule", &ShapeEntry::capsule, {.meaning = "a solid capsule"})
                                 .key("cylinder", &ShapeEntry::cylinder, {.meaning = "a solid cylinder"})
                                 .key("bucket", &ShapeEntry::bucket, {.meaning = "an open bucket"})
                                 .key("mesh", &ShapeEntry::mesh, {.meaning = "the surface of a mesh"})
                                 .exactly_one({"plane", "sphere", "box", "capsule", "cylinder", "bucket", "mesh"});
    return rule;
}

}  // namespace skerry
