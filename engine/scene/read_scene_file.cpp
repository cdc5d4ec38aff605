#include "engine/scene/assign.h"
#include "engine/scene/parse_json.h"
#include "engine/scene/scene_rules.h"

namespace skerry {

namespace {

/// Reads a scene file and the files that it includes. `open` lists the files that are being read now, from the
/// outermost to the innermost.
void read_into(SceneFile& scene, const std::filesystem::path& file, std::span<const std::string> assignments,
               std::vector<std::filesystem::path>& open) {
    Json json = read_json(file);
    for (const std::string& assignment : assignments) assign(assignment, file, json);
    const Place place(file);

    // The file is evaluated twice. The first time, only the included files are found and read. The second time, the
    // content of this file is added to the content of the included files.
    SceneFile own;
    rule_of<SceneFile>().read(json, place, own);
    open.push_back(std::filesystem::weakly_canonical(file));
    for (const FilePath& included : own.include.items) {
        const std::filesystem::path next = std::filesystem::weakly_canonical(included.path);
        if (std::find(open.begin(), open.end(), next) != open.end())
            place.key("include").refuse(
                in_quotes(included.path.string()) + ", which includes this file directly or through other files",
                "a scene file that does not include this file", "delete one of the two includes");
        read_into(scene, included.path, {}, open);
    }
    open.pop_back();
    if (own.include.items.empty() && open.empty()) {
        scene = std::move(own);
        return;
    }
    rule_of<SceneFile>().read(json, place, scene);
}

}  // namespace

SceneFile read_scene_file(const std::filesystem::path& file, std::span<const std::string> assignments) {
    SceneFile scene;
    std::vector<std::filesystem::path> open;
    read_into(scene, file, assignments, open);
    if (scene.name.empty()) scene.name = file.stem().string();
    if (scene.bodies.empty())
        Place(file).key("bodies").refuse("no bodies", "at least one body", "add a body to \"bodies\"");
    return scene;
}

}  // namespace skerry
