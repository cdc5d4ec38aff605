#include "engine/scene/scene_rules.h"
#include "skerry/scene.h"

namespace skerry {

std::string scene_schema() {
    SchemaBook definitions = SchemaBook::object();
    const Json scene = rule_of<SceneFile>().schema(definitions);
    Json schema = {{"$schema", "https://json-schema.org/draft/2020-12/schema"}, {"title", "Skerry scene"}};
    for (const auto& [key, value] : scene.items()) schema[key] = value;
    schema["$defs"] = definitions;
    return schema.dump(1) + "\n";
}

}  // namespace skerry
