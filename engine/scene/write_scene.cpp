#include "engine/scene/write_scene.h"

#include "engine/base/write_file.h"
#include "engine/scene/assign.h"
#include "engine/scene/parse_json.h"
#include "engine/scene/scene_file.h"

namespace skerry {

namespace {

/// Calls use(place, path) for each path of a file in a scene.
void for_each_path(const SceneFile& scene, auto use) {
    const auto use_mesh = [&](const MeshEntry& mesh) {
        if (mesh.file) use(mesh.place.key("file"), mesh.file->path);
        if (mesh.surface) use(mesh.place.key("surface"), mesh.surface->path);
    };
    for (const BodyEntry& body : scene.bodies) {
        if (body.mesh) use_mesh(*body.mesh);
        // An entry of a visual surface or an included scene that has no key other than its path may be a plain path
        // instead of an object. The new path then replaces the whole entry.
        if (body.visual)
            use(body.visual->scale ? body.visual->place.key("file") : body.visual->place, body.visual->file.path);
    }
    for (const ColliderEntry& collider : scene.colliders)
        if (collider.shape.mesh) use_mesh(*collider.shape.mesh);
    for (const IncludeEntry& include : scene.include.items)
        use(include.name.empty() ? include.place : include.place.key("scene"), include.scene.path);
}

}  // namespace

std::string path_in_scene(const std::filesystem::path& file, const std::filesystem::path& scene) {
    // Symbolic links are resolved first, because ".." leads out of the folder to which a link points, not out of the
    // folder that contains the link.
    const auto folder_of = [](const std::filesystem::path& path) {
        return std::filesystem::weakly_canonical(std::filesystem::absolute(path).parent_path());
    };
    return (folder_of(file) / file.filename()).lexically_relative(folder_of(scene)).string();
}

void write_scene(const std::filesystem::path& target, const std::filesystem::path& source,
                 std::span<const std::string> assignments) {
    Json json = read_json(source);
    for (const std::string& assignment : assignments) assign(assignment, source, json);
    for_each_path(read_scene_file(source, assignments), [&](const Place& place, const std::filesystem::path& path) {
        if (place.file() == source) assign(place.path() + "=" + Json(path_in_scene(path, target)).dump(), source, json);
    });
    if (const auto schema = json.find("$schema"); schema != json.end()) {
        const auto text = schema->get<std::string>();
        if (text.find("://") == std::string::npos) *schema = path_in_scene(source.parent_path() / text, target);
    }
    write_file(target, [&](std::ostream& out) { out << json.dump(4) << "\n"; });
}

}  // namespace skerry
