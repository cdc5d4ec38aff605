// Changes of a scene on its way in: bodies[0].position=[0,0,1].
#pragma once

#include <filesystem>
#include <string>

#include "engine/scene/place.h"

namespace skerry {

/// Carries out PLACE=VALUE on what a scene file holds. PLACE is written as messages write it:
/// bodies[3].mesh.ball.radius, materials["soft rubber"].E; objects that are not there are made, items of lists must be
/// there. VALUE is JSON, or the text that it is. Throws SceneError that names `file` and the assignment.
void assign(const std::string& assignment, const std::filesystem::path& file, Json& scene);

}  // namespace skerry
