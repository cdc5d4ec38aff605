// Random valid scenes: as JSON, so that `skerry run` can rerun one that failed, and changes in mid-run, which JSON
// cannot say.
#pragma once

#include <cstdint>
#include <filesystem>
#include <string>
#include <utility>
#include <vector>

#include "components/types.h"
#include "skerry/mesh.h"

namespace skerry::test {

/// What happens to the world before one of the calls of advance.
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
    int advance = 0;  // before this one, from 0
    Change change = Change::remove_body;
    std::uint64_t seed = 0;  // of what it needs to know
};

struct RandomScene {
    std::string json;
    std::vector<std::pair<std::string, Mesh>> meshes;  // names of files beside the JSON, and what is in them
    std::vector<SceneChange> changes;                  // by ascending advance
    int advances = 0;
    Real steps_per_advance = 1;   // stable steps
    Real length = 1;              // m, of its bodies, about
    Real speed = 0;               // m/s, the highest that something starts or is moved with
    bool passive = true;          // nothing does work on it but gravity, and contacts that are pressed in at its start
    bool oversized_step = false;  // it asks for a step that may be longer than the stable one
};

/// Writes the scene and its meshes into a folder that is there; returns the file of the scene.
std::filesystem::path write_random_scene(const RandomScene& scene, const std::filesystem::path& folder,
                                         const std::string& name);

/// The same seed gives the same scene on every machine. Spheres, capsules, cylinders, bodies of all built-in shapes and
/// of poor meshes that overlap, touch or nearly touch; 1 mm to 100 m, E 1e3 to 1e9 Pa, nu -0.3 to 0.499, density 1 to
/// 1e4 kg/m^3, friction 0 to 10, speeds up to 100 m/s; every kind of collider, still or moved; pins, self contact, all
/// methods, laws and switches.
RandomScene make_random_scene(std::uint64_t seed);

}  // namespace skerry::test
