// Plan of a scene: its meshes are read, its copies are placed, and most names are replaced by indices. A world can be
// built from the plan without reading any file.
#pragma once

#include <array>
#include <functional>
#include <map>
#include <memory>
#include <span>
#include <string>
#include <string_view>
#include <utility>
#include <variant>
#include <vector>

#include "engine/mesh/subdivision.h"
#include "engine/mesh/visual/bound_visual.h"
#include "engine/output/series/follow_point.h"
#include "engine/scene/place.h"
#include "engine/scene/scene_file.h"
#include "engine/world/tuning.h"
#include "skerry/anchor.h"
#include "skerry/fill.h"
#include "skerry/load.h"
#include "skerry/scene.h"
#include "skerry/spring.h"
#include "skerry/surface.h"

namespace skerry {

/// A mesh, and the subdivisions that made it, in their order. Node numbers in the scene file refer to the mesh before
/// the first subdivision.
struct PlannedMesh : Mesh {
    std::vector<mesh::Subdivision> subdivisions{};
};
struct PinPlan {
    std::vector<Index> nodes;  // node numbers within the body
    Motion motion;
    Vec3 pivot = Vec3::Zero();       // position of the pivot in world coordinates [m]
    std::vector<Vec3> directions{};  // directions along which the nodes are held; empty: all
    Place place;
};
struct SurfacePlan {
    SurfaceSetSettings settings;  // settings without the body handle, because handles exist only in a built world
    Place place;
};
struct BodyPlan {
    BodySettings settings;  // settings without material handles, because handles exist only in a built world
    // Index in ScenePlan::meshes. For a sphere, capsule or cylinder: the mesh that represents it in output.
    std::size_t mesh = 0;
    BodyShapeEntry shape{};
    std::size_t material = 0;                            // index in ScenePlan::materials
    std::vector<std::pair<int, std::size_t>> materials;  // pairs (label of tetrahedra, index in ScenePlan::materials)
    std::vector<std::pair<std::string, std::size_t>> set_materials;  // pairs (set, index in ScenePlan::materials)
    std::map<std::string, MeshSet> sets;                             // sets of the scene, in addition to Mesh::sets
    std::vector<PinPlan> pins;
    std::vector<SurfacePlan> surfaces;
    std::shared_ptr<const BoundVisual> visual{};  // surface drawn in place of the body; shared by its copies
    Place place;
};
struct ColliderPlan {
    Shape shape;
    ColliderSettings settings;
    std::optional<std::size_t> material{};  // index in ScenePlan::materials
    Place place;
};
struct PairPlan {
    std::size_t first = 0, second = 0;  // indices in ScenePlan::materials
    SurfaceSettings surface;
    Place place;
};
struct AnchorPlan {
    std::optional<std::size_t> body{}, collider{};  // indices in ScenePlan::bodies and ScenePlan::colliders
    // Position in the frame of the body's mesh or of the collider; in the world if there is neither [m].
    Vec3 point = Vec3::Zero();
};
struct JointPlan {
    std::string name;
    std::size_t first = 0;                // index in ScenePlan::bodies
    std::optional<std::size_t> second{};  // index in ScenePlan::bodies
    JointSettings settings;               // settings without body handles, because handles exist only in a built world
    std::optional<MimicEntry> mimic{};
    Place place;
};
struct TiePlan {
    std::string name;
    std::size_t body = 0;                                 // index in ScenePlan::bodies
    std::optional<std::size_t> to_body{}, to_collider{};  // indices in ScenePlan::bodies and ScenePlan::colliders
    TieSettings settings;  // settings without handles, because handles exist only in a built world
    Place place;
};
struct CablePlan {
    std::string name;
    std::vector<AnchorPlan> points{};
    CableSettings settings{};  // settings without points, because handles exist only in a built world
    Place place{};
};
struct CavityPlan {
    std::string name;
    std::size_t body = 0;     // index in ScenePlan::bodies
    CavitySettings settings;  // settings without body handle, because handles exist only in a built world
    Place place;
};
struct PipePlan {
    std::string name;
    std::size_t first = 0;                // index in ScenePlan::cavities
    std::optional<std::size_t> second{};  // index in ScenePlan::cavities
    PipeSettings settings;                // settings without handles, because handles exist only in a built world
    Place place;
};
struct LoadPlan {
    std::string name;
    std::optional<std::size_t> body{};  // index in ScenePlan::bodies
    // load without its body handle, because handles exist only in a built world
    AnyLoad load{};
    Place place;
};
struct FibrePlan {
    std::string name;
    std::size_t body = 0;    // index in ScenePlan::bodies
    FibreSettings settings;  // settings without body handle, because handles exist only in a built world
    Place place;
};
struct SpringPlan {
    std::string name;
    AnchorPlan first, second;
    SpringSettings settings;  // settings without anchors, because handles exist only in a built world
    Place place;
};
struct NoCollisionPlan {
    std::size_t body = 0;                             // index in ScenePlan::bodies
    std::optional<std::size_t> to_body, to_collider;  // indices in ScenePlan::bodies and ScenePlan::colliders
};
struct ProbePlan {
    std::string name;
    std::size_t body = 0;      // index in ScenePlan::bodies
    std::vector<Index> nodes;  // node numbers within the body
};
/// A time series to be recorded. The recorded quantity determines which of the following members are used.
struct SeriesPlan {
    std::string name;
    ProbeQuantity quantity = ProbeQuantity::energy;
    std::optional<std::size_t> body{}, by_body{};          // indices in ScenePlan::bodies
    std::optional<std::size_t> collider{}, by_collider{};  // indices in ScenePlan::colliders
    std::size_t joint = 0;                                 // index in ScenePlan::joints
    std::size_t tie = 0;                                   // index in ScenePlan::ties
    std::size_t cable = 0;                                 // index in ScenePlan::cables
    std::size_t cavity = 0;                                // index in ScenePlan::cavities
    std::size_t spring = 0;                                // index in ScenePlan::springs
    std::size_t pin = 0;                                   // index in BodyPlan::pins
    std::vector<Index> nodes;                              // node numbers within the body
    std::optional<MaterialPoint> point;
    Place place;
};

struct ScenePlan {
    std::string name, description;
    Real seconds = 2;     // [s]
    Real frame_step = 0;  // [s]
    Settings settings;
    Tuning tuning{};  // set by tests and measurements, not by scene files
    std::vector<std::pair<std::string, MaterialSettings>> materials;
    // meshes of the bodies; copies of a body share one mesh, and so do bodies that use the same file with equal
    // settings
    std::vector<PlannedMesh> meshes;
    std::vector<std::filesystem::path> mesh_files;  // for each mesh: file of the mesh or surface, or empty
    std::vector<std::string> notes;                 // remarks about mesh files that were corrected on reading
    std::vector<BodyPlan> bodies;
    std::vector<ColliderPlan> colliders;
    std::vector<PairPlan> pairs;
    std::vector<NoCollisionPlan> no_collision;
    std::vector<JointPlan> joints;
    std::vector<TiePlan> ties;
    std::vector<CablePlan> cables;
    std::vector<CavityPlan> cavities;
    std::vector<PipePlan> pipes;
    std::vector<LoadPlan> loads;
    std::vector<FibrePlan> fibres;
    std::vector<SpringPlan> springs;
    std::vector<ProbePlan> probes;
    std::vector<SeriesPlan> series;
    Real probe_step = 0;  // [s]
    std::vector<SliderEntry> sliders;
    std::filesystem::path file;
};

/// Reads a scene, its meshes and the files that it includes, fills surfaces with tetrahedra, and resolves all names.
/// `progress`: is called with a text about the activity while surfaces are filled. Throws SceneError.
ScenePlan plan_scene(const std::filesystem::path& file, const SceneOverrides& overrides = {},
                     const mesh::FillProgress& progress = {});
/// Plans a scene that the caller has already read with `overrides.assignments`. `file`: scene file, for messages.
ScenePlan plan_scene(const SceneFile& scene, const std::filesystem::path& file, const SceneOverrides& overrides,
                     const mesh::FillProgress& progress = {});

/// Returns for each copy of a body the position of the origin of its mesh [m].
std::vector<Vec3> positions_of(const BodyEntry& entry);

/// Node numbers of a part of a body, in the order of the scene file if it lists the nodes, otherwise in ascending
/// order. Throws SceneError if the entry names no part, a part without nodes, or an unknown set. For an unknown set the
/// message lists the existing sets.
std::vector<Index> nodes_of(const PartEntry& part, const BodyPlan& body, const ScenePlan& plan);
/// Faces of a part of a body, oriented as on the surface: the faces that the part lists, the surface triangles whose
/// nodes are all in the part, and the surface triangles of the tetrahedra of the part. Throws SceneError like
/// nodes_of(), and if the part has no faces.
std::vector<std::array<Index, 3>> faces_of(const PartEntry& part, const BodyPlan& body, const ScenePlan& plan);
/// Faces of a set: the listed faces, the surface triangles whose nodes are all listed, and the surface triangles of
/// listed tetrahedra.
std::vector<std::array<Index, 3>> faces_of(const MeshSet& set, const Mesh& mesh);
/// Returns the node numbers of a part of a body whose plan is not complete yet. `sets`: BodyPlan::sets.
std::vector<Index> nodes_of(const PartEntry& part, const PlannedMesh& mesh, const std::map<std::string, MeshSet>& sets);

/// Returns the set with this name: from `sets`, or else from Mesh::sets. Throws SceneError if neither has it.
const MeshSet& find_set(const std::string& name, const Mesh& mesh, const std::map<std::string, MeshSet>& sets,
                        const Place& place);
/// Text for the part "expected" of an error message about a missing set: lists the existing sets.
std::string expected_set(const Mesh& mesh, const std::map<std::string, MeshSet>& sets);
/// Finds the nodes, faces and tetrahedra of the sets that a scene file defines for a body.
std::map<std::string, MeshSet> plan_sets(const Named<SetEntry>& entries, const PlannedMesh& mesh, const Place& place);

/// Names of the objects in a list of a plan, for example of all joints. The views are valid until the list changes.
template <class Object>
std::vector<std::string_view> names_of(const std::vector<Object>& objects) {
    std::vector<std::string_view> names;
    for (const Object& object : objects)
        if constexpr (requires { object.name; })
            names.push_back(object.name);
        else
            names.push_back(object.settings.name);
    return names;
}
/// Returns the index of a name in a list. Throws SceneError if it is not there. `kind`: kind of the objects, such as
/// "joint".
std::size_t find_name(std::span<const std::string_view> names, const std::string& name, const std::string& kind,
                      const Place& place);
/// Returns `name`. If it is empty, returns KIND_NUMBER, where NUMBER is the number of names in `taken`. Throws
/// SceneError if an object of this kind has the name already. `place`: entry of the object.
std::string choose_name(const std::string& name, std::span<const std::string_view> taken, const std::string& kind,
                        const Place& place);
/// Returns the index of a body or a collider in a plan. Throws SceneError if the plan has none of this name.
std::size_t find_body(const ScenePlan& plan, const std::string& name, const Place& place);
std::size_t find_collider(const ScenePlan& plan, const std::string& name, const Place& place);

/// Index in ScenePlan::joints of the joint whose coordinate `joint` follows. `joint` must have a MimicEntry. Throws
/// SceneError if the plan has no joint of the name in this entry.
std::size_t leader_of(const JointPlan& joint, const ScenePlan& plan);

/// Resolves the names of an anchor. The plan must already contain all bodies and colliders.
AnchorPlan plan_anchor(const AnchorEntry& entry, const ScenePlan& plan);

/// Handles of the bodies, colliders and pins of a world that is being built, in the order of the plan.
struct PlannedHandles {
    const std::vector<BodyHandle>& bodies;
    const std::vector<ColliderHandle>& colliders;
    const std::vector<std::vector<AttachmentHandle>>& pins;  // indexed by body
};
/// Converts a planned anchor to an Anchor with handles of `world`.
Anchor anchor_of(const AnchorPlan& anchor, const ScenePlan& plan, const World& world, const PlannedHandles& handles);

/// Resolve the names and nodes of ties, cables and springs. The plan must already contain all bodies and colliders.
TiePlan plan_tie(const TieEntry& entry, const ScenePlan& plan);
CablePlan plan_cable(const CableEntry& entry, const ScenePlan& plan);
SpringPlan plan_spring(const SpringEntry& entry, const ScenePlan& plan);

/// Adds the cavities and pipes of a scene to a plan that already contains all bodies.
void plan_cavities(const SceneFile& scene, ScenePlan& plan);
/// Adds the planned cavities and pipes to a world. `bodies`: handles in the order of ScenePlan::bodies. Returns the
/// cavities.
std::vector<CavityHandle> add_cavities(const ScenePlan& plan, const std::vector<BodyHandle>& bodies, World& world);

/// Plans a load. `plan` already contains all bodies.
LoadPlan plan_load(const LoadEntry& entry, const ScenePlan& plan);
/// Adds a planned load to a world. `bodies`: handles in the order of ScenePlan::bodies.
LoadHandle add_planned(const LoadPlan& load, std::span<const BodyHandle> bodies, World& world);

/// Plans the fibres of an entry. `plan` already contains all bodies.
FibrePlan plan_fibres(const FibreEntry& entry, const ScenePlan& plan);

/// Adds a probe to a plan that already contains all objects that a probe can name (ProbeEntry).
void plan_probe(const ProbeEntry& entry, ScenePlan& plan);

/// Makes the sliders of a plan. Finds their objects in `world` by name, and sets the start values that the scene gives.
/// Throws SceneError.
std::vector<Slider> make_sliders(const ScenePlan& plan, const PlannedHandles& handles, World& world);

/// Gives an object its name from the scene. If `name` is empty, the object keeps the name that the world gave it.
template <class HandleType>
void name_object(World& world, HandleType object, const std::string& name) {
    if (!name.empty()) ObjectView<HandleType>(world).set_name(object, name);
}

/// Builds the world from a plan. Throws SceneError for errors that only the world detects, such as inverted tetrahedra.
/// If `added` is given, calls it after each body with the number of bodies that were added so far.
Scene build_scene(const ScenePlan& plan, const std::function<void(std::size_t)>& added = {});

/// Returns the bodies of a scene that was just built, in the order of ScenePlan::bodies. The order of World::bodies()
/// differs: a body whose dynamics were changed comes last there.
std::vector<BodyHandle> bodies_in_order(const World& world);

}  // namespace skerry
