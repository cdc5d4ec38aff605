// Shortest distance between the objects of a scene, for a run in which no objects touched.
#pragma once

#include <string>

#include "skerry/world.h"

namespace skerry {

/// Returns the shortest distance between a node of a body and the surface of another object that may collide with the
/// body, as text with the names of both. Returns an empty text if there is no such pair, or if the scene is so large
/// that the search would take long.
std::string nearest_text(const World& world);

}  // namespace skerry
