// Changes to a scene while it is read, such as bodies[0].position=[0,0,1].
#pragma once

#include <filesystem>
#include <string>

#include "engine/scene/place.h"

namespace skerry {

/// Applies PLACE=VALUE to the content of a scene file. PLACE is written as in messages: bodies[3].mesh.ball.radius,
/// materials["soft rubber"].E. Missing objects are created; list items must exist. VALUE is JSON, or otherwise a plain
/// text. Throws SceneError that names `file` and the assignment.
void assign(const std::string& assignment, const std::filesystem::path& file, Json& scene);

}  // namespace skerry
