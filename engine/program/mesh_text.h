// Text and JSON about meshes.
#pragma once

#include <string>
#include <vector>

#include "engine/scene/scene_plan.h"

namespace skerry {

using Problems = std::vector<std::string>;

/// Returns the faults of a mesh, each with the number of affected elements.
Problems problems_of(const MeshReport& report);
Json mesh_json(const MeshReport& report);
/// Returns the number of tetrahedra per label, for example "label 1: 300 tetrahedra, label 2: 20 tetrahedra". Only the
/// first 20 labels are listed.
std::string labels_text(const MeshReport& report);
/// Describes a set, such as "skin": 12 nodes, 20 faces. `count`: numbers of listed nodes, faces and tetrahedra.
std::string set_text(const std::string& name, const std::array<std::size_t, 3>& count);
/// Returns the name of a body and the file of its mesh, for example: body "ball" (mesh meshes/ball.msh).
std::string mesh_of_body_text(const ScenePlan& plan, std::size_t body);

}  // namespace skerry
