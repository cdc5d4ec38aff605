// Random valid scenes. Each is JSON, which `skerry run` can run, with internal settings and changes during the run,
// which JSON cannot express. The program random_scenes reruns a failed one from its seed.
#pragma once

#include <cstdint>
#include <filesystem>
#include <string>
#include <utility>
#include <vector>

#include "components/types.h"
#include "engine/world/tuning.h"
#include "skerry/mesh.h"

namespace skerry::test {

/// A change made to the world before one of the calls of advance.
enum class Change {
    remove_body,
    remove_collider,
    add_body,
    add_collider,
    attach,
    detach,
    set_velocities,
    set_loads,
    set_gravity
};

struct SceneChange {
    int advance = 0;  // number of the call of advance that follows the change, from 0
    Change change = Change::remove_body;
    std::uint64_t seed = 0;  // for the random parameters of the change
};

struct RandomScene {
    std::string json;
    Tuning tuning;
    std::vector<std::pair<std::string, Mesh>> meshes;  // names and contents of the files beside the JSON
    std::vector<SceneChange> changes;                  // sorted by advance, ascending
    int advances = 0;
    Real steps_per_advance = 1;   // length of one call of advance [stable steps]
    Real length = 1;              // approximate size of the bodies [m]
    Real speed = 0;               // highest speed at which anything starts or is moved [m/s]
    bool passive = true;          // no energy input but gravity and contacts that overlap at the start
    bool oversized_step = false;  // the scene asks for a step that may exceed the stable step
};

/// Writes the scene and its meshes into an existing folder. Returns the path of the scene file.
std::filesystem::path write_random_scene(const RandomScene& scene, const std::filesystem::path& folder,
                                         const std::string& name);

/// Builds the scene of a seed; the scene is the same on every machine. It has spheres, capsules, cylinders, and bodies
/// of all built-in shapes and of poor meshes that overlap, touch or nearly touch. Sizes 1 mm to 100 m, E 1e3 to 1e9 Pa,
/// nu -0.3 to 0.499, density 1 to 1e4 kg/m^3, friction 0 to 10, speeds up to 100 m/s; every kind of collider, still or
/// moved; pins, self contact, all methods, laws and switches.
RandomScene make_random_scene(std::uint64_t seed);

}  // namespace skerry::test
