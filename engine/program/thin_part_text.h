// Text about parts of a body that are too stiff in bending, because few cells lie across their thickness.
#pragma once

#include <array>
#include <span>
#include <string>

#include "engine/program/step_bound.h"

namespace skerry {

/// Returns a text about the thin part of a body that is stiffest in bending compared to its material. The text also
/// counts the other parts that are too stiff, and gives a remedy. If no part is too stiff, but elements of the body
/// lock (are far too stiff, because the material is nearly incompressible), the text names their kind. Otherwise it is
/// empty. `boundary`: boundary triangles of the mesh.
std::string thin_part_text(const Mesh& mesh, std::span<const std::array<Index, 3>> boundary, const BodyCase& body_case);

}  // namespace skerry
