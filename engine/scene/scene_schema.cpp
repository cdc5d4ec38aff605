#include "engine/scene/scene_rules.h"
#include "skerry/scene.h"

namespace skerry {

std::string schema_document(const std::string& title, const RuleTable& rule) {
    SchemaBook definitions = SchemaBook::object();
    const Json object = rule.schema(definitions);
    Json schema = object_of({{"$schema", "https://json-schema.org/draft/2020-12/schema"}, {"title", title}});
    for (const auto& [key, value] : object.items()) schema[key] = value;
    schema["$defs"] = definitions;
    return schema.dump(1) + "\n";
}

std::string scene_schema() {
    return schema_document("Skerry scene", rule_of<SceneFile>());
}

}  // namespace skerry
