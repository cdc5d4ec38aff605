// Scenes that another scene includes with a name and a pose.
#pragma once

#include "engine/scene/scene_file.h"

namespace skerry {

/// Adds the objects of the scene `included` to `scene`, moved and renamed as `include` prescribes. Values that a
/// scene has only once, such as its settings, are taken from `scene`, not from `included`. Throws SceneError if
/// `included` has pins along world axes and `include` rotates them, or if it has a load on all bodies, which would also
/// act on those of `scene`.
void add_placed(const IncludeEntry& include, SceneFile& included, SceneFile& scene);

}  // namespace skerry
