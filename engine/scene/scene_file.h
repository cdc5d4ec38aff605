// Content of a scene file, key by key, before meshes are read and names are resolved.
#pragma once

#include <array>
#include <optional>
#include <span>
#include <string>
#include <variant>
#include <vector>

#include "components/cavity_law.h"
#include "components/load_kind.h"
#include "engine/scene/values.h"
#include "skerry/cable.h"
#include "skerry/cavity.h"
#include "skerry/fibre.h"
#include "skerry/joint.h"
#include "skerry/settings.h"
#include "skerry/spring.h"
#include "skerry/tie.h"
#include "skerry/time_table.h"

namespace skerry {

struct BoxMesh {
    Vec3 size = {1, 1, 1};  // [m]
    std::array<int, 3> cells{1, 1, 1};
};
struct BallMesh {
    Real radius = 1;  // [m]
    int resolution = 4;
};
struct CylinderMesh {
    Real radius = 1;  // [m]
    Real height = 1;  // [m]
    int resolution = 4;
};
struct LatheMesh {
    std::vector<std::array<Real, 2>> profile;  // (radius, z) [m]
    int resolution = 4;
};
struct SkittleMesh {
    Real height = 1;  // [m]
    int resolution = 4;
};
/// A mesh in a scene file. Exactly one of the members `box`, `ball`, ... up to `surface` is set.
struct MeshEntry {
    std::optional<BoxMesh> box;
    std::optional<BallMesh> ball;
    std::optional<CylinderMesh> cylinder;
    std::optional<LatheMesh> lathe;
    std::optional<SkittleMesh> skittle;
    std::optional<mesh::TableShape> table;
    std::optional<FilePath> file;
    std::optional<FilePath> surface;  // surface to fill with tetrahedra, controlled by the next three members
    std::optional<Real> edge;
    std::optional<Real> tolerance;
    bool cavities = false;
    Real scale = 1;
    int refine = 0;  // n > 0: the edges are halved n times; n < 0: they are doubled -n times
    Place place;
};

struct RestBox {
    Vec3 lower = Vec3::Zero();  // lower corner in the mesh's own frame [m]
    Vec3 upper = Vec3::Zero();
};
enum class WorldAxis { x, y, z };
template <>
struct EnumNames<WorldAxis> {
    static constexpr std::array<std::pair<WorldAxis, std::string_view>, 3> table{
        {{WorldAxis::x, "x"}, {WorldAxis::y, "y"}, {WorldAxis::z, "z"}}};
};
/// A part of a body. At most one of `set`, `box` and `nodes` is given. Whether one is required depends on the derived
/// entry, such as PinEntry.
struct PartEntry {
    std::optional<std::string> set;  // name of a set of the body
    std::optional<RestBox> box;
    std::vector<int> nodes;  // nodes in the order of the mesh file, counted from 0
    Place place;
};
struct SphereRegion {
    Vec3 center = Vec3::Zero();  // centre in the mesh's own frame [m]
    Real radius = 0;             // [m]
};
/// The side of a plane to which the normal points, including the plane.
struct HalfSpaceRegion {
    Vec3 point = Vec3::Zero();  // point in the mesh's own frame [m]
    Vec3 normal = {0, 0, 1};
};
/// A named set of a body: the part of the body that meets all given conditions.
struct SetEntry {
    OneOrMore<std::string> set;  // names of other sets; this set lies within their union
    std::optional<RestBox> box;
    std::optional<SphereRegion> sphere;
    std::optional<HalfSpaceRegion> half_space;
    std::optional<int> label;
    bool surface = false;
    std::vector<int> nodes;  // nodes in the order of the mesh file, counted from 0
    Place place;
};
struct KeyEntry {
    Real time = 0;
    Vec3 position = Vec3::Zero();
    Rotation rotation;
};
struct MotionEntry {
    Vec3 velocity = Vec3::Zero();
    Vec3 angular_velocity = Vec3::Zero();
    std::vector<KeyEntry> keys;
};
struct PinEntry : PartEntry {
    MotionEntry motion;
    Vec3 pivot = Vec3::Zero();
    std::optional<std::vector<WorldAxis>> axes;
    std::optional<Vec3> direction;
};
/// A part of the surface of a body with its own friction and restitution.
struct SurfaceEntry : PartEntry {
    std::optional<Real> friction, static_friction, dynamic_friction, restitution, friction_across;
    std::optional<Vec3> direction;
};
/// A grid of copies of a body.
struct RepeatEntry {
    std::array<int, 3> count{1, 1, 1};
    Vec3 spacing = Vec3::Zero();  // [m]
    Real jitter = 0;              // [m]
    int seed = 1;
};
/// A surface that is drawn in place of a body.
struct VisualEntry {
    FilePath file;
    std::optional<Real> scale;
    Place place;
};
struct BodyShapeEntry {
    std::optional<Sphere> sphere;
    std::optional<Capsule> capsule;
    std::optional<Cylinder> cylinder;
};
struct BodyEntry {
    std::string name;
    std::optional<MeshEntry> mesh;
    std::optional<BodyShapeEntry> shape;
    std::string material;
    Named<std::string> materials;  // names of materials, by label or by name of a set of tetrahedra
    Named<SetEntry> sets;
    Vec3 position = Vec3::Zero();
    Rotation rotation;
    std::vector<Vec3> positions;
    std::optional<RepeatEntry> repeat;
    Vec3 velocity = Vec3::Zero();
    Vec3 angular_velocity = Vec3::Zero();
    std::optional<Real> contact_distance;
    bool self_contact = false;
    BodyDynamics dynamics = BodySettings{}.dynamics;
    std::optional<Real> mass;
    std::optional<Vec3> center_of_mass;
    std::optional<std::array<Vec3, 3>> inertia;
    std::uint32_t collision_group = BodySettings{}.collision_group, collision_mask = BodySettings{}.collision_mask;
    ElementKind element = BodySettings{}.element;
    OneOrMore<PinEntry> pin;
    std::vector<SurfaceEntry> surfaces;
    std::optional<VisualEntry> visual;
    Place place;
};

struct ShapeEntry {
    std::optional<Plane> plane;
    std::optional<Sphere> sphere;
    std::optional<Box> box;
    std::optional<Capsule> capsule;
    std::optional<Cylinder> cylinder;
    std::optional<Bucket> bucket;
    std::optional<MeshEntry> mesh;
};
struct ColliderEntry {
    std::string name;
    ShapeEntry shape;
    Vec3 position = Vec3::Zero();
    Rotation rotation;
    MotionEntry motion;
    std::optional<std::string> material;
    std::optional<Real> friction, static_friction, dynamic_friction, restitution;
    Real contact_distance = 0;
    std::uint32_t collision_group = ColliderSettings{}.collision_group,
                  collision_mask = ColliderSettings{}.collision_mask;
    Place place;
};
/// A point that is fixed to a body, to a collider, or to the world.
struct AnchorEntry {
    std::optional<std::string> body, collider;
    Vec3 point = Vec3::Zero();  // in the frame of the mesh or collider; in the world if neither is given [m]
    Place place;
};
/// Surface properties of contacts between two materials.
struct PairEntry {
    std::array<std::string, 2> materials;
    std::optional<Real> friction, static_friction, dynamic_friction, restitution;
    Place place;
};
/// Two objects that do not collide: a body, and another body or a collider.
struct NoCollisionEntry {
    std::string body;
    std::optional<std::string> to_body, to_collider;
    Place place;
};
struct SpringEntry {
    std::string name;
    AnchorEntry first, second;
    Real stiffness = SpringSettings{}.stiffness, damping = SpringSettings{}.damping;
    std::optional<TimeTable> rest_length;
    SpringSide only = SpringSettings{}.only;
    std::optional<Real> strength;
    Place place;
};
struct MotorEntry {
    std::optional<Real> speed, position;
    std::vector<MotorKey> keys;
    Real strength = 0;
    std::optional<Real> fastest;
};
struct MimicEntry {
    std::string joint;  // name of the joint that this joint follows
    Real ratio = JointMimic{}.ratio, offset = JointMimic{}.offset;
};
struct JointEntry {
    std::string name;
    JointKind kind = JointKind::ball;
    std::string first;
    std::optional<std::string> second;
    Vec3 point = JointSettings{}.point, axis = JointSettings{}.axis;
    Real coordinate = JointSettings{}.coordinate;
    std::optional<Real> lower, upper;
    std::optional<MotorEntry> motor;
    std::optional<MimicEntry> mimic;
    JointPassive passive;
    bool bodies_touch = JointSettings{}.bodies_touch;
    Place place;
};
struct TieEntry : PartEntry {
    std::string name;
    TieKind kind = TieKind::weld;
    std::string body;
    std::optional<std::string> to_body, to_collider;
    std::optional<Real> break_force;
    bool close_gap = false, bodies_touch = false;
};
struct CableEntry {
    std::string name;
    std::vector<AnchorEntry> points;
    std::optional<TimeTable> tension, length, rate;
    Real friction = CableSettings{}.friction;
    Place place;
};
/// A cavity of a body. If none of `set`, `box` and `nodes` is given, the cavity has the default faces that
/// CavitySettings::faces describes.
struct CavityEntry : PartEntry {
    std::string name;
    std::string body;
    std::optional<TimeTable> pressure;
    std::optional<GasFilling> gas;
    std::optional<LiquidFilling> liquid;
    std::optional<Real> volume;
};
struct PipeEntry {
    std::string name;
    std::string first;
    std::optional<std::string> second;
    Real conductance = 0;
    std::optional<TimeTable> pressure;
    Place place;
};
/// A load or a force field. `kind` determines which of the members are used.
struct LoadEntry : PartEntry {
    std::string name;
    LoadKind kind = LoadKind::force;
    std::optional<std::string> body;
    std::optional<Vec3> force, traction, acceleration, wind;  // [N, Pa, m/s^2, m/s]
    std::optional<Real> rate;  // drag: rate at which the velocity approaches `wind` [1/s]
    std::optional<LoadArea> area;
    std::optional<TimeTable> scale;
};
/// Fibres in a body, or in a set of its tetrahedra.
struct FibreEntry {
    std::string name;
    std::string body;
    std::optional<std::string> set;
    std::optional<Vec3> direction;
    std::optional<std::string> direction_array;  // name in Mesh::vectors
    Real stiffness = FibreSettings{}.stiffness, exponent = FibreSettings{}.exponent;
    TimeTable tension = FibreSettings{}.tension;
    Place place;
};
/// Quantity that a probe records. `contacts`: sticking and sliding of a part of a body, for the report. All other
/// quantities are time series of numbers, for a file.
enum class ProbeQuantity {
    contacts,
    motion,
    force,
    reaction,
    joint,
    cable,
    energy,
    stress,
    volume,
    cavity,
    spring,
    tie
};
template <>
struct EnumNames<ProbeQuantity> {
    static constexpr std::array<std::pair<ProbeQuantity, std::string_view>, 12> table{{
        {ProbeQuantity::contacts, "contacts"},
        {ProbeQuantity::motion, "motion"},
        {ProbeQuantity::force, "force"},
        {ProbeQuantity::reaction, "reaction"},
        {ProbeQuantity::joint, "joint"},
        {ProbeQuantity::cable, "cable"},
        {ProbeQuantity::energy, "energy"},
        {ProbeQuantity::stress, "stress"},
        {ProbeQuantity::volume, "volume"},
        {ProbeQuantity::cavity, "cavity"},
        {ProbeQuantity::spring, "spring"},
        {ProbeQuantity::tie, "tie"},
    }};
};
struct ProbeEntry {
    std::string name;
    ProbeQuantity quantity = ProbeQuantity::contacts;
    std::optional<std::string> body, collider, by, joint, set, cable, cavity, spring, tie;
    std::optional<RestBox> box;
    std::optional<Vec3> point;  // position in the mesh's own frame [m]
    std::optional<int> pin;
    Place place;
};

/// A slider, with which a user changes a value while the scene runs. Exactly one of the lists of names is given; it
/// selects the controlled objects.
struct SliderEntry {
    std::string name;
    OneOrMore<std::string> collider, body, joint, cable, cavity, pipe, spring, load, fibres;
    std::optional<int> pin;
    std::optional<Vec3> along, about;
    Real low = 0, high = 0;
    std::optional<Real> value, fastest;
    Place place;
};

/// A scene file that a scene includes. An entry that consists only of a path has no name. Its objects then keep their
/// names and poses.
struct IncludeEntry {
    FilePath scene;
    std::string name;              // prefix of all names: NAME/OBJECT, and NAME_PROBE for probes
    Vec3 position = Vec3::Zero();  // origin of the frame of the included scene [m]
    Rotation rotation;
    Place place;
};

struct SceneFile {
    std::string schema;  // location of the JSON schema, used only by editors
    std::string name;
    std::string description;
    Real seconds = 2;
    Real frame_step = 1.0 / 60;
    OneOrMore<IncludeEntry> include;
    Settings settings;
    Named<MaterialSettings> materials;
    std::vector<PairEntry> pairs;
    std::vector<BodyEntry> bodies;
    std::vector<ColliderEntry> colliders;
    std::vector<NoCollisionEntry> no_collision;
    std::vector<JointEntry> joints;
    std::vector<TieEntry> ties;
    std::vector<CableEntry> cables;
    std::vector<CavityEntry> cavities;
    std::vector<PipeEntry> pipes;
    std::vector<LoadEntry> loads;
    std::vector<FibreEntry> fibres;
    std::vector<SpringEntry> springs;
    std::vector<ProbeEntry> probes;
    std::optional<Real> probe_step;
    std::vector<SliderEntry> sliders;
};

/// Reads a scene file and all files that it includes. `assignments` (assign.h) are applied to the content of the file
/// first. Throws SceneError.
SceneFile read_scene_file(const std::filesystem::path& file, std::span<const std::string> assignments = {});

/// Used in place of the file name in messages about a scene that was read from a text.
inline constexpr const char* scene_text_name = "scene";
/// Reads the text of a scene file. Relative paths start at `folder`.
SceneFile read_scene_text(const std::string& json, const std::filesystem::path& folder,
                          std::span<const std::string> assignments = {});

}  // namespace skerry
