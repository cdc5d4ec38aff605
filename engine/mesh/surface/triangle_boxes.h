// Bounding boxes of the triangles of a surface.
#pragma once

#include <vector>

#include "engine/mesh/repair/surface_measures.h"
#include "systems/collision/tree/box.h"

namespace skerry::mesh {

/// Bounding boxes of all triangles, enlarged by `margin` on each side [m].
inline std::vector<Aabb> triangle_boxes(const SurfaceMesh& surface, Real margin) {
    std::vector<Aabb> boxes(surface.triangles.size(), empty_box());
    for (std::size_t t = 0; t < boxes.size(); ++t) {
        for (const Vec3& x : corners_of(surface, static_cast<Index>(t))) grow(boxes[t], x);
        boxes[t].lower.array() -= margin;
        boxes[t].upper.array() += margin;
    }
    return boxes;
}

}  // namespace skerry::mesh
