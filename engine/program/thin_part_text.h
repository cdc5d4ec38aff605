// Text about parts of a body that are too stiff in bending, because few cells lie across their thickness.
#pragma once

#include <array>
#include <span>
#include <string>

#include "engine/program/step_bound.h"

namespace skerry {

/// Describes the thin part of a body with the largest excess of bending stiffness over that of its material, counts the
/// other parts that are too stiff, and gives a remedy. If no thin part is too stiff, names a kind of elements of the
/// body that lock, because the material is nearly incompressible. Otherwise returns an empty text. `boundary` lists the
/// boundary triangles of the mesh.
std::string thin_part_text(const Mesh& mesh, std::span<const std::array<Index, 3>> boundary, const BodyCase& body_case);

}  // namespace skerry
