// A scene in which meshes are read, copies placed and names resolved. It is ready to be added to a world.
#pragma once

#include <array>
#include <functional>
#include <map>
#include <string>
#include <utility>
#include <vector>

#include "engine/output/series/follow_point.h"
#include "engine/scene/place.h"
#include "engine/scene/scene_file.h"
#include "engine/world/tuning.h"
#include "skerry/scene.h"

namespace skerry {

struct PinPlan {
    std::vector<Index> nodes;  // local numbers
    Motion motion;
    Vec3 pivot = Vec3::Zero();       // position of the pivot in world coordinates [m]
    std::vector<Vec3> directions{};  // directions along which the nodes are held; empty: all
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
    Place place;
};
struct ColliderPlan {
    Shape shape;
    ColliderSettings settings;
    Place place;
};
struct JointPlan {
    std::string name;
    std::size_t first = 0;                // index in ScenePlan::bodies
    std::optional<std::size_t> second{};  // index in ScenePlan::bodies
    JointSettings settings;               // settings without body handles, because handles exist only in a built world
    Place place;
};
struct ProbePlan {
    std::string name;
    std::size_t body = 0;      // index in ScenePlan::bodies
    std::vector<Index> nodes;  // local numbers
};
/// A time series to be recorded. The recorded quantity determines which of the following members are used.
struct SeriesPlan {
    std::string name;
    ProbeQuantity quantity = ProbeQuantity::energy;
    std::optional<std::size_t> body{}, by_body{};          // indices in ScenePlan::bodies
    std::optional<std::size_t> collider{}, by_collider{};  // indices in ScenePlan::colliders
    std::size_t joint = 0;                                 // index in ScenePlan::joints
    std::size_t pin = 0;                                   // index in BodyPlan::pins
    std::vector<Index> nodes;                              // local numbers
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
    // one mesh for each mesh file, and for each entry of "bodies" without a file; copies of a body share the mesh
    std::vector<Mesh> meshes;
    std::vector<std::filesystem::path> mesh_files;  // file of each mesh; empty for a mesh without a file
    std::vector<std::string> notes;                 // remarks about mesh files that were corrected on reading
    std::vector<BodyPlan> bodies;
    std::vector<ColliderPlan> colliders;
    std::vector<JointPlan> joints;
    std::vector<ProbePlan> probes;
    std::vector<SeriesPlan> series;
    Real probe_step = 0;  // [s]
    std::filesystem::path file;
};

/// Reads a scene, its meshes and the files that it includes, and resolves all names. Throws SceneError.
ScenePlan plan_scene(const std::filesystem::path& file, const SceneOverrides& overrides = {});
/// Plans a scene that was read with the assignments of `overrides`. Messages name `file`.
ScenePlan plan_scene(const SceneFile& scene, const std::filesystem::path& file, const SceneOverrides& overrides);

/// Resolves a part of a body to node numbers, in ascending order unless the scene lists them, or to faces in the
/// orientation of the surface. The faces are those of mesh::faces_of. Throws SceneError if the entry names no part, an
/// unknown set, or a part without nodes or faces. Such errors list the sets that exist.
std::vector<Index> nodes_of(const PartEntry& part, const BodyPlan& body, const ScenePlan& plan);
std::vector<std::array<Index, 3>> faces_of(const PartEntry& part, const BodyPlan& body, const ScenePlan& plan);
/// Resolves a part of a body that is not complete yet. `sets`: BodyPlan::sets.
std::vector<Index> nodes_of(const PartEntry& part, const Mesh& mesh, const std::map<std::string, MeshSet>& sets);

/// Returns a set of the mesh or of the scene. Throws SceneError if there is none of this name.
const MeshSet& find_set(const std::string& name, const Mesh& mesh, const std::map<std::string, MeshSet>& sets,
                        const Place& place);
/// Returns the expected value in an error message about a set that does not exist.
std::string expected_set(const Mesh& mesh, const std::map<std::string, MeshSet>& sets);
/// Resolves the sets of a body in a scene file.
std::map<std::string, MeshSet> plan_sets(const Named<SetEntry>& entries, const Mesh& mesh, const Place& place);

/// Adds a probe to a plan that already contains all bodies, colliders and joints.
void plan_probe(const ProbeEntry& entry, ScenePlan& plan);

/// Builds the world from a plan. Throws SceneError for errors that only the world detects, such as inverted tetrahedra.
/// Calls added(count), if given, after each body with the number of bodies that were added so far.
Scene build_scene(const ScenePlan& plan, const std::function<void(std::size_t)>& added = {});

/// Returns the bodies of a scene that was just built, in the order of ScenePlan::bodies. World::bodies() returns bodies
/// last whose dynamics have changed.
std::vector<BodyHandle> bodies_in_order(const World& world);

}  // namespace skerry
