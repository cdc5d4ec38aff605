// Replacement for engine/scene and engine/study if SKERRY_SCENES=OFF. All functions throw SceneError.
#include "engine/absent/refuse_absent.h"
#include "skerry/scene.h"
#include "skerry/study.h"

namespace skerry {

Scene load_scene(const std::filesystem::path&, const SceneOverrides&, const std::function<void(const std::string&)>&) {
    refuse_absent("load_scene", "SKERRY_SCENES");
}
Scene load_scene_text(const std::string&, const std::filesystem::path&, const SceneOverrides&,
                      const std::function<void(const std::string&)>&) {
    refuse_absent("load_scene_text", "SKERRY_SCENES");
}
std::string scene_schema() {
    refuse_absent("scene_schema", "SKERRY_SCENES");
}
StudyResult study(const std::filesystem::path&, const StudySettings&) {
    refuse_absent("study", "SKERRY_SCENES");
}
std::string study_text(const StudyResult&) {
    refuse_absent("study_text", "SKERRY_SCENES");
}
std::string study_page(const StudyResult&) {
    refuse_absent("study_page", "SKERRY_SCENES");
}
std::string study_json(const StudyResult&) {
    refuse_absent("study_json", "SKERRY_SCENES");
}
void write_cheapest_scene(const std::filesystem::path&, const StudyResult&, const std::filesystem::path&) {
    refuse_absent("write_cheapest_scene", "SKERRY_SCENES");
}

}  // namespace skerry
