// Scenes: JSON files that describe a world and a run.
#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "skerry/recorder.h"
#include "skerry/world.h"

#pragma GCC visibility push(default)
namespace skerry {

/// Changes that the caller makes to the settings of a scene.
struct SceneOverrides {
    std::optional<int> threads{};
    std::optional<Backend> backend{};
    std::optional<ContactRegions> contact_regions{};
    std::optional<SolverMethod> method{};
    std::optional<Friction> friction{};
    std::optional<Real> tolerance{};
    std::optional<int> max_iterations{};
    std::optional<StartOverlaps> start_overlaps{};
    std::optional<Real> step_size{};
    std::optional<ElementKind> element{};  // element kind of all bodies
    // Assignments PLACE=VALUE, such as bodies[0].position=[0,0,1]. They change the scene file itself, not the files
    // that it includes, in this order and before all members above. PLACE is written as in error messages. VALUE is
    // JSON, else it is taken as a string.
    std::vector<std::string> assignments{};
};

/// A part of a body whose contacts a run reports, such as the feet of a table.
struct Probe {
    std::string name;
    BodyHandle body;
    std::vector<Index> nodes;  // local node numbers
};

/// A scene with its world built.
struct Scene {
    std::string name;
    std::string description;
    std::vector<std::string> materials;  // names of the materials, in the order added
    Real seconds = 2;                    // default length of a run [s]
    Real frame_step = 1.0 / 60;          // time between frames of output [s]
    World world;
    std::vector<Probe> probes;
    std::vector<RecordedProbe> recorded;  // probes for a Recorder, in the order of the file
    Real probe_step = 1.0 / 60;           // time between two samples of the probes, or two rows [s]
};

/// Reads a scene and builds its world. Mesh files are searched beside the scene file. Throws SceneError for any input
/// that it does not understand; for an unknown key the message names the nearest known one.
Scene load_scene(const std::filesystem::path& file, const SceneOverrides& overrides = {});

/// The JSON schema of scene files.
std::string scene_schema();

}  // namespace skerry
#pragma GCC visibility pop
