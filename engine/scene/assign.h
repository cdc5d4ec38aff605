// Assignments that change a scene while it is read, such as bodies[0].position=[0,0,1].
#pragma once

#include <filesystem>
#include <string>

#include "engine/scene/place.h"

namespace skerry {

/// Applies an assignment PLACE=VALUE to the content of a scene file. Throws SceneError that names `file` and the
/// assignment.
/// - PLACE has the form used in error messages: bodies[3].mesh.ball.radius, materials["soft rubber"].E. Missing JSON
///   objects on the way to PLACE are created, except for materials. An index must belong to an existing list item.
/// - VALUE is read as JSON, or as a text if it is not valid JSON.
void assign(const std::string& assignment, const std::filesystem::path& file, Json& scene);

}  // namespace skerry
