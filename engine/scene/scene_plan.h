// A scene with everything resolved: meshes read, copies placed, names found. What is left is to add it to a world.
#pragma once

#include <string>
#include <utility>
#include <vector>

#include "engine/output/series/follow_point.h"
#include "engine/scene/place.h"
#include "engine/scene/scene_file.h"
#include "skerry/scene.h"

namespace skerry {

struct PinPlan {
    std::vector<Index> nodes;  // local
    Motion motion;
    Vec3 pivot = Vec3::Zero();  // m, world
    Place place;
};
struct BodyPlan {
    BodySettings settings;  // handles of materials come when it is built
    std::size_t mesh = 0;   // of ScenePlan::meshes; of a shape: what draws it
    BodyShapeEntry shape{};
    std::size_t material = 0;                            // of ScenePlan::materials
    std::vector<std::pair<int, std::size_t>> materials;  // of ScenePlan::materials, by label
    std::vector<PinPlan> pins;
    Place place;
};
struct ColliderPlan {
    Shape shape;
    ColliderSettings settings;
    Place place;
};
struct JointPlan {
    std::size_t first = 0;                // of ScenePlan::bodies
    std::optional<std::size_t> second{};  // of ScenePlan::bodies
    JointSettings settings;               // handles of bodies come when it is built
    Place place;
};
struct ProbePlan {
    std::string name;
    std::size_t body = 0;      // of ScenePlan::bodies
    std::vector<Index> nodes;  // local
};
/// A series: what of it is given depends on the quantity.
struct SeriesPlan {
    std::string name;
    ProbeQuantity quantity = ProbeQuantity::energy;
    std::optional<std::size_t> body{}, by_body{};          // of ScenePlan::bodies
    std::optional<std::size_t> collider{}, by_collider{};  // of ScenePlan::colliders
    std::size_t pin = 0;                                   // of BodyPlan::pins
    std::vector<Index> nodes;                              // local
    std::optional<MaterialPoint> point;
    Place place;
};

struct ScenePlan {
    std::string name, description;
    Real seconds = 2;     // s
    Real frame_step = 0;  // s
    Settings settings;
    std::vector<std::pair<std::string, MaterialSettings>> materials;
    std::vector<Mesh> meshes;  // one for each entry of "bodies": copies share it
    std::vector<BodyPlan> bodies;
    std::vector<ColliderPlan> colliders;
    std::vector<JointPlan> joints;
    std::vector<ProbePlan> probes;
    std::vector<SeriesPlan> series;
    Real probe_step = 0;  // s
    std::filesystem::path file;
};

/// Reads a scene and resolves it. Throws SceneError.
ScenePlan plan_scene(const std::filesystem::path& file, const SceneOverrides& overrides = {});

/// The nodes of a mesh inside a box of its own frame; refuses a box without any.
std::vector<Index> nodes_inside(const Mesh& mesh, const RestBox& box, const Place& place);

/// Adds a probe to a plan that has all bodies and colliders.
void plan_probe(const ProbeEntry& entry, ScenePlan& plan);

/// Puts the world together. Throws SceneError for what only the world finds, such as inverted tetrahedra.
Scene build_scene(const ScenePlan& plan);

}  // namespace skerry
