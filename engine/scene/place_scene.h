// Scenes that another scene includes with a name and a pose.
#pragma once

#include "engine/scene/scene_file.h"

namespace skerry {

/// Adds the objects of the scene `included` to `scene`, moved and renamed as `include` prescribes. Values that a scene
/// has only once, such as its settings, are taken from `scene`. Throws SceneError if
/// - `include` has a rotation and `included` has pins along world axes,
/// - `included` has a load on all bodies, because it would also act on the bodies of `scene`.
void add_placed(const IncludeEntry& include, SceneFile& included, SceneFile& scene);

}  // namespace skerry
