// Warnings and notes about the values in a scene, found before its first step.
#pragma once

#include <string>
#include <vector>

#include "engine/scene/scene_plan.h"

namespace skerry {

/// Returns one sentence for each value that was probably given in another unit, or that the run does not use although
/// it differs from the value used.
std::vector<std::string> plan_warnings(const ScenePlan& plan);

/// Returns the notes of the reading of a scene, and one note for each mesh of several parts that deforms. The note
/// names one body with this mesh.
std::vector<std::string> plan_notes(const ScenePlan& plan);

/// Prints one line for each text on standard error. `kind`: NOTE or WARNING.
void print_lines(const char* kind, const std::vector<std::string>& texts);

}  // namespace skerry
