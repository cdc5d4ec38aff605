// Assignments that change a scene while it is read, such as bodies[0].position=[0,0,1].
#pragma once

#include <filesystem>
#include <string>

#include "engine/scene/place.h"

namespace skerry {

/// Applies an assignment PLACE=VALUE to the content of a scene file. PLACE has the form used in error messages:
/// bodies[3].mesh.ball.radius, materials["soft rubber"].E. JSON objects on the way to PLACE are created if they are
/// missing. An index in PLACE must belong to an existing list item. If PLACE lies inside a material, this material must
/// exist. VALUE is read as JSON; if it is not valid JSON, it is taken as a text. Throws SceneError that names `file`
/// and the assignment.
void assign(const std::string& assignment, const std::filesystem::path& file, Json& scene);

}  // namespace skerry
