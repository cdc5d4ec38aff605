// Bending stiffness of the elements of thin parts, relative to the exact stiffness by the theory of beams.
#pragma once

#include <span>
#include <vector>

#include "engine/mesh/thin/column.h"
#include "engine/mesh/thin/thin_parts.h"

namespace skerry::mesh {

/// A column of cells through the thickness of a thin part, and a unit vector `tangent` perpendicular to the column:
/// the direction of the axis that becomes curved when the part is bent.
struct BentColumn {
    const ThinColumn* column;
    Vec3 tangent;
    std::size_t part;
};

/// Returns the stiffness of each part in bending, as a multiple of the exact one (see ThinPart::stiffness).
std::vector<Real> bending_stiffness(const Mesh& mesh, std::span<const BentColumn> columns, std::size_t part_count,
                                    std::span<const MaterialZone> zones, std::span<const ElasticConstants> materials);

}  // namespace skerry::mesh
