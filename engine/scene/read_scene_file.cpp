#include "engine/scene/assign.h"
#include "engine/scene/parse_json.h"
#include "engine/scene/place_scene.h"
#include "engine/scene/scene_rules.h"

namespace skerry {

namespace {

/// Adds the content of a scene and of the files that it includes. `open`: files that are being read now, from the
/// outermost to the innermost, which has the content `json`. With this list a file that includes itself is refused.
void read_into(SceneFile& scene, const Json& json, const Place& place, std::vector<std::filesystem::path>& open) {
    // The content is read twice: first to find the included files, whose contents are added to `scene`, and then to add
    // the own content, whose values replace those of the included files. An outermost scene without included files is
    // read once.
    SceneFile own;
    rule_of<SceneFile>().read(json, place, own);
    std::vector<std::string> names;
    for (const IncludeEntry& included : own.include.items) {
        const std::filesystem::path& file = included.scene.path;
        const std::filesystem::path next = std::filesystem::weakly_canonical(file);
        if (std::find(open.begin(), open.end(), next) != open.end())
            place.key("include").refuse(
                in_quotes(file.string()) + ", which includes this file directly or through other files",
                "a scene file that does not include this file", "delete one of the two includes");
        open.push_back(next);
        if (included.name.empty()) {
            read_into(scene, read_json(file), Place(file), open);
        } else {
            if (std::ranges::find(names, included.name) != names.end())
                included.place.key("name").refuse(in_quotes(included.name) + ", which another included scene has",
                                                  "a different name for every included scene");
            if (included.name.find('/') != std::string::npos)
                included.place.key("name").refuse(in_quotes(included.name),
                                                  "a name without /, which separates it from the names of objects");
            names.push_back(included.name);
            SceneFile part;
            read_into(part, read_json(file), Place(file), open);
            add_placed(included, part, scene);
        }
        open.pop_back();
    }
    if (own.include.items.empty() && open.size() == 1) {
        scene = std::move(own);
        return;
    }
    rule_of<SceneFile>().read(json, place, scene);
}

/// Applies the assignments to `json` and reads it as a scene. `file`: canonical path of the scene file; empty if the
/// scene is given as a text.
SceneFile read_scene(Json json, const Place& place, const std::filesystem::path& file,
                     std::span<const std::string> assignments) {
    for (const std::string& assignment : assignments) assign(assignment, place.file(), json);
    SceneFile scene;
    std::vector<std::filesystem::path> open{file};
    read_into(scene, json, place, open);
    if (scene.name.empty()) scene.name = place.file().stem().string();
    if (scene.bodies.empty()) place.key("bodies").refuse("no bodies", "at least one body", "add a body to \"bodies\"");
    return scene;
}

}  // namespace

SceneFile read_scene_file(const std::filesystem::path& file, std::span<const std::string> assignments) {
    return read_scene(read_json(file), Place(file), std::filesystem::weakly_canonical(file), assignments);
}

SceneFile read_scene_text(const std::string& json, const std::filesystem::path& folder,
                          std::span<const std::string> assignments) {
    const Place place(scene_text_name, folder);
    return read_scene(parse_json(json, place.file()), place, {}, assignments);
}

}  // namespace skerry
