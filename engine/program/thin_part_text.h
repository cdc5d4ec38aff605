// Text about parts of a body that are too stiff in bending, because few cells lie across their thickness.
#pragma once

#include <array>
#include <span>
#include <string>

#include "engine/program/step_bound.h"

namespace skerry {

/// Returns a text about problems of a body in bending:
/// - If the mesh of thin parts is too stiff compared to their material, the text describes the stiffest part, counts
///   the others, and gives a remedy.
/// - Otherwise, if elements lock (are far too stiff, because the material is nearly incompressible), it names their
///   kind.
/// - Otherwise it is empty.
///
/// `boundary`: boundary triangles of the mesh.
std::string thin_part_text(const Mesh& mesh, std::span<const std::array<Index, 3>> boundary, const BodyCase& body_case);

}  // namespace skerry
