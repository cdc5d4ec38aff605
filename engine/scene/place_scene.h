// Scenes that another scene includes with a name and a pose.
#pragma once

#include "engine/scene/scene_file.h"

namespace skerry {

/// Adds the objects of the scene `included` to `scene`, moved and renamed as `include` prescribes. Single values of the
/// included scene, such as its settings, are not used. Throws SceneError for pins along world axes if `include`
/// rotates, and for loads on all bodies.
void add_placed(const IncludeEntry& include, SceneFile& included, SceneFile& scene);

}  // namespace skerry
