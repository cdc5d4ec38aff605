// Bending stiffness of the elements of thin parts, as a multiple of the stiffness by the theory of beams.
#pragma once

#include <span>
#include <vector>

#include "engine/mesh/thin/column.h"
#include "engine/mesh/thin/thin_parts.h"

namespace skerry::mesh {

/// A column of a part, and the direction of the axis that becomes curved when the part is bent: `tangent`, a unit
/// vector perpendicular to the column.
struct BentColumn {
    const ThinColumn* column;
    Vec3 tangent;
    std::size_t part;
};

/// Returns the stiffness of each part in bending, as a multiple of the exact one (see ThinPart::stiffness).
std::vector<Real> bending_stiffness(const Mesh& mesh, std::span<const BentColumn> columns, std::size_t part_count,
                                    std::span<const MaterialZone> zones, std::span<const ElasticConstants> materials);

}  // namespace skerry::mesh
