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
    std::optional<Real> relaxation{};
    std::optional<Real> step_size{};
    std::optional<ElementKind> element{};  // of all bodies
    // PLACE=VALUE, such as bodies[0].position=[0,0,1], in their order and before all above: of the file itself, not of
    // what it includes. PLACE as messages write it, VALUE in JSON or a text.
    std::vector<std::string> assignments{};
};

/// A part of a body whose contacts a run reports, such as the feet of a table.
struct Probe {
    std::string name;
    BodyHandle body;
    std::vector<Index> nodes;  // local
};

/// A scene as built.
struct Scene {
    std::string name;
    std::string description;
    std::vector<std::string> materials;  // names, in the order added
    Real seconds = 2;                    // s, length of a run unless asked otherwise
    Real frame_step = 1.0 / 60;          // s, between frames of output
    World world;
    std::vector<Probe> probes;
    std::vector<RecordedProbe> recorded;  // what a Recorder takes, in the order of the file
    Real probe_step = 1.0 / 60;           // s, between two looks at the probes, or two rows
};

/// Reads and builds a scene. Mesh files are looked for beside it. Throws SceneError for anything it does not
/// understand: unknown keys name the nearest known one.
Scene load_scene(const std::filesystem::path& file, const SceneOverrides& overrides = {});

/// The JSON schema of scene files.
std::string scene_schema();

}  // namespace skerry
#pragma GCC visibility pop
