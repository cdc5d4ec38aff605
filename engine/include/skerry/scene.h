// Scenes: JSON files that describe a world and a run.
#pragma once

#include <filesystem>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "skerry/recorder.h"
#include "skerry/slider.h"
#include "skerry/world.h"

#pragma GCC visibility push(default)
namespace skerry {

/// Values with which the caller replaces settings of a scene file.
struct SceneOverrides {
    std::optional<int> threads{};                     // Settings::threads
    std::optional<Backend> backend{};                 // Settings::backend
    std::optional<ContactRegions> contact_regions{};  // Settings::contact_regions
    std::optional<SolverMethod> method{};             // Settings::method
    std::optional<Friction> friction{};               // Settings::friction
    std::optional<Real> tolerance{};                  // Settings::tolerance
    std::optional<int> max_iterations{};              // Settings::max_iterations
    std::optional<StartOverlaps> start_overlaps{};    // Settings::start_overlaps
    std::optional<Real> step_size{};                  // Settings::step_size [s]
    std::optional<ElementKind> element{};  // element kind for all bodies, in place of the kinds in the scene file
    // Assignments PLACE=VALUE to keys of the scene file, such as bodies[0].position=[0,0,1]. PLACE is written as in
    // error messages about the scene file. VALUE is JSON; if it is not valid JSON, it is taken as a text.
    //
    // They are made in the given order, before the other members of this struct replace values. They do not change the
    // files that the scene file includes.
    std::vector<std::string> assignments{};
    std::string fill_python{};  // Python interpreter for filling surfaces; see mesh::FillSettings::python
};

/// Some nodes of a body, such as the feet of a table. The program `skerry run` reports the contacts of these nodes.
struct Probe {
    std::string name;          // name in the report
    BodyHandle body;           // body of the nodes
    std::vector<Index> nodes;  // numbers of the nodes within the body
};

/// A scene file's content, with the world already built.
struct Scene {
    std::string name;                     // key `name` of the file; by default the name of the file
    std::string description;              // key `description` of the file
    std::vector<std::string> materials;   // names of the materials, in the order added
    Real seconds = 2;                     // default duration of a run [s]
    Real frame_step = 1.0 / 60;           // time between two frames of output [s]
    World world;                          // the world at the time 0
    std::vector<Probe> probes;            // node sets whose contacts the run reports
    std::vector<RecordedProbe> recorded;  // probes for a Recorder, in the order of the file
    // Time between two samples of the contacts of `probes`. Also the time between two rows of the time series that a
    // Recorder writes for the probes `recorded` [s].
    Real probe_step = 1.0 / 60;
    std::vector<Slider> sliders{};  // values that a user of the live view can change
    // corrections and warnings from reading the file, for example about filled surfaces
    std::vector<std::string> notes{};
};

/// Reads a scene file and builds its world. Relative paths of mesh files start at the folder of the scene file. Throws
/// SceneError for any invalid input; for an unknown key the message names the known key with the most similar name.
/// `progress`: called many times a second while a surface is filled with tetrahedra, with a text on the current
/// activity. If it throws, load_scene() ends with this exception.
Scene load_scene(const std::filesystem::path& file, const SceneOverrides& overrides = {},
                 const std::function<void(const std::string&)>& progress = {});

/// Builds a scene from the text of a scene file. Relative paths start at `folder`. Errors give "scene" as the name of
/// the file. `progress`: see load_scene().
Scene load_scene_text(const std::string& json, const std::filesystem::path& folder,
                      const SceneOverrides& overrides = {},
                      const std::function<void(const std::string&)>& progress = {});

/// Returns the JSON schema of scene files.
std::string scene_schema();

}  // namespace skerry
#pragma GCC visibility pop
