// Warnings and notes about the values in a scene, found before its first step.
#pragma once

#include <string>
#include <vector>

#include "engine/scene/scene_plan.h"

namespace skerry {

/// Returns one sentence for each value that is probably a mistake, for example one in a wrong unit, and for each given
/// value that the run ignores.
std::vector<std::string> plan_warnings(const ScenePlan& plan);

/// Returns the notes from reading the scene, and one note for each mesh that consists of several unconnected parts and
/// belongs to a deformable body. The note names one such body.
std::vector<std::string> plan_notes(const ScenePlan& plan);

/// Prints one line for each text on standard error. `kind`: NOTE or WARNING.
void print_lines(const char* kind, const std::vector<std::string>& texts);

}  // namespace skerry
